#include "base/bd_rate.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "base/exact_math.h"

namespace pac {
namespace {

bool is_finite(double x) {
  return x - x == 0;
}

// Slope at an end from the two nearest intervals (h, d: length and slope; 0 is the end's own), kept from overshooting.
double end_slope(double h0, double h1, double d0, double d1) {
  const double slope = ((2 * h0 + h1) * d0 - h0 * d1) / (h0 + h1);
  if (slope * d0 <= 0) return 0;
  if (d0 * d1 <= 0 && std::abs(slope) > 3 * std::abs(d0)) return 3 * d0;
  return slope;
}

// Fritsch and Butland's slopes: the weighted harmonic mean of the neighbors', 0 at a turn.
std::vector<double> monotone_slopes(const std::vector<double>& x, const std::vector<double>& y) {
  const size_t n = x.size();
  std::vector<double> h(n - 1), d(n - 1), slope(n);
  for (size_t i = 0; i + 1 < n; ++i) {
    h[i] = x[i + 1] - x[i];
    d[i] = (y[i + 1] - y[i]) / h[i];
  }
  if (n == 2) return {d[0], d[0]};
  slope[0] = end_slope(h[0], h[1], d[0], d[1]);
  slope[n - 1] = end_slope(h[n - 2], h[n - 3], d[n - 2], d[n - 3]);
  for (size_t i = 1; i + 1 < n; ++i) {
    if (d[i - 1] * d[i] <= 0) continue;
    const double w0 = 2 * h[i] + h[i - 1], w1 = h[i] + 2 * h[i - 1];
    slope[i] = (w0 + w1) / (w0 / d[i - 1] + w1 / d[i]);
  }
  return slope;
}

}  // namespace

Result<RateCurve> RateCurve::create(std::span<const RatePoint> points) {
  if (points.size() < 2) return Failure{Error::bad_argument, 0, "a rate curve needs two points"};
  std::vector<RatePoint> sorted(points.begin(), points.end());
  for (const RatePoint& point : sorted)
    if (!is_finite(point.quality) || !is_finite(point.size_bytes) || !(point.size_bytes > 0))
      return Failure{Error::bad_argument, 0, "a rate curve's point is not finite, or has no bytes"};
  std::sort(sorted.begin(), sorted.end(), [](const RatePoint& a, const RatePoint& b) { return a.quality < b.quality; });
  RateCurve curve;
  for (const RatePoint& point : sorted) {
    if (!curve.quality_.empty() && !(point.quality > curve.quality_.back()))
      return Failure{Error::bad_argument, 0, "two points of a rate curve have one quality"};
    curve.quality_.push_back(point.quality);
    curve.log_bytes_.push_back(exact_log(point.size_bytes));
  }
  curve.slope_ = monotone_slopes(curve.quality_, curve.log_bytes_);
  return curve;
}

RateCurve::Place RateCurve::place_of(double quality) const {
  const double q = std::clamp(quality, quality_.front(), quality_.back());
  const auto above = std::upper_bound(quality_.begin() + 1, quality_.end() - 1, q);
  const auto i = static_cast<size_t>(above - quality_.begin()) - 1;
  return {i, (q - quality_[i]) / (quality_[i + 1] - quality_[i])};
}

// Hermite's cubic on the interval.
double RateCurve::log_bytes(Place place) const {
  const auto [i, t] = place;
  const double h = quality_[i + 1] - quality_[i], s = 1 - t;
  return (1 + 2 * t) * s * s * log_bytes_[i] + t * s * s * h * slope_[i] + t * t * (3 - 2 * t) * log_bytes_[i + 1] -
         t * t * s * h * slope_[i + 1];
}

double RateCurve::area_before(Place place) const {
  const auto [i, t] = place;
  const double h = quality_[i + 1] - quality_[i], t2 = t * t, t3 = t2 * t, t4 = t3 * t;
  return h * ((t - t3 + t4 / 2) * log_bytes_[i] + (t2 / 2 - 2 * t3 / 3 + t4 / 4) * h * slope_[i] +
              (t3 - t4 / 2) * log_bytes_[i + 1] + (t4 / 4 - t3 / 3) * h * slope_[i + 1]);
}

double RateCurve::bytes_at(double quality) const {
  return exact_exp(log_bytes(place_of(quality)));
}

double RateCurve::integral(double low, double high) const {
  const Place first = place_of(low), last = place_of(high);
  double area = area_before(last) - area_before(first);
  for (size_t i = first.interval; i < last.interval; ++i) area += area_before({i, 1});
  return area;
}

Result<BdRate> bd_rate(std::span<const RatePoint> reference, std::span<const RatePoint> test) {
  PAC_TRY(const RateCurve a, RateCurve::create(reference));
  PAC_TRY(const RateCurve b, RateCurve::create(test));
  BdRate result;
  result.lowest_quality = std::max(a.lowest_quality(), b.lowest_quality());
  result.highest_quality = std::min(a.highest_quality(), b.highest_quality());
  const double range = result.highest_quality - result.lowest_quality;
  if (!(range > 0)) return Failure{Error::bad_argument, 0, "the rate curves share no range of quality"};
  const double mean_log_ratio = (b.integral(result.lowest_quality, result.highest_quality) -
                                 a.integral(result.lowest_quality, result.highest_quality)) /
                                range;
  result.percent = 100 * (exact_exp(mean_log_ratio) - 1);
  return result;
}

}  // namespace pac
