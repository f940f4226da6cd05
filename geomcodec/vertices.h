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

// How the two sections are coded.
struct CodedVertices {
  std::span<const uint8_t> positions, colors;
  bool positions_by_tables = false, colors_by_tables = false;
  int position_bits = 0;
  bool trained = false, chooses = false;                                                 // as the header says
  Expected expected_positions = Expected::nothing, expected_colors = Expected::nothing;  // what it lets expect
};

// The same positions and colors that decode_positions() and decode_colors() or their likes by tables find one after the
// other, for a mesh whose vertices are its points. vertices: all of them. False: `failure` tells why.
bool decode_positions_and_colors(const CodedVertices& coded, const AttributeMesh& mesh,
                                 std::span<QuantizedVertex> vertices, VertexFailure& failure);

}  // namespace pac::geomcodec
