#include "mpeg1/quantizer.h"

#include <algorithm>

#include "base/kernels/block_kernels.h"

namespace pac::mpeg1 {
namespace {

constexpr uint32_t kMaxCoefficient = 16384 + 8192;  // fdct_macroblock's, with rounding up by half a step

// With 2^s <= d < 2^(s+1), s >= 1: reciprocal m = ceil(2^(16+s) / d) is at most 2^16, and (n * m) >> (16 + s) == n / d
// for n < 2^15, because n * (m * d - 2^(16+s)) < 2^(16+s). d = 2^s would need m = 2^16: half of it, one shift less.
void set_divisor(uint32_t divisor, uint16_t& reciprocal, uint16_t& scale) {
  int s = 1;
  while (divisor >> (s + 1) != 0) ++s;
  uint32_t m = ((uint32_t{1} << (16 + s)) + divisor - 1) / divisor;
  if (m == 0x10000) {
    m = 0x8000;
    s -= 1;
  }
  reciprocal = static_cast<uint16_t>(m);
  scale = static_cast<uint16_t>(uint32_t{1} << (16 - s));  // s >= 1: divisors are at least kMinMatrixEntry
}

}  // namespace

void make_quantizers(const QuantizerMatrix& matrix, double rounding, QuantizerSet& set) {
  for (uint32_t q = 1; q < 32; ++q) {
    for (size_t i = 0; i < 64; ++i) {
      const uint32_t divisor = q * matrix[i];
      set_divisor(divisor, set.divide[q].reciprocal[i], set.divide[q].scale[i]);
      set.divide[q].bias[i] = static_cast<uint16_t>(divisor * rounding);
    }
    const uint32_t least = *std::min_element(matrix.begin() + 1, matrix.end());
    set.least_weight[q] = static_cast<uint16_t>(q * std::min<uint32_t>(least, matrix[0]));
    set.may_overflow[q] = kMaxCoefficient >= (kMaxLevel + 1u) * set.least_weight[q];
    for (size_t k = 0; k < 64; ++k) set.weight[q][k] = static_cast<uint16_t>(q * matrix[kNaturalFromZigzag[k]]);
  }
}

}  // namespace pac::mpeg1
