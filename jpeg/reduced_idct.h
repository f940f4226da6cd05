// Blocks to samples at the size that a scaled picture wants.
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/kernels/block_kernels.h"

namespace pac::jpeg {

// As BlockKernels::idct_islow, but `size` x `size` samples a block, size 8, 4, 2 or 1: block i at samples + size * i.
inline void idct_to_size(const BlockKernels& kernels, int size, const int16_t* levels, const uint16_t* steps,
                         const uint8_t* last, size_t n_blocks, uint8_t* samples, ptrdiff_t stride) {
  switch (size) {
    case 8:
      kernels.idct_islow(levels, steps, last, n_blocks, samples, stride);
      return;
    case 4:
      kernels.idct_4x4(levels, steps, n_blocks, samples, stride);
      return;
    case 2:
      kernels.idct_2x2(levels, steps, n_blocks, samples, stride);
      return;
    default:
      kernels.idct_1x1(levels, steps, n_blocks, samples, stride);
  }
}

}  // namespace pac::jpeg
