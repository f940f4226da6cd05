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
  // plus_1 + plus_2 - minus_1 - minus_2: by how much a parallelogram beside the one used missed.
  struct Twist {
    uint32_t plus_1, plus_2, minus_1, minus_2;
  };
  Parallelogram parallelogram[kMax];
  Twist twist[kMax];
  // Vertices that share an edge with this one (twice if two faces share it); one more is written before it is dropped.
  uint32_t neighbor[kMax + 1];
  int n_parallelograms = 0, n_twists = 0, n_neighbors = 0;
  bool extended = false;  // no parallelogram: the list holds straight continuations, side + side - opposite
  int n_corners = 0;      // faces around the vertex, at most kMax

  void clear() {
    n_parallelograms = n_twists = n_neighbors = n_corners = 0;
    extended = false;
  }
  void add(uint32_t side_1, uint32_t side_2, uint32_t opposite) {
    if (n_parallelograms < kMax) parallelogram[n_parallelograms++] = {side_1, side_2, opposite};
  }
  void add_twist(uint32_t plus_1, uint32_t plus_2, uint32_t minus_1, uint32_t minus_2) {
    if (n_twists < kMax) twist[n_twists++] = {plus_1, plus_2, minus_1, minus_2};
  }
  void add_neighbor(uint32_t vertex) {
    if (n_neighbors < kMax) neighbor[n_neighbors++] = vertex;
  }
};

// The corners around each vertex, and the stencils that follow from them.
class Stencils {
 public:
  explicit Stencils(const Topology& topology);
  // Empty for vertices that no face uses; twists only if wanted.
  void get(uint32_t vertex, bool with_twists, Stencil& stencil) const;
  uint32_t n_vertices() const { return static_cast<uint32_t>(first_.size()) - 1; }
  // Corners at `vertex`, in their order, but those of degenerate faces.
  const uint32_t* begin(uint32_t vertex) const { return around_.data() + first_[vertex]; }
  const uint32_t* end(uint32_t vertex) const { return around_.data() + first_[vertex + 1]; }

 private:
  void collect_triangles(uint32_t vertex, bool with_twists, Stencil& stencil) const;
  void collect_quads(uint32_t vertex, Stencil& stencil) const;
  void add_corner(uint32_t vertex, uint32_t corner, bool with_twists, Stencil& stencil) const;
  void add_extension(uint32_t vertex, uint32_t corner, Stencil& stencil) const;
  uint32_t tip_across(uint32_t vertex, uint32_t edge) const;
  void add_quad_twist(uint32_t vertex, uint32_t edge, bool entering, Stencil& stencil) const;

  const Topology& topology_;
  std::vector<uint32_t> first_;   // n_vertices + 1: vertex v has around_[first_[v]] .. around_[first_[v + 1] - 1]
  std::vector<uint32_t> around_;  // corners, in their order
};

}  // namespace pac::geomcodec
