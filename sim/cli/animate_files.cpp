#include "sim/cli/animate_files.h"

#include <utility>

#include "base/y4m.h"
#include "mpeg1/repeats.h"
#include "mpeg1/system.h"
#include "sim/cli/command.h"
#include "sim/cli/report_files.h"
#include "sim/frame420.h"
#include "sim/pacs.h"

namespace pac::cli {
namespace {

void append(Bytes& out, std::span<const uint8_t> bytes) {
  out.insert(out.end(), bytes.begin(), bytes.end());
}

}  // namespace

AnimationFiles::AnimationFiles(std::string folder, sim::VideoCodec codec, int fps, Isa isa)
    : folder_(std::move(folder)), codec_(codec), fps_(fps), isa_(isa) {}

int AnimationFiles::open() const {
  return folder_.empty() ? kDone : make_folder(folder_);
}

void AnimationFiles::add_session(std::span<const uint8_t> session) {
  if (!folder_.empty()) sim::append_pacs_message(pacs_, session);
}

void AnimationFiles::add_picture(Bytes& sequence, const RgbImage& picture) const {
  if (sequence.empty())
    append_y4m_header(sequence, {picture.width(), picture.height(), fps_, 1, 1, 1, ChromaSiting::jpeg});
  Frame420 frame(picture.width(), picture.height());
  sim::frame420_from_rgb(picture.view(), frame, isa_);
  append_y4m_frame(sequence, frame);
}

void AnimationFiles::add_frame(const sim::AnimationFrame& frame) {
  if (folder_.empty()) return;
  append(image_, frame.image_code);
  append(difference_, frame.difference_code);
  sim::append_pacs_message(pacs_, frame.packet);
  add_picture(high_y4m_, frame.high);
  add_picture(image_y4m_, frame.image_based);
  add_picture(composite_y4m_, frame.composite);
}

// The paper's 20 frames a second is no legal picture_rate: files for players repeat pictures.
int AnimationFiles::write_videos() const {
  const auto image = mpeg1::with_repeats(image_, 1000 * fps_);
  if (!image.ok()) return data_error("image.m1v", image.failure());
  const auto system = mpeg1::multiplex(*image);
  if (!system.ok()) return data_error("image.mpg", system.failure());
  const auto difference = mpeg1::with_repeats(difference_, 1000 * fps_);
  if (!difference.ok()) return data_error("difference.m1v", difference.failure());
  if (const int code = write_output(folder_ + "/image.m1v", *image); code != kDone) return code;
  if (const int code = write_output(folder_ + "/image.mpg", *system); code != kDone) return code;
  return write_output(folder_ + "/difference.m1v", *difference);
}

int AnimationFiles::write_jpegs() const {
  if (const int code = write_output(folder_ + "/image.mjpeg", image_); code != kDone) return code;
  return write_output(folder_ + "/difference.mjpeg", difference_);
}

int AnimationFiles::write() const {
  if (folder_.empty()) return kDone;
  const int code_of_streams = codec_ == sim::VideoCodec::mpeg1 ? write_videos() : write_jpegs();
  if (code_of_streams != kDone) return code_of_streams;
  const std::pair<const char*, const Bytes*> files[] = {
      {"session.pacs", &pacs_}, {"H.y4m", &high_y4m_}, {"image.y4m", &image_y4m_}, {"composite.y4m", &composite_y4m_}};
  for (const auto& [name, bytes] : files)
    if (const int code = write_output(folder_ + "/" + name, *bytes); code != kDone) return code;
  return kDone;
}

}  // namespace pac::cli
