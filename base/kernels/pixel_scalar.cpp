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

}  // namespace

void fill_pixel_scalar(PixelKernels& table) {
  table.difference_row = difference_row;
  table.composite_row = composite_row;
}

}  // namespace pac
