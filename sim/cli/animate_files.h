// What `pac animate -o DIR` leaves behind.
#pragma once

#include <span>
#include <string>

#include "sim/animation.h"

namespace pac::cli {

// The streams of a sequence into a folder that exists: image.mjpeg and difference.mjpeg, or image.m1v, image.mpg (the
// same in a system stream) and difference.m1v, at a legal picture_rate with repeated pictures. image, difference: JPEG
// files one after the other, or MPEG-1 of `fps` pictures a second. kDone, or kBadData after the message.
int write_streams(const std::string& folder, sim::VideoCodec codec, int fps, std::span<const uint8_t> image,
                  std::span<const uint8_t> difference);

// DIR/image.mjpeg, difference.mjpeg (one JPEG after the other, as ffplay reads them) or image.m1v, image.mpg (the same
// in a system stream), difference.m1v, all at a legal picture_rate with repeated pictures;
// session.pacs, and the sequences H.y4m, image.y4m, composite.y4m. Collected in memory, written at the end.
class AnimationFiles {
 public:
  // An empty folder name: nothing is kept or written.
  AnimationFiles(std::string folder, sim::VideoCodec codec, int fps, Isa isa);

  // Makes the folder. kDone, or kBadData after the message; so does write().
  int open() const;
  void add_session(std::span<const uint8_t> session);
  void add_frame(const sim::AnimationFrame& frame);
  int write() const;

 private:
  void add_picture(Bytes& sequence, const RgbImage& picture) const;

  std::string folder_;
  sim::VideoCodec codec_;
  int fps_;
  Isa isa_;
  Bytes image_, difference_, pacs_, high_y4m_, image_y4m_, composite_y4m_;
};

}  // namespace pac::cli
