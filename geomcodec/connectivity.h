// The walk over the faces of a mesh, and its code. Each step takes an open edge of the part walked so far and tells
// whether a face lies across it, how many corners that has, and for each corner whether it is a new vertex, a neighbor
// on the boundary or (rarely) some other vertex. FORMAT.md section 4.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/mesh.h"
#include "base/result.h"
#include "geomcodec/range_coder.h"
#include "geomcodec/table_coder.h"
#include "geomcodec/topology.h"

namespace pac::geomcodec {

// What the encoder knows about where the faces came from.
struct WalkOrder {
  std::vector<uint32_t> face;          // per coded face: its number in the mesh
  std::vector<uint32_t> first_corner;  // per coded face: which of its corners comes first, 0 .. count - 1
  std::vector<uint32_t> vertex;        // per coded vertex: its number in the mesh; used ones only
};

// Walks the faces of a mesh that is already checked, coding as it goes: adaptively, by tables or in both ways, the walk
// being the same. What is not asked for is empty. degenerate: per face, whether it is left out (degenerate_faces.h);
// empty if none is. expected: of contexts that no table is told of, faces or nothing.
struct CodedConnectivity {
  Topology topology;
  WalkOrder order;
  std::vector<uint8_t> adaptive_bytes, table_bytes;
};
CodedConnectivity encode_connectivity(std::span<const uint32_t> indices, std::span<const Face> faces,
                                      std::span<const uint8_t> degenerate, uint32_t n_vertices, bool adaptively,
                                      bool by_tables, Expected expected);

// How often each symbol occurs in each context of the walk by tables, for training: [context][symbol].
std::vector<SymbolCounts> count_walk_symbols(std::span<const uint32_t> indices, std::span<const Face> faces,
                                             uint32_t n_vertices);

struct ConnectivityHeader {
  uint32_t n_vertices = 0, n_faces = 0, n_corners = 0;  // vertices: those that faces use
};
// Arrays grow as faces are read, from what a stream of so many bytes usually holds, never past the header's counts.
// byte_offset of failures counts from bytes.data().
Result<Topology> decode_connectivity(std::span<const uint8_t> bytes, const ConnectivityHeader& header, bool by_tables,
                                     Expected expected, uint64_t stream_bytes);

}  // namespace pac::geomcodec
