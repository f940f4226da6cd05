#include "sim/table_family.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace pac::sim {

namespace {

constexpr double kLn2 = 0.69314718055994530942;
constexpr double kFinestScale = 1, kCoarsestScale = 2600;  // percent; at 2545 the last Annex K entry reaches 255

// The scales at which an entry of Annex K's tables, floor((k * s + 50) / 100), takes a new value in 2..255; ascending.
std::vector<double> annex_k_breakpoints() {
  const jpeg::QuantTables base = jpeg::annex_k_tables(50);  // scale 100: the tables themselves
  std::vector<uint16_t> entries(base.luma.begin(), base.luma.end());
  entries.insert(entries.end(), base.chroma.begin(), base.chroma.end());
  std::sort(entries.begin(), entries.end());
  entries.erase(std::unique(entries.begin(), entries.end()), entries.end());
  std::vector<double> scales;
  for (const uint16_t entry : entries)
    for (int value = 2; value <= 255; ++value) scales.push_back((100.0 * value - 50) / entry);
  std::sort(scales.begin(), scales.end());
  scales.erase(std::unique(scales.begin(), scales.end()), scales.end());
  return scales;
}

// Whether a level other than zero can differ between two steps of one coefficient. One unit of slack for the codec's
// integer arithmetic.
bool matters(const jpeg::QuantTable& a, const jpeg::QuantTable& b, const std::array<double, 64>& peaks) {
  for (size_t k = 0; k < 64; ++k)
    if (a[k] != b[k] && 2 * (peaks[k] + 1) >= std::min(a[k], b[k])) return true;
  return false;
}

std::vector<double> annex_k_steps(const CoefficientPeaks& peaks) {
  const std::vector<double> breaks = annex_k_breakpoints();
  std::vector<double> qualities = {100};
  jpeg::QuantTables last = jpeg::annex_k_tables(100);
  for (size_t i = 0; i < breaks.size(); ++i) {
    const double next = i + 1 < breaks.size() ? breaks[i + 1] : kCoarsestScale;
    const double quality = quality_from_scale(0.5 * (breaks[i] + next));
    const jpeg::QuantTables tables = jpeg::annex_k_tables(quality);
    if (!matters(tables.luma, last.luma, peaks.luma) && !matters(tables.chroma, last.chroma, peaks.chroma)) continue;
    qualities.push_back(quality);
    last = tables;
  }
  return qualities;
}

jpeg::QuantTable cheapest_steps(const std::array<StepCosts, 64>& costs, double lambda) {
  jpeg::QuantTable table{};
  for (size_t k = 0; k < 64; ++k) {
    size_t best = 1;
    double best_cost = costs[k].error[1] + lambda * costs[k].bits[1];
    for (size_t step = 2; step < 256; ++step) {
      const double cost = costs[k].error[step] + lambda * costs[k].bits[step];
      if (cost < best_cost) {
        best = step;
        best_cost = cost;
      }
    }
    table[k] = static_cast<uint16_t>(best);
  }
  return table;
}

}  // namespace

bool same_tables(const jpeg::QuantTables& a, const jpeg::QuantTables& b) {
  return a.luma == b.luma && a.chroma == b.chroma;
}

Result<ScaledTables> ScaledTables::create(ConstRgbView image, TableFamily family, jpeg::Subsampling subsampling,
                                          std::span<const float> importance) {
  if (image.empty()) return Failure{Error::bad_argument, 0, "image has no pixels"};
  ScaledTables tables;
  if (family == TableFamily::adapted)
    tables.costs_ = measure_costs(image, subsampling, importance);
  else
    tables.peaks_ = measure_peaks(image, subsampling);
  return tables;
}

jpeg::QuantTables ScaledTables::at_quality(double quality) const {
  if (costs_ == nullptr) return jpeg::annex_k_tables(quality);
  const double step = 0.16 * scale_from_quality(quality);
  const double lambda = kLn2 / 6 * step * step;
  return {cheapest_steps(costs_->luma, lambda), cheapest_steps(costs_->chroma, lambda)};
}

std::vector<double> ScaledTables::step_qualities() const {
  if (costs_ == nullptr) return annex_k_steps(peaks_);
  std::vector<double> qualities;
  jpeg::QuantTables last;
  for (double scale = kFinestScale; scale < kCoarsestScale; scale *= 1.002) {
    const double quality = quality_from_scale(scale);
    const jpeg::QuantTables tables = at_quality(quality);
    if (qualities.empty() || !same_tables(tables, last)) qualities.push_back(quality);
    last = tables;
  }
  return qualities;
}

}  // namespace pac::sim
