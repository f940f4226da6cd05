// Elementary functions whose bits are the same on every system: only + - * / and sqrt of IEEE doubles, in a fixed
// order. libm's differ between versions and, by run-time FMA selection, between processors. Accuracy: about 1e-14
// relative.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

namespace pac {

constexpr double kPi = 3.14159265358979323846;

namespace exact {

// |r| <= pi/4: Taylor series up to r^17 (error below 1e-17).
inline double sin_near_zero(double r) {
  const double s = r * r;
  double sum = 1.0 / 355687428096000.0;
  sum = sum * s - 1.0 / 1307674368000.0;
  sum = sum * s + 1.0 / 6227020800.0;
  sum = sum * s - 1.0 / 39916800.0;
  sum = sum * s + 1.0 / 362880.0;
  sum = sum * s - 1.0 / 5040.0;
  sum = sum * s + 1.0 / 120.0;
  sum = sum * s - 1.0 / 6.0;
  return r + r * s * sum;
}

// |r| <= pi/4: Taylor series up to r^16.
inline double cos_near_zero(double r) {
  const double s = r * r;
  double sum = 1.0 / 20922789888000.0;
  sum = sum * s - 1.0 / 87178291200.0;
  sum = sum * s + 1.0 / 479001600.0;
  sum = sum * s - 1.0 / 3628800.0;
  sum = sum * s + 1.0 / 40320.0;
  sum = sum * s - 1.0 / 720.0;
  sum = sum * s + 1.0 / 24.0;
  return 1.0 - 0.5 * s + s * s * sum;
}

// sin(x + quarter_turns * pi/2). |x| up to about 1e9 (angles beyond lose digits); NaN and infinities give 0.
inline double sin_quadrant(double x, int64_t quarter_turns) {
  if (!(x > -1e15 && x < 1e15)) return 0.0;
  const double turns = std::floor(x * (2.0 / kPi) + 0.5);
  // pi/2 in two parts, so that turns * kHigh is exact for |turns| < 2^20.
  constexpr double kHigh = 1.57079632673412561417e+00, kLow = 6.07710050650619224932e-11;
  const double r = (x - turns * kHigh) - turns * kLow;
  switch ((static_cast<int64_t>(turns) + quarter_turns) & 3) {
    case 0:
      return sin_near_zero(r);
    case 1:
      return cos_near_zero(r);
    case 2:
      return -sin_near_zero(r);
    default:
      return -cos_near_zero(r);
  }
}

}  // namespace exact

// Radians.
inline double exact_sin(double angle_rad) {
  return exact::sin_quadrant(angle_rad, 0);
}
inline double exact_cos(double angle_rad) {
  return exact::sin_quadrant(angle_rad, 1);
}
inline double exact_tan(double angle_rad) {
  return exact_sin(angle_rad) / exact_cos(angle_rad);
}

// Natural logarithm; x must be positive, finite and normal (else 0).
inline double exact_log(double x) {
  if (!(x >= 2.2250738585072014e-308 && x < 1e308)) return 0.0;
  uint64_t bits;
  std::memcpy(&bits, &x, sizeof bits);
  int exponent = static_cast<int>(bits >> 52) - 1023;
  bits = (bits & 0x000FFFFFFFFFFFFFu) | 0x3FF0000000000000u;
  double m;
  std::memcpy(&m, &bits, sizeof m);  // in [1, 2)
  if (m > 1.4142135623730951) {
    m *= 0.5;
    exponent += 1;
  }
  const double t = (m - 1.0) / (m + 1.0);  // |t| <= 0.1716: log m = 2 atanh t
  const double s = t * t;
  double sum = 0.0;
  for (int k = 21; k >= 1; k -= 2) sum = sum * s + 1.0 / k;
  return 2.0 * t * sum + exponent * 0.69314718055994530942;
}

// e^x, clamped to [1e-300, 1e300].
inline double exact_exp(double x) {
  if (!(x > -690.0)) return 1e-300;
  if (x > 690.0) return 1e300;
  const double n = std::floor(x * 1.44269504088896340736 + 0.5);
  const double r = (x - n * 6.93147180369123816490e-01) - n * 1.90821492927058770002e-10;
  double sum = 1.0;
  for (int k = 14; k >= 1; --k) sum = 1.0 + sum * r / k;
  const uint64_t bits = static_cast<uint64_t>(static_cast<int64_t>(n) + 1023) << 52;
  double power;
  std::memcpy(&power, &bits, sizeof power);
  return sum * power;
}

// base^exponent for base > 0; 0 for base <= 0.
inline double exact_pow(double base, double exponent) {
  return base > 0.0 ? exact_exp(exponent * exact_log(base)) : 0.0;
}

// sRGB transfer function [IEC 61966-2-1], both in [0, 1].
inline double srgb_from_linear(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * exact_pow(linear, 1.0 / 2.4) - 0.055;
}
inline double linear_from_srgb(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : exact_pow((encoded + 0.055) / 1.055, 2.4);
}

}  // namespace pac
