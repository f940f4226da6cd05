// Positions and colors as differences from predictions, adaptively coded. FORMAT.md sections 5 and 6.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "geomcodec/geomcodec.h"
#include "geomcodec/topology.h"

namespace pac::geomcodec {

struct CodedAttributes {
  std::vector<uint8_t> positions, colors;  // colors empty if they are constant
};
// vertices in coded order: those that faces use, then the isolated ones.
CodedAttributes encode_attributes(const Topology& topology, std::span<const QuantizedVertex> vertices,
                                  int position_bits, bool constant_color);

// Appends n_vertices vertices to `vertices` as they are read; with constant_color their color stays that of `fill`.
// byte_offset of failures counts from the first byte of the section.
Result<void> decode_attributes(const Topology& topology, std::span<const uint8_t> positions,
                               std::span<const uint8_t> colors, uint32_t n_vertices, int position_bits,
                               bool constant_color, const QuantizedVertex& fill,
                               std::vector<QuantizedVertex>& vertices);

}  // namespace pac::geomcodec
