// Texture coordinates: a triangle in the texture is similar to the triangle in space [Isenburg, Snoeyink 2003].
// FORMAT.md section 9.
#include <cmath>
#include <memory>

#include "geomcodec/attribute_coder.h"

namespace pac::geomcodec {
namespace {

template <class Coder>
class TexcoordCoder {
 public:
  TexcoordCoder(const AttributeMesh& mesh, Coder& coder, int bits)
      : mesh_(mesh),
        coder_(coder),
        mask_((1 << bits) - 1),
        half_(1 << (bits - 1)),
        models_(Coder::kTables ? nullptr : std::make_unique<Models>()) {}
  void begin(std::span<QuantizedVertex> /*vertices*/) {}
  void code(uint32_t v, std::span<QuantizedVertex> vertices);

 private:
  struct Models {
    ComponentModel component[2];
  };
  // Predictions by the triangles at v whose other corners are known, for both orientations of the texture.
  struct Similar {
    double sum[2][2] = {};  // [orientation][component]
    int count = 0;
  };
  Similar similar(uint32_t v, std::span<const QuantizedVertex> vertices) const;
  static void add(const QuantizedVertex& here, const QuantizedVertex& a, const QuantizedVertex& b, Similar& result);
  struct Prediction {
    int32_t at[2];
    AttributeBasis basis;
  };
  Prediction from_triangles(const Similar& similar) const;
  Prediction from_texcoords(uint32_t v, const Stencil& stencil, std::span<const QuantizedVertex> vertices) const;
  void learn(const Similar& similar, const Prediction& triangles, const Prediction& plain,
             const uint16_t (&texcoord)[2]);
  static int32_t cost(const Prediction& prediction, const uint16_t (&texcoord)[2]) {
    return static_cast<int32_t>(class_of(texcoord[0] - prediction.at[0]) + class_of(texcoord[1] - prediction.at[1]));
  }

  const AttributeMesh& mesh_;
  Coder& coder_;
  const int32_t mask_, half_;
  std::unique_ptr<Models> models_;
  SiblingModel sibling_;
  Stencil stencil_;
  int orientation_ = 0;
  int32_t error_[2] = {};  // recent costs of predictions by triangles, by texture coordinates alone
  std::vector<std::array<uint8_t, 2>> memory_;
};

template <class Coder>
void TexcoordCoder<Coder>::add(const QuantizedVertex& here, const QuantizedVertex& a, const QuantizedVertex& b,
                               Similar& result) {
  double dot = 0, edge_edge = 0, side_side = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double edge = b.position[axis] - a.position[axis], side = here.position[axis] - a.position[axis];
    dot = dot + edge * side;
    edge_edge = edge_edge + edge * edge;
    side_side = side_side + side * side;
  }
  double along = 0.5, across = 0;
  if (edge_edge > 0) {
    along = dot / edge_edge;
    across = std::sqrt(std::max(0.0, side_side * edge_edge - dot * dot)) / edge_edge;
  }
  const double u = b.texcoord[0] - a.texcoord[0], v = b.texcoord[1] - a.texcoord[1];
  result.sum[0][0] = result.sum[0][0] + ((a.texcoord[0] + along * u) - across * v);
  result.sum[0][1] = result.sum[0][1] + ((a.texcoord[1] + along * v) + across * u);
  result.sum[1][0] = result.sum[1][0] + ((a.texcoord[0] + along * u) + across * v);
  result.sum[1][1] = result.sum[1][1] + ((a.texcoord[1] + along * v) - across * u);
  ++result.count;
}

template <class Coder>
typename TexcoordCoder<Coder>::Similar TexcoordCoder<Coder>::similar(uint32_t v,
                                                                     std::span<const QuantizedVertex> vertices) const {
  Similar result;
  if (v >= mesh_.topology.n_vertices) return result;
  for (const uint32_t* c = mesh_.stencils.begin(v); c != mesh_.stencils.end(v) && result.count < 8; ++c) {
    const uint32_t a = mesh_.topology.corner_vertex[mesh_.topology.next(*c)];
    const uint32_t b = mesh_.topology.corner_vertex[mesh_.topology.previous(*c)];
    if (a < v && b < v) add(vertices[v], vertices[a], vertices[b], result);
  }
  return result;
}

template <class Coder>
typename TexcoordCoder<Coder>::Prediction TexcoordCoder<Coder>::from_triangles(const Similar& similar) const {
  Prediction prediction;
  for (int i = 0; i < 2; ++i) {
    const double mean = similar.sum[orientation_][i] / similar.count;
    prediction.at[i] = static_cast<int32_t>(std::clamp(std::floor(mean + 0.5), 0.0, static_cast<double>(mask_)));
  }
  prediction.basis = similar.count > 1 ? kFromMore : kFromOne;
  return prediction;
}

template <class Coder>
typename TexcoordCoder<Coder>::Prediction TexcoordCoder<Coder>::from_texcoords(
    uint32_t v, const Stencil& stencil, std::span<const QuantizedVertex> vertices) const {
  const uint32_t sibling = mesh_.sibling_of(v);
  Prediction prediction;
  for (int i = 0; i < 2; ++i) {
    const auto at = [&](uint32_t vertex) { return int32_t{vertices[vertex].texcoord[i]}; };
    int32_t& component = prediction.at[i];
    if (stencil.n_parallelograms > 0)
      component = scaled_mean(parallelogram_sum(stencil, at), stencil.n_parallelograms, 0);
    else if (stencil.n_neighbors > 0)
      component = scaled_mean(neighbor_sum(stencil, at), stencil.n_neighbors, 0);
    else if (sibling != kNone)
      component = at(sibling);
    else
      component = v > 0 ? at(v - 1) : 0;
    component = std::clamp(component, 0, mask_);
  }
  prediction.basis = stencil.n_parallelograms > 1 ? kFromTwo : attribute_basis(stencil);
  if (prediction.basis == kFromOne) prediction.basis = kFromTwo;
  return prediction;
}

// Textures are mirrored here and there: the orientation that was nearer holds for the next vertex.
template <class Coder>
void TexcoordCoder<Coder>::learn(const Similar& similar, const Prediction& triangles, const Prediction& plain,
                                 const uint16_t (&texcoord)[2]) {
  if (similar.count == 0) return;
  error_[0] += (64 * cost(triangles, texcoord) - error_[0]) >> 3;
  error_[1] += (64 * cost(plain, texcoord) - error_[1]) >> 3;
  double missed[2];
  for (int o = 0; o < 2; ++o)
    missed[o] = std::abs(texcoord[0] - similar.sum[o][0] / similar.count) +
                std::abs(texcoord[1] - similar.sum[o][1] / similar.count);
  if (missed[0] != missed[1]) orientation_ = missed[0] < missed[1] ? 0 : 1;
}

template <class Coder>
void TexcoordCoder<Coder>::code(uint32_t v, std::span<QuantizedVertex> vertices) {
  uint16_t(&texcoord)[2] = vertices[v].texcoord;
  memory_.push_back({});
  if (const uint32_t sibling = mesh_.sibling_of(v); sibling != kNone) {
    if (sibling_.code(coder_, std::equal(texcoord, texcoord + 2, vertices[sibling].texcoord))) {
      std::copy_n(vertices[sibling].texcoord, 2, texcoord);
      memory_[v] = memory_[sibling];
      return;
    }
  }
  mesh_.stencils.get(v, false, stencil_);
  const Stencil& stencil = stencil_;
  const Similar shapes = similar(v, vertices);
  const Prediction plain = from_texcoords(v, stencil, vertices);
  const Prediction triangles = shapes.count > 0 ? from_triangles(shapes) : plain;
  const Prediction& chosen = error_[1] < error_[0] ? plain : triangles;
  uint32_t other = 0;
  int32_t before = 0;
  HeldCoder<Coder> coder = coder_;
  for (size_t i = 0; i < 2; ++i) {
    const uint32_t scale = mean_class(v, stencil, [&](uint32_t vertex) { return int32_t{memory_[vertex][i]}; });
    int32_t residual = ((texcoord[i] - chosen.at[i] + half_) & mask_) - half_;
    residual = code_component(coder, models_ == nullptr ? nullptr : &models_->component[i], static_cast<uint32_t>(i),
                              chosen.basis, scale, other, before, residual);
    texcoord[i] = static_cast<uint16_t>((chosen.at[i] + residual) & mask_);
    memory_[v][i] = static_cast<uint8_t>(class_of(residual));
    other = class_of(residual);
    before = residual;
  }
  release(coder_, coder);
  learn(shapes, triangles, plain, texcoord);
}

}  // namespace

std::vector<uint8_t> encode_texcoords(const AttributeMesh& mesh, std::span<const QuantizedVertex> vertices, int bits,
                                      AttributeCoding coding) {
  return encode_attribute<TexcoordCoder>(mesh, vertices, bits, coding);
}

Result<void> decode_texcoords(std::span<const uint8_t> bytes, const AttributeMesh& mesh,
                              std::span<QuantizedVertex> vertices, int bits, AttributeCoding coding) {
  return decode_attribute<TexcoordCoder>(bytes, mesh, vertices, bits, coding);
}

}  // namespace pac::geomcodec
