// Sums over a stencil and their exact rounding, for every attribute. FORMAT.md section 6.
#pragma once

#include <cstdint>

#include "geomcodec/stencil.h"

namespace pac::geomcodec {

// round(sum * 2^scale_bits / count), by a reciprocal of 16 bits: |sum| < 2^23, count 0 (gives 0) .. 12, scale_bits
// 0..6. Defined by this formula, not by the exact quotient.
inline int32_t scaled_mean(int32_t sum, int count, int scale_bits) {
  constexpr int32_t kReciprocal[Stencil::kMax + 1] = {0,    65536, 32768, 21845, 16384, 13107, 10923,
                                                      9362, 8192,  7282,  6554,  5958,  5461};
  const int shift = 16 - scale_bits;
  return static_cast<int32_t>((int64_t{sum} * kReciprocal[count] + (int64_t{1} << (shift - 1))) >> shift);
}

// value / by to the nearest, halves upwards; by > 0.
inline int64_t round_quotient(int64_t value, int64_t by) {
  const int64_t twice = 2 * value + by, unit = 2 * by;
  return twice >= 0 ? twice / unit : -((-twice + unit - 1) / unit);
}

// `at(vertex)` is one coordinate or channel, below 2^16 in magnitude.
template <class At>
int32_t parallelogram_sum(const Stencil& stencil, At at) {
  int32_t sum = 0;
  for (int i = 0; i < stencil.n_parallelograms; ++i) {
    const Stencil::Parallelogram& p = stencil.parallelogram[i];
    sum += at(p.side_1) + at(p.side_2) - at(p.opposite);
  }
  return sum;
}
template <class At>
int32_t neighbor_sum(const Stencil& stencil, At at) {
  int32_t sum = 0;
  for (int i = 0; i < stencil.n_neighbors; ++i) sum += at(stencil.neighbor[i]);
  return sum;
}

}  // namespace pac::geomcodec
