// What vertices carry beside positions: colors, normals, texture coordinates, predicted from vertices before them and
// from the positions, which are complete. FORMAT.md sections 7, 8, 9.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "geomcodec/expected_tables.h"
#include "geomcodec/geomcodec.h"
#include "geomcodec/stencil.h"
#include "geomcodec/topology.h"

namespace pac::geomcodec {

// Everything the predictions may use. Vertices in coded order, isolated ones last; their positions are set.
struct AttributeMesh {
  const Topology& topology;           // over vertices, cut at seams
  const Stencils& stencils;           // of `topology`
  std::span<const uint32_t> sibling;  // per vertex that faces use: Seams::sibling

  uint32_t sibling_of(uint32_t vertex) const { return vertex < sibling.size() ? sibling[vertex] : kNone; }
};

// By tables or by adaptive models; what contexts have that no table is told of.
struct AttributeCoding {
  bool by_tables = false;
  Expected expected = Expected::nothing;
};

std::vector<uint8_t> encode_colors(const AttributeMesh& mesh, std::span<const QuantizedVertex> vertices, bool trained,
                                   AttributeCoding coding);
std::vector<uint8_t> encode_normals(const AttributeMesh& mesh, std::span<const QuantizedVertex> vertices, int bits,
                                    AttributeCoding coding);
std::vector<uint8_t> encode_texcoords(const AttributeMesh& mesh, std::span<const QuantizedVertex> vertices, int bits,
                                      AttributeCoding coding);

// Fill the attribute of all vertices. byte_offset of failures counts from the first byte of the section.
Result<void> decode_colors(std::span<const uint8_t> bytes, const AttributeMesh& mesh,
                           std::span<QuantizedVertex> vertices, bool trained, AttributeCoding coding);
Result<void> decode_normals(std::span<const uint8_t> bytes, const AttributeMesh& mesh,
                            std::span<QuantizedVertex> vertices, int bits, AttributeCoding coding);
Result<void> decode_texcoords(std::span<const uint8_t> bytes, const AttributeMesh& mesh,
                              std::span<QuantizedVertex> vertices, int bits, AttributeCoding coding);

}  // namespace pac::geomcodec
