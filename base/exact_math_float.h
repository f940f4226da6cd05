// Elementary functions of single precision with the same bits on every system, from + - * / and integer operations
// alone: loops over rows that call them become vectors, whose lanes compute what the scalar code computes. Errors are a
// few units in the last place; for digits use base/exact_math.h.
#pragma once

#include <cstdint>
#include <cstring>

namespace pac {

namespace exact {

inline int32_t bits_of(float x) {
  int32_t bits;
  std::memcpy(&bits, &x, sizeof bits);
  return bits;
}
inline float float_of(int32_t bits) {
  float x;
  std::memcpy(&x, &bits, sizeof x);
  return x;
}

}  // namespace exact

// x^(1/3) for x in [2^-20, 2]: a third of the exponent (and, linearly, of the mantissa) is within 3.2 %; each step of
// Halley's iteration leaves 2/3 of the cube of the relative error: 2.3e-5, then 1e-14, so that rounding decides: 2.5e-7
// measured over the range.
inline float exact_cube_root(float x) {
  float root = exact::float_of(static_cast<int32_t>(static_cast<float>(exact::bits_of(x)) * (1.0f / 3)) + 0x2A510000);
  for (int i = 0; i < 2; ++i) {
    const float cube = root * root * root;
    root = root * (cube + 2 * x) / (2 * cube + x);
  }
  return root;
}

// base^exponent for base in [2^-100, 2] and exponent in [0, 1], error below 5e-6 of 1; for smaller bases, 0 included,
// as for 2^-100.
inline float exact_pow_unit(float base, float exponent) {
  const float x = base > 0x1p-100f ? base : 0x1p-100f;
  // log2: exponent + 2/ln 2 atanh((m - 1) / (m + 1)), m in [sqrt(1/2), sqrt 2), |t| < 0.1716: t^11/11 < 4e-10.
  constexpr int32_t kSqrtHalf = 0x3F3504F3;
  const int32_t shifted = exact::bits_of(x) - kSqrtHalf;
  const float m = exact::float_of((shifted & 0x007FFFFF) + kSqrtHalf);
  const float t = (m - 1) / (m + 1), s = t * t;
  const float series = ((((1.0f / 9) * s + 1.0f / 7) * s + 1.0f / 5) * s + 1.0f / 3) * s + 1;
  const float log2 = static_cast<float>(shifted >> 23) + t * series * 2.88539008f;
  // 2^y = 2^n 2^r, n the nearest integer, |r| <= 1/2: Taylor series of e^(r ln 2) up to r^7: 6e-9 is left.
  const float y = exponent * log2;                             // in [-100, 1]
  const int32_t n = static_cast<int32_t>(y + 128.5f) - 128;    // y + 128.5 > 0: truncation is floor
  const float r = (y - static_cast<float>(n)) * 0.693147181f;  // |r| <= 0.347
  const float power =
      1 +
      r * (1 + r * (1.0f / 2) *
                   (1 + r * (1.0f / 3) *
                            (1 + r * (1.0f / 4) * (1 + r * (1.0f / 5) * (1 + r * (1.0f / 6) * (1 + r * (1.0f / 7)))))));
  return power * exact::float_of((n + 127) << 23);
}

}  // namespace pac
