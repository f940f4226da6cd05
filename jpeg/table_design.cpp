#include "jpeg/table_design.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "base/exact_math.h"
#include "jpeg/quantizer.h"
#include "jpeg/tables.h"

namespace pac::jpeg {
namespace {

// The designed quantizer rounds |x| / step up from .64, as the encoder's dead zone of 0.14 does.
constexpr double kRoundingOffset = 0.36;

double log2_of(double x) {
  return exact_log(x) * 1.44269504088896340736;
}

// Bits that an ideal entropy coder needs for n symbols of which counts[i] are of kind i: n log2 n - sum c log2 c.
class EntropyCounter {
 public:
  void add(double count) {
    if (count <= 0.0) return;
    total_ += count;
    sum_ += count * log2_of(count);
  }
  double bits() const { return total_ > 0.0 ? total_ * log2_of(total_) - sum_ : 0.0; }

 private:
  double total_ = 0, sum_ = 0;
};

}  // namespace

void TableDesigner::Histograms::reset() {
  counts.assign(size_t{64} * kBins, 0);
  n_blocks = 0;
}

// DC is coded as differences: its histogram is of those.
void TableDesigner::add(const int16_t* coefficients, size_t n_blocks, int& dc, Histograms& to) const {
  to.n_blocks += n_blocks;
  for (size_t block = 0; block < n_blocks; ++block) {
    const int16_t* c = coefficients + 64 * block;
    for (size_t i = 0; i < 64; ++i) {
      const int magnitude = std::abs(i == 0 ? c[0] - dc : c[i]);
      const int bin = std::min((magnitude + kDctScale / 4) / (kDctScale / 2), kBins - 1);
      to.counts[i * kBins + static_cast<size_t>(bin)] += 1;
    }
    dc = c[0];
  }
}

void TableDesigner::measure(CoefficientSource& source) {
  luma_.reset();
  chroma_.reset();
  int dc[3] = {0, 0, 0};
  for (int row = 0; row < source.frame().mcu_rows; ++row) {
    source.load(row);
    for (int c = 0; c < source.frame().n_components; ++c)
      add(source.row(c), source.n_blocks(c, row), dc[c], c == 0 ? luma_ : chroma_);
  }
}

// J(step) = bits + kBitsPerSquaredStep * sum((error / reference)^2) of one frequency.
double TableDesigner::cost(const Histograms& of, size_t natural, int step, double reference) const {
  const uint32_t* counts = of.counts.data() + natural * kBins;
  int n_bins = kBins;
  while (n_bins > 1 && counts[n_bins - 1] == 0) --n_bins;
  EntropyCounter entropy;
  double squared_error = 0, in_level = 0;
  int level = 0;
  // Bin b holds magnitudes near b / 2. It joins level l when b / 2 / step + offset reaches l.
  double next = (1.0 - kRoundingOffset) * step;
  for (int bin = 0; bin < n_bins; ++bin) {
    const double x = 0.5 * bin;
    while (x >= next) {
      entropy.add(level == 0 ? in_level : 0.5 * in_level);
      if (level > 0) entropy.add(0.5 * in_level);
      in_level = 0;
      level += 1;
      next += step;
    }
    const double error = x - static_cast<double>(level) * step;
    in_level += counts[bin];
    squared_error += counts[bin] * error * error;
  }
  entropy.add(level == 0 ? in_level : 0.5 * in_level);
  if (level > 0) entropy.add(0.5 * in_level);
  // The differences of DC do not show its error: it is that of a uniform quantizer.
  if (natural == 0) squared_error = static_cast<double>(of.n_blocks) * step * step / 12.0;
  return entropy.bits() + kBitsPerSquaredStep * squared_error / (reference * reference);
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
