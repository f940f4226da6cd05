// Material numbers of faces, and the permutations that restore the order of the original mesh. FORMAT.md sections 7, 8.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "geomcodec/connectivity.h"
#include "geomcodec/topology.h"

namespace pac::geomcodec {

// material: per coded face. Empty bytes if all are 0.
std::vector<uint8_t> encode_materials(const Topology& topology, std::span<const uint32_t> material);
// Every number of the result is <= highest.
Result<std::vector<uint32_t>> decode_materials(std::span<const uint8_t> bytes, const Topology& topology,
                                               uint32_t highest);

// order.vertex here has all vertices, isolated ones last.
std::vector<uint8_t> encode_order(const Topology& topology, const WalkOrder& order);
// The result's vertex and face are permutations, first_corner[f] < size of face f.
Result<WalkOrder> decode_order(std::span<const uint8_t> bytes, const Topology& topology, uint32_t n_vertices);

}  // namespace pac::geomcodec
