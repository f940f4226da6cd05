// Pixels as callers hold them: channel orders, views with a stride, rows that come and go one at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

namespace pac::jpeg {

// Bytes of a pixel in memory order. x: written as 255, ignored when read; a (alpha) likewise, since JPEG has none.
// gray: luma. An encoder makes one component of it; a decoder delivers Y (of RGB files 0.299 R + 0.587 G + 0.114 B).
enum class PixelFormat : uint8_t { rgb, bgr, rgbx, bgrx, rgba, bgra, gray };

constexpr int bytes_per_pixel(PixelFormat format) {
  return format == PixelFormat::gray ? 1 : format <= PixelFormat::bgr ? 3 : 4;
}

// A picture that somebody else owns. Row y starts at data + y * stride_bytes; a negative stride (data at the last row
// in memory) means bottom-up storage.
template <class Byte>
struct BasicPixelView {
  Byte* data = nullptr;
  int width = 0, height = 0;  // pixels
  ptrdiff_t stride_bytes = 0;
  PixelFormat format = PixelFormat::rgb;

  Byte* row(int y) const { return data + y * stride_bytes; }
  operator BasicPixelView<const Byte>() const { return {data, width, height, stride_bytes, format}; }
};
using PixelView = BasicPixelView<uint8_t>;
using ConstPixelView = BasicPixelView<const uint8_t>;

// Receives row y, counted from the top of what is decoded, in order: width * bytes_per_pixel bytes that are valid
// during the call only. false: no further rows are wanted.
using RowSink = std::function<bool(int y, std::span<const uint8_t> row)>;

// Fills row y of the picture to be encoded, width * bytes_per_pixel bytes. Every row is asked for once, in order.
// false: the picture cannot be had; encoding fails with bad_argument.
using RowSource = std::function<bool(int y, std::span<uint8_t> row)>;

}  // namespace pac::jpeg
