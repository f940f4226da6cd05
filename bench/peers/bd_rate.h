// Bjontegaard's rate difference, with monotone cubic interpolation.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pac::bench {

struct Curve {
  std::vector<double> psnr_db, log_rate;  // ascending in PSNR
};

// Fritsch and Carlson's slopes, then Hermite's cubic.
inline double interpolate(const Curve& c, double x) {
  const size_t n = c.psnr_db.size();
  std::vector<double> secant(n - 1), slope(n);
  for (size_t i = 0; i + 1 < n; ++i)
    secant[i] = (c.log_rate[i + 1] - c.log_rate[i]) / (c.psnr_db[i + 1] - c.psnr_db[i]);
  slope[0] = secant[0];
  slope[n - 1] = secant[n - 2];
  for (size_t i = 1; i + 1 < n; ++i)
    slope[i] = secant[i - 1] * secant[i] <= 0 ? 0 : 2 / (1 / secant[i - 1] + 1 / secant[i]);
  size_t i = 0;
  while (i + 2 < n && x > c.psnr_db[i + 1]) ++i;
  const double h = c.psnr_db[i + 1] - c.psnr_db[i], t = (x - c.psnr_db[i]) / h;
  return c.log_rate[i] * (1 + 2 * t) * (1 - t) * (1 - t) + slope[i] * h * t * (1 - t) * (1 - t) +
         c.log_rate[i + 1] * t * t * (3 - 2 * t) + slope[i + 1] * h * t * t * (t - 1);
}

// Percent of bytes more (or less) than `base` for the same PSNR.
inline double bd_rate(const Curve& base, const Curve& test) {
  const double low = std::max(base.psnr_db.front(), test.psnr_db.front());
  const double high = std::min(base.psnr_db.back(), test.psnr_db.back());
  double sum = 0;
  constexpr int kSteps = 200;
  for (int i = 0; i < kSteps; ++i) {
    const double x = low + (high - low) * (i + 0.5) / kSteps;
    sum += interpolate(test, x) - interpolate(base, x);
  }
  return 100 * (std::exp(sum / kSteps) - 1);
}

}  // namespace pac::bench
