#include "jpeg/quantizer.h"

namespace pac::jpeg {
namespace {

// With 2^s <= d < 2^(s+1), s >= 1: reciprocal m = ceil(2^(16+s) / d) is at most 2^16, and
//   n * m = n * 2^(16+s) / d + n * e / d  with e = m * d - 2^(16+s) < d,
// so (n * m) >> (16 + s) == n / d as long as n * e < 2^(16+s): true for n < 2^15, since e < d < 2^(s+1).
// Only d = 2^s gives m = 2^16; then half of it with one shift less is exact for every n.
void set_divisor(uint32_t divisor, uint16_t& reciprocal, uint16_t& scale) {
  int s = 1;
  while (divisor >> (s + 1) != 0) ++s;
  uint32_t m = ((uint32_t{1} << (16 + s)) + divisor - 1) / divisor;
  if (m == 0x10000) {
    m = 0x8000;
    s -= 1;
  }
  reciprocal = static_cast<uint16_t>(m);
  scale = static_cast<uint16_t>(uint32_t{1} << (16 - s));  // s >= 1 here because divisors are at least 8
}

}  // namespace

BlockQuantizer make_quantizer(const QuantTable& steps, double dead_zone, const double (&gain)[64]) {
  BlockQuantizer quantizer;
  for (size_t i = 0; i < 64; ++i) {
    const auto divisor =
        static_cast<uint32_t>(kDctScale * steps[i] / effective_gain(gain[i], steps[i]) + 0.5);  // at least 8
    set_divisor(divisor, quantizer.reciprocal[i], quantizer.scale[i]);
    quantizer.bias[i] = static_cast<uint16_t>(i == 0 ? divisor / 2.0 : divisor * (0.5 - dead_zone));
  }
  return quantizer;
}

}  // namespace pac::jpeg
