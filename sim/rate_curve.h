// Rate-distortion curves of both arms, and the numbers that the paper reads off them: bytes at equal quality (s.4.1)
// and the compression ratio below which polygon assistance stops paying (s.6: "more than 25:1").
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/result.h"
#include "sim/experiment.h"

namespace pac::sim {

struct RatePoint {
  double quality = 0;  // coded quality
  double equivalent_quality = 0;
  uint64_t bytes = 0;  // image + model
  double compression_ratio = 0;
  Scores scores;
};

struct RateCurve {
  std::vector<RatePoint> points;  // in the order of the qualities asked for
};

// Both arms at each coded quality of its list. Runs options.threads points at once.
Result<RateCurve> rate_curve(const Renderings& renderings, ArmKind kind, std::span<const double> qualities,
                             const CodingOptions& options);

// The qualities that the demo plots: 5..95 for H; for D those that give the same tables in H's domain, and up to 98.
std::span<const double> plotted_qualities(ArmKind kind);

enum class Metric : uint8_t { rms, ssim };

// How many bytes `curve` needs for the score `value`: log(bytes) interpolated linearly in the score between the two
// neighboring points (sorted by bytes) that first enclose it. Empty where the curve never reaches it.
std::optional<double> bytes_for_score(const RateCurve& curve, Metric metric, double value);

// "Images of equal quality": bytes of the image-based arm at quality q over bytes of the polygon-assisted arm at
// the same score; the paper judges 3 by eye for q15 of the room. Empty where the curves do not overlap.
std::optional<double> equal_quality_gain(const RateCurve& image_based, const RateCurve& polygon_assisted, Metric metric,
                                         size_t image_based_point);

// The compression ratio at which polygon assistance stops paying: going from the smallest files to larger ones, where
// its score at equal bytes first falls from better to worse. Empty where that does not happen in the common range of
// bytes; the two flags say who wins at its ends. `behind_above`: where it is behind for the smallest files, the ratio
// at which it first comes ahead.
struct Crossing {
  std::optional<double> ratio, behind_above;
  bool assisted_wins_at_high_ratio = false, assisted_wins_at_low_ratio = false;
  double lowest_common_ratio = 0, highest_common_ratio = 0;  // the range that was looked at
};
Crossing find_crossing(const RateCurve& image_based, const RateCurve& polygon_assisted, Metric metric);

}  // namespace pac::sim
