#include "jpeg/table_design.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>

#include "base/exact_math.h"
#include "jpeg/quantizer.h"
#include "jpeg/tables.h"

namespace pac::jpeg {
namespace {

// The designed quantizer rounds |x| / step up from .68, as the encoder's dead zone of 0.18 does.
constexpr double kRoundingOffset = 0.32;

double log2_of(double x) {
  return exact_log(x) * 1.44269504088896340736;
}

// Blocks of like activity (sum of AC magnitudes) share a histogram: a block's end and its runs tell a decoder much the
// same.
int kind_of(uint32_t activity) {
  return std::clamp(static_cast<int>(std::bit_width(activity)) - 5, 0, TableDesigner::kKinds - 1);
}

// Bits that an ideal entropy coder needs for n symbols of which counts[i] are of kind i: n log2 n - sum c log2 c.
class EntropyCounter {
 public:
  void add(double count) {
    if (count <= 0.0) return;
    total_ += count;
    sum_ += count * log2_of(count);
  }
  // `count` of either sign together, half of each.
  void add_both_signs(double count) {
    if (count <= 0.0) return;
    total_ += count;
    sum_ += count * log2_of(0.5 * count);
  }
  double bits() const { return total_ > 0.0 ? total_ * log2_of(total_) - sum_ : 0.0; }

 private:
  double total_ = 0, sum_ = 0;
};

}  // namespace

void TableDesigner::Histograms::reset() {
  for (int kind = 0; kind < kKinds; ++kind) {
    counts[kind].assign(size_t{64} * kBins, 0);
    std::fill(n_bins[kind], n_bins[kind] + 64, 1);
  }
  n_blocks = 0;
}

// DC is coded as differences: its histogram is of those.
void TableDesigner::add(const int16_t* coefficients, size_t n_blocks, int& dc, Histograms& to) const {
  to.n_blocks += n_blocks;
  for (size_t block = 0; block < n_blocks; ++block) {
    const int16_t* c = coefficients + 64 * block;
    uint32_t activity = 0;
    for (size_t i = 1; i < 64; ++i) activity += static_cast<uint32_t>(std::abs(c[i]));
    const int kind = kind_of(activity / kDctScale);
    for (size_t i = 0; i < 64; ++i) {
      const int magnitude = std::abs(i == 0 ? c[0] - dc : c[i]);
      const int bin = std::min((magnitude + kDctScale / 4) / (kDctScale / 2), kBins - 1);
      to.counts[kind][i * kBins + static_cast<size_t>(bin)] += 1;
      to.n_bins[kind][i] = std::max(to.n_bins[kind][i], bin + 1);
    }
    dc = c[0];
  }
}

void TableDesigner::reset() {
  luma_.reset();
  chroma_.reset();
  for (int& dc : dc_) dc = 0;
}

void TableDesigner::add_rows(CoefficientSource& source, int first_row, int end_row) {
  for (int row = first_row; row < end_row; ++row) {
    source.load(row);
    for (int c = 0; c < source.frame().n_components; ++c)
      add(source.row(c), source.n_blocks(c, row), dc_[c], c == 0 ? luma_ : chroma_);
  }
}

// J(step) = bits + kBitsPerSquaredStep * sum((error / reference)^2) of one frequency.
double TableDesigner::cost(const Histograms& of, size_t natural, int step, double reference) const {
  double bits = 0, squared_error = 0;
  for (int kind = 0; kind < kKinds; ++kind) {
    const uint32_t* counts = of.counts[kind].data() + natural * kBins;
    EntropyCounter entropy;
    double in_level = 0;
    int level = 0;
    // Bin b holds magnitudes near b / 2. It joins level l when b / 2 / step + offset reaches l.
    double next = (1.0 - kRoundingOffset) * step;
    for (int bin = 0; bin < of.n_bins[kind][natural]; ++bin) {
      const double x = 0.5 * bin;
      while (x >= next) {
        level == 0 ? entropy.add(in_level) : entropy.add_both_signs(in_level);
        in_level = 0;
        level += 1;
        next += step;
      }
      const double error = x - static_cast<double>(level) * step;
      in_level += counts[bin];
      squared_error += counts[bin] * error * error;
    }
    level == 0 ? entropy.add(in_level) : entropy.add_both_signs(in_level);
    bits += entropy.bits();
  }
  // The differences of DC do not show its error: it is that of a uniform quantizer.
  if (natural == 0) squared_error = static_cast<double>(of.n_blocks) * step * step / 12.0;
  return bits + kBitsPerSquaredStep * squared_error / (reference * reference);
}

// Coarse steps a tenth apart first, then every step between the neighbors of the best.
uint16_t TableDesigner::best_step(const Histograms& of, size_t natural, double reference) const {
  const auto next_step = [](int step) { return step + 1 + step / 10; };
  int best = 1, below = 1, above = 2;
  double best_cost = cost(of, natural, 1, reference);
  for (int previous = 1, step = 2; step <= 255; previous = step, step = next_step(step)) {
    const double j = cost(of, natural, step, reference);
    if (j >= best_cost) continue;
    best_cost = j;
    best = step;
    below = previous;
    above = next_step(step);
  }
  for (int step = below + 1; step < above && step <= 255; ++step) {
    const double j = cost(of, natural, step, reference);
    if (j >= best_cost) continue;
    best_cost = j;
    best = step;
  }
  return static_cast<uint16_t>(best);
}

QuantTables TableDesigner::at_quality(Tune tune, double quality) const {
  const ReferenceSteps reference = tuned_reference(tune, quality);
  QuantTables tables;
  for (size_t i = 0; i < 64; ++i) {
    tables.luma[i] = best_step(luma_, i, reference.luma[i]);
    tables.chroma[i] = chroma_.n_blocks > 0 ? best_step(chroma_, i, reference.chroma[i]) : uint16_t{1};
  }
  return tables;
}

}  // namespace pac::jpeg
