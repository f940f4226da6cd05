// How positions are predicted: what the encoder may turn on per mesh, and the sums that predictions are made of.
// FORMAT.md section 6.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "geomcodec/positions.h"
#include "geomcodec/prediction.h"
#include "geomcodec/stencil.h"

namespace pac::geomcodec {

// How well a position's prediction is founded: the first context of its residual.
enum PositionBasis : uint32_t { kPrevious, kNeighbors, kExtension, kOneParallelogram, kTwo, kMore, kRepeated, kBases };

inline PositionBasis basis_of(const Stencil& stencil) {
  if (stencil.extended) return kExtension;
  if (stencil.n_parallelograms > 0)
    return static_cast<PositionBasis>(kOneParallelogram + static_cast<uint32_t>(std::min(stencil.n_parallelograms, 3)) -
                                      1);
  return stencil.n_neighbors > 0 ? kNeighbors : kPrevious;
}

// Corrections of the parallelogram's prediction: for each class of vertex the shares, in 1/128, of the neighbors' mean
// and of the twist beside it.
struct PositionWeights {
  static constexpr int kClasses = 16;
  static constexpr int kFeatures = 2;
  bool raw = false;         // no predictions, no other fields: all bits of all coordinates as they are
  bool lifted = false;      // the axis nearest to the surface normal comes last and follows the other two
  bool exact = false;       // first a symbol: which of the predictions is the position itself
  uint32_t period = 0;      // vertices repeat those so many before; 0: those of the part before
  bool customized = false;  // some classes have weights of their own
  int8_t share[kClasses][kFeatures] = {};
  bool own[kClasses] = {};

  static size_t class_of(const Stencil& stencil) {
    const int kind = stencil.extended ? 0 : std::min(stencil.n_parallelograms, 3);
    return static_cast<size_t>(kind * 4 + std::clamp(stencil.n_corners - 4, 0, 3));
  }
};

template <class Coder>
void code_weights(Coder& coder, PositionWeights& weights) {
  weights.raw = coder.raw(1, weights.raw ? 1 : 0) != 0;
  if (weights.raw) return;
  weights.lifted = coder.raw(1, weights.lifted ? 1 : 0) != 0;
  weights.exact = coder.raw(1, weights.exact ? 1 : 0) != 0;
  if (coder.raw(1, weights.period != 0 ? 1 : 0) != 0) weights.period = coder.raw(16, weights.period);
  weights.customized = coder.raw(1, weights.customized ? 1 : 0) != 0;
  if (!weights.customized) return;
  for (int c = 0; c < PositionWeights::kClasses; ++c) {
    weights.own[c] = coder.raw(1, weights.own[c] ? 1 : 0) != 0;
    if (!weights.own[c]) continue;
    for (int8_t& share : weights.share[c]) share = static_cast<int8_t>(coder.raw(8, static_cast<uint8_t>(share)));
  }
}

// What code_weights() takes.
inline uint64_t weights_bits(const PositionWeights& weights) {
  if (weights.raw) return 1;
  const uint64_t n_own = static_cast<uint64_t>(std::count(weights.own, weights.own + PositionWeights::kClasses, true));
  return 5 + (weights.period != 0 ? 16 : 0) + (weights.customized ? PositionWeights::kClasses + 16 * n_own : 0);
}

// What a vertex is predicted from, per axis, in 1/64 of a step.
struct Features {
  int32_t base[3], mean_less_base[3], twist[3];
};

inline Features features_of(const Stencil& stencil, std::span<const Position> known) {
  int32_t base[3] = {}, twist[3] = {}, mean[3] = {};
  for (int i = 0; i < stencil.n_parallelograms; ++i) {
    const Stencil::Parallelogram& p = stencil.parallelogram[i];
    const Position &one = known[p.side_1], &two = known[p.side_2], &opposite = known[p.opposite];
    for (size_t axis = 0; axis < 3; ++axis) base[axis] += one[axis] + two[axis] - opposite[axis];
  }
  for (int i = 0; i < stencil.n_twists; ++i) {
    const Stencil::Twist& t = stencil.twist[i];
    const Position &p = known[t.plus_1], &q = known[t.plus_2], &m = known[t.minus_1], &n = known[t.minus_2];
    for (size_t axis = 0; axis < 3; ++axis) twist[axis] += p[axis] + q[axis] - m[axis] - n[axis];
  }
  for (int i = 0; i < stencil.n_neighbors; ++i)
    for (size_t axis = 0; axis < 3; ++axis) mean[axis] += known[stencil.neighbor[i]][axis];
  Features features;
  for (size_t axis = 0; axis < 3; ++axis) {
    features.base[axis] = scaled_mean(base[axis], stencil.n_parallelograms, 6);
    features.mean_less_base[axis] = scaled_mean(mean[axis], stencil.n_neighbors, 6) - features.base[axis];
    features.twist[axis] = scaled_mean(twist[axis], stencil.n_twists, 6);
  }
  return features;
}

// The encoder's choices, for positions in coded order.
PositionWeights fit_weights(const Topology& topology, const Stencils& stencils, std::span<const Position> positions);
// After how many vertices the steps from vertex to vertex repeat, if most of them do; else 0.
uint32_t find_period(std::span<const Position> positions);

}  // namespace pac::geomcodec
