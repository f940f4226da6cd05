#include "mpeg1/adapted_matrices.h"

#include <algorithm>
#include <bit>

#include "base/kernels/block_kernels.h"
#include "mpeg1/vlc_tables.h"

namespace pac::mpeg1 {
namespace {

constexpr uint32_t kEnoughBlocks = 2000;
constexpr int64_t kLeastGainPerMille = 5;
constexpr int kLargestEntry = 96;  // coarser ones would rest on too few coefficients

using Histogram = CoefficientStatistics::Histogram;

// Twice the middle of a bin, so that it is whole: bins are two units wide.
int64_t twice_middle(int bin) {
  return 2 * (2 * int64_t{bin} + 1);
}

// What the encoder makes of it, about: intra levels round down from five eighths, others have no rounding.
int64_t level_of(int64_t twice, int entry, bool is_intra) {
  return is_intra ? (8 * twice + 6 * int64_t{entry}) / (16 * int64_t{entry}) : twice / (2 * int64_t{entry});
}
int64_t twice_reconstructed(int64_t level, int entry, bool is_intra) {
  if (level == 0) return 0;
  return is_intra ? 2 * level * entry : (2 * level + 1) * entry;
}

struct Position {
  const uint32_t* counts;
  int run;  // before a level here, ordinarily
  bool is_intra;
  int64_t lambda;
};

// Four times distortion + lambda * bits.
int64_t cost_of(const Position& position, int entry) {
  int64_t cost = 0;
  for (int bin = 0; bin < CoefficientStatistics::kBins; ++bin) {
    const int64_t count = position.counts[bin];
    if (count == 0) continue;
    const int64_t twice = twice_middle(bin);
    const int64_t level = std::min<int64_t>(level_of(twice, entry, position.is_intra), kMaxLevel);
    const int64_t error = twice - twice_reconstructed(level, entry, position.is_intra);
    const int64_t kept =
        error * error + (level == 0 ? 0 : 4 * position.lambda * run_level_bits(position.run, static_cast<int>(level)));
    cost += count * std::min(kept, twice * twice);  // levels that do not pay are left out
  }
  return cost;
}

// The mean run of zeros before each position, from how often the positions before it are zero with this matrix.
void ordinary_runs(const Histogram& histogram, const QuantizerMatrix& matrix, bool is_intra, int (&runs)[64]) {
  double expected = 0;
  for (size_t k = 0; k < 64; ++k) {
    runs[k] = static_cast<int>(expected + 0.5);
    if (is_intra && k == 0) continue;
    uint64_t zeros = 0;
    for (int bin = 0; bin < CoefficientStatistics::kBins; ++bin)
      if (level_of(twice_middle(bin), matrix[kNaturalFromZigzag[k]], is_intra) == 0) zeros += histogram.counts[k][bin];
    expected = (expected + 1) * static_cast<double>(zeros) / histogram.n_blocks;
  }
}

int best_entry(const Position& position, int present, int64_t& gain) {
  const int64_t before = cost_of(position, present);
  int64_t least = before;
  int best = present;
  const int first = std::max(kMinMatrixEntry, present / 2), last = std::min(kLargestEntry, 2 * present);
  for (int entry = first; entry <= last; ++entry) {
    const int64_t cost = cost_of(position, entry);
    if (cost < least) least = cost, best = entry;
  }
  gain = before - least;
  return best;
}

}  // namespace

CoefficientStatistics::CoefficientStatistics() : histograms_(2) {}

void CoefficientStatistics::clear() {
  for (Histogram& histogram : histograms_) histogram = {};
}

void CoefficientStatistics::add(const Attempt& attempt) {
  const bool is_intra = attempt.kind == MacroblockKind::intra;
  Histogram& histogram = histograms_[is_intra ? 1 : 0];
  const int width = 2 * attempt.quantizer;
  for (int block = 0; block < kBlocks; ++block) {
    if (!is_intra && (attempt.pattern & 32 >> block) == 0) continue;
    ++histogram.n_blocks;
    for (size_t k = 0; k < 64; ++k) {
      const int c = attempt.dct[64 * block + kNaturalFromZigzag[k]];
      ++histogram.counts[k][std::min((c < 0 ? -c : c) / width, kBins - 1)];
    }
  }
}

void CoefficientStatistics::add(const CoefficientStatistics& other) {
  for (size_t kind = 0; kind < 2; ++kind) {
    histograms_[kind].n_blocks += other.histograms_[kind].n_blocks;
    for (size_t k = 0; k < 64; ++k)
      for (size_t bin = 0; bin < kBins; ++bin)
        histograms_[kind].counts[k][bin] += other.histograms_[kind].counts[k][bin];
  }
}

QuantizerMatrix adapted_matrix(const CoefficientStatistics& statistics, const QuantizerMatrix& matrix, bool is_intra,
                               int64_t lambda) {
  const Histogram& histogram = statistics.of(is_intra);
  if (histogram.n_blocks < kEnoughBlocks) return matrix;
  int runs[64];
  ordinary_runs(histogram, matrix, is_intra, runs);
  QuantizerMatrix adapted = matrix;
  int64_t total = 0, gained = 0;
  for (size_t k = is_intra ? 1 : 0; k < 64; ++k) {
    const size_t natural = kNaturalFromZigzag[k];
    const Position position{histogram.counts[k], runs[k], is_intra, lambda};
    int64_t gain = 0;
    total += cost_of(position, matrix[natural]);
    adapted[natural] = static_cast<uint8_t>(best_entry(position, matrix[natural], gain));
    gained += gain;
  }
  return gained * 1000 > total * kLeastGainPerMille ? adapted : matrix;
}

QuantizerMatrix scaled_matrix(const QuantizerMatrix& matrix, double scale, bool is_intra) {
  QuantizerMatrix scaled = matrix;
  for (size_t i = is_intra ? 1 : 0; i < 64; ++i)
    scaled[i] = static_cast<uint8_t>(std::clamp(static_cast<int>(matrix[i] * scale + 0.5), kMinMatrixEntry, 255));
  return scaled;
}

}  // namespace pac::mpeg1
