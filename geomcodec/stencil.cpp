#include "geomcodec/stencil.h"

namespace pac::geomcodec {

Stencils::Stencils(const Topology& topology) : topology_(topology), first_(size_t{topology.n_vertices} + 1) {
  for (const uint32_t vertex : topology.corner_vertex) ++first_[vertex + 1];
  for (size_t v = 0; v < topology.n_vertices; ++v) first_[v + 1] += first_[v];
  around_.resize(topology.n_corners());
  std::vector<uint32_t> end(first_.begin(), first_.end() - 1);
  for (uint32_t corner = 0; corner < topology.n_corners(); ++corner)
    around_[end[topology.corner_vertex[corner]]++] = corner;
}

Stencil Stencils::at(uint32_t vertex) const {
  Stencil stencil;
  const uint32_t begin = first_[vertex], end = first_[vertex + 1];
  for (uint32_t i = begin; i < end && stencil.n_neighbors < Stencil::kMax; ++i) add_corner(vertex, around_[i], stencil);
  if (stencil.n_parallelograms == 0)
    for (uint32_t i = begin; i < end && i < begin + Stencil::kMax; ++i) add_extension(vertex, around_[i], stencil);
  return stencil;
}

// What the face of one corner at `vertex` offers.
void Stencils::add_corner(uint32_t vertex, uint32_t corner, Stencil& stencil) const {
  const uint32_t next = topology_.next(corner), previous = topology_.previous(corner);
  const uint32_t a = topology_.corner_vertex[next], b = topology_.corner_vertex[previous];
  if (a < vertex) stencil.add_neighbor(a);
  if (b < vertex) stencil.add_neighbor(b);
  if (a >= vertex || b >= vertex) return;
  const uint32_t size = topology_.face_size(topology_.corner_face[corner]);
  if (size == 3) {
    const uint32_t across = topology_.twin[next];
    if (across == kNone) return;
    const uint32_t opposite = topology_.corner_vertex[topology_.previous(across)];
    if (opposite < vertex) stencil.add(a, b, opposite);
  } else {
    const uint32_t opposite = topology_.corner_vertex[topology_.next(next)];
    if (opposite < vertex) stencil.add(a, b, opposite);
  }
}

// Where no parallelogram is: a polygon's side continues the side of the polygon it grew from, v = a + (a - behind a).
void Stencils::add_extension(uint32_t vertex, uint32_t corner, Stencil& stencil) const {
  const uint32_t next = topology_.next(corner), previous = topology_.previous(corner);
  const uint32_t a = topology_.corner_vertex[next], b = topology_.corner_vertex[previous];
  if (a < vertex && topology_.twin[next] != kNone) {
    // The twin runs back to a; the corner after it leaves a.
    const uint32_t behind = topology_.corner_vertex[topology_.next(topology_.next(topology_.twin[next]))];
    if (behind < vertex) stencil.add(a, a, behind);
  }
  const uint32_t before = topology_.previous(previous);
  if (b < vertex && topology_.twin[before] != kNone) {
    const uint32_t behind = topology_.corner_vertex[topology_.previous(topology_.twin[before])];
    if (behind < vertex) stencil.add(b, b, behind);
  }
}

}  // namespace pac::geomcodec
