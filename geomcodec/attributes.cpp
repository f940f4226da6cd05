#include "geomcodec/attributes.h"

#include <algorithm>
#include <bit>

#include "geomcodec/models.h"
#include "geomcodec/stencil.h"

namespace pac::geomcodec {
namespace {

// How well a prediction is founded: the first context of its residual.
enum Basis : uint32_t { kPrevious, kNeighbors, kOneParallelogram, kManyParallelograms, kBases };

constexpr int kClassBits = 5;     // of a magnitude class: bit lengths 0..17
constexpr uint32_t kScales = 18;  // mean class of the neighbors' residuals
constexpr uint32_t kClasses = 18;

int32_t divide_to_nearest(int32_t sum, int32_t count) {  // halves upwards; count > 0
  const int32_t twice = 2 * sum + count, unit = 2 * count;
  return twice >= 0 ? twice / unit : -((-twice + unit - 1) / unit);
}

// A signed residual: class, sign, bits below the leading one.
struct ResidualModel {
  AdaptiveBit by_scale[kBases][kScales][1 << kClassBits];
  AdaptiveBit by_class[kBases][kClasses][1 << kClassBits];
  AdaptiveBit sign[kBases][3];
  MantissaModel mantissa;
};

uint32_t class_of(int32_t residual) {
  return static_cast<uint32_t>(std::bit_width(static_cast<uint32_t>(residual < 0 ? -residual : residual)));
}

// `other` < kClasses: the class of a residual that was coded just before for the same vertex; sign_context 0..2.
template <class Coder>
int32_t code_residual(Coder& coder, ResidualModel& model, Basis basis, uint32_t scale, uint32_t other,
                      uint32_t sign_context, int32_t residual) {
  const uint32_t length = std::min(
      kClasses - 1,
      code_tree(coder, model.by_scale[basis][scale], model.by_class[basis][other], kClassBits, class_of(residual)));
  if (length == 0) return 0;
  const bool negative = coder.bit(model.sign[basis][sign_context], residual < 0 ? 1 : 0) != 0;
  const auto magnitude = static_cast<int32_t>(code_mantissa(
      coder, model.mantissa, static_cast<int>(length), static_cast<uint32_t>(residual < 0 ? -residual : residual)));
  return negative ? -magnitude : magnitude;
}

uint32_t sign_of(int32_t value) {
  return value == 0 ? 0 : value > 0 ? 1 : 2;
}

// What is kept of each coded vertex for the contexts of those after it.
struct Memory {
  uint8_t position_class[3] = {};
  uint8_t color_class = 0;
};

template <class Coder>
class AttributeCoder {
 public:
  AttributeCoder(const Topology& topology, Coder& positions, Coder& colors, int position_bits, bool constant_color)
      : topology_(topology),
        stencils_(topology),
        positions_(positions),
        colors_(colors),
        highest_((1 << position_bits) - 1),
        constant_color_(constant_color),
        models_(1) {}

  // Codes vertex v; those before it are complete. False: corrupt.
  bool code(uint32_t v, std::vector<QuantizedVertex>& vertices);

 private:
  struct Models {
    ResidualModel position[3];
    ResidualModel color[4];
  };
  bool code_position(uint32_t v, const Stencil& stencil, std::vector<QuantizedVertex>& vertices);
  bool code_color(uint32_t v, const Stencil& stencil, std::vector<QuantizedVertex>& vertices);

  const Topology& topology_;
  const Stencils stencils_;
  Coder& positions_;
  Coder& colors_;
  const int32_t highest_;
  const bool constant_color_;
  std::vector<Models> models_;  // one element: too large for the stack
  std::vector<Memory> memory_;
  // Running covariance of green's residuals with red's and blue's, and green's variance.
  int64_t red_green_ = 1 << 10, blue_green_ = 1 << 10, green_green_ = 1 << 10;
};

template <class Coder>
bool AttributeCoder<Coder>::code(uint32_t v, std::vector<QuantizedVertex>& vertices) {
  const Stencil stencil = v < topology_.n_vertices ? stencils_.at(v) : Stencil{};
  memory_.emplace_back();
  return code_position(v, stencil, vertices) && (constant_color_ || code_color(v, stencil, vertices));
}

template <class Coder>
bool AttributeCoder<Coder>::code_position(uint32_t v, const Stencil& stencil, std::vector<QuantizedVertex>& vertices) {
  const Basis basis = stencil.n_parallelograms > 1    ? kManyParallelograms
                      : stencil.n_parallelograms == 1 ? kOneParallelogram
                      : stencil.n_neighbors > 0       ? kNeighbors
                                                      : kPrevious;
  uint32_t other = 0;
  for (int axis = 0; axis < 3; ++axis) {
    int32_t prediction = v > 0 ? vertices[v - 1].position[axis] : 0;
    if (stencil.n_parallelograms > 0) {
      int32_t sum = 0;
      for (int i = 0; i < stencil.n_parallelograms; ++i) {
        const Stencil::Parallelogram& p = stencil.parallelogram[i];
        sum +=
            vertices[p.side_1].position[axis] + vertices[p.side_2].position[axis] - vertices[p.opposite].position[axis];
      }
      prediction = divide_to_nearest(sum, stencil.n_parallelograms);
    } else if (stencil.n_neighbors > 0) {
      int32_t sum = 0;
      for (int i = 0; i < stencil.n_neighbors; ++i) sum += vertices[stencil.neighbor[i]].position[axis];
      prediction = divide_to_nearest(sum, stencil.n_neighbors);
    }
    prediction = std::clamp(prediction, 0, highest_);
    int32_t classes = 0;
    for (int i = 0; i < stencil.n_neighbors; ++i) classes += memory_[stencil.neighbor[i]].position_class[axis];
    const uint32_t scale = stencil.n_neighbors > 0
                               ? static_cast<uint32_t>(divide_to_nearest(classes, stencil.n_neighbors))
                           : v > 0 ? memory_[v - 1].position_class[axis]
                                   : 0;
    const int32_t residual = code_residual(positions_, models_[0].position[axis], basis, scale, other, 0,
                                           vertices[v].position[axis] - prediction);
    const int32_t value = prediction + residual;
    if (value < 0 || value > highest_) return false;
    vertices[v].position[axis] = static_cast<uint16_t>(value);
    memory_[v].position_class[axis] = static_cast<uint8_t>(class_of(residual));
    other = axis == 0 ? class_of(residual) : std::max(other, class_of(residual));
  }
  return true;
}

// Green first; red and blue are predicted to miss as green did, in the ratio that held so far; alpha alone.
template <class Coder>
bool AttributeCoder<Coder>::code_color(uint32_t v, const Stencil& stencil, std::vector<QuantizedVertex>& vertices) {
  const Basis basis = stencil.n_parallelograms > 1    ? kManyParallelograms
                      : stencil.n_parallelograms == 1 ? kOneParallelogram
                      : stencil.n_neighbors > 0       ? kNeighbors
                                                      : kPrevious;
  constexpr int kOrder[4] = {1, 0, 2, 3};
  int32_t green = 0;
  uint32_t other = 0, sign_context = 0;
  uint32_t scale = v > 0 ? memory_[v - 1].color_class : 0;
  if (stencil.n_neighbors > 0) {
    int32_t classes = 0;
    for (int i = 0; i < stencil.n_neighbors; ++i) classes += memory_[stencil.neighbor[i]].color_class;
    scale = static_cast<uint32_t>(divide_to_nearest(classes, stencil.n_neighbors));
  }
  for (const int channel : kOrder) {
    int32_t prediction = v > 0 ? vertices[v - 1].color[channel] : 255;
    if (stencil.n_neighbors > 0) {
      int32_t sum = 0;
      for (int i = 0; i < stencil.n_neighbors; ++i) sum += vertices[stencil.neighbor[i]].color[channel];
      // In 1/64 of a level: neighbors' mean + a share of where the parallelograms' mean lies.
      int32_t mean = divide_to_nearest(64 * sum, stencil.n_neighbors);
      if (stencil.n_parallelograms > 0) {
        int32_t linear = 0;
        for (int i = 0; i < stencil.n_parallelograms; ++i) {
          const Stencil::Parallelogram& p = stencil.parallelogram[i];
          linear += vertices[p.side_1].color[channel] + vertices[p.side_2].color[channel] -
                    vertices[p.opposite].color[channel];
        }
        linear = divide_to_nearest(64 * linear, stencil.n_parallelograms);
        mean += divide_to_nearest(linear - mean, 2);
      }
      prediction = divide_to_nearest(mean, 64);
    }
    if (channel == 0 || channel == 2) {
      const int64_t covariance = channel == 0 ? red_green_ : blue_green_;
      const int64_t ratio = std::clamp<int64_t>(covariance * 256 / green_green_, -512, 512);
      prediction += divide_to_nearest(static_cast<int32_t>(ratio) * green, 256);
    }
    const int32_t unclamped = prediction;
    prediction = std::clamp(prediction, 0, 255);
    const int32_t residual = code_residual(colors_, models_[0].color[channel], basis, scale, other, sign_context,
                                           vertices[v].color[channel] - prediction);
    const int32_t value = prediction + residual;
    if (value < 0 || value > 255) return false;
    vertices[v].color[channel] = static_cast<uint8_t>(value);
    if (channel == 1) {
      green = residual;
      other = class_of(residual);
      sign_context = sign_of(residual);
      memory_[v].color_class = static_cast<uint8_t>(class_of(residual));
      green_green_ += int64_t{green} * green * 64 - (green_green_ >> 5);
      if (green_green_ < 32) green_green_ = 32;
    } else if (channel != 3) {
      int64_t& covariance = channel == 0 ? red_green_ : blue_green_;
      const int64_t ratio = std::clamp<int64_t>(covariance * 256 / green_green_, -512, 512);
      const int32_t missed = value - (unclamped - divide_to_nearest(static_cast<int32_t>(ratio) * green, 256));
      covariance += int64_t{missed} * green * 64 - (covariance >> 5);
      other = std::max(other, class_of(residual));
      sign_context = sign_of(residual);
    }
  }
  return true;
}

}  // namespace

CodedAttributes encode_attributes(const Topology& topology, std::span<const QuantizedVertex> vertices,
                                  int position_bits, bool constant_color) {
  RangeEncoder positions, colors;
  AttributeCoder<RangeEncoder> coder(topology, positions, colors, position_bits, constant_color);
  std::vector<QuantizedVertex> copy(vertices.begin(), vertices.end());
  for (uint32_t v = 0; v < copy.size(); ++v) PAC_ASSERT(coder.code(v, copy));
  CodedAttributes coded;
  coded.positions = positions.finish();
  if (!constant_color) coded.colors = colors.finish();
  return coded;
}

Result<void> decode_attributes(const Topology& topology, std::span<const uint8_t> positions,
                               std::span<const uint8_t> colors, uint32_t n_vertices, int position_bits,
                               bool constant_color, const QuantizedVertex& fill,
                               std::vector<QuantizedVertex>& vertices) {
  RangeDecoder position_coder(positions), color_coder(colors);
  AttributeCoder<RangeDecoder> coder(topology, position_coder, color_coder, position_bits, constant_color);
  for (uint32_t v = 0; v < n_vertices; ++v) {
    vertices.push_back(fill);
    if (!coder.code(v, vertices)) return Failure{Error::corrupt, 0, "vertex outside the grid"};
    if (position_coder.failed()) return Failure{Error::corrupt, 0, "positions end too early"};
    if (color_coder.failed() && !constant_color) return Failure{Error::corrupt, 0, "colors end too early"};
  }
  if (!position_coder.ends_exactly()) return Failure{Error::corrupt, 0, "positions do not end where the header says"};
  if (!constant_color && !color_coder.ends_exactly())
    return Failure{Error::corrupt, 0, "colors do not end where the header says"};
  return {};
}

}  // namespace pac::geomcodec
