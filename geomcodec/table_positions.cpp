#include "geomcodec/table_positions.h"

#include <algorithm>
#include <cmath>

#include "base/exact_math.h"

namespace pac::geomcodec {
namespace {

// Choices are made on a quarter of the vertices in runs spread over the mesh, from kFewestRuns to kMostRuns of them.
constexpr size_t kRun = 64, kFewestRuns = 16, kMostRuns = 64;

// A coder that counts what TableEncoder would be given.
class Meter {
 public:
  static constexpr bool kDecodes = false;
  uint32_t symbol(uint32_t lane, uint32_t /*context*/, uint32_t symbol) {
    ++count_[lane][symbol];
    return symbol;
  }
  uint32_t raw(int count, uint32_t value) {
    raw_ += static_cast<uint64_t>(count);
    return value;
  }
  // Bits with ideal tables, one per lane.
  double bits() const {
    double sum = static_cast<double>(raw_);
    for (const auto& counts : count_) {
      double total = 0;
      for (const uint32_t count : counts) total += count;
      for (const uint32_t count : counts)
        if (count > 0) sum += count * exact_log(total / count) / 0.69314718055994530942;
    }
    return sum;
  }

 private:
  uint32_t count_[kLanes][kTableSymbols] = {};
  uint64_t raw_ = 0;
};
inline void release(Meter& /*coder*/, const Meter& /*held*/) {}

struct Sampled {
  std::vector<uint32_t> vertex;
  std::vector<Stencil> stencil;
};

Sampled sample_of(const Stencils& stencils, size_t n_positions) {
  Sampled sampled;
  const bool all = n_positions <= kRun * kFewestRuns;
  const size_t n_runs = all ? 1 : std::clamp(n_positions / (4 * kRun), kFewestRuns, kMostRuns);
  for (size_t run = 0; run < n_runs; ++run) {
    const size_t begin = n_positions * run / n_runs;
    const size_t end = all ? n_positions : begin + kRun;
    for (size_t v = begin; v < end; ++v) {
      sampled.vertex.push_back(static_cast<uint32_t>(v));
      stencils.get(static_cast<uint32_t>(v), false, sampled.stencil.emplace_back());
    }
  }
  return sampled;
}

double bits_of(const Sampled& sampled, std::span<const Position> positions, std::vector<KnownPosition>& known,
               const PositionWeights& weights, int bits) {
  Meter meter;
  TablePositionCoder<Meter> coder(meter, weights, bits, known);
  for (size_t i = 0; i < sampled.vertex.size(); ++i) {
    Position position = positions[sampled.vertex[i]];
    coder.code(sampled.vertex[i], sampled.stencil[i], position);
  }
  return meter.bits();
}

// Least squares for each class's share of the neighbors' mean, large misses counting less.
PositionWeights fit_shares(const Sampled& sampled, std::span<const Position> positions,
                           std::span<const KnownPosition> known) {
  double both[PositionWeights::kClasses] = {}, square[PositionWeights::kClasses] = {};
  uint32_t n[PositionWeights::kClasses] = {};
  for (size_t i = 0; i < sampled.vertex.size(); ++i) {
    const Stencil& stencil = sampled.stencil[i];
    if (stencil.n_parallelograms == 0) continue;
    const size_t which = PositionWeights::class_of(stencil);
    const Features features = features_of(stencil, known);
    double missed[3], size = 64;
    for (size_t axis = 0; axis < 3; ++axis) {
      missed[axis] = 64.0 * positions[sampled.vertex[i]][axis] - features.base[axis];
      size += std::abs(missed[axis]);
    }
    for (size_t axis = 0; axis < 3; ++axis) {
      both[which] += missed[axis] * features.mean_less_base[axis] / size;
      square[which] += static_cast<double>(features.mean_less_base[axis]) * features.mean_less_base[axis] / size;
    }
    ++n[which];
  }
  PositionWeights weights;
  for (size_t c = 0; c < PositionWeights::kClasses; ++c) {
    if (n[c] < 24 || !(square[c] > 0)) continue;
    weights.customized = true;
    weights.share[c][0] = static_cast<int8_t>(std::clamp(std::floor(128 * both[c] / square[c] + 0.5), -127.0, 127.0));
  }
  return weights;
}

}  // namespace

std::vector<uint8_t> encode_positions_by_tables(const Stencils& stencils, std::span<const Position> positions, int bits,
                                                Expected expected) {
  std::vector<KnownPosition> known;
  known.reserve(positions.size());
  for (const Position& position : positions) known.push_back({PackedPosition(position), 0});
  const Sampled sampled = sample_of(stencils, positions.size());
  PositionWeights best;
  double best_bits = bits_of(sampled, positions, known, best, bits);
  const auto try_weights = [&](const PositionWeights& weights) {
    const double cost = bits_of(sampled, positions, known, weights, bits);
    if (cost >= best_bits) return;
    best_bits = cost;
    best = weights;
  };
  if (const PositionWeights fitted = fit_shares(sampled, positions, known); fitted.customized) try_weights(fitted);
  PositionWeights changed = best;
  changed.lifted = true;
  try_weights(changed);
  if (best_bits > 3.0 * bits * static_cast<double>(sampled.vertex.size())) {
    best = {};
    best.raw = true;
  }

  TableEncoder coder(kPositionContexts, expected);
  coder.reserve(best.raw ? 0 : 3 * positions.size());
  code_table_weights(coder, best);
  TablePositionCoder<TableEncoder> position_coder(coder, best, bits, known);
  Stencil stencil;
  for (uint32_t v = 0; v < positions.size(); ++v) {
    stencils.get(v, false, stencil);
    Position position = positions[v];
    position_coder.code(v, stencil, position);
  }
  return coder.finish();
}

Result<std::vector<Position>> decode_positions_by_tables(std::span<const uint8_t> bytes, const Stencils& stencils,
                                                         uint32_t n_positions, int bits, Expected expected) {
  SymbolTables tables;
  TableDecoder coder(bytes, kPositionContexts, expected, tables);
  PositionWeights weights;
  code_table_weights(coder, weights);
  std::vector<KnownPosition> known;
  std::vector<Position> positions;
  TablePositionCoder<TableDecoder> position_coder(coder, weights, bits, known);
  Stencil stencil;
  for (uint32_t v = 0; v < n_positions; ++v) {
    if (v == positions.size()) {
      // Faces have shown the first ones; the rest is a claim of the header.
      const size_t room = std::max<size_t>(stencils.n_vertices(), 2 * positions.size() + 4096);
      positions.resize(std::min<size_t>(n_positions, room));
      known.resize(positions.size());
    }
    stencils.get(v, false, stencil);
    position_coder.code(v, stencil, positions[v]);
    if (coder.failed()) return Failure{Error::corrupt, 0, "positions end too early"};
  }
  if (!coder.ends_exactly()) return Failure{Error::corrupt, 0, "positions do not end where the header says"};
  return positions;
}

}  // namespace pac::geomcodec
