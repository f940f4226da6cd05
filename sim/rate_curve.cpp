#include "sim/rate_curve.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <utility>

#include "base/exact_math.h"
#include "base/parallel.h"

namespace pac::sim {

namespace {

constexpr std::array<double, 16> kImageQualities = {3, 5, 8, 10, 12, 15, 20, 25, 30, 40, 50, 60, 70, 80, 90, 95};
// The same tables in H's own domain (coded_quality of the above up to 90), then what only a halved table can reach.
constexpr std::array<double, 16> kDifferenceQualities = {6,     10, 16, 20, 24, 30, 40, 50, 58.333333333333336,
                                                         68.75, 75, 80, 85, 90, 95, 98};

double score_of(const RatePoint& point, Metric metric) {
  return metric == Metric::rms ? point.scores.rms : point.scores.ssim;
}

std::vector<RatePoint> by_bytes(const RateCurve& curve) {
  std::vector<RatePoint> points = curve.points;
  std::stable_sort(points.begin(), points.end(),
                   [](const RatePoint& a, const RatePoint& b) { return a.bytes < b.bytes; });
  return points;
}

// Score at a size between two neighboring points, linear in log(bytes). `points` sorted and enclosing log_bytes.
double score_at(const std::vector<RatePoint>& points, Metric metric, double log_bytes) {
  for (size_t i = 0; i + 1 < points.size(); ++i) {
    const double a = exact_log(static_cast<double>(points[i].bytes));
    const double b = exact_log(static_cast<double>(points[i + 1].bytes));
    if (log_bytes > b && i + 2 < points.size()) continue;
    const double t = b > a ? (log_bytes - a) / (b - a) : 0;
    return score_of(points[i], metric) + t * (score_of(points[i + 1], metric) - score_of(points[i], metric));
  }
  return points.empty() ? 0 : score_of(points.front(), metric);
}

RatePoint point_of(const Arm& arm) {
  return {arm.coded.quality, arm.coded.equivalent_quality, arm.total_bytes, arm.compression_ratio, arm.scores};
}

}  // namespace

Result<RateCurve> rate_curve(const Renderings& renderings, ArmKind kind, std::span<const double> qualities,
                             const CodingOptions& options) {
  std::vector<std::optional<Result<Arm>>> arms(qualities.size());
  CodingOptions one_thread = options;
  one_thread.threads = 1;
  parallel_for(options.threads, static_cast<int64_t>(qualities.size()), [&](int64_t i) {
    const auto index = static_cast<size_t>(i);
    Result<Arm> arm = code_arm_at_quality(renderings, kind, qualities[index], one_thread);
    if (arm.ok()) {  // a curve needs no pictures
      arm->shown = RgbImage();
      arm->decoded = RgbImage();
    }
    arms[index] = std::move(arm);
  });
  RateCurve curve;
  for (const auto& arm : arms) {
    if (!arm->ok()) return arm->failure();
    curve.points.push_back(point_of(**arm));
  }
  return curve;
}

std::span<const double> plotted_qualities(ArmKind kind) {
  if (kind == ArmKind::image_based) return kImageQualities;
  return kDifferenceQualities;
}

std::optional<double> bytes_for_score(const RateCurve& curve, Metric metric, double value) {
  const std::vector<RatePoint> points = by_bytes(curve);
  for (size_t i = 0; i + 1 < points.size(); ++i) {
    const double a = score_of(points[i], metric), b = score_of(points[i + 1], metric);
    if (value < std::min(a, b) || value > std::max(a, b)) continue;
    const double log_a = exact_log(static_cast<double>(points[i].bytes));
    const double log_b = exact_log(static_cast<double>(points[i + 1].bytes));
    return exact_exp(a == b ? log_a : log_a + (value - a) / (b - a) * (log_b - log_a));
  }
  return std::nullopt;
}

std::optional<double> equal_quality_gain(const RateCurve& image_based, const RateCurve& polygon_assisted, Metric metric,
                                         size_t image_based_point) {
  PAC_ASSERT(image_based_point < image_based.points.size());
  const RatePoint& point = image_based.points[image_based_point];
  const auto bytes = bytes_for_score(polygon_assisted, metric, score_of(point, metric));
  if (!bytes) return std::nullopt;
  return static_cast<double>(point.bytes) / *bytes;
}

Crossing find_crossing(const RateCurve& image_based, const RateCurve& polygon_assisted, Metric metric) {
  Crossing crossing;
  const std::vector<RatePoint> image = by_bytes(image_based), assisted = by_bytes(polygon_assisted);
  if (image.size() < 2 || assisted.size() < 2) return crossing;
  const double raw_bytes = image[0].compression_ratio * static_cast<double>(image[0].bytes);
  const double low = exact_log(static_cast<double>(std::max(image.front().bytes, assisted.front().bytes)));
  const double high = exact_log(static_cast<double>(std::min(image.back().bytes, assisted.back().bytes)));
  if (!(low < high)) return crossing;
  crossing.highest_common_ratio = raw_bytes / exact_exp(low);
  crossing.lowest_common_ratio = raw_bytes / exact_exp(high);

  // How much better the assisted arm is; sampled densely enough to see every segment of both curves.
  const auto lead = [&](double log_bytes) {
    const double difference = score_at(assisted, metric, log_bytes) - score_at(image, metric, log_bytes);
    return metric == Metric::rms ? -difference : difference;
  };
  constexpr int kSteps = 512;
  double previous = lead(low);
  crossing.assisted_wins_at_high_ratio = previous > 0;
  for (int step = 1; step <= kSteps; ++step) {
    const double at = low + (high - low) * step / kSteps;
    const double next = lead(at);
    if ((previous > 0) != (next > 0)) {
      const double t = previous / (previous - next);
      auto& found = previous > 0 ? crossing.ratio : crossing.behind_above;
      if (!found) found = raw_bytes / exact_exp(at - (high - low) / kSteps * (1 - t));
    }
    previous = next;
  }
  if (crossing.assisted_wins_at_high_ratio) crossing.behind_above.reset();
  crossing.assisted_wins_at_low_ratio = previous > 0;
  return crossing;
}

}  // namespace pac::sim
