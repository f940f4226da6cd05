// Whole images through the difference and composite kernels, and the hash by which client and server compare L.
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/image.h"
#include "base/isa.h"

namespace pac::sim {

// D = 127 + trunc((H - L) / 2) per sample [Levoy95 s.3]. All views have one size; `difference` may be `high` or `low`.
void difference_image(ConstRgbView high, ConstRgbView low, RgbView difference, Isa isa = best_isa());

// C = clamp(L + 2 (D - 127)): what the client shows. `composite` may be `low` or `difference`.
void composite_image(ConstRgbView low, ConstRgbView difference, RgbView composite, Isa isa = best_isa());

// 64 bits of width, height and the pixels in row order, equal on every machine: four lanes of multiplications, mixed.
uint64_t image_hash(ConstRgbView image);

// The same row by row, from the top.
class ImageHash {
 public:
  ImageHash(int width, int height);
  void add_row(const uint8_t* rgb);
  uint64_t finish() const;

 private:
  size_t row_bytes_;
  uint64_t lanes_[4] = {1, 2, 3, 4};
};

}  // namespace pac::sim
