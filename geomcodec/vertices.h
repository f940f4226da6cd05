// Positions and colors of a mesh without seams, decoded together: one stencil serves both, and while the one range
// decoder waits for its division the other works.
#pragma once

#include <span>

#include "geomcodec/attributes.h"
#include "geomcodec/positions.h"

namespace pac::geomcodec {

// Which of the two sections a failure is in, with the offset in it.
struct VertexFailure {
  bool in_colors = false;
  Failure failure;
};

// The same positions and colors that decode_positions() and decode_colors() find one after the other, for a mesh whose
// vertices are its points. vertices: all of them. False: `failure` tells why.
bool decode_positions_and_colors(std::span<const uint8_t> position_bytes, std::span<const uint8_t> color_bytes,
                                 const AttributeMesh& mesh, int position_bits, bool trained, bool chooses,
                                 std::span<QuantizedVertex> vertices, VertexFailure& failure);
// The same where tables code both.
bool decode_positions_and_colors_by_tables(std::span<const uint8_t> position_bytes,
                                           std::span<const uint8_t> color_bytes, const AttributeMesh& mesh,
                                           int position_bits, std::span<QuantizedVertex> vertices,
                                           VertexFailure& failure);

}  // namespace pac::geomcodec
