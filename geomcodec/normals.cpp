// Octahedral normals [Meyer et al. 2010], predicted from the faces around the vertex. FORMAT.md section 8.
#include <array>
#include <cmath>
#include <cstdlib>
#include <memory>

#include "geomcodec/attribute_coder.h"

namespace pac::geomcodec {
namespace {

using Octahedral = std::array<int32_t, 2>;  // -m .. m each, m = 2^(bits - 1) - 1

// The other side of the square: what lies outside the diamond goes inside and the other way round. On the square's rim
// two points stand for one direction: one of them stays, so that this is its own inverse.
Octahedral folded(const Octahedral& at, int32_t m) {
  if ((std::abs(at[1]) == m && at[0] < 0) || (std::abs(at[0]) == m && at[1] < 0)) return at;
  const int32_t u = m - std::abs(at[1]), v = m - std::abs(at[0]);
  return {at[0] < 0 ? -u : u, at[1] < 0 ? -v : v};
}

template <class Coder>
class NormalCoder {
 public:
  NormalCoder(const AttributeMesh& mesh, Coder& coder, int bits)
      : mesh_(mesh),
        coder_(coder),
        m_((1 << (bits - 1)) - 1),
        models_(Coder::kTables ? nullptr : std::make_unique<Models>()) {}
  void begin(std::span<QuantizedVertex> /*vertices*/) {}
  void code(uint32_t v, std::span<QuantizedVertex> vertices);

 private:
  struct Models {
    ComponentModel component[2];
  };
  struct Memory {
    uint8_t residual_class[2];
    int16_t off_faces[2];  // by how much the normal misses that of the faces, in their hemisphere
  };
  // The area-weighted normal of the faces around v; false if it vanishes.
  bool normal_of_faces(uint32_t v, std::span<const QuantizedVertex> vertices, Octahedral& normal, bool& below) const;
  void predict_without_faces(uint32_t v, const Stencil& stencil, std::span<const QuantizedVertex> vertices,
                             Octahedral& prediction) const;
  // To -m .. m, around the square.
  int32_t wrapped(int32_t difference) const {
    const int32_t side = 2 * m_ + 1;
    return difference > m_ ? difference - side : difference < -m_ ? difference + side : difference;
  }

  const AttributeMesh& mesh_;
  Coder& coder_;
  const int32_t m_;
  std::unique_ptr<Models> models_;
  SiblingModel sibling_;
  Stencil stencil_;
  std::vector<Memory> memory_;
};

template <class Coder>
bool NormalCoder<Coder>::normal_of_faces(uint32_t v, std::span<const QuantizedVertex> vertices, Octahedral& normal,
                                         bool& below) const {
  if (v >= mesh_.topology.n_vertices) return false;
  int64_t sum[3] = {0, 0, 0};
  int n_corners = 0;
  for (const uint32_t* c = mesh_.stencils.begin(v); c != mesh_.stencils.end(v) && n_corners < 64; ++c, ++n_corners) {
    const uint16_t* here = vertices[v].position;
    const uint16_t* next = vertices[mesh_.topology.corner_vertex[mesh_.topology.next(*c)]].position;
    const uint16_t* previous = vertices[mesh_.topology.corner_vertex[mesh_.topology.previous(*c)]].position;
    int64_t a[3], b[3];
    for (int axis = 0; axis < 3; ++axis) {
      a[axis] = int64_t{next[axis]} - here[axis];
      b[axis] = int64_t{previous[axis]} - here[axis];
    }
    sum[0] += a[1] * b[2] - a[2] * b[1];
    sum[1] += a[2] * b[0] - a[0] * b[2];
    sum[2] += a[0] * b[1] - a[1] * b[0];
  }
  const int64_t length = std::abs(sum[0]) + std::abs(sum[1]) + std::abs(sum[2]);
  if (length == 0) return false;
  // |sum| < 64 * 2^33, m < 2^15: below 2^54.
  normal = {static_cast<int32_t>(round_quotient(sum[0] * m_, length)),
            static_cast<int32_t>(round_quotient(sum[1] * m_, length))};
  below = sum[2] < 0;
  return true;
}

template <class Coder>
void NormalCoder<Coder>::predict_without_faces(uint32_t v, const Stencil& stencil,
                                               std::span<const QuantizedVertex> vertices,
                                               Octahedral& prediction) const {
  const uint32_t sibling = mesh_.sibling_of(v);
  for (size_t i = 0; i < 2; ++i) {
    const auto at = [&](uint32_t vertex) { return vertices[vertex].normal[i] - m_; };
    if (stencil.n_neighbors > 0)
      prediction[i] = scaled_mean(neighbor_sum(stencil, at), stencil.n_neighbors, 0);
    else if (sibling != kNone)
      prediction[i] = at(sibling);
    else
      prediction[i] = v > 0 ? at(v - 1) : 0;
  }
}

template <class Coder>
void NormalCoder<Coder>::code(uint32_t v, std::span<QuantizedVertex> vertices) {
  uint16_t* normal = vertices[v].normal;
  memory_.push_back({});
  if (const uint32_t sibling = mesh_.sibling_of(v); sibling != kNone) {
    if (sibling_.code(coder_, std::equal(normal, normal + 2, vertices[sibling].normal))) {
      std::copy_n(vertices[sibling].normal, 2, normal);
      memory_[v] = memory_[sibling];
      return;
    }
  }
  mesh_.stencils.get(v, false, stencil_);
  const Stencil& stencil = stencil_;
  Octahedral faces = {0, 0};
  bool below = false;
  const bool has_faces = normal_of_faces(v, vertices, faces, below);
  if (!has_faces) predict_without_faces(v, stencil, vertices, faces);
  const AttributeBasis basis = !has_faces ? kFromPrevious : stencil.n_neighbors > 0 ? kFromMore : kFromNeighbors;

  // In the hemisphere of the faces' normal, where the square is flat around it.
  Octahedral actual = {normal[0] - m_, normal[1] - m_};
  if (below) actual = folded(actual, m_);
  uint32_t other = 0;
  int32_t before = 0;
  HeldCoder<Coder> coder = coder_;
  for (size_t i = 0; i < 2; ++i) {
    const auto off = [&](uint32_t vertex) { return int32_t{memory_[vertex].off_faces[i]}; };
    int32_t prediction = faces[i];
    if (has_faces && stencil.n_neighbors > 0)
      prediction += scaled_mean(neighbor_sum(stencil, off), stencil.n_neighbors, 0) / 2;
    prediction = std::clamp(prediction, -m_, m_);
    const uint32_t scale =
        mean_class(v, stencil, [&](uint32_t vertex) { return int32_t{memory_[vertex].residual_class[i]}; });
    const int32_t residual =
        code_component(coder, models_ == nullptr ? nullptr : &models_->component[i], static_cast<uint32_t>(i), basis,
                       scale, other, before, wrapped(actual[i] - prediction));
    actual[i] = std::clamp(wrapped(prediction + residual), -m_, m_);
    memory_[v].off_faces[i] = static_cast<int16_t>(has_faces ? std::clamp(actual[i] - faces[i], -m_, m_) : 0);
    memory_[v].residual_class[i] = static_cast<uint8_t>(class_of(residual));
    other = class_of(residual);
    before = residual;
  }
  release(coder_, coder);
  if (below) actual = folded(actual, m_);
  for (size_t i = 0; i < 2; ++i) normal[i] = static_cast<uint16_t>(actual[i] + m_);
}

}  // namespace

std::vector<uint8_t> encode_normals(const AttributeMesh& mesh, std::span<const QuantizedVertex> vertices, int bits,
                                    AttributeCoding coding) {
  return encode_attribute<NormalCoder>(mesh, vertices, bits, coding);
}

Result<void> decode_normals(std::span<const uint8_t> bytes, const AttributeMesh& mesh,
                            std::span<QuantizedVertex> vertices, int bits, AttributeCoding coding) {
  return decode_attribute<NormalCoder>(bytes, mesh, vertices, bits, coding);
}

}  // namespace pac::geomcodec
