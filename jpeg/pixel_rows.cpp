#include "jpeg/pixel_rows.h"

#include <cstring>

namespace pac::jpeg {
namespace {

// kRed: where R stands; B stands at 2 - kRed.
template <int kBytes, int kRed>
void spread(const uint8_t* rgb, size_t n, uint8_t* out) {
  for (size_t i = 0; i < n; ++i, rgb += 3, out += kBytes) {
    out[kRed] = rgb[0];
    out[1] = rgb[1];
    out[2 - kRed] = rgb[2];
    if (kBytes == 4) out[3] = 255;
  }
}

template <int kBytes, int kRed>
void gather(const uint8_t* in, size_t n, uint8_t* rgb) {
  for (size_t i = 0; i < n; ++i, rgb += 3, in += kBytes) {
    rgb[0] = in[kRed];
    rgb[1] = in[1];
    rgb[2] = in[2 - kRed];
  }
}

}  // namespace

void pixels_from_rgb(PixelFormat format, const uint8_t* rgb, size_t n, uint8_t* pixels) {
  switch (format) {
    case PixelFormat::rgb:
      std::memcpy(pixels, rgb, 3 * n);
      return;
    case PixelFormat::bgr:
      return spread<3, 2>(rgb, n, pixels);
    case PixelFormat::rgbx:
    case PixelFormat::rgba:
      return spread<4, 0>(rgb, n, pixels);
    case PixelFormat::bgrx:
    case PixelFormat::bgra:
      return spread<4, 2>(rgb, n, pixels);
    case PixelFormat::gray:
      for (size_t i = 0; i < n; ++i, rgb += 3)
        pixels[i] = static_cast<uint8_t>((19595 * rgb[0] + 38470 * rgb[1] + 7471 * rgb[2] + 32768) >> 16);
      return;
  }
}

void rgb_from_pixels(PixelFormat format, const uint8_t* pixels, size_t n, uint8_t* rgb) {
  switch (format) {
    case PixelFormat::rgb:
      std::memcpy(rgb, pixels, 3 * n);
      return;
    case PixelFormat::bgr:
      return gather<3, 2>(pixels, n, rgb);
    case PixelFormat::rgbx:
    case PixelFormat::rgba:
      return gather<4, 0>(pixels, n, rgb);
    case PixelFormat::bgrx:
    case PixelFormat::bgra:
      return gather<4, 2>(pixels, n, rgb);
    case PixelFormat::gray:
      return;  // has no colors
  }
}

}  // namespace pac::jpeg
