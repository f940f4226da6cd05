// Which coded vertices a vertex is predicted from. Vertices are coded in their order, with all faces known: a vertex
// may use whatever lies around it and has a lower number. FORMAT.md section 5.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "geomcodec/topology.h"

namespace pac::geomcodec {

struct Stencil {
  static constexpr int kMax = 12;  // of each list; the first ones met

  // Predictions side_1 + side_2 - opposite: the fourth corner of a parallelogram [Touma, Gotsman 1998], inside a
  // polygon or across the edge of a triangle.
  struct Parallelogram {
    uint32_t side_1, side_2, opposite;
  };
  Parallelogram parallelogram[kMax];
  int n_parallelograms = 0;
  // Vertices that share an edge with this one (twice if two faces share it).
  uint32_t neighbor[kMax];
  int n_neighbors = 0;

  void add(uint32_t side_1, uint32_t side_2, uint32_t opposite) {
    if (n_parallelograms < kMax) parallelogram[n_parallelograms++] = {side_1, side_2, opposite};
  }
  void add_neighbor(uint32_t vertex) {
    if (n_neighbors < kMax) neighbor[n_neighbors++] = vertex;
  }
};

// The corners around each vertex, and the stencils that follow from them.
class Stencils {
 public:
  explicit Stencils(const Topology& topology);
  // vertex < topology.n_vertices.
  Stencil at(uint32_t vertex) const;

 private:
  void add_corner(uint32_t vertex, uint32_t corner, Stencil& stencil) const;
  void add_extension(uint32_t vertex, uint32_t corner, Stencil& stencil) const;

  const Topology& topology_;
  std::vector<uint32_t> first_;   // n_vertices + 1: vertex v has around_[first_[v]] .. around_[first_[v + 1] - 1]
  std::vector<uint32_t> around_;  // corners, in their order
};

}  // namespace pac::geomcodec
