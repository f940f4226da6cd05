// Colors: green first, red and blue after how green missed, alpha alone. FORMAT.md section 7.
#pragma once

#include <cmath>
#include <memory>

#include "geomcodec/attribute_coder.h"
#include "geomcodec/priors.h"

namespace pac::geomcodec {

// How red and blue residuals go with green's: running sums that forget by 1/128 a vertex, in 1/64.
class Covariance {
 public:
  // What a channel misses where green misses by `green`, in levels; the ratio is kept within -2..2.
  int32_t expected(size_t channel, int32_t green) const {
    const int64_t ratio = std::clamp<int64_t>(with_green_[channel] * 256 / green_green_, -512, 512);
    return static_cast<int32_t>(round_quotient(ratio * green, 256));
  }
  void learn_green(int32_t green) {
    green_green_ = std::max<int64_t>(green_green_ + int64_t{64} * green * green - (green_green_ >> 7), 32);
  }
  // missed: by how much the channel's spatial prediction missed, the share that green foretold included.
  void learn(size_t channel, int32_t missed, int32_t green) {
    with_green_[channel] += int64_t{64} * missed * green - (with_green_[channel] >> 7);
  }

 private:
  int64_t with_green_[3] = {1024, 0, 1024};  // ratio 1 at first
  int64_t green_green_ = 1024;
};

// How far, in 1/128, from the neighbors' mean to the parallelograms' mean the prediction lies, by basis.
struct Shares {
  uint8_t of[kAttributeBases] = {0, 0, 96, 96, 96, 96};
};

template <class Coder>
class ColorCoder {
 public:
  struct Models {
    ComponentModel channel[4];
    explicit Models(bool trained) {
      for (size_t basis = 0; trained && basis < kAttributeBases; ++basis)
        for (const size_t c : {size_t{0}, size_t{1}, size_t{2}})
          channel[c].classes[basis].start_from(
              kPriorModels[(c == 1 ? kPriorGreen : kPriorRedBlue) + kPriorOfAttributeBasis[basis]]);
      for (const size_t c : {size_t{0}, size_t{1}, size_t{2}})
        if (trained) std::fill_n(channel[c].details, 3, kPriorDetails[c == 1 ? kDetailsOfGreen : kDetailsOfRedBlue]);
    }
  };

  // trained: models start as training left them.
  ColorCoder(const AttributeMesh& mesh, Coder& coder, bool trained)
      : mesh_(mesh), coder_(coder), models_(Coder::kTables ? nullptr : std::make_unique<Models>(trained)) {}
  const Models& models() const { return *models_; }
  void begin(std::span<QuantizedVertex> vertices);
  void code(uint32_t v, std::span<QuantizedVertex> vertices) {
    memory_.push_back(0);
    if (is_sibling(v, vertices)) return;
    mesh_.stencils.get(v, false, stencil_);
    code_residuals(v, stencil_, vertices);
  }
  // The same for a vertex without a sibling whose stencil the caller has already.
  void code(uint32_t v, const Stencil& stencil, std::span<QuantizedVertex> vertices) {
    memory_.push_back(0);
    code_residuals(v, stencil, vertices);
  }

 private:
  // Per channel, in 1/64.
  struct Means {
    int32_t neighbors[4], parallelograms[4];
  };
  static Means means(const Stencil& stencil, std::span<const QuantizedVertex> vertices);
  void predict(uint32_t v, const Stencil& stencil, std::span<const QuantizedVertex> vertices,
               int32_t (&prediction)[4]) const;
  void fit_shares(std::span<const QuantizedVertex> vertices);
  bool is_sibling(uint32_t v, std::span<QuantizedVertex> vertices);
  void code_residuals(uint32_t v, const Stencil& stencil, std::span<QuantizedVertex> vertices);

  const AttributeMesh& mesh_;
  Coder& coder_;
  std::unique_ptr<Models> models_;
  Covariance covariance_;
  SiblingModel sibling_;
  Stencil stencil_;
  Shares shares_;
  bool constant_alpha_ = false;
  uint8_t alpha_ = 255;
  std::vector<uint8_t> memory_;  // per vertex: class of green's residual
};

template <class Coder>
typename ColorCoder<Coder>::Means ColorCoder<Coder>::means(const Stencil& stencil,
                                                           std::span<const QuantizedVertex> vertices) {
  int32_t neighbors[4] = {}, parallelograms[4] = {};
  for (int i = 0; i < stencil.n_neighbors; ++i)
    for (int c = 0; c < 4; ++c) neighbors[c] += vertices[stencil.neighbor[i]].color[c];
  for (int i = 0; i < stencil.n_parallelograms; ++i) {
    const Stencil::Parallelogram& p = stencil.parallelogram[i];
    const QuantizedVertex &one = vertices[p.side_1], &two = vertices[p.side_2], &opposite = vertices[p.opposite];
    for (int c = 0; c < 4; ++c) parallelograms[c] += one.color[c] + two.color[c] - opposite.color[c];
  }
  Means means;
  for (int c = 0; c < 4; ++c) {
    means.neighbors[c] = scaled_mean(neighbors[c], stencil.n_neighbors, 6);
    means.parallelograms[c] =
        stencil.n_parallelograms > 0 ? scaled_mean(parallelograms[c], stencil.n_parallelograms, 6) : means.neighbors[c];
  }
  return means;
}

// Least squares over green.
template <class Coder>
void ColorCoder<Coder>::fit_shares(std::span<const QuantizedVertex> vertices) {
  double both[kAttributeBases] = {}, square[kAttributeBases] = {};
  for (uint32_t v = 0; v < vertices.size(); ++v) {
    mesh_.stencils.get(v, false, stencil_);
    const Stencil& stencil = stencil_;
    if (stencil.n_parallelograms == 0) continue;
    const Means mean = means(stencil, vertices);
    const double step = mean.parallelograms[1] - mean.neighbors[1];
    const double missed = 64.0 * vertices[v].color[1] - mean.neighbors[1];
    const double weight = 1 / (64 + std::abs(missed));
    both[attribute_basis(stencil)] += weight * step * missed;
    square[attribute_basis(stencil)] += weight * step * step;
  }
  for (size_t basis = kFromExtension; basis < kAttributeBases; ++basis)
    if (square[basis] > 1000)
      shares_.of[basis] =
          static_cast<uint8_t>(std::clamp(std::floor(128 * both[basis] / square[basis] + 0.5), 0.0, 255.0));
}

template <class Coder>
void ColorCoder<Coder>::begin(std::span<QuantizedVertex> vertices) {
  memory_.reserve(vertices.size());
  if constexpr (!Coder::kDecodes) {
    fit_shares(vertices);
    alpha_ = vertices[0].color[3];
    constant_alpha_ = std::all_of(vertices.begin(), vertices.end(),
                                  [&](const QuantizedVertex& vertex) { return vertex.color[3] == alpha_; });
  }
  constant_alpha_ = coder_.raw(1, constant_alpha_ ? 1 : 0) != 0;
  if (constant_alpha_) alpha_ = static_cast<uint8_t>(coder_.raw(8, alpha_));
  for (size_t basis = kFromExtension; basis < kAttributeBases; ++basis)
    shares_.of[basis] = static_cast<uint8_t>(coder_.raw(8, shares_.of[basis]));
}

template <class Coder>
void ColorCoder<Coder>::predict(uint32_t v, const Stencil& stencil, std::span<const QuantizedVertex> vertices,
                                int32_t (&prediction)[4]) const {
  if (stencil.n_neighbors > 0) {
    const Means mean = means(stencil, vertices);
    const int32_t share = shares_.of[attribute_basis(stencil)];
    for (int c = 0; c < 4; ++c)
      prediction[c] = (128 * mean.neighbors[c] + share * (mean.parallelograms[c] - mean.neighbors[c]) + 4096) >> 13;
    return;
  }
  const uint32_t sibling = mesh_.sibling_of(v), other = sibling != kNone ? sibling : v - 1;
  for (int c = 0; c < 4; ++c) prediction[c] = v > 0 ? vertices[other].color[c] : 255;
}

// Whether v has its sibling's color, which it then gets.
template <class Coder>
bool ColorCoder<Coder>::is_sibling(uint32_t v, std::span<QuantizedVertex> vertices) {
  const uint32_t sibling = mesh_.sibling_of(v);
  if (sibling == kNone) return false;
  const bool same = std::equal(vertices[v].color, vertices[v].color + 4, vertices[sibling].color);
  if (!sibling_.code(coder_, same)) return false;
  std::copy_n(vertices[sibling].color, 4, vertices[v].color);
  memory_[v] = memory_[sibling];
  return true;
}

template <class Coder>
void ColorCoder<Coder>::code_residuals(uint32_t v, const Stencil& stencil, std::span<QuantizedVertex> vertices) {
  const AttributeBasis basis = attribute_basis(stencil);
  const uint32_t scale = mean_class(v, stencil, [&](uint32_t vertex) { return int32_t{memory_[vertex]}; });
  int32_t spatial[4];
  predict(v, stencil, vertices, spatial);
  int32_t green = 0, before = 0;  // residuals
  uint32_t other = 0;
  HeldCoder<Coder> coder = coder_;
  uint32_t rank = 0;
  for (const size_t channel : {size_t{1}, size_t{0}, size_t{2}, size_t{3}}) {
    uint8_t& level = vertices[v].color[channel];
    if (channel == 3 && constant_alpha_) {
      level = alpha_;
      continue;
    }
    const bool follows_green = channel == 0 || channel == 2;
    const int32_t prediction =
        std::clamp(spatial[channel] + (follows_green ? covariance_.expected(channel, green) : 0), 0, 255);
    int32_t residual = static_cast<int8_t>(static_cast<uint8_t>(level - prediction));  // modulo 256
    ComponentModel* model = models_ == nullptr ? nullptr : &models_->channel[channel];
    residual = code_component(coder, model, rank++, basis, scale, other, before, residual);
    level = static_cast<uint8_t>(prediction + residual);
    other = std::max(other, class_of(residual));
    before = residual;
    if (follows_green) {
      covariance_.learn(channel, level - spatial[channel], green);
    } else if (channel == 1) {
      green = residual;
      memory_[v] = static_cast<uint8_t>(class_of(residual));
      covariance_.learn_green(green);
    }
  }
  release(coder_, coder);
}

}  // namespace pac::geomcodec
