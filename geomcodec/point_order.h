// The order in which points are coded where it is not the walk's: points that most parallelograms predict come first,
// so that irregular meshes have more to predict from [Draco's traversal by prediction degree]. FORMAT.md section 17.
#pragma once

#include <cstdint>
#include <vector>

#include "geomcodec/stencil.h"
#include "geomcodec/topology.h"

namespace pac::geomcodec {

// Per point of the walk: its place in that order.
std::vector<uint32_t> rank_points(const Topology& topology, const Stencils& stencils);

// The same mesh, its points numbered by their ranks.
Topology renumbered(const Topology& topology, const std::vector<uint32_t>& rank);

}  // namespace pac::geomcodec
