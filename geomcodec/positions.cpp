#include "geomcodec/positions.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>

#include "geomcodec/prediction.h"
#include "geomcodec/stencil.h"
#include "geomcodec/symbol_model.h"

namespace pac::geomcodec {
namespace {

// How well a prediction is founded: the first context of its residual.
enum Basis : uint32_t { kPrevious, kNeighbors, kExtension, kOneParallelogram, kTwo, kMore, kRepeated, kBases };

Basis basis_of(const Stencil& stencil) {
  if (stencil.extended) return kExtension;
  if (stencil.n_parallelograms > 0)
    return static_cast<Basis>(kOneParallelogram + static_cast<uint32_t>(std::min(stencil.n_parallelograms, 3)) - 1);
  return stencil.n_neighbors > 0 ? kNeighbors : kPrevious;
}

// Corrections of the parallelogram's prediction: for each class of vertex the shares, in 1/128, of the neighbors' mean
// and of the twist beside it.
struct Weights {
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
void code_weights(Coder& coder, Weights& weights) {
  weights.raw = coder.raw(1, weights.raw ? 1 : 0) != 0;
  if (weights.raw) return;
  weights.lifted = coder.raw(1, weights.lifted ? 1 : 0) != 0;
  weights.exact = coder.raw(1, weights.exact ? 1 : 0) != 0;
  if (coder.raw(1, weights.period != 0 ? 1 : 0) != 0) weights.period = coder.raw(16, weights.period);
  weights.customized = coder.raw(1, weights.customized ? 1 : 0) != 0;
  if (!weights.customized) return;
  for (int c = 0; c < Weights::kClasses; ++c) {
    weights.own[c] = coder.raw(1, weights.own[c] ? 1 : 0) != 0;
    if (!weights.own[c]) continue;
    for (int8_t& share : weights.share[c]) share = static_cast<int8_t>(coder.raw(8, static_cast<uint8_t>(share)));
  }
}

// What a vertex is predicted from, per axis, in 1/64 of a step.
struct Features {
  int32_t base[3], mean_less_base[3], twist[3];
};

Features features_of(const Stencil& stencil, std::span<const Position> known) {
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

// (a - d) x (b - d) over the parallelograms: the normal of the surface, as long as the areas are large.
std::array<int64_t, 3> normal_of(const Stencil& stencil, std::span<const Position> known) {
  std::array<int64_t, 3> normal = {0, 0, 0};
  for (int i = 0; i < stencil.n_parallelograms; ++i) {
    const Stencil::Parallelogram& p = stencil.parallelogram[i];
    int64_t u[3], w[3];
    for (size_t axis = 0; axis < 3; ++axis) {
      u[axis] = int64_t{known[p.side_1][axis]} - known[p.opposite][axis];
      w[axis] = int64_t{known[p.side_2][axis]} - known[p.opposite][axis];
    }
    normal[0] += u[1] * w[2] - u[2] * w[1];
    normal[1] += u[2] * w[0] - u[0] * w[2];
    normal[2] += u[0] * w[1] - u[1] * w[0];
  }
  return normal;
}

// Where a mesh is made of equal parts: parts (seeds of the walk) by their first vertex.
class Parts {
 public:
  explicit Parts(const Topology& topology) {
    uint32_t n_seen = 0;
    for (uint32_t face = 0; face < topology.n_faces(); ++face) {
      const uint32_t first = topology.face_first[face], gate = topology.twin[first];
      const bool seed = gate == kNone || topology.corner_face[gate] >= face;
      if (seed && (start_.empty() || start_.back() != n_seen)) start_.push_back(n_seen);
      for (uint32_t corner = first; corner < topology.face_first[face + 1]; ++corner)
        n_seen = std::max(n_seen, topology.corner_vertex[corner] + 1);
    }
    end_ = n_seen;
  }
  // For vertices in ascending order: how many vertices the part before had, 0 if there is none.
  uint32_t lag(uint32_t vertex) {
    while (part_ + 1 < start_.size() && start_[part_ + 1] <= vertex) ++part_;
    return part_ == 0 || vertex >= end_ ? 0 : start_[part_] - start_[part_ - 1];
  }
  bool is_first(uint32_t vertex) const { return start_[part_] == vertex; }

 private:
  std::vector<uint32_t> start_;
  uint32_t end_ = 0;
  size_t part_ = 0;
};

template <class Coder>
class PositionCoder {
 public:
  PositionCoder(const Topology& topology, const Stencils& stencils, Coder& coder, const Weights& weights, int bits)
      : stencils_(stencils),
        parts_(topology),
        coder_(coder),
        weights_(weights),
        bits_(bits),
        mask_((1 << bits) - 1),
        half_(1 << (bits - 1)),
        models_(std::make_unique<Models>()) {}

  // Codes position v; those before it are complete.
  void code(uint32_t v, std::span<Position> positions);

 private:
  static constexpr size_t kChoices = 8;  // none of the predictions, the mean, single parallelograms
  struct Models {
    ClassModels<kClasses + 1> classes[3][kBases];
    DetailModel details[3];
    SymbolModel choice_by_basis[kBases][kChoices], choice_by_last[kChoices][kChoices];
    Models() {
      for (auto& models : choice_by_basis)
        for (size_t n = 1; n < kChoices; ++n) models[n] = SymbolModel(static_cast<int>(n) + 1);
      for (auto& models : choice_by_last)
        for (size_t n = 1; n < kChoices; ++n) models[n] = SymbolModel(static_cast<int>(n) + 1);
    }
  };
  struct Prediction {
    int32_t at[3] = {0, 0, 0};
    int order[3] = {0, 1, 2};
    int64_t normal[3] = {0, 0, 0};  // in that order; the last one 0: no lifting
    uint32_t spread = 0;            // class of what the neighbors' mean and the parallelograms disagree by
    Basis basis = kPrevious;
  };
  Prediction predict(uint32_t v, const Stencil& stencil, std::span<const Position> known) const;
  void lift(const Stencil& stencil, std::span<const Position> known, Prediction& prediction) const;
  void get_scales(uint32_t v, const Stencil& stencil, uint32_t (&scale)[3]) const;
  bool code_choice(const Stencil& stencil, const Prediction& prediction, std::span<Position> positions, uint32_t v);
  void code_residuals(uint32_t v, const Stencil& stencil, const Prediction& prediction, Position& position);
  void code_position(uint32_t v, const Stencil& stencil, const Prediction& prediction, std::span<Position> positions) {
    if (!weights_.exact || !code_choice(stencil, prediction, positions, v))
      code_residuals(v, stencil, prediction, positions[v]);
  }
  static int32_t cost(const Position& position, const int32_t (&prediction)[3]) {
    uint32_t sum = 0;
    for (size_t axis = 0; axis < 3; ++axis) sum += class_of(position[axis] - prediction[axis]);
    return static_cast<int32_t>(sum);
  }

  const Stencils& stencils_;
  Parts parts_;
  Coder& coder_;
  const Weights weights_;
  const int bits_;
  const int32_t mask_, half_;
  std::unique_ptr<Models> models_;
  std::vector<uint32_t> memory_;  // per vertex: classes of its residuals, 10 bits each
  Stencil stencil_;
  int32_t error_[2][2] = {};  // [first of a part][by the part before]: recent costs
  uint32_t last_choice_ = 0;
};

template <class Coder>
typename PositionCoder<Coder>::Prediction PositionCoder<Coder>::predict(uint32_t v, const Stencil& stencil,
                                                                        std::span<const Position> known) const {
  Prediction prediction;
  prediction.basis = basis_of(stencil);
  if (stencil.n_parallelograms > 0) {
    const Features features = features_of(stencil, known);
    const auto& share = weights_.share[Weights::class_of(stencil)];
    int32_t spread = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const int64_t corrected = int64_t{features.base[axis]} * 128 + int64_t{features.mean_less_base[axis]} * share[0] +
                                int64_t{features.twist[axis]} * share[1];
      prediction.at[axis] = static_cast<int32_t>((corrected + 4096) >> 13);
      spread = std::max(spread, std::abs(features.mean_less_base[axis]));
    }
    prediction.spread = std::min(class_of(spread >> 6), kClasses);
    if (weights_.lifted) lift(stencil, known, prediction);
  } else if (stencil.n_neighbors > 0) {
    for (size_t axis = 0; axis < 3; ++axis)
      prediction.at[axis] = scaled_mean(
          neighbor_sum(stencil, [&](uint32_t vertex) { return int32_t{known[vertex][axis]}; }), stencil.n_neighbors, 0);
  } else if (v > 0) {
    std::copy_n(known[v - 1].begin(), 3, prediction.at);
  }
  for (int32_t& coordinate : prediction.at) coordinate = std::clamp(coordinate, 0, mask_);
  return prediction;
}

// The axis nearest to the normal last.
template <class Coder>
void PositionCoder<Coder>::lift(const Stencil& stencil, std::span<const Position> known, Prediction& prediction) const {
  const std::array<int64_t, 3> normal = normal_of(stencil, known);
  int* order = prediction.order;
  const auto swap_if_longer = [&](int i, int j) {
    if (std::abs(normal[static_cast<size_t>(order[i])]) > std::abs(normal[static_cast<size_t>(order[j])]))
      std::swap(order[i], order[j]);
  };
  swap_if_longer(0, 1);
  swap_if_longer(1, 2);
  swap_if_longer(0, 1);
  for (int i = 0; i < 3; ++i) prediction.normal[i] = normal[static_cast<size_t>(order[i])];
}

// The neighbors' mean classes in halves; without neighbors those of the vertex before.
template <class Coder>
void PositionCoder<Coder>::get_scales(uint32_t v, const Stencil& stencil, uint32_t (&scale)[3]) const {
  uint32_t sum = 0;  // of each role in 10 bits: at most 12 * 17
  for (int i = 0; i < stencil.n_neighbors; ++i) sum += memory_[stencil.neighbor[i]];
  const bool alone = stencil.n_neighbors == 0;
  if (alone && v > 0) sum = memory_[v - 1];
  for (int role = 0; role < 3; ++role)
    scale[role] = static_cast<uint32_t>(
        scaled_mean(static_cast<int32_t>(sum >> 10 * role & 1023), alone ? 1 : stencil.n_neighbors, 1));
}

template <class Coder>
void PositionCoder<Coder>::code_residuals(uint32_t v, const Stencil& stencil, const Prediction& prediction,
                                          Position& position) {
  uint32_t other = prediction.spread;
  uint32_t scale[3];
  get_scales(v, stencil, scale);
  int64_t missed[3] = {0, 0, 0};
  for (size_t role = 0; role < 3; ++role) {
    const auto axis = static_cast<size_t>(prediction.order[role]);
    int32_t expected = prediction.at[axis];
    if (role == 2 && prediction.normal[2] != 0) {
      const int64_t sign = prediction.normal[2] < 0 ? -1 : 1;
      const int64_t follows = round_quotient(
          -sign * (prediction.normal[0] * missed[0] + prediction.normal[1] * missed[1]), sign * prediction.normal[2]);
      expected = static_cast<int32_t>(std::clamp<int64_t>(expected + follows, 0, mask_));
    }
    int32_t residual = 0;
    if constexpr (!Coder::kDecodes) residual = ((position[axis] - expected + half_) & mask_) - half_;
    auto& classes = models_->classes[role][prediction.basis];
    residual =
        code_residual(coder_, classes.by_scale[scale[role]], classes.by_other[other], models_->details[role], residual);
    position[axis] = static_cast<uint16_t>((expected + residual) & mask_);
    missed[role] = position[axis] - prediction.at[axis];
    const uint32_t its_class = class_of(residual);
    memory_[v] |= its_class << 10 * role;
    other = role == 0 ? its_class : std::max(other, its_class);
  }
}

// Whether the position is the prediction or one parallelogram's, exactly: parts with flat sides are full of them.
template <class Coder>
bool PositionCoder<Coder>::code_choice(const Stencil& stencil, const Prediction& prediction,
                                       std::span<Position> positions, uint32_t v) {
  Position candidate[kChoices];
  size_t n = 1;  // candidate[1 .. n - 1]
  const auto add = [&](const int32_t(&at)[3]) {
    Position position;
    for (size_t axis = 0; axis < 3; ++axis) position[axis] = static_cast<uint16_t>(std::clamp(at[axis], 0, mask_));
    if (n < kChoices && std::find(candidate + 1, candidate + n, position) == candidate + n) candidate[n++] = position;
  };
  add(prediction.at);
  for (int i = 0; i < stencil.n_parallelograms; ++i) {
    const Stencil::Parallelogram& p = stencil.parallelogram[i];
    int32_t at[3];
    for (size_t axis = 0; axis < 3; ++axis)
      at[axis] = positions[p.side_1][axis] + positions[p.side_2][axis] - positions[p.opposite][axis];
    add(at);
  }
  uint32_t choice = 0;
  if constexpr (!Coder::kDecodes) {
    const auto found = std::find(candidate + 1, candidate + n, positions[v]);
    choice = found == candidate + n ? 0 : static_cast<uint32_t>(found - candidate);
  }
  choice = code_symbol(coder_, models_->choice_by_basis[prediction.basis][n - 1],
                       models_->choice_by_last[last_choice_][n - 1], choice);
  last_choice_ = std::min<uint32_t>(choice, kChoices - 1);
  if (choice == 0 || choice >= n) return false;
  positions[v] = candidate[choice];
  return true;
}

template <class Coder>
void PositionCoder<Coder>::code(uint32_t v, std::span<Position> positions) {
  if (weights_.raw) {
    for (uint16_t& coordinate : positions[v]) coordinate = static_cast<uint16_t>(coder_.raw(bits_, coordinate));
    return;
  }
  stencils_.get(v, true, stencil_);
  const Stencil& stencil = stencil_;
  memory_.push_back(0);
  Prediction prediction = predict(v, stencil, positions);
  const uint32_t lag = weights_.period != 0 ? weights_.period : parts_.lag(v);
  if (lag == 0 || lag >= v) return code_position(v, stencil, prediction, positions);

  // v moved from the vertex before as their counterparts in the part before did.
  Prediction repeated;
  repeated.basis = kRepeated;
  for (size_t axis = 0; axis < 3; ++axis)
    repeated.at[axis] =
        std::clamp(positions[v - 1][axis] + positions[v - lag][axis] - positions[v - lag - 1][axis], 0, mask_);
  int32_t(&error)[2] = error_[weights_.period == 0 && parts_.is_first(v) ? 1 : 0];
  code_position(v, stencil, error[1] < error[0] ? repeated : prediction, positions);
  error[0] += (64 * cost(positions[v], prediction.at) - error[0]) >> 3;
  error[1] += (64 * cost(positions[v], repeated.at) - error[1]) >> 3;
}

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

Weights fit_weights(const Topology& topology, const Stencils& stencils, std::span<const Position> positions) {
  Fit fit[Weights::kClasses];
  Stencil stencil;
  for (uint32_t v = 0; v < topology.n_vertices; ++v) {
    stencils.get(v, true, stencil);
    if (stencil.n_parallelograms > 0)
      fit[Weights::class_of(stencil)].add(features_of(stencil, positions), positions[v]);
  }
  Weights weights;
  for (int c = 0; c < Weights::kClasses; ++c) {
    weights.own[c] = fit[c].solve(weights.share[c]);
    weights.customized = weights.customized || weights.own[c];
  }
  return weights;
}

// After how many vertices the steps from vertex to vertex repeat, if most of them do; else 0.
uint32_t find_period(std::span<const Position> positions) {
  constexpr size_t kSample = 4096, kTable = 4096;
  const size_t n = std::min(kSample, positions.size());
  const auto step = [&](size_t v) {
    std::array<int32_t, 3> result;
    for (size_t axis = 0; axis < 3; ++axis) result[axis] = positions[v][axis] - positions[v - 1][axis];
    return result;
  };
  // Distances between occurrences of the same three steps.
  std::vector<uint32_t> last(kTable, 0), votes(kSample, 0);
  for (size_t v = 4; v < n; ++v) {
    uint64_t hash = 0;
    for (size_t i = 0; i < 3; ++i)
      for (const int32_t s : step(v - i)) hash = (hash ^ static_cast<uint32_t>(s)) * 0x9E3779B97F4A7C15u;
    uint32_t& before = last[hash >> 52];
    if (before != 0) ++votes[v - before];
    before = static_cast<uint32_t>(v);
  }
  uint32_t best = 0;
  size_t best_hits = n / 2;
  for (int round = 0; round < 8; ++round) {
    const auto top = std::max_element(votes.begin(), votes.end());
    const auto period = static_cast<uint32_t>(top - votes.begin());
    if (*top == 0) break;
    *top = 0;
    for (const uint32_t candidate : {period, 2 * period, 4 * period}) {
      size_t hits = 0;
      for (size_t v = candidate + 1; v < n; ++v) hits += step(v) == step(v - candidate) ? 1 : 0;
      if (hits <= best_hits) continue;
      best_hits = hits;
      best = candidate;
    }
  }
  return best;
}

std::vector<uint8_t> encode_first(const Topology& topology, const Stencils& stencils, std::vector<Position>& positions,
                                  size_t count, Weights weights, int bits) {
  RangeEncoder coder;
  code_weights(coder, weights);
  PositionCoder<RangeEncoder> position_coder(topology, stencils, coder, weights, bits);
  for (uint32_t v = 0; v < count; ++v) position_coder.code(v, positions);
  return coder.finish();
}

}  // namespace

std::vector<uint8_t> encode_positions(const Topology& topology, std::span<const Position> given, int bits) {
  constexpr size_t kSample = 4096;  // choices are made on that many, one after the other
  std::vector<Position> positions(given.begin(), given.end());
  const Stencils stencils(topology);
  const size_t sample = std::min(kSample, positions.size());
  Weights best;
  std::vector<uint8_t> best_bytes = encode_first(topology, stencils, positions, sample, best, bits);
  const auto try_weights = [&](const Weights& weights) {
    std::vector<uint8_t> bytes = encode_first(topology, stencils, positions, sample, weights, bits);
    if (bytes.size() >= best_bytes.size()) return;
    best_bytes = std::move(bytes);
    best = weights;
  };
  try_weights(fit_weights(topology, stencils, positions));
  Weights changed = best;
  changed.lifted = true;
  try_weights(changed);
  changed = best;
  changed.exact = true;
  try_weights(changed);
  changed = best;
  changed.period = find_period(positions);
  if (changed.period != 0) try_weights(changed);
  if (8 * best_bytes.size() > 3 * static_cast<size_t>(bits) * sample) best.raw = true, best_bytes.clear();
  if (sample == positions.size() && !best.raw) return best_bytes;
  return encode_first(topology, stencils, positions, positions.size(), best, bits);
}

Result<std::vector<Position>> decode_positions(std::span<const uint8_t> bytes, const Topology& topology,
                                               uint32_t n_positions, int bits) {
  RangeDecoder coder(bytes);
  Weights weights;
  code_weights(coder, weights);
  const Stencils stencils(topology);
  PositionCoder<RangeDecoder> position_coder(topology, stencils, coder, weights, bits);
  std::vector<Position> positions;
  positions.reserve(std::min<size_t>(n_positions, 4096 + 8 * bytes.size()));
  for (uint32_t v = 0; v < n_positions; ++v) {
    positions.emplace_back();
    position_coder.code(v, positions);
    if (coder.failed()) return Failure{Error::corrupt, 0, "positions end too early"};
  }
  if (!coder.ends_exactly()) return Failure{Error::corrupt, 0, "positions do not end where the header says"};
  return positions;
}

}  // namespace pac::geomcodec
