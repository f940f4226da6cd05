// Positions as differences from predictions, adaptively coded. FORMAT.md section 6.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "geomcodec/stencil.h"
#include "geomcodec/topology.h"

namespace pac::geomcodec {

using Position = std::array<uint16_t, 3>;

// stencils: of `topology`. trained: models start as training left them. positions: of the points in coded order, then
// of the isolated vertices. codes_all: whatever may pay is coded, else most of it only estimated (size_estimator.h).
struct PositionSection {
  std::vector<uint8_t> bytes;
  bool chooses = false;        // residuals choose what they start from: the stream's version has to say so
  uint64_t choosing_bits = 0;  // by estimate, where choosing takes much less than not; else 0
};
PositionSection encode_positions(const Topology& topology, const Stencils& stencils,
                                 std::span<const Position> positions, int bits, bool trained, bool codes_all);
// About how many bits all positions take that choose with no shares, by estimate from a sample.
uint64_t estimate_choosing(const Topology& topology, const Stencils& stencils, std::span<const Position> positions,
                           int bits);
// The same by coding the sample: residuals start from the prediction, or choose.
uint64_t estimate_positions(const Topology& topology, const Stencils& stencils, std::span<const Position> positions,
                            int bits, bool trained, bool chooses);

// n_positions >= topology.n_vertices. byte_offset of failures counts from the first byte of the section.
Result<std::vector<Position>> decode_positions(std::span<const uint8_t> bytes, const Topology& topology,
                                               const Stencils& stencils, uint32_t n_positions, int bits, bool trained,
                                               bool chooses);

}  // namespace pac::geomcodec
