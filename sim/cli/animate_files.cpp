#include "sim/cli/animate_files.h"

#include <utility>

#include "base/y4m.h"
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

int AnimationFiles::write() const {
  if (folder_.empty()) return kDone;
  const bool is_video = codec_ == sim::VideoCodec::mpeg1;
  const std::pair<const char*, const Bytes*> files[] = {
      {is_video ? "image.m1v" : "image.mjpeg", &image_},
      {is_video ? "difference.m1v" : "difference.mjpeg", &difference_},
      {"session.pacs", &pacs_},
      {"H.y4m", &high_y4m_},
      {"image.y4m", &image_y4m_},
      {"composite.y4m", &composite_y4m_}};
  for (const auto& [name, bytes] : files)
    if (const int code = write_output(folder_ + "/" + name, *bytes); code != kDone) return code;
  return kDone;
}

}  // namespace pac::cli
