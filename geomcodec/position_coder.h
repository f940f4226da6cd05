// One position after the other, for encoder and decoder: prediction, choice among exact candidates, residuals.
// FORMAT.md section 6.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <type_traits>
#include <unordered_map>
#include <utility>
#include <vector>

#include "geomcodec/position_weights.h"
#include "geomcodec/priors.h"
#include "geomcodec/symbol_model.h"

namespace pac::geomcodec {

// (a - d) x (b - d) over the parallelograms: the normal of the surface, as long as the areas are large.
// at_most: of the first so many.
inline std::array<int64_t, 3> normal_of(const Stencil& stencil, std::span<const KnownPosition> known,
                                        int at_most = Stencil::kMax) {
  std::array<int64_t, 3> normal = {0, 0, 0};
  for (int i = 0; i < std::min(stencil.n_parallelograms, at_most); ++i) {
    const Stencil::Parallelogram& p = stencil.parallelogram[i];
    const PackedPosition opposite = known[p.opposite].at, side_1 = known[p.side_1].at, side_2 = known[p.side_2].at;
    int64_t u[3], w[3];
    for (size_t axis = 0; axis < 3; ++axis) {
      u[axis] = int64_t{side_1.field(axis)} - opposite.field(axis);
      w[axis] = int64_t{side_2.field(axis)} - opposite.field(axis);
    }
    normal[0] += u[1] * w[2] - u[2] * w[1];
    normal[1] += u[2] * w[0] - u[0] * w[2];
    normal[2] += u[0] * w[1] - u[1] * w[0];
  }
  return normal;
}

// Axes by how far along them the normal points, the farthest last; by three exchanges, without branches: which axis is
// the farthest is as good as random.
inline void order_by_normal(const std::array<int64_t, 3>& normal, size_t (&order)[3]) {
  uint64_t length[3], axis[3] = {0, 1, 2};
  for (size_t i = 0; i < 3; ++i) length[i] = static_cast<uint64_t>(std::abs(normal[i]));
  const auto swap_if_longer = [&](size_t i, size_t j) {
    const uint64_t mask = uint64_t{0} - static_cast<uint64_t>(length[i] > length[j]);
    const uint64_t lengths = (length[i] ^ length[j]) & mask, axes = (axis[i] ^ axis[j]) & mask;
    length[i] ^= lengths;
    length[j] ^= lengths;
    axis[i] ^= axes;
    axis[j] ^= axes;
  };
  swap_if_longer(0, 1);
  swap_if_longer(1, 2);
  swap_if_longer(0, 1);
  for (size_t i = 0; i < 3; ++i) order[i] = axis[i];
}

// Where a mesh is made of equal parts: parts (seeds of the walk) by their first vertex.
class PositionParts {
 public:
  explicit PositionParts(const Topology& topology) : by_size_(topology.parts_repeat_by_size) {
    uint32_t n_seen = 0;
    for (uint32_t face = 0; face < topology.n_faces(); ++face) {
      const uint32_t first = topology.face_first[face], gate = topology.twin[first];
      const bool seed = gate == kNone || topology.face_at(gate) >= face;
      if (seed && (start_.empty() || start_.back() != n_seen)) start_.push_back(n_seen);
      for (uint32_t corner = first; corner < topology.face_first[face + 1]; ++corner)
        n_seen = std::max(n_seen, topology.corner_vertex[corner] + 1);
    }
    end_ = n_seen;
    find_lags();
  }
  size_t count() const { return start_.size(); }
  // For vertices in ascending order: by how much the number of the one that tells where it is expected is lower; 0 if
  // there is none.
  uint32_t lag(uint32_t vertex) {
    while (part_ + 1 < start_.size() && start_[part_ + 1] <= vertex) ++part_;
    if (vertex >= end_ || (by_size_ && is_first(vertex))) return 0;
    return lag_[part_];
  }
  bool is_first(uint32_t vertex) const { return start_[part_] == vertex; }
  // The vertex that moved as this one did: the one before it, or with parts of a size the first one of its part.
  uint32_t anchor(uint32_t vertex) const { return by_size_ ? start_[part_] : vertex - 1; }

 private:
  // To the part before, or to the last one with as many vertices.
  void find_lags() {
    std::unordered_map<uint32_t, uint32_t> last;  // by size
    for (size_t part = 0; part < start_.size(); ++part) {
      if (!by_size_) {
        lag_.push_back(part == 0 ? 0 : start_[part] - start_[part - 1]);
        continue;
      }
      const uint32_t size = (part + 1 < start_.size() ? start_[part + 1] : end_) - start_[part];
      const auto [before, is_new] = last.try_emplace(size, start_[part]);
      lag_.push_back(is_new ? 0 : start_[part] - before->second);
      before->second = start_[part];
    }
  }

  std::vector<uint32_t> start_, lag_;
  uint32_t end_ = 0;
  size_t part_ = 0;
  bool by_size_;
};

template <class Coder>
class PositionCoder {
 public:
  static constexpr size_t kChoices = 8;  // none of the predictions, the mean, single parallelograms
  struct ChoiceModels {
    SymbolModel choice_by_basis[kBases][kChoices], choice_by_last[kChoices][kChoices];
    explicit ChoiceModels(bool /*trained*/) {
      static constexpr auto kEqual = [] {
        std::array<SymbolModel, kChoices> models;
        for (size_t n = 1; n < kChoices; ++n) models[n] = SymbolModel(static_cast<int>(n) + 1);
        return models;
      }();
      for (auto& models : choice_by_basis) std::copy(kEqual.begin(), kEqual.end(), models);
      for (auto& models : choice_by_last) std::copy(kEqual.begin(), kEqual.end(), models);
    }
  };
  struct AllModels : ChoiceModels {
    ClassModels<kClasses + 1> classes[3][kBases];
    DetailModel details[3];
    explicit AllModels(bool trained) : ChoiceModels(trained) {
      for (auto& role : classes)
        for (size_t basis = 0; trained && basis < kBases; ++basis)
          role[basis].start_from(kPriorModels[kPriorPositions + kPriorOfPositionBasis[basis]]);
      if (trained) std::fill_n(details, 3, kPriorDetails[kDetailsOfPositions]);
    }
  };
  // Estimates need no models of residuals.
  using Models = std::conditional_t<Coder::kEstimates, ChoiceModels, AllModels>;

  PositionCoder(const Topology& topology, const Stencils& stencils, Coder& coder, const PositionWeights& weights,
                int bits, bool trained)
      : PositionCoder(PositionParts(topology), stencils, coder, weights, bits, trained) {}
  // parts: the topology's, from their beginning.
  PositionCoder(PositionParts parts, const Stencils& stencils, Coder& coder, const PositionWeights& weights, int bits,
                bool trained)
      : stencils_(stencils),
        parts_(std::move(parts)),
        coder_(coder),
        weights_(weights),
        twisted_(weights.twisted()),
        bits_(bits),
        mask_((1 << bits) - 1),
        half_(1 << (bits - 1)),
        models_(std::make_unique<Models>(trained)) {}

  const Models& models() const { return *models_; }

  // Codes position v; those before it are complete.
  void code(uint32_t v, std::span<Position> positions) {
    if (weights_.raw) return code_raw(positions[v]);
    stencils_.get(v, twisted_, stencil_);
    code(v, stencil_, positions);
  }
  // Passes the next vertex over: what follows takes it for predicted as well as the last one. For an encoder that
  // samples.
  void skip(const Position& position) {
    known_.push_back({PackedPosition(position), known_.empty() ? 0 : known_.back().classes});
  }
  // The same where the caller has the stencil (with twists, if weights have shares of them) already; not for raw
  // positions.
  void code(uint32_t v, const Stencil& stencil, std::span<Position> positions);

 private:
  struct Prediction {
    int32_t at[3] = {0, 0, 0};
    size_t order[3] = {0, 1, 2};
    int64_t normal[3] = {0, 0, 0};  // in that order; the last one 0: no lifting
    uint32_t spread = 0;            // class of what the neighbors' mean and the parallelograms disagree by
    PositionBasis basis = kPrevious;
  };
  void code_raw(Position& position) {
    for (uint16_t& coordinate : position) coordinate = static_cast<uint16_t>(coder_.raw(bits_, coordinate));
  }
  Prediction predict(uint32_t v, const Stencil& stencil) const;
  void lift(const Stencil& stencil, Prediction& prediction) const;
  void get_scales(uint32_t v, const Stencil& stencil, uint32_t (&scale)[3]) const;
  // What residuals may start from: at[1] is the prediction, at[2 .. n - 1] are others.
  struct Candidates {
    PackedPosition at[kChoices + 1];  // one more is written before it is dropped
    size_t n = 1;
    void add(PackedPosition position) {
      at[n] = position;
      bool is_new = n < kChoices;
      for (size_t i = 1; i < n; ++i) is_new = is_new & (at[i] != position);
      n += is_new ? 1 : 0;
    }
  };
  Candidates candidates_for(const Stencil& stencil, const Prediction& prediction) const;
  bool code_choice(const Stencil& stencil, const Prediction& prediction, std::span<Position> positions, uint32_t v);
  void code_start(const Stencil& stencil, const Position& position, Prediction& prediction);
  uint32_t cheapest(const Candidates& candidates, const Starts& starts, const uint32_t (&scale)[3],
                    Prediction prediction, const Position& position) const;
  int32_t expected_of(const Prediction& prediction, size_t role, const int64_t (&missed)[3]) const;
  void code_residuals(uint32_t v, const Stencil& stencil, const Prediction& prediction, Position& position);
  void code_position(uint32_t v, const Stencil& stencil, Prediction& prediction, std::span<Position> positions) {
    if (weights_.exact && weights_.chooses) {
      code_start(stencil, positions[v], prediction);
      code_residuals(v, stencil, prediction, positions[v]);
    } else if (!weights_.exact || !code_choice(stencil, prediction, positions, v)) {
      code_residuals(v, stencil, prediction, positions[v]);
    }
  }
  static int32_t cost(const Position& position, const int32_t (&prediction)[3]) {
    uint32_t sum = 0;
    for (size_t axis = 0; axis < 3; ++axis) sum += class_of(position[axis] - prediction[axis]);
    return static_cast<int32_t>(sum);
  }

  const Stencils& stencils_;
  PositionParts parts_;
  Coder& coder_;
  const PositionWeights weights_;
  const bool twisted_;
  const int bits_;
  const int32_t mask_, half_;
  std::unique_ptr<Models> models_;
  std::vector<KnownPosition> known_;  // the vertices before; the one being coded has its classes first
  Stencil stencil_;
  int32_t error_[2][2] = {};  // [first of a part][by the part before]: recent costs
  uint32_t last_choice_ = 0;
};

template <class Coder>
typename PositionCoder<Coder>::Prediction PositionCoder<Coder>::predict(uint32_t v, const Stencil& stencil) const {
  Prediction prediction;
  prediction.basis = basis_of(stencil);
  if (stencil.n_parallelograms > 0) {
    const Features features = features_of(stencil, known_);
    const auto& share = weights_.share[PositionWeights::class_of(stencil)];
    int32_t spread = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const int64_t corrected = int64_t{features.base[axis]} * 128 + int64_t{features.mean_less_base[axis]} * share[0] +
                                int64_t{features.twist[axis]} * share[1];
      prediction.at[axis] = static_cast<int32_t>((corrected + 4096) >> 13);
      spread = std::max(spread, std::abs(features.mean_less_base[axis]));
    }
    prediction.spread = std::min(class_of(spread >> 6), kClasses);
    if (weights_.lifted) lift(stencil, prediction);
  } else if (stencil.n_neighbors > 0) {
    PackedPosition sum;
    for (int i = 0; i < stencil.n_neighbors; ++i) sum += known_[stencil.neighbor[i]].at;
    for (size_t axis = 0; axis < 3; ++axis) prediction.at[axis] = scaled_mean(sum.field(axis), stencil.n_neighbors, 0);
  } else if (v > 0) {
    for (size_t axis = 0; axis < 3; ++axis) prediction.at[axis] = known_[v - 1].at.field(axis);
  }
  for (int32_t& coordinate : prediction.at) coordinate = std::clamp(coordinate, 0, mask_);
  return prediction;
}

// The axis nearest to the normal last.
template <class Coder>
void PositionCoder<Coder>::lift(const Stencil& stencil, Prediction& prediction) const {
  const std::array<int64_t, 3> normal = normal_of(stencil, known_);
  order_by_normal(normal, prediction.order);
  for (size_t i = 0; i < 3; ++i) prediction.normal[i] = normal[prediction.order[i]];
}

// The neighbors' mean classes in halves; without neighbors those of the vertex before.
template <class Coder>
void PositionCoder<Coder>::get_scales(uint32_t v, const Stencil& stencil, uint32_t (&scale)[3]) const {
  uint32_t sum = 0;  // of each role in 10 bits: at most 12 * 17
  for (int i = 0; i < stencil.n_neighbors; ++i) sum += known_[stencil.neighbor[i]].classes;
  const bool alone = stencil.n_neighbors == 0;
  if (alone && v > 0) sum = known_[v - 1].classes;
  for (int role = 0; role < 3; ++role)
    scale[role] = static_cast<uint32_t>(
        scaled_mean(static_cast<int32_t>(sum >> 10 * role & 1023), alone ? 1 : stencil.n_neighbors, 1));
}

// Where the coordinate of one role is expected, those of the roles before having missed the prediction by `missed`.
template <class Coder>
inline int32_t PositionCoder<Coder>::expected_of(const Prediction& prediction, size_t role,
                                                 const int64_t (&missed)[3]) const {
  const int32_t expected = prediction.at[prediction.order[role]];
  if (role != 2 || prediction.normal[2] == 0) return expected;
  const int64_t sign = prediction.normal[2] < 0 ? -1 : 1;
  const int64_t follows = round_quotient(-sign * (prediction.normal[0] * missed[0] + prediction.normal[1] * missed[1]),
                                         sign * prediction.normal[2]);
  return static_cast<int32_t>(std::clamp<int64_t>(expected + follows, 0, mask_));
}

template <class Coder>
void PositionCoder<Coder>::code_residuals(uint32_t v, const Stencil& stencil, const Prediction& prediction,
                                          Position& position) {
  uint32_t other = prediction.spread;
  uint32_t scale[3];
  get_scales(v, stencil, scale);
  int64_t missed[3] = {0, 0, 0};
  uint32_t classes_coded = 0;
  HeldCoder<Coder> coder = coder_;
  for (size_t role = 0; role < 3; ++role) {
    const size_t axis = prediction.order[role];
    const int32_t expected = expected_of(prediction, role, missed);
    int32_t residual = 0;
    if constexpr (!Coder::kDecodes) residual = ((position[axis] - expected + half_) & mask_) - half_;
    if constexpr (Coder::kEstimates) {
      coder.residual(role, scale[role], residual);
    } else {
      auto& classes = models_->classes[role][prediction.basis];
      residual = code_residual(coder, classes.by_scale[scale[role]], classes.by_other[other], models_->details[role],
                               residual);
    }
    position[axis] = static_cast<uint16_t>((expected + residual) & mask_);
    missed[role] = position[axis] - prediction.at[axis];
    const uint32_t its_class = class_of(residual);
    classes_coded |= its_class << 10 * role;
    other = role == 0 ? its_class : std::max(other, its_class);
  }
  known_[v].classes = classes_coded;
  release(coder_, coder);
}

// The prediction, each parallelogram's position, and where residuals choose, the first one's sides continued: where
// triangles cut a grid, one of them is often right and their mean is not.
template <class Coder>
inline typename PositionCoder<Coder>::Candidates PositionCoder<Coder>::candidates_for(
    const Stencil& stencil, const Prediction& prediction) const {
  Candidates candidates;
  Position predicted;  // clamped already
  for (size_t axis = 0; axis < 3; ++axis) predicted[axis] = static_cast<uint16_t>(prediction.at[axis]);
  candidates.add(PackedPosition(predicted));
  for (int i = 0; i < stencil.n_parallelograms; ++i) {
    const Stencil::Parallelogram& p = stencil.parallelogram[i];
    candidates.add((known_[p.side_1].at + known_[p.side_2].at).less_clamped(known_[p.opposite].at, mask_));
  }
  if (!weights_.chooses || stencil.n_parallelograms == 0) return candidates;
  const Stencil::Parallelogram& p = stencil.parallelogram[0];
  for (const uint32_t side : {p.side_1, p.side_2})
    candidates.add((known_[side].at + known_[side].at).less_clamped(known_[p.opposite].at, mask_));
  return candidates;
}

// Whether the position is the prediction or one parallelogram's, exactly: parts with flat sides are full of them.
template <class Coder>
bool PositionCoder<Coder>::code_choice(const Stencil& stencil, const Prediction& prediction,
                                       std::span<Position> positions, uint32_t v) {
  const Candidates candidates = candidates_for(stencil, prediction);
  const size_t n = candidates.n;
  uint32_t choice = 0;
  if constexpr (!Coder::kDecodes) {
    const auto found = std::find(candidates.at + 1, candidates.at + n, PackedPosition(positions[v]));
    choice = found == candidates.at + n ? 0 : static_cast<uint32_t>(found - candidates.at);
  }
  choice = code_symbol(coder_, models_->choice_by_basis[prediction.basis][n - 1],
                       models_->choice_by_last[last_choice_][n - 1], choice);
  last_choice_ = std::min<uint32_t>(choice, kChoices - 1);
  if (choice == 0 || choice >= n) return false;
  for (size_t axis = 0; axis < 3; ++axis) positions[v][axis] = static_cast<uint16_t>(candidates.at[choice].field(axis));
  return true;
}

// Which candidate the residuals start from, which then takes the prediction's place.
template <class Coder>
void PositionCoder<Coder>::code_start(const Stencil& stencil, const Position& position, Prediction& prediction) {
  const Candidates candidates = candidates_for(stencil, prediction);
  const size_t n = candidates.n;
  if (n <= 2) return;  // the prediction alone
  SymbolModel& by_basis = models_->choice_by_basis[prediction.basis][n - 1];
  SymbolModel& by_last = models_->choice_by_last[last_choice_][n - 1];
  uint32_t choice = 1;
  if constexpr (!Coder::kDecodes) {
    uint32_t scale[3];
    get_scales(static_cast<uint32_t>(known_.size() - 1), stencil, scale);
    choice = cheapest(candidates, starts_of(by_basis, by_last), scale, prediction, position);
  }
  choice = code_symbol(coder_, by_basis, by_last, choice);
  if (choice == 0 || choice >= n) choice = 1;
  last_choice_ = choice;
  if (choice == 1) return;
  prediction.basis = kChosen;
  for (size_t axis = 0; axis < 3; ++axis) prediction.at[axis] = candidates.at[choice].field(axis);
}

// The encoder's choice: the fewest bits by estimate, twice the logarithms of the residuals beside a quarter of what the
// neighbors' classes let expect, and the symbol.
template <class Coder>
uint32_t PositionCoder<Coder>::cheapest(const Candidates& candidates, const Starts& starts, const uint32_t (&scale)[3],
                                        Prediction prediction, const Position& position) const {
  // log2 in 1/256, x > 0, by chords.
  const auto logarithm = [](uint32_t x) {
    const uint32_t whole = static_cast<uint32_t>(std::bit_width(x)) - 1;
    return static_cast<int32_t>(whole * 256 + (x - (1u << whole)) * 256 / (1u << whole));
  };
  uint32_t best = 1;
  int32_t best_cost = 0;
  for (uint32_t choice = 1; choice < candidates.n; ++choice) {
    for (size_t axis = 0; axis < 3; ++axis) prediction.at[axis] = candidates.at[choice].field(axis);
    int64_t missed[3] = {0, 0, 0};
    int32_t sum = 0;
    for (size_t role = 0; role < 3; ++role) {
      const size_t axis = prediction.order[role];
      const int32_t residual = ((position[axis] - expected_of(prediction, role, missed) + half_) & mask_) - half_;
      missed[role] = position[axis] - prediction.at[axis];
      const uint32_t usual = (1u << scale[role] / 2) >> 2;
      sum += logarithm(static_cast<uint32_t>(std::abs(residual)) + 1 + usual) * 2;
    }
    const int32_t cost = sum - logarithm(uint32_t{starts.at[choice + 1]} - starts.at[choice]);
    if (choice > 1 && cost >= best_cost) continue;
    best = choice;
    best_cost = cost;
  }
  return best;
}

template <class Coder>
void PositionCoder<Coder>::code(uint32_t v, const Stencil& stencil, std::span<Position> positions) {
  known_.emplace_back();
  Prediction prediction = predict(v, stencil);
  const uint32_t lag = weights_.period != 0 ? weights_.period : parts_.lag(v);
  if (lag == 0 || lag >= v) {
    code_position(v, stencil, prediction, positions);
    known_[v].at = PackedPosition(positions[v]);
    return;
  }

  // v moved from the anchor as their counterparts did.
  const uint32_t anchor = weights_.period != 0 ? v - 1 : parts_.anchor(v);
  Prediction repeated;
  repeated.basis = kRepeated;
  for (size_t axis = 0; axis < 3; ++axis)
    repeated.at[axis] =
        std::clamp(positions[anchor][axis] + positions[v - lag][axis] - positions[anchor - lag][axis], 0, mask_);
  int32_t(&error)[2] = error_[weights_.period == 0 && parts_.is_first(v) ? 1 : 0];
  Prediction used = error[1] < error[0] ? repeated : prediction;
  code_position(v, stencil, used, positions);
  known_[v].at = PackedPosition(positions[v]);
  error[0] += (64 * cost(positions[v], prediction.at) - error[0]) >> 3;
  error[1] += (64 * cost(positions[v], repeated.at) - error[1]) >> 3;
}

}  // namespace pac::geomcodec
