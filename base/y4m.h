// YUV4MPEG2 (Y4M) files of 8-bit 4:2:0 frames [mjpegtools yuv4mpeg(5)]: reader and writer, frame by frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/image.h"
#include "base/result.h"

namespace pac {

// Where the chroma samples lie; all three have the same sizes. jpeg: between luma columns; mpeg2: on even ones.
enum class ChromaSiting : uint8_t { jpeg, mpeg2, paldv };

struct Y4mHeader {
  int width = 0, height = 0;                         // luma samples, >= 1
  int rate_numerator = 0, rate_denominator = 0;      // frames a second; 0:0 = not told
  int aspect_numerator = 0, aspect_denominator = 0;  // of a sample; 0:0 = not told
  ChromaSiting siting = ChromaSiting::jpeg;
};

// Delivers the frames of a file in memory. Keeps a pointer to the caller's bytes.
class Y4mReader {
 public:
  // Parses the stream header. Fails with truncated, corrupt (a bad, missing or repeated parameter), unsupported (not
  // 8-bit 4:2:0, interlaced) or limit_exceeded.
  static Result<Y4mReader> open(std::span<const uint8_t> bytes, const Limits& limits = {});

  const Y4mHeader& header() const { return header_; }

  // The next frame into `frame` (made anew if its size differs), or false after the last. Fails with truncated or
  // corrupt, and again so on the next call; `frame` then holds what it held before.
  Result<bool> next(Frame420& frame);

 private:
  std::span<const uint8_t> bytes_;
  size_t at_ = 0;  // of the next frame's header
  Y4mHeader header_;
};

// Append the stream header (progressive), then each frame. width, height >= 1; frames of that size.
void append_y4m_header(std::vector<uint8_t>& out, const Y4mHeader& header);
void append_y4m_frame(std::vector<uint8_t>& out, const Frame420& frame);

}  // namespace pac
