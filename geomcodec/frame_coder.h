// One group of values (positions, colors, normals or texture coordinates) of a frame, for encoder and decoder: what is
// expected, how the neighbors moved against that, and what is left. FORMAT.md section 14.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "geomcodec/frame_stream.h"
#include "geomcodec/prediction.h"
#include "geomcodec/symbol_model.h"

namespace pac::geomcodec {

// Per vertex: the vertices with lower numbers that share an edge of a face with it, in the order of the faces' corners,
// twice if two faces do; the first kMost.
class FrameNeighbors {
 public:
  static constexpr uint32_t kMost = 12;
  explicit FrameNeighbors(const QuantizedMesh& mesh);
  std::span<const uint32_t> of(uint32_t vertex) const {
    return std::span(list_).subspan(first_[vertex], first_[vertex + 1] - first_[vertex]);
  }

 private:
  std::vector<uint32_t> first_, list_;
};

using FrameValue = std::array<uint16_t, 4>;
using FrameValues = std::vector<FrameValue>;

// What a group of values is like.
struct FrameShape {
  size_t n_components = 3;
  int bits = 16;
  int32_t highest = 65535;
};
FrameShape frame_shape(FrameGroup group, const QuantizedMesh& mesh);
// Colors as green, red, blue, alpha.
FrameValues frame_values(FrameGroup group, std::span<const QuantizedVertex> vertices);
void set_frame_values(FrameGroup group, const FrameValues& values, std::span<QuantizedVertex> vertices);
// Per vertex: the last one before it at the same position, or kNone.
std::vector<uint32_t> frame_siblings(std::span<const QuantizedVertex> reference);

// What the encoder chooses for a group.
struct FrameChoice {
  static constexpr uint32_t kWhole = 8;
  uint32_t share = 0;          // in 1/8: how far a vertex follows its neighbors
  bool follows_first = false;  // components follow what the first one missed by
};

template <class Coder>
class FrameCoder {
 public:
  // sibling: empty, or per vertex as frame_siblings() says.
  FrameCoder(const FrameNeighbors& neighbors, std::span<const uint32_t> sibling, const FrameValues& expected,
             const FrameShape& shape, Coder& coder)
      : neighbors_(neighbors),
        sibling_(sibling),
        expected_(expected),
        shape_(shape),
        coder_(coder),
        models_(std::make_unique<Models>()),
        memory_(expected.size()) {}

  // False: no encoder wrote this.
  bool begin(const FrameChoice& choice) {
    choice_.share = coder_.raw(4, choice.share);
    choice_.follows_first = coder_.raw(1, choice.follows_first ? 1 : 0) != 0;
    return choice_.share <= FrameChoice::kWhole;
  }
  // Those before v are complete. False: a value above its grid.
  bool code(uint32_t v, FrameValues& values);

 private:
  static constexpr size_t kMostExact = 7;
  struct Models {
    ClassModels<kClasses> classes[4];
    DetailModel details[4];
    AdaptiveBit exact_by_state[5][2], exact_by_count[kMostExact + 1];
  };
  struct Memory {
    bool exact = false;
    uint8_t residual_class[4] = {};
  };
  bool code_exact(uint32_t sibling, std::span<const uint32_t> neighbors, bool exact);
  FrameValue predict(uint32_t v, uint32_t sibling, std::span<const uint32_t> neighbors,
                     const FrameValues& values) const;
  bool code_residuals(uint32_t v, std::span<const uint32_t> neighbors, const FrameValue& prediction, FrameValue& value);
  uint32_t scale_of(uint32_t v, std::span<const uint32_t> neighbors, size_t component) const;

  const FrameNeighbors& neighbors_;
  const std::span<const uint32_t> sibling_;
  const FrameValues& expected_;
  const FrameShape shape_;
  Coder& coder_;
  FrameChoice choice_;
  std::unique_ptr<Models> models_;
  std::vector<Memory> memory_;
  bool last_exact_ = true;
};

template <class Coder>
bool FrameCoder<Coder>::code_exact(uint32_t sibling, std::span<const uint32_t> neighbors, bool exact) {
  size_t n_exact = 0;
  for (const uint32_t neighbor : neighbors) n_exact += memory_[neighbor].exact ? 1 : 0;
  const size_t state = sibling != kNone              ? 4
                       : neighbors.empty()           ? 0
                       : n_exact == neighbors.size() ? 1
                       : n_exact > 0                 ? 2
                                                     : 3;
  last_exact_ = coder_.bit(models_->exact_by_state[state][last_exact_ ? 1 : 0],
                           models_->exact_by_count[std::min(n_exact, kMostExact)], exact ? 1 : 0) != 0;
  return last_exact_;
}

template <class Coder>
FrameValue FrameCoder<Coder>::predict(uint32_t v, uint32_t sibling, std::span<const uint32_t> neighbors,
                                      const FrameValues& values) const {
  if (sibling != kNone) return values[sibling];
  FrameValue prediction = expected_[v];
  if (neighbors.empty() || choice_.share == 0) return prediction;
  for (size_t c = 0; c < shape_.n_components; ++c) {
    int32_t sum = 0;
    for (const uint32_t neighbor : neighbors) sum += values[neighbor][c] - expected_[neighbor][c];
    const int32_t follows =
        (scaled_mean(sum, static_cast<int>(neighbors.size()), 6) * static_cast<int32_t>(choice_.share) + 256) >> 9;
    prediction[c] = static_cast<uint16_t>(std::clamp(expected_[v][c] + follows, 0, shape_.highest));
  }
  return prediction;
}

template <class Coder>
uint32_t FrameCoder<Coder>::scale_of(uint32_t v, std::span<const uint32_t> neighbors, size_t component) const {
  if (neighbors.empty()) return v > 0 ? 2u * memory_[v - 1].residual_class[component] : 0;
  int32_t sum = 0;
  for (const uint32_t neighbor : neighbors) sum += memory_[neighbor].residual_class[component];
  return static_cast<uint32_t>(scaled_mean(sum, static_cast<int>(neighbors.size()), 1));
}

template <class Coder>
bool FrameCoder<Coder>::code_residuals(uint32_t v, std::span<const uint32_t> neighbors, const FrameValue& prediction,
                                       FrameValue& value) {
  const int32_t half = 1 << (shape_.bits - 1), mask = (1 << shape_.bits) - 1;
  uint32_t other = 0;
  int32_t first = 0;
  bool legal = true;
  HeldCoder<Coder> coder = coder_;
  for (size_t c = 0; c < shape_.n_components; ++c) {
    const int32_t expected = std::clamp(prediction[c] + first, 0, shape_.highest);
    int32_t residual = ((value[c] - expected + half) & mask) - half;
    auto& classes = models_->classes[c];
    residual = code_residual(coder, classes.by_scale[scale_of(v, neighbors, c)], classes.by_other[other],
                             models_->details[c], residual);
    value[c] = static_cast<uint16_t>((expected + residual) & mask);
    legal = legal && value[c] <= shape_.highest;
    memory_[v].residual_class[c] = static_cast<uint8_t>(class_of(residual));
    other = std::max(other, class_of(residual));
    if (c == 0 && choice_.follows_first) first = residual;
  }
  release(coder_, coder);
  return legal;
}

template <class Coder>
bool FrameCoder<Coder>::code(uint32_t v, FrameValues& values) {
  const std::span<const uint32_t> neighbors = neighbors_.of(v);
  const uint32_t sibling = sibling_.empty() ? kNone : sibling_[v];
  const FrameValue prediction = predict(v, sibling, neighbors, values);
  memory_[v].exact = code_exact(sibling, neighbors, values[v] == prediction);
  if (!memory_[v].exact) return code_residuals(v, neighbors, prediction, values[v]);
  values[v] = prediction;
  return true;
}

}  // namespace pac::geomcodec
