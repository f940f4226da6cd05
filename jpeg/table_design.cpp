#include "jpeg/table_design.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>

#include "jpeg/quantizer.h"

namespace pac::jpeg {
namespace {

// Found best with the trellis behind it: levels round up from .64.
constexpr double kRoundingOffset = 0.36;

// log2 of 1 and more, within 2e-5: exponent, and 2 atanh((m - 1) / (m + 1)) / ln 2 of the mantissa by its series.
double log2_of(double x) {
  const auto bits = std::bit_cast<uint64_t>(x);
  const auto exponent = static_cast<double>(static_cast<int>(bits >> 52) - 1023);
  const double mantissa = std::bit_cast<double>((bits & 0xFFFFFFFFFFFFF) | 0x3FF0000000000000);
  const double t = (mantissa - 1.0) / (mantissa + 1.0), s = t * t;
  return exponent + 2.88539008177792681 * t * (1.0 + s * (1.0 / 3 + s * (1.0 / 5 + s * (1.0 / 7))));
}

// Blocks of like activity (sum of AC magnitudes) share a histogram: a block's end and its runs tell a decoder much the
// same.
int kind_of(uint32_t activity, int n_kinds) {
  return std::clamp(static_cast<int>(std::bit_width(activity)) - 5, 0, n_kinds - 1);
}

// Bits that an ideal entropy coder needs for n symbols of which counts[i] are of kind i: n log2 n - sum c log2 c.
class EntropyCounter {
 public:
  void add(double count) {
    if (count < 1.0) return;
    total_ += count;
    sum_ += count * log2_of(count);
  }
  // `count` of either sign together, half of each.
  void add_both_signs(double count) {
    if (count < 1.0) return;
    total_ += count;
    sum_ += count * (log2_of(count) - 1.0);
  }
  double bits() const { return total_ > 0.0 ? total_ * log2_of(total_) - sum_ : 0.0; }

 private:
  double total_ = 0, sum_ = 0;
};

// The step with the least cost(step) among about 30 that lie an eighth apart, within a factor of 4 of `reference`, and
// then those between the neighbors of the best.
template <class Cost>
uint16_t search_step(double reference, Cost&& cost) {
  const int first = std::clamp(static_cast<int>(reference / 4), 1, 255);
  const int last = std::clamp(static_cast<int>(reference * 4), first, 255);
  const auto next_step = [](int step) { return step + 1 + step / 8; };
  int best = first, below = first, above = next_step(first);
  double best_cost = cost(first);
  for (int previous = first, step = next_step(first); step <= last; previous = step, step = next_step(step)) {
    const double j = cost(step);
    if (j >= best_cost) continue;
    best_cost = j;
    best = step;
    below = previous;
    above = next_step(step);
  }
  const int coarse_best = best;
  for (int step = below + 1; step < above && step <= last; ++step) {
    if (step == coarse_best) continue;
    const double j = cost(step);
    if (j >= best_cost) continue;
    best_cost = j;
    best = step;
  }
  return static_cast<uint16_t>(best);
}

}  // namespace

void DcDesigner::reset() {
  value_counts_.assign(2 * kRange + 1, 0);
  difference_counts_.assign(2 * kRange + 1, 0);
}

void DcDesigner::add(const int16_t* coefficients, size_t n_blocks, int& dc) {
  const auto unit = [](int c) { return (std::abs(c) + kDctScale / 2) / kDctScale; };
  for (size_t block = 0; block < n_blocks; ++block) {
    const int c = coefficients[64 * block];
    value_counts_[static_cast<size_t>(std::min(unit(c), 2 * kRange))] += 1;
    difference_counts_[static_cast<size_t>(std::min(unit(c - dc), 2 * kRange))] += 1;
    dc = c;
  }
}

void DcDesigner::finish() {
  const auto sum_up = [](const std::vector<uint32_t>& counts, std::vector<Below>& below) {
    size_t end = counts.size();
    while (end > 0 && counts[end - 1] == 0) --end;
    Below sums{0, 0, 0};
    below.assign(1, sums);
    for (size_t i = 0; i < end; ++i) {
      const auto n = int64_t{counts[i]}, magnitude = static_cast<int64_t>(i);
      sums = {sums.count + n, sums.sum + n * magnitude, sums.squares + n * magnitude * magnitude};
      below.push_back(sums);
    }
  };
  sum_up(value_counts_, values_below_);
  sum_up(difference_counts_, differences_below_);
}

// J(step) = bits + weight * sum(error^2), level by level.
double DcDesigner::cost(int step, double weight) const {
  const auto for_each_level = [step](const std::vector<Below>& below, auto&& visit) {
    const auto n = static_cast<int>(below.size()) - 1;
    for (int value = 0, first = 0, next = step - step / 2; first < n; value += step, first = next, next += step) {
      const Below &a = below[static_cast<size_t>(first)], &b = below[static_cast<size_t>(std::min(next, n))];
      visit(value, Below{b.count - a.count, b.sum - a.sum, b.squares - a.squares});
    }
  };
  int64_t squared_error = 0;
  for_each_level(values_below_, [&](int value, const Below& in) {
    squared_error += in.squares - value * (2 * in.sum - value * in.count);
  });
  EntropyCounter entropy;
  for_each_level(differences_below_, [&](int value, const Below& in) {
    const auto count = static_cast<double>(in.count);
    value == 0 ? entropy.add(count) : entropy.add_both_signs(count);
  });
  return entropy.bits() + weight * static_cast<double>(squared_error);
}

// Every step: the good ones may be single.
uint16_t DcDesigner::best_step(double reference, double bits_per_squared_step) const {
  const int first = std::clamp(static_cast<int>(reference / 4), 1, 255);
  const int last = std::clamp(static_cast<int>(reference * 3), first, 255);
  const double weight = bits_per_squared_step / (reference * reference);
  int best = first;
  double best_cost = cost(first, weight);
  for (int step = first + 1; step <= last; ++step) {
    const double j = cost(step, weight);
    if (j >= best_cost) continue;
    best_cost = j;
    best = step;
  }
  return static_cast<uint16_t>(best);
}

void AcDesigner::reset() {
  counts_.assign(size_t{kKinds} * 64 * kBins, 0);
  for (auto& of_kind : n_bins_) std::fill(of_kind, of_kind + 64, uint16_t{1});
}

void AcDesigner::add(const int16_t* coefficients, size_t n_blocks) {
  for (size_t block = 0; block < n_blocks; ++block) {
    const int16_t* c = coefficients + 64 * block;
    uint32_t activity = 0;
    for (size_t i = 1; i < 64; ++i) activity += static_cast<uint32_t>(std::abs(c[i]));
    const int kind = kind_of(activity / kDctScale, kKinds);
    uint16_t* counts = counts_.data() + static_cast<size_t>(kind) * 64 * kBins;
    for (size_t i = 1; i < 64; ++i) {
      const int bin = std::min((std::abs(c[i]) + kDctScale / 4) / (kDctScale / 2), kBins - 1);
      uint16_t& count = counts[i * kBins + static_cast<size_t>(bin)];
      if (count < 65535) ++count;
      n_bins_[kind][i] = std::max(n_bins_[kind][i], static_cast<uint16_t>(bin + 1));
    }
  }
}

void AcDesigner::finish() {
  below_.clear();
  for (size_t kind = 0; kind < kKinds; ++kind) {
    for (size_t i = 1; i < 64; ++i) {
      const uint16_t* counts = counts_.data() + (kind * 64 + i) * kBins;
      first_below_[kind][i] = static_cast<uint32_t>(below_.size());
      Below sums{};
      below_.push_back(sums);
      for (int bin = 0; bin < n_bins_[kind][i]; ++bin) {
        const double n = counts[bin], x = 0.5 * bin;
        sums = {sums.count + n, sums.sum + n * x, sums.squares + n * x * x};
        below_.push_back(sums);
      }
    }
  }
}

// J(step) = bits + bits_per_squared_step * sum((error / reference)^2).
double AcDesigner::cost(size_t natural, int step, double reference, double gain, double bits_per_squared_step) const {
  const double g = effective_gain(gain, step), interval = step / g;
  double bits = 0, squared_error = 0;
  for (size_t kind = 0; kind < kKinds; ++kind) {
    const int n_bins = n_bins_[kind][natural];
    const Below* below = below_.data() + first_below_[kind][natural];
    EntropyCounter entropy;
    // Bin b holds magnitudes near b / 2. It joins level l where b / 2 / interval + offset reaches l.
    for (int level = 0, first = 0; first < n_bins; ++level) {
      const double next = (level + 1.0 - kRoundingOffset) * interval;
      const int end = std::min(static_cast<int>(std::ceil(2.0 * next)), n_bins);
      const double n = below[end].count - below[first].count, value = level * interval;
      level == 0 ? entropy.add(n) : entropy.add_both_signs(n);
      squared_error +=
          below[end].squares - below[first].squares - value * (2.0 * (below[end].sum - below[first].sum) - n * value);
      first = end;
    }
    bits += entropy.bits();
  }
  const double scale = g / reference;
  return bits + bits_per_squared_step * squared_error * scale * scale;
}

uint16_t AcDesigner::best_step(size_t natural, double reference, double gain, double bits_per_squared_step) const {
  return search_step(reference, [&](int step) { return cost(natural, step, reference, gain, bits_per_squared_step); });
}

void TableDesigner::reset(bool dc_only) {
  dc_only_ = dc_only;
  has_chroma_ = false;
  for (int set = 0; set < 2; ++set) {
    dc_[set].reset();
    if (!dc_only) ac_[set].reset();
  }
  for (int& dc : last_dc_) dc = 0;
}

void TableDesigner::add_row(CoefficientSource& source, int mcu_row) {
  source.load(mcu_row);
  for (int c = 0; c < source.frame().n_components; ++c) {
    const int set = c == 0 ? 0 : 1;
    const size_t n_blocks = source.n_blocks(c, mcu_row);
    dc_[set].add(source.row(c), n_blocks, last_dc_[c]);
    if (!dc_only_) ac_[set].add(source.row(c), n_blocks);
    has_chroma_ = has_chroma_ || c > 0;
  }
}

void TableDesigner::finish() {
  for (int set = 0; set < 2; ++set) {
    dc_[set].finish();
    if (!dc_only_) ac_[set].finish();
  }
}

QuantTables TableDesigner::at_quality(Tune tune, double quality, const double (&chroma_gain)[64]) const {
  const ReferenceSteps reference = tuned_reference(tune, quality);
  const double rate = exchange_rates(tune).design;
  QuantTables tables = dc_at_quality(tune, quality);
  for (size_t i = 1; i < 64; ++i) {
    tables.luma[i] = ac_[0].best_step(i, reference.luma[i], 1.0, rate);
    tables.chroma[i] = has_chroma_ ? ac_[1].best_step(i, reference.chroma[i], chroma_gain[i], rate) : uint16_t{1};
  }
  return tables;
}

QuantTables TableDesigner::dc_at_quality(Tune tune, double quality) const {
  const ReferenceSteps reference = tuned_reference(tune, quality);
  const double rate = exchange_rates(tune).design;
  QuantTables tables = tuned_tables(tune, quality);
  tables.luma[0] = dc_[0].best_step(reference.luma[0], rate);
  if (has_chroma_) tables.chroma[0] = dc_[1].best_step(reference.chroma[0], rate);
  return tables;
}

}  // namespace pac::jpeg
