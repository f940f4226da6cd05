// What the coders of colors, normals and texture coordinates share: one loop over the vertices, contexts from the
// magnitudes of the neighbors' residuals, and the question whether a vertex is like its sibling across a seam.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "geomcodec/attributes.h"
#include "geomcodec/prediction.h"
#include "geomcodec/symbol_model.h"
#include "geomcodec/table_coder.h"

namespace pac::geomcodec {

enum AttributeBasis : uint32_t {
  kFromPrevious,
  kFromNeighbors,
  kFromExtension,
  kFromOne,
  kFromTwo,
  kFromMore,
  kAttributeBases
};

inline AttributeBasis attribute_basis(const Stencil& stencil) {
  if (stencil.extended) return kFromExtension;
  if (stencil.n_parallelograms > 0)
    return static_cast<AttributeBasis>(kFromOne + static_cast<uint32_t>(std::min(stencil.n_parallelograms, 3)) - 1);
  return stencil.n_neighbors > 0 ? kFromNeighbors : kFromPrevious;
}

// Residuals of one component of an attribute.
struct ComponentModel {
  ClassModels<kClasses> classes[kAttributeBases];
  DetailModel details[3];  // by the sign of the residual before in the same vertex

  // scale: mean class of the neighbors' residuals in halves; other: largest class so far in this vertex.
  template <class Coder>
  [[gnu::always_inline]] inline int32_t code(Coder& coder, AttributeBasis basis, uint32_t scale, uint32_t other,
                                             int32_t sign_before, int32_t residual) {
    return code_residual(coder, classes[basis].by_scale[scale], classes[basis].by_other[other],
                         details[sign_before == 0  ? 0
                                 : sign_before > 0 ? 1
                                                   : 2],
                         residual);
  }
};

static_assert(kAttributeContexts <= kMaxTableContexts);

inline uint32_t table_context(uint32_t component, AttributeBasis basis, uint32_t scale, uint32_t other) {
  const uint32_t founded = basis >= kFromTwo ? 2 : basis >= kFromExtension ? 1 : 0;
  if (component == 0) return founded * kScaleHalves + scale;
  return kFirstContexts + (component - 1) * kOtherContexts + std::min(other, kOtherClasses - 1) * kScales +
         (scale + 1) / 2;
}

// A residual of a component by whichever coding the coder stands for. rank: how many components come before it.
template <class Coder>
[[gnu::always_inline]] inline int32_t code_component(Coder& coder, ComponentModel* model, uint32_t rank,
                                                     AttributeBasis basis, uint32_t scale, uint32_t other,
                                                     int32_t sign_before, int32_t residual) {
  if constexpr (Coder::kTables)
    return code_table_residual(coder, rank, table_context(rank, basis, scale, other), residual);
  else
    return model->code(coder, basis, scale, other, sign_before, residual);
}

// Mean of class_at(neighbor) in halves; without neighbors that of the vertex before.
template <class ClassAt>
uint32_t mean_class(uint32_t v, const Stencil& stencil, ClassAt class_at) {
  if (stencil.n_neighbors > 0)
    return static_cast<uint32_t>(scaled_mean(neighbor_sum(stencil, class_at), stencil.n_neighbors, 1));
  return v > 0 ? 2 * static_cast<uint32_t>(class_at(v - 1)) : 0;
}

// "The same as the sibling's" for vertices that have one.
class SiblingModel {
 public:
  template <class Coder>
  bool code(Coder& coder, bool same) {
    if constexpr (Coder::kTables)
      return last_ = coder.symbol(0, kSiblingContext + (last_ ? 1 : 0), same ? 1 : 0) != 0;
    else
      return last_ = coder.bit(same_[last_ ? 1 : 0], same ? 1 : 0) != 0;
  }

 private:
  AdaptiveBit same_[2];
  bool last_ = true;
};

// Drives an attribute's coder, a class template with begin(vertices) and code(v, vertices), over all vertices.
template <class AttributeCoder, class Coder>
std::vector<uint8_t> encode_attribute(AttributeCoder& attribute, Coder& coder, std::span<const QuantizedVertex> given) {
  std::vector<QuantizedVertex> vertices(given.begin(), given.end());
  attribute.begin(vertices);
  for (uint32_t v = 0; v < vertices.size(); ++v) attribute.code(v, vertices);
  return coder.finish();
}
template <class AttributeCoder, class Coder>
Result<void> decode_attribute(AttributeCoder& attribute, Coder& coder, std::span<QuantizedVertex> vertices) {
  attribute.begin(vertices);
  for (uint32_t v = 0; v < vertices.size(); ++v) {
    attribute.code(v, vertices);
    if (coder.failed()) return Failure{Error::corrupt, 0, "vertex attributes end too early"};
  }
  if (!coder.ends_exactly()) return Failure{Error::corrupt, 0, "vertex attributes do not end where the header says"};
  return {};
}

// The same with a coder of its own, by tables or by adaptive models; `more` goes to the attribute's constructor.
template <template <class> class AttributeCoder, class More>
std::vector<uint8_t> encode_attribute(const AttributeMesh& mesh, std::span<const QuantizedVertex> vertices, More more,
                                      AttributeCoding coding) {
  if (coding.by_tables) {
    TableEncoder coder(kAttributeContexts, coding.expected);
    AttributeCoder<TableEncoder> attribute(mesh, coder, more);
    return encode_attribute(attribute, coder, vertices);
  }
  RangeEncoder coder;
  AttributeCoder<RangeEncoder> attribute(mesh, coder, more);
  return encode_attribute(attribute, coder, vertices);
}
template <template <class> class AttributeCoder, class More>
Result<void> decode_attribute(std::span<const uint8_t> bytes, const AttributeMesh& mesh,
                              std::span<QuantizedVertex> vertices, More more, AttributeCoding coding) {
  if (coding.by_tables) {
    SymbolTables tables;
    TableDecoder coder(bytes, kAttributeContexts, coding.expected, tables);
    AttributeCoder<TableDecoder> attribute(mesh, coder, more);
    return decode_attribute(attribute, coder, vertices);
  }
  RangeDecoder coder(bytes);
  AttributeCoder<RangeDecoder> attribute(mesh, coder, more);
  return decode_attribute(attribute, coder, vertices);
}

}  // namespace pac::geomcodec
