#include "base/kernels/pixel_kernels.h"

namespace pac {
namespace {

uint8_t clamp_to_byte(int value) {
  return static_cast<uint8_t>(value < 0 ? 0 : value > 255 ? 255 : value);
}

void difference_row(const uint8_t* h, const uint8_t* l, uint8_t* d, size_t n) {
  for (size_t i = 0; i < n; ++i) d[i] = static_cast<uint8_t>(127 + (h[i] - l[i]) / 2);
}

void composite_row(const uint8_t* l, const uint8_t* d, uint8_t* c, size_t n) {
  for (size_t i = 0; i < n; ++i) c[i] = clamp_to_byte(l[i] + 2 * (d[i] - 127));
}

void ycc_from_rgb_row(const uint8_t* rgb, size_t n, uint8_t* y, uint8_t* cb, uint8_t* cr) {
  constexpr int kHalf = 1 << 15, kCenter = 128 << 16;
  for (size_t i = 0; i < n; ++i) {
    const int r = rgb[3 * i], g = rgb[3 * i + 1], b = rgb[3 * i + 2];
    y[i] = static_cast<uint8_t>((19595 * r + 38470 * g + 7471 * b + kHalf) >> 16);
    cb[i] = static_cast<uint8_t>((-11059 * r - 21709 * g + 32768 * b + kCenter + kHalf - 1) >> 16);
    cr[i] = static_cast<uint8_t>((32768 * r - 27439 * g - 5329 * b + kCenter + kHalf - 1) >> 16);
  }
}

void rgb_from_ycc_row(const uint8_t* y, const uint8_t* cb, const uint8_t* cr, size_t n, uint8_t* rgb) {
  constexpr int kHalf = 1 << 15;
  for (size_t i = 0; i < n; ++i) {
    const int u = cb[i] - 128, v = cr[i] - 128;
    rgb[3 * i] = clamp_to_byte(y[i] + ((91881 * v + kHalf) >> 16));
    rgb[3 * i + 1] = clamp_to_byte(y[i] + ((-22554 * u - 46802 * v + kHalf) >> 16));
    rgb[3 * i + 2] = clamp_to_byte(y[i] + ((116130 * u + kHalf) >> 16));
  }
}

void downsample_h2v1_row(const uint8_t* in, size_t n, uint8_t* out) {
  for (size_t i = 0; i < n; ++i)
    out[i] = static_cast<uint8_t>((in[2 * i] + in[2 * i + 1] + static_cast<int>(i & 1)) >> 1);
}

void downsample_h2v2_row(const uint8_t* a, const uint8_t* b, size_t n, uint8_t* out) {
  for (size_t i = 0; i < n; ++i) {
    const int sum = a[2 * i] + a[2 * i + 1] + b[2 * i] + b[2 * i + 1];
    out[i] = static_cast<uint8_t>((sum + 1 + static_cast<int>(i & 1)) >> 2);
  }
}

void upsample_h2v1_row(const uint8_t* in, size_t n, uint8_t* out) {
  for (size_t i = 0; i < n; ++i) {
    const int left = in[i == 0 ? 0 : i - 1], right = in[i + 1 == n ? i : i + 1];
    out[2 * i] = static_cast<uint8_t>((3 * in[i] + left + 1) >> 2);
    out[2 * i + 1] = static_cast<uint8_t>((3 * in[i] + right + 2) >> 2);
  }
}

void upsample_h2v2_row(const uint8_t* near, const uint8_t* far, size_t n, uint8_t* out) {
  const auto column = [near, far](size_t i) { return 3 * near[i] + far[i]; };
  for (size_t i = 0; i < n; ++i) {
    const int left = column(i == 0 ? 0 : i - 1), right = column(i + 1 == n ? i : i + 1);
    out[2 * i] = static_cast<uint8_t>((3 * column(i) + left + 8) >> 4);
    out[2 * i + 1] = static_cast<uint8_t>((3 * column(i) + right + 7) >> 4);
  }
}

void upsample_h1v2_row(const uint8_t* near, const uint8_t* far, int bias, size_t n, uint8_t* out) {
  for (size_t i = 0; i < n; ++i) out[i] = static_cast<uint8_t>((3 * near[i] + far[i] + bias) >> 2);
}

// Sample x of the upsampled row.
uint8_t upsampled_h2v2(const uint8_t* near, const uint8_t* far, size_t n, size_t x) {
  const size_t i = x / 2, next = (x & 1) == 0 ? (i == 0 ? 0 : i - 1) : (i + 1 == n ? i : i + 1);
  return static_cast<uint8_t>((3 * (3 * near[i] + far[i]) + 3 * near[next] + far[next] + ((x & 1) == 0 ? 8 : 7)) >> 4);
}

void rgb_from_ycc420_row(const uint8_t* y, const uint8_t* cb_near, const uint8_t* cb_far, const uint8_t* cr_near,
                         const uint8_t* cr_far, size_t n, uint8_t* rgb) {
  for (size_t x = 0; x < n; ++x) {
    const uint8_t cb = upsampled_h2v2(cb_near, cb_far, (n + 1) / 2, x);
    const uint8_t cr = upsampled_h2v2(cr_near, cr_far, (n + 1) / 2, x);
    rgb_from_ycc_row(y + x, &cb, &cr, 1, rgb + 3 * x);
  }
}

#include "base/kernels/ycc420_simd.inc"

}  // namespace

void fill_pixel_scalar(PixelKernels& table) {
  table.difference_row = difference_row;
  table.composite_row = composite_row;
  table.ycc_from_rgb_row = ycc_from_rgb_row;
  table.ycc420_from_rgb_rows = ycc420_from_rgb_rows;
  table.rgb_from_ycc_row = rgb_from_ycc_row;
  table.downsample_h2v1_row = downsample_h2v1_row;
  table.downsample_h2v2_row = downsample_h2v2_row;
  table.upsample_h2v1_row = upsample_h2v1_row;
  table.upsample_h2v2_row = upsample_h2v2_row;
  table.upsample_h1v2_row = upsample_h1v2_row;
  table.rgb_from_ycc420_row = rgb_from_ycc420_row;
}

}  // namespace pac
