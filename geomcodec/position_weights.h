// How positions are predicted: what the encoder may turn on per mesh, and the sums that predictions are made of.
// FORMAT.md section 6.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <iterator>
#include <span>
#include <vector>

#include "geomcodec/positions.h"
#include "geomcodec/prediction.h"
#include "geomcodec/stencil.h"

namespace pac::geomcodec {

// How well a position's prediction is founded: the first context of its residual.
enum PositionBasis : uint32_t {
  kPrevious,
  kNeighbors,
  kExtension,
  kOneParallelogram,
  kTwo,
  kMore,
  kRepeated,
  kChosen,
  kBases
};

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
  bool chooses = false;     // with exact: the symbol tells which of them the residuals start from. By version
  uint32_t period = 0;      // vertices repeat those so many before; 0: those of the part before
  bool customized = false;  // some classes have weights of their own
  int8_t share[kClasses][kFeatures] = {};
  bool own[kClasses] = {};

  // Whether any prediction has a share in the twists: else nobody need look for them.
  bool twisted() const {
    return std::any_of(std::begin(share), std::end(share), [](const int8_t(&of)[kFeatures]) { return of[1] != 0; });
  }
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

// A position, or a sum of up to 24 of them, in three fields of 21 bits: axes are added together.
class PackedPosition {
 public:
  PackedPosition() = default;
  explicit PackedPosition(const Position& position)
      : fields_(uint64_t{position[0]} | uint64_t{position[1]} << kBits | uint64_t{position[2]} << 2 * kBits) {}
  int32_t field(size_t axis) const { return static_cast<int32_t>(fields_ >> (kBits * axis) & ((1u << kBits) - 1)); }
  PackedPosition& operator+=(PackedPosition other) {
    fields_ += other.fields_;
    return *this;
  }
  PackedPosition operator+(PackedPosition other) const { return other += *this; }
  // *this (a sum of two positions) less a position, each coordinate clamped to 0..highest (2^bits - 1). Fields start
  // from 2^17, so that none borrows from the next: 2^17 - 65535 .. 2^17 + 131070 fit 21 bits. Without the 2^17 a field
  // has a bit above `highest` if and only if it is outside.
  PackedPosition less_clamped(PackedPosition position, int32_t highest) const {
    constexpr uint64_t kUnits = uint64_t{1} | uint64_t{1} << kBits | uint64_t{1} << 2 * kBits;
    PackedPosition result;
    result.fields_ = (fields_ + (kUnits << 17) - position.fields_) ^ kUnits << 17;
    if ((result.fields_ & ~(kUnits * static_cast<uint64_t>(highest))) == 0) return result;
    Position clamped;
    for (size_t axis = 0; axis < 3; ++axis)
      clamped[axis] = static_cast<uint16_t>(std::clamp(field(axis) - position.field(axis), 0, highest));
    return PackedPosition(clamped);
  }
  bool operator==(const PackedPosition&) const = default;

 private:
  static constexpr int kBits = 21;
  uint64_t fields_ = 0;
};
static_assert(24 * 65535 < 1 << 21 && 2 * Stencil::kMax <= 24);

// What later vertices need of one: one cache line each.
struct KnownPosition {
  PackedPosition at;
  uint32_t classes = 0;  // of its residuals, 10 bits each
};

inline Features features_of(const Stencil& stencil, std::span<const KnownPosition> known) {
  PackedPosition sides, opposites, plus, minus, mean;
  for (int i = 0; i < stencil.n_parallelograms; ++i) {
    const Stencil::Parallelogram& p = stencil.parallelogram[i];
    sides += known[p.side_1].at + known[p.side_2].at;
    opposites += known[p.opposite].at;
  }
  for (int i = 0; i < stencil.n_twists; ++i) {
    const Stencil::Twist& t = stencil.twist[i];
    plus += known[t.plus_1].at + known[t.plus_2].at;
    minus += known[t.minus_1].at + known[t.minus_2].at;
  }
  for (int i = 0; i < stencil.n_neighbors; ++i) mean += known[stencil.neighbor[i]].at;
  Features features;
  for (size_t axis = 0; axis < 3; ++axis) {
    features.base[axis] = scaled_mean(sides.field(axis) - opposites.field(axis), stencil.n_parallelograms, 6);
    features.mean_less_base[axis] = scaled_mean(mean.field(axis), stencil.n_neighbors, 6) - features.base[axis];
    features.twist[axis] = scaled_mean(plus.field(axis) - minus.field(axis), stencil.n_twists, 6);
  }
  return features;
}

// The encoder's choices, for positions in coded order. first: stencils (with twists) of the first vertices, as many as
// the caller has.
PositionWeights fit_weights(const Topology& topology, const Stencils& stencils, std::span<const Stencil> first,
                            std::span<const Position> positions);
// After how many vertices the steps from vertex to vertex repeat, if most of them do: by few steps, then, if that is
// another, by many.
std::vector<uint32_t> find_periods(std::span<const Position> positions);

}  // namespace pac::geomcodec
