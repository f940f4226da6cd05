// Degenerate faces: triangles whose corners lie at two points or at one, on an edge or at a point of a face that is not
// such a triangle. Rounding leaves them of slivers, in models from CAD by the thousand. The walk leaves them out, so
// that it and predictions see the surface that is left; then each edge tells which of them lie on it. FORMAT.md
// section 16.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/mesh.h"
#include "base/result.h"
#include "geomcodec/connectivity.h"
#include "geomcodec/topology.h"

namespace pac::geomcodec {

// Per face, whether it is degenerate; empty if none is. indices: points, below n_points.
std::vector<uint8_t> find_degenerate_faces(std::span<const uint32_t> indices, std::span<const Face> faces,
                                           uint32_t n_points);

// The degenerate faces of the mesh whose other faces are walked: they are added to the topology and the order of faces.
std::vector<uint8_t> encode_degenerate_faces(std::span<const uint32_t> indices, std::span<const Face> faces,
                                             std::span<const uint8_t> degenerate, Topology& topology, WalkOrder& order);

// So many of them, added to the topology. byte_offset of failures counts from bytes.data().
Result<void> decode_degenerate_faces(std::span<const uint8_t> bytes, uint32_t n_degenerate, Topology& topology);

}  // namespace pac::geomcodec
