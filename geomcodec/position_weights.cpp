// What the encoder of positions finds out about a mesh: shares by least squares, and repetition.
#include "geomcodec/position_weights.h"

#include <cmath>
#include <cstdlib>
#include <vector>

namespace pac::geomcodec {
namespace {

// Least squares for the shares of one class, large misses counting less: the code's cost grows with their logarithm.
class Fit {
 public:
  void add(const Features& features, const Position& position) {
    double missed[3], size = 64;
    for (size_t axis = 0; axis < 3; ++axis) {
      missed[axis] = 64.0 * position[axis] - features.base[axis];
      size += std::abs(missed[axis]);
    }
    const double weight = 1 / size;
    for (size_t axis = 0; axis < 3; ++axis) {
      const double f = features.mean_less_base[axis], g = features.twist[axis], m = missed[axis];
      ff_ += weight * f * f;
      fg_ += weight * f * g;
      gg_ += weight * g * g;
      fm_ += weight * f * m;
      gm_ += weight * g * m;
    }
    ++n_;
  }
  bool solve(int8_t (&share)[2]) const {
    const double regular = 1e-3 * (ff_ + gg_) + 1e-9;
    const double ff = ff_ + regular, gg = gg_ + regular, determinant = ff * gg - fg_ * fg_;
    if (n_ < 24 || !(determinant > 0)) return false;
    share[0] = rounded((fm_ * gg - gm_ * fg_) / determinant);
    share[1] = rounded((gm_ * ff - fm_ * fg_) / determinant);
    return true;
  }

 private:
  static int8_t rounded(double share) {
    return static_cast<int8_t>(std::clamp(std::floor(128 * share + 0.5), -127.0, 127.0));
  }
  double ff_ = 0, fg_ = 0, gg_ = 0, fm_ = 0, gm_ = 0;
  uint32_t n_ = 0;
};

}  // namespace

PositionWeights fit_weights(const Topology& topology, const Stencils& stencils, std::span<const Stencil> first,
                            std::span<const Position> positions) {
  Fit fit[PositionWeights::kClasses];
  std::vector<KnownPosition> known;
  known.reserve(positions.size());
  for (const Position& position : positions) known.push_back({PackedPosition(position), 0});
  Stencil found;
  for (uint32_t v = 0; v < topology.n_vertices; ++v) {
    if (v >= first.size()) stencils.get(v, true, found);
    const Stencil& stencil = v < first.size() ? first[v] : found;
    if (stencil.n_parallelograms > 0)
      fit[PositionWeights::class_of(stencil)].add(features_of(stencil, known), positions[v]);
  }
  PositionWeights weights;
  for (int c = 0; c < PositionWeights::kClasses; ++c) {
    weights.own[c] = fit[c].solve(weights.share[c]);
    weights.customized = weights.customized || weights.own[c];
  }
  return weights;
}

std::vector<uint32_t> find_periods(std::span<const Position> positions) {
  constexpr size_t kSample = 4096, kTable = 4096;
  const size_t n = std::min(kSample, positions.size());
  // Steps from vertex to vertex, an axis in 20 bits.
  std::vector<uint64_t> step(n);
  for (size_t v = 1; v < n; ++v) {
    for (size_t axis = 0; axis < 3; ++axis)
      step[v] = step[v] << 20 | static_cast<uint32_t>(positions[v][axis] + 65536 - positions[v - 1][axis]);
  }
  // Distances between occurrences of the same so many steps: rows of equal things that rounding moves repeat sooner
  // than whole rows do, but only these with all that rounding does.
  std::vector<uint32_t> periods;
  for (const size_t context : {size_t{3}, size_t{24}}) {
    if (n <= context || (context > 3 && periods.empty())) break;
    uint32_t best = 0;
    size_t least_missed = n / 2;  // and a quarter of those that nothing can be before
    std::vector<uint32_t> last(kTable, 0), votes(n, 0);
    for (size_t v = context + 1; v < n; ++v) {
      uint64_t hash = 0;
      for (size_t i = 0; i < context; ++i) hash = (hash ^ step[v - i]) * 0x9E3779B97F4A7C15u;
      uint32_t& before = last[hash >> 52];
      if (before != 0) ++votes[v - before];
      before = static_cast<uint32_t>(v);
    }
    for (int round = 0; round < 8; ++round) {
      const auto top = std::max_element(votes.begin(), votes.end());
      if (top == votes.end() || *top == 0) break;
      const auto period = static_cast<uint32_t>(top - votes.begin());
      *top = 0;
      for (const uint32_t candidate : {period, 2 * period, 4 * period}) {
        if (2 * candidate > n) continue;
        size_t missed = candidate / 4;
        for (size_t v = candidate + 1; v < n; ++v) missed += step[v] == step[v - candidate] ? 0 : 1;
        if (missed >= least_missed) continue;
        least_missed = missed;
        best = candidate;
      }
    }
    if (best != 0 && (periods.empty() || best != periods.front())) periods.push_back(best);
  }
  return periods;
}

}  // namespace pac::geomcodec
