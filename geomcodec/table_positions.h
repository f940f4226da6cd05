// Positions coded by tables: parallelograms, shares of the neighbors' mean, lifting, and no other of the predictions of
// position_coder.h. FORMAT.md section 15.
#pragma once

#include <span>
#include <vector>

#include "geomcodec/position_coder.h"
#include "geomcodec/table_coder.h"

namespace pac::geomcodec {

template <class Coder>
class TablePositionCoder {
 public:
  // known: of the vertices before, as long as those that are to be coded; filled on the way.
  TablePositionCoder(Coder& coder, const PositionWeights& weights, int bits, std::vector<KnownPosition>& known)
      : coder_(coder), weights_(weights), bits_(bits), mask_((1 << bits) - 1), half_(1 << (bits - 1)), known_(known) {}

  // Codes position v; those before it are complete. stencil: no twists needed.
  void code(uint32_t v, const Stencil& stencil, Position& position) {
    if (weights_.raw) {
      for (uint16_t& coordinate : position) coordinate = static_cast<uint16_t>(coder_.raw(bits_, coordinate));
      return;
    }
    Prediction prediction;
    predict(v, stencil, prediction);
    if (weights_.lifted && stencil.n_parallelograms > 0)
      known_[v].classes = code_lifted(stencil, prediction, position);
    else
      known_[v].classes = code_plain(prediction, position);
    known_[v].at = PackedPosition(position);
  }

 private:
  struct Prediction {
    int32_t at[3] = {0, 0, 0};
    uint32_t context[3];
  };
  void predict(uint32_t v, const Stencil& stencil, Prediction& prediction) const;
  uint32_t code_residuals(auto& coder, const Prediction& prediction, int32_t (&residual)[3]);
  uint32_t code_plain(const Prediction& prediction, Position& position);
  uint32_t code_lifted(const Stencil& stencil, const Prediction& prediction, Position& position);

  Coder& coder_;
  const PositionWeights weights_;
  const int bits_;
  const int32_t mask_, half_;
  std::vector<KnownPosition>& known_;
};

template <class Coder>
[[gnu::always_inline]] inline void TablePositionCoder<Coder>::predict(uint32_t v, const Stencil& stencil,
                                                                      Prediction& prediction) const {
  const KnownPosition* known = known_.data();
  PackedPosition sum;
  uint32_t classes = 0;  // of each role in 10 bits: at most 12 * 17
  for (int i = 0; i < stencil.n_neighbors; ++i) {
    sum += known[stencil.neighbor[i]].at;
    classes += known[stencil.neighbor[i]].classes;
  }
  uint32_t founded = 0;
  if (stencil.n_parallelograms > 0) {
    founded = stencil.extended ? 0 : stencil.n_parallelograms > 1 ? 2 : 1;
    PackedPosition sides, opposites;
    for (int i = 0; i < stencil.n_parallelograms; ++i) {
      const Stencil::Parallelogram& p = stencil.parallelogram[i];
      sides += known[p.side_1].at + known[p.side_2].at;
      opposites += known[p.opposite].at;
    }
    const int64_t share = weights_.share[PositionWeights::class_of(stencil)][0];
    for (size_t axis = 0; axis < 3; ++axis) {
      const int32_t base = scaled_mean(sides.field(axis) - opposites.field(axis), stencil.n_parallelograms, 6);
      const int32_t mean = scaled_mean(sum.field(axis), stencil.n_neighbors, 6);
      prediction.at[axis] = static_cast<int32_t>((int64_t{base} * 128 + (mean - base) * share + 4096) >> 13);
    }
  } else if (stencil.n_neighbors > 0) {
    for (size_t axis = 0; axis < 3; ++axis) prediction.at[axis] = scaled_mean(sum.field(axis), stencil.n_neighbors, 0);
  } else if (v > 0) {
    for (size_t axis = 0; axis < 3; ++axis) prediction.at[axis] = known[v - 1].at.field(axis);
  }
  int n_classes = stencil.n_neighbors;
  if (n_classes == 0 && v > 0) {
    classes = known[v - 1].classes;
    n_classes = 1;
  }
  for (uint32_t role = 0; role < 3; ++role) {
    const auto scale =
        static_cast<uint32_t>(scaled_mean(static_cast<int32_t>(classes >> 10 * role & 1023), n_classes, 1));
    prediction.context[role] = (3 * role + founded) * kPositionScales + scale;
  }
  for (int32_t& coordinate : prediction.at) coordinate = std::clamp(coordinate, 0, mask_);
}

template <class Coder>
[[gnu::always_inline]] inline uint32_t TablePositionCoder<Coder>::code_plain(const Prediction& prediction,
                                                                             Position& position) {
  int32_t residual[3] = {0, 0, 0};
  if constexpr (!Coder::kDecodes)
    for (size_t axis = 0; axis < 3; ++axis)
      residual[axis] = ((position[axis] - prediction.at[axis] + half_) & mask_) - half_;
  HeldCoder<Coder> coder = coder_;
  const uint32_t classes = code_residuals(coder, prediction, residual);
  for (size_t axis = 0; axis < 3; ++axis)
    position[axis] = static_cast<uint16_t>((prediction.at[axis] + residual[axis]) & mask_);
  release(coder_, coder);
  return classes;
}

// Residuals by role. Returns their classes. All symbols are asked for before the first one's details are.
template <class Coder>
[[gnu::always_inline]] inline uint32_t TablePositionCoder<Coder>::code_residuals(auto& coder,
                                                                                 const Prediction& prediction,
                                                                                 int32_t (&residual)[3]) {
  uint32_t symbol[3], classes = 0;
  for (uint32_t role = 0; role < 3; ++role)
    symbol[role] = code_table_class(coder, role, prediction.context[role], residual[role]);
  for (uint32_t role = 0; role < 3; ++role)
    classes |= code_table_details(coder, symbol[role], residual[role]) << 10 * role;
  return classes;
}

// The axis nearest to the normal comes last and follows the other two.
template <class Coder>
uint32_t TablePositionCoder<Coder>::code_lifted(const Stencil& stencil, const Prediction& prediction,
                                                Position& position) {
  const std::array<int64_t, 3> normal = normal_of(stencil, known_, 2);
  size_t order[3];
  order_by_normal(normal, order);
  const auto residual_to = [&](size_t axis, int32_t expected) {
    return ((position[axis] - expected + half_) & mask_) - half_;
  };
  // What the last axis is moved by, once the others are known.
  const auto last_expected = [&] {
    const int32_t expected = prediction.at[order[2]];
    const int64_t of_last = normal[order[2]];
    if (of_last == 0) return expected;
    int64_t sum = 0;
    for (size_t role = 0; role < 2; ++role)
      sum += normal[order[role]] * (position[order[role]] - prediction.at[order[role]]);
    const int64_t follows = of_last < 0 ? round_quotient(sum, -of_last) : round_quotient(-sum, of_last);
    return static_cast<int32_t>(std::clamp<int64_t>(expected + follows, 0, mask_));
  };
  int32_t residual[3] = {0, 0, 0};
  if constexpr (!Coder::kDecodes) {
    for (size_t role = 0; role < 2; ++role) residual[role] = residual_to(order[role], prediction.at[order[role]]);
    residual[2] = residual_to(order[2], last_expected());
  }
  HeldCoder<Coder> coder = coder_;
  const uint32_t classes = code_residuals(coder, prediction, residual);
  for (size_t role = 0; role < 2; ++role)
    position[order[role]] = static_cast<uint16_t>((prediction.at[order[role]] + residual[role]) & mask_);
  position[order[2]] = static_cast<uint16_t>((last_expected() + residual[2]) & mask_);
  release(coder_, coder);
  return classes;
}

// What precedes the positions.
template <class Coder>
void code_table_weights(Coder& coder, PositionWeights& weights) {
  weights.raw = coder.raw(1, weights.raw ? 1 : 0) != 0;
  weights.lifted = coder.raw(1, weights.lifted ? 1 : 0) != 0;
  weights.customized = coder.raw(1, weights.customized ? 1 : 0) != 0;
  for (int c = 0; c < PositionWeights::kClasses && weights.customized; ++c)
    weights.share[c][0] = static_cast<int8_t>(coder.raw(8, static_cast<uint8_t>(weights.share[c][0])));
}

// Like encode_positions() and decode_positions(). expected: what contexts have that no table is told of.
std::vector<uint8_t> encode_positions_by_tables(const Stencils& stencils, std::span<const Position> positions, int bits,
                                                Expected expected);
Result<std::vector<Position>> decode_positions_by_tables(std::span<const uint8_t> bytes, const Stencils& stencils,
                                                         uint32_t n_positions, int bits, Expected expected);

}  // namespace pac::geomcodec
