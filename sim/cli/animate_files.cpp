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

// The paper's 20 frames a second is no legal picture_rate: files for players repeat pictures.
int write_videos(const std::string& folder, int fps, std::span<const uint8_t> image,
                 std::span<const uint8_t> difference) {
  const auto of_image = mpeg1::with_repeats(image, 1000 * fps);
  if (!of_image.ok()) return data_error("image.m1v", of_image.failure());
  const auto system = mpeg1::multiplex(*of_image);
  if (!system.ok()) return data_error("image.mpg", system.failure());
  const auto of_difference = mpeg1::with_repeats(difference, 1000 * fps);
  if (!of_difference.ok()) return data_error("difference.m1v", of_difference.failure());
  if (const int code = write_output(folder + "/image.m1v", *of_image); code != kDone) return code;
  if (const int code = write_output(folder + "/image.mpg", *system); code != kDone) return code;
  return write_output(folder + "/difference.m1v", *of_difference);
}

}  // namespace

int write_streams(const std::string& folder, sim::VideoCodec codec, int fps, std::span<const uint8_t> image,
                  std::span<const uint8_t> difference) {
  if (codec == sim::VideoCodec::mpeg1) return write_videos(folder, fps, image, difference);
  if (const int code = write_output(folder + "/image.mjpeg", image); code != kDone) return code;
  return write_output(folder + "/difference.mjpeg", difference);
}

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

int AnimationFiles::write() const {
  if (folder_.empty()) return kDone;
  if (const int code = write_streams(folder_, codec_, fps_, image_, difference_); code != kDone) return code;
  const std::pair<const char*, const Bytes*> files[] = {
      {"session.pacs", &pacs_}, {"H.y4m", &high_y4m_}, {"image.y4m", &image_y4m_}, {"composite.y4m", &composite_y4m_}};
  for (const auto& [name, bytes] : files)
    if (const int code = write_output(folder_ + "/" + name, *bytes); code != kDone) return code;
  return kDone;
}

}  // namespace pac::cli
