// The interpolation filter of the reprojection: six taps, Lanczos-windowed sinc, 64 phases.
#pragma once

#include <array>
#include <cstdint>

#include "base/kernels/warp_kernels.h"

namespace pac::sim {

using WarpFilter = std::array<int16_t, size_t{kWarpPhases} * kWarpTapStride>;

namespace warp_filter {

constexpr double kPiConstant = 3.14159265358979323846;

// sin by its Taylor series, |x| <= pi: the compiler's IEEE arithmetic, the same everywhere.
constexpr double sine(double x) {
  double term = x, sum = x;
  for (int k = 1; k < 14; ++k) {
    term *= -x * x / ((2 * k) * (2 * k + 1));
    sum += term;
  }
  return sum;
}

// sin(pi x) / (pi x), |x| <= 3.
constexpr double sinc(double x) {
  if (x > -1e-9 && x < 1e-9) return 1;
  double reduced = x;  // sin(pi x) from x modulo 2
  while (reduced > 1) reduced -= 2;
  while (reduced < -1) reduced += 2;
  return sine(kPiConstant * reduced) / (kPiConstant * x);
}

constexpr int rounded(double value) {
  return value < 0 ? -static_cast<int>(0.5 - value) : static_cast<int>(value + 0.5);
}

constexpr WarpFilter make() {
  WarpFilter filter{};
  for (int phase = 0; phase < kWarpPhases; ++phase) {
    double weight[kWarpTaps] = {}, sum = 0;
    for (int tap = 0; tap < kWarpTaps; ++tap) {
      const double x = tap - 2 - static_cast<double>(phase) / kWarpPhases;
      weight[tap] = x <= -3 || x >= 3 ? 0 : sinc(x) * sinc(x / 3);
      sum += weight[tap];
    }
    int total = 0;
    int16_t* taps = &filter[static_cast<size_t>(phase) * kWarpTapStride];
    for (int tap = 0; tap < kWarpTaps; ++tap) {
      taps[tap] = static_cast<int16_t>(rounded(weight[tap] / sum * 512));
      total += taps[tap];
    }
    taps[phase < kWarpPhases / 2 ? 2 : 3] = static_cast<int16_t>(taps[phase < kWarpPhases / 2 ? 2 : 3] + 512 - total);
  }
  return filter;
}

}  // namespace warp_filter

inline constexpr WarpFilter kWarpFilter = warp_filter::make();

}  // namespace pac::sim
