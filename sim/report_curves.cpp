#include "sim/report_curves.h"

#include <algorithm>

#include "base/exact_math.h"
#include "sim/report_figure.h"
#include "sim/report_markup.h"

namespace pac::sim {
namespace {

enum class Measure : uint8_t { ssim, psnr };

double measure_of(const RatePoint& point, Measure measure) {
  return measure == Measure::ssim ? point.scores.ssim : point.scores.psnr_db;
}

std::vector<RatePoint> by_bytes(const RateCurve& curve) {
  std::vector<RatePoint> points = curve.points;
  std::sort(points.begin(), points.end(), [](const RatePoint& a, const RatePoint& b) { return a.bytes < b.bytes; });
  return points;
}

PlotSeries series_of(const RateCurve& curve, ArmKind kind, Measure measure) {
  PlotSeries series;
  series.name = kind == ArmKind::image_based ? "image-based" : "polygon-assisted";
  series.style = kind == ArmKind::image_based ? "image" : "polygon";
  for (const RatePoint& point : by_bytes(curve)) {
    const std::string label = series.name + ", q " + short_quality(point.quality) + "\n" +
                              decimal_text(static_cast<double>(point.bytes), 0) + " bytes, " +
                              decimal_text(point.compression_ratio, 0) + ":1\n" + scores_text(point.scores);
    series.points.push_back({static_cast<double>(point.bytes), measure_of(point, measure), label});
  }
  return series;
}

Plot rate_plot(const FigureSet& set, Measure measure) {
  const bool is_ssim = measure == Measure::ssim;
  const double pixels = static_cast<double>(set.renderings.high.width()) * set.renderings.high.height();
  Plot plot;
  plot.id = "plot-" + set.key + (is_ssim ? "-ssim" : "-psnr");
  plot.title = set.scene + ", " + set.renderings.split.name + " split: " + (is_ssim ? "SSIM" : "PSNR");
  plot.description = std::string(is_ssim ? "SSIM" : "PSNR in decibels") + " against bytes a frame for both arms";
  plot.x_label = "bytes a frame";
  plot.y_label = is_ssim ? "SSIM" : "PSNR (dB)";
  plot.top_per_x = 8 / pixels;
  plot.series = {series_of(set.image_curve, ArmKind::image_based, measure),
                 series_of(set.assisted_curve, ArmKind::polygon_assisted, measure)};
  plot.marks = {{3 * pixels / 25, "25:1"}, {kBudgetBytesPerFrame, "2 Mb/s at 20/s"}};
  return plot;
}

// The score of a curve at `bytes`, linear in log(bytes) between its points; false outside them.
bool score_at(const std::vector<RatePoint>& points, double bytes, Measure measure, double& score) {
  for (size_t i = 1; i < points.size(); ++i) {
    const double low = static_cast<double>(points[i - 1].bytes), high = static_cast<double>(points[i].bytes);
    if (bytes < low || bytes > high || low == high) continue;
    const double part = (exact_log(bytes) - exact_log(low)) / (exact_log(high) - exact_log(low));
    score = measure_of(points[i - 1], measure) * (1 - part) + measure_of(points[i], measure) * part;
    return true;
  }
  return false;
}

// Polygon-assisted minus image-based at the sizes of the image-based files.
PlotSeries gain_series(const FigureSet& set, Measure measure) {
  const std::vector<RatePoint> image = by_bytes(set.image_curve), assisted = by_bytes(set.assisted_curve);
  PlotSeries series;
  series.name = set.scene + ", " + set.renderings.split.name;
  for (const RatePoint& point : image) {
    double score = 0;
    if (!score_at(assisted, static_cast<double>(point.bytes), measure, score)) continue;
    const double gain = score - measure_of(point, measure);
    const std::string ratio = decimal_text(point.compression_ratio, 0) + ":1";
    series.points.push_back(
        {point.compression_ratio, gain, series.name + "\n" + ratio + ", gain " + decimal_text(gain, 4)});
  }
  std::reverse(series.points.begin(), series.points.end());
  return series;
}

Plot gain_plot(const std::vector<const FigureSet*>& sets, Measure measure) {
  const bool is_ssim = measure == Measure::ssim;
  Plot plot;
  plot.id = is_ssim ? "plot-gain-ssim" : "plot-gain-psnr";
  plot.title = std::string("Gain of polygon assistance at equal bytes: ") + (is_ssim ? "SSIM" : "PSNR");
  plot.description =
      "Polygon-assisted minus image-based score at equal bytes, against the compression ratio; above the "
      "zero line polygon assistance pays";
  plot.x_label = "compression ratio (:1)";
  plot.y_label = is_ssim ? "SSIM gain" : "PSNR gain (dB)";
  plot.zero_line = true;
  constexpr size_t kHues = 7;
  for (size_t i = 0; i < sets.size(); ++i) {
    plot.series.push_back(gain_series(*sets[i], measure));
    plot.series.back().style = "hue";
    plot.series.back().style += std::to_string(i % kHues);
  }
  plot.marks = {{25, "the paper’s 25:1"}};
  return plot;
}

}  // namespace

std::vector<Plot> demo_plots(const PaperResults& results) {
  std::vector<const FigureSet*> plotted;
  std::vector<Plot> plots;
  for (const FigureSet& set : results.figures) {
    if (set.image_curve.points.empty() || set.assisted_curve.points.empty()) continue;
    plotted.push_back(&set);
    plots.push_back(rate_plot(set, Measure::ssim));
    plots.push_back(rate_plot(set, Measure::psnr));
  }
  if (plotted.empty()) return plots;
  plots.push_back(gain_plot(plotted, Measure::ssim));
  plots.push_back(gain_plot(plotted, Measure::psnr));
  return plots;
}

std::optional<double> mean_ssim_gain(const FigureSet& set, double low_ratio, double high_ratio) {
  double sum = 0;
  int count = 0;
  for (const PlotPoint& point : gain_series(set, Measure::ssim).points) {
    if (point.x < low_ratio || point.x >= high_ratio) continue;
    sum += point.y;
    ++count;
  }
  if (count == 0) return std::nullopt;
  return sum / count;
}

}  // namespace pac::sim
