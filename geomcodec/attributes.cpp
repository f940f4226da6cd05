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

// What is kept of each coded vertex for the contexts of those after it: classes of its residuals.
struct Memory {
  uint8_t position_class[3] = {};
  uint8_t green_class = 0;
};

// How red and blue residuals go with green's: running sums that forget by 1/128 a vertex, in 1/64.
class Covariance {
 public:
  // What a channel misses where green misses by `green`, in levels; the ratio is kept within -2..2.
  int32_t expected(int channel, int32_t green) const {
    const int64_t ratio = std::clamp<int64_t>(with_green_[channel] * 256 / green_green_, -512, 512);
    return divide_to_nearest(static_cast<int32_t>(ratio) * green, 256);
  }
  void learn_green(int32_t green) {
    green_green_ = std::max<int64_t>(green_green_ + int64_t{64} * green * green - (green_green_ >> 7), 32);
  }
  // missed: by how much the channel's spatial prediction missed, the share that green foretold included.
  void learn(int channel, int32_t missed, int32_t green) {
    with_green_[channel] += int64_t{64} * missed * green - (with_green_[channel] >> 7);
  }

 private:
  int64_t with_green_[3] = {1024, 0, 1024};  // ratio 1 at first
  int64_t green_green_ = 1024;
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
  // Mean of what `class_at(neighbor)` tells; without neighbors that of the vertex before.
  template <class ClassAt>
  static uint32_t mean_class(uint32_t v, const Stencil& stencil, ClassAt class_at);

  const Topology& topology_;
  const Stencils stencils_;
  Coder& positions_;
  Coder& colors_;
  const int32_t highest_;
  const bool constant_color_;
  std::vector<Models> models_;  // one element: too large for the stack
  std::vector<Memory> memory_;
  Covariance covariance_;
};

Basis basis_of(const Stencil& stencil) {
  if (stencil.n_parallelograms > 0) return stencil.n_parallelograms > 1 ? kManyParallelograms : kOneParallelogram;
  return stencil.n_neighbors > 0 ? kNeighbors : kPrevious;
}

// `value(vertex)` is one coordinate or channel; sums stay below 12 * 3 * 65535 * 64 < 2^31.
template <class Value>
int32_t parallelogram_sum(const Stencil& stencil, Value value) {
  int32_t sum = 0;
  for (int i = 0; i < stencil.n_parallelograms; ++i) {
    const Stencil::Parallelogram& p = stencil.parallelogram[i];
    sum += value(p.side_1) + value(p.side_2) - value(p.opposite);
  }
  return sum;
}
template <class Value>
int32_t neighbor_sum(const Stencil& stencil, Value value) {
  int32_t sum = 0;
  for (int i = 0; i < stencil.n_neighbors; ++i) sum += value(stencil.neighbor[i]);
  return sum;
}

template <class Coder>
template <class ClassAt>
uint32_t AttributeCoder<Coder>::mean_class(uint32_t v, const Stencil& stencil, ClassAt class_at) {
  if (stencil.n_neighbors > 0)
    return static_cast<uint32_t>(divide_to_nearest(neighbor_sum(stencil, class_at), stencil.n_neighbors));
  return v > 0 ? static_cast<uint32_t>(class_at(v - 1)) : 0;
}

template <class Coder>
bool AttributeCoder<Coder>::code(uint32_t v, std::vector<QuantizedVertex>& vertices) {
  const Stencil stencil = v < topology_.n_vertices ? stencils_.at(v) : Stencil{};
  memory_.emplace_back();
  return code_position(v, stencil, vertices) && (constant_color_ || code_color(v, stencil, vertices));
}

template <class Coder>
bool AttributeCoder<Coder>::code_position(uint32_t v, const Stencil& stencil, std::vector<QuantizedVertex>& vertices) {
  const Basis basis = basis_of(stencil);
  uint32_t largest_class = 0;  // of the axes before
  for (int axis = 0; axis < 3; ++axis) {
    const auto coordinate = [&](uint32_t vertex) { return int32_t{vertices[vertex].position[axis]}; };
    int32_t prediction = 0;
    if (stencil.n_parallelograms > 0)
      prediction = divide_to_nearest(parallelogram_sum(stencil, coordinate), stencil.n_parallelograms);
    else if (stencil.n_neighbors > 0)
      prediction = divide_to_nearest(neighbor_sum(stencil, coordinate), stencil.n_neighbors);
    else if (v > 0)
      prediction = coordinate(v - 1);
    prediction = std::clamp(prediction, 0, highest_);

    const uint32_t scale =
        mean_class(v, stencil, [&](uint32_t vertex) { return int32_t{memory_[vertex].position_class[axis]}; });
    const int32_t residual = code_residual(positions_, models_[0].position[axis], basis, scale, largest_class, 0,
                                           coordinate(v) - prediction);
    const int32_t value = prediction + residual;
    if (value < 0 || value > highest_) return false;
    vertices[v].position[axis] = static_cast<uint16_t>(value);
    memory_[v].position_class[axis] = static_cast<uint8_t>(class_of(residual));
    largest_class = std::max(largest_class, class_of(residual));
  }
  return true;
}

// The neighbors' mean, moved by 3/4 of the way to the parallelograms' mean.
template <class Value>
int32_t predict_channel(const Stencil& stencil, Value value) {
  const int32_t mean = divide_to_nearest(64 * neighbor_sum(stencil, value), stencil.n_neighbors);
  if (stencil.n_parallelograms == 0) return divide_to_nearest(mean, 64);
  const int32_t linear = divide_to_nearest(64 * parallelogram_sum(stencil, value), stencil.n_parallelograms);
  return divide_to_nearest(mean + divide_to_nearest(3 * (linear - mean), 4), 64);
}

// Green first; red and blue are predicted to miss as green did, in the ratio that held so far; alpha alone.
template <class Coder>
bool AttributeCoder<Coder>::code_color(uint32_t v, const Stencil& stencil, std::vector<QuantizedVertex>& vertices) {
  const Basis basis = basis_of(stencil);
  const uint32_t scale = mean_class(v, stencil, [&](uint32_t vertex) { return int32_t{memory_[vertex].green_class}; });
  int32_t green = 0;  // its residual
  uint32_t largest_class = 0, sign_context = 0;
  for (const int channel : {1, 0, 2, 3}) {
    const auto level = [&](uint32_t vertex) { return int32_t{vertices[vertex].color[channel]}; };
    const int32_t spatial = stencil.n_neighbors > 0 ? predict_channel(stencil, level) : v > 0 ? level(v - 1) : 255;
    const bool follows_green = channel == 0 || channel == 2;
    const int32_t prediction = std::clamp(spatial + (follows_green ? covariance_.expected(channel, green) : 0), 0, 255);
    const int32_t residual = code_residual(colors_, models_[0].color[channel], basis, scale, largest_class,
                                           sign_context, level(v) - prediction);
    const int32_t value = prediction + residual;
    if (value < 0 || value > 255) return false;
    vertices[v].color[channel] = static_cast<uint8_t>(value);
    largest_class = std::max(largest_class, class_of(residual));
    sign_context = sign_of(residual);
    if (follows_green) {
      covariance_.learn(channel, value - spatial, green);
    } else if (channel == 1) {
      green = residual;
      memory_[v].green_class = static_cast<uint8_t>(class_of(residual));
      covariance_.learn_green(green);
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
