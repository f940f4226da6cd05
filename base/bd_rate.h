// Rate-distortion curves and the Bjontegaard difference of two: how many bytes one coder saves at equal quality, over
// all qualities that both reach.
//
// Bjontegaard, VCEG-M33 (2001); the logarithm of bytes is interpolated over quality by a monotone piecewise cubic
// (PCHIP: Fritsch, Butland 1984), as JVET's common test conditions do since 2010: unlike the cubic fit of 2001 it
// passes through every point and never swings beyond its neighbors.
#pragma once

#include <span>
#include <vector>

#include "base/result.h"

namespace pac {

struct RatePoint {
  double size_bytes = 0;  // or bits a second; above 0
  double quality = 0;     // any finite metric; better may be larger (SSIMULACRA2, PSNR) or smaller (FLIP)
};

class RateCurve {
 public:
  // Points in any order, at least 2. Fails with bad_argument if fewer, not finite, sizes not positive, or two points of
  // one quality.
  static Result<RateCurve> create(std::span<const RatePoint> points);

  double lowest_quality() const { return quality_.front(); }
  double highest_quality() const { return quality_.back(); }

  // Bytes that give `quality`, clamped to the range of the points.
  double bytes_at(double quality) const;

  // Integral of ln(bytes) over quality from `low` to `high`, both within the range, low <= high.
  double integral(double low, double high) const;

 private:
  struct Place {
    size_t interval;
    double t;  // 0..1 within it
  };
  Place place_of(double quality) const;
  double log_bytes(Place place) const;
  double area_before(Place place) const;  // from the interval's left end

  std::vector<double> quality_, log_bytes_, slope_;
};

struct BdRate {
  double percent = 0;                              // bytes of the test relative to the reference: -30 = saves 30 %
  double lowest_quality = 0, highest_quality = 0;  // the range that both curves reach
};
// Fails with bad_argument as create() does, or if the curves share no range of quality.
Result<BdRate> bd_rate(std::span<const RatePoint> reference, std::span<const RatePoint> test);

}  // namespace pac
