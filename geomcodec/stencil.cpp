#include "geomcodec/stencil.h"

#include <algorithm>

namespace pac::geomcodec {

Stencils::Stencils(const Topology& topology) : topology_(topology), first_(size_t{topology.n_vertices} + 1) {
  const uint32_t n_corners = topology.n_corners() - topology.n_degenerate_corners;
  for (uint32_t corner = 0; corner < n_corners; ++corner) ++first_[topology.corner_vertex[corner] + 1];
  for (size_t v = 0; v < topology.n_vertices; ++v) first_[v + 1] += first_[v];
  around_.resize(n_corners);
  std::vector<uint32_t> end(first_.begin(), first_.end() - 1);
  for (uint32_t corner = 0; corner < n_corners; ++corner) around_[end[topology.corner_vertex[corner]]++] = corner;
}

namespace {

// Corners of a mesh of triangles only: face f has corners 3f .. 3f + 2.
struct TriangleCorners {
  uint32_t next, previous;
  explicit TriangleCorners(uint32_t corner) {
    const uint32_t place = corner % 3;
    next = place == 2 ? corner - 2 : corner + 1;
    previous = place == 0 ? corner + 2 : corner - 1;
  }
};

}  // namespace

// The loop over add_corner() where every face is a triangle. Whether a vertex is known is as good as random: entries
// are written whatever the answers are and counted by them, where branches would be mispredicted. Counts are held here,
// since stores of vertices might change the stencil's own. At most 13 neighbors come before the loop ends, and each
// other entry needs two of them.
void Stencils::collect_triangles(uint32_t vertex, bool with_twists, Stencil& stencil) const {
  const uint32_t* corner_vertex = topology_.corner_vertex.data();
  const uint32_t* twin = topology_.twin.data();
  const auto or_else = [](uint32_t corner, uint32_t other) { return corner == kNone ? other : corner; };
  const uint32_t *at = begin(vertex), *last = end(vertex);
  int n_neighbors = 0, n_parallelograms = 0, n_twists = 0;
  for (; at != last && n_neighbors < Stencil::kMax; ++at) {
    const TriangleCorners here(*at);
    const uint32_t a = corner_vertex[here.next], b = corner_vertex[here.previous];
    stencil.neighbor[n_neighbors] = a;
    n_neighbors += a < vertex ? 1 : 0;
    stencil.neighbor[n_neighbors] = b;
    n_neighbors += b < vertex ? 1 : 0;
    if (std::max(a, b) >= vertex) continue;

    // Where no triangle is across, this one stands in, whose third corner is `vertex` itself: not known.
    const TriangleCorners there(or_else(twin[here.next], here.next));
    const uint32_t opposite = corner_vertex[there.previous];
    stencil.parallelogram[n_parallelograms] = {a, b, opposite};
    n_parallelograms += opposite < vertex ? 1 : 0;
    if (!with_twists) continue;
    const uint32_t left = twin[there.next], right = twin[there.previous];
    const uint32_t left_tip = corner_vertex[TriangleCorners(or_else(left, *at)).previous];
    const uint32_t right_tip = corner_vertex[TriangleCorners(or_else(right, *at)).previous];
    stencil.twist[n_twists] = {left_tip, right_tip, opposite, opposite};
    const bool known = std::max({opposite, left_tip, right_tip}) < vertex;
    n_twists += static_cast<int>(known & (left != kNone) & (right != kNone));
  }
  stencil.n_neighbors = std::min(n_neighbors, Stencil::kMax);
  stencil.n_parallelograms = n_parallelograms;
  stencil.n_twists = n_twists;
}

// The same where every face is a quadrilateral, without twists.
void Stencils::collect_quads(uint32_t vertex, Stencil& stencil) const {
  const uint32_t* corner_vertex = topology_.corner_vertex.data();
  const uint32_t *at = begin(vertex), *last = end(vertex);
  int n_neighbors = 0, n_parallelograms = 0;
  for (; at != last && n_neighbors < Stencil::kMax; ++at) {
    const uint32_t* face = corner_vertex + (*at & ~3u);
    const uint32_t a = face[(*at + 1) & 3], b = face[(*at + 3) & 3], opposite = face[(*at + 2) & 3];
    stencil.neighbor[n_neighbors] = a;
    n_neighbors += a < vertex ? 1 : 0;
    stencil.neighbor[n_neighbors] = b;
    n_neighbors += b < vertex ? 1 : 0;
    stencil.parallelogram[n_parallelograms] = {a, b, opposite};
    n_parallelograms += std::max({a, b, opposite}) < vertex ? 1 : 0;
  }
  stencil.n_neighbors = std::min(n_neighbors, Stencil::kMax);
  stencil.n_parallelograms = n_parallelograms;
}

void Stencils::get(uint32_t vertex, bool with_twists, Stencil& stencil) const {
  stencil.clear();
  if (vertex >= topology_.n_vertices) return;
  const uint32_t *first = begin(vertex), *last = end(vertex);
  const auto n_corners = std::min<size_t>(static_cast<size_t>(last - first), Stencil::kMax);
  stencil.n_corners = static_cast<int>(n_corners);
  if (topology_.all_triangles)
    collect_triangles(vertex, with_twists, stencil);
  else if (topology_.all_quads && !with_twists)
    collect_quads(vertex, stencil);
  else
    for (const uint32_t* corner = first; corner != last && stencil.n_neighbors < Stencil::kMax; ++corner)
      add_corner(vertex, *corner, with_twists, stencil);
  if (stencil.n_parallelograms > 0) return;
  for (size_t i = 0; i < n_corners; ++i) add_extension(vertex, first[i], stencil);
  stencil.extended = stencil.n_parallelograms > 0;
}

// What the face of one corner at `vertex` offers.
void Stencils::add_corner(uint32_t vertex, uint32_t corner, bool with_twists, Stencil& stencil) const {
  const uint32_t face = topology_.face_at(corner);
  const uint32_t first = topology_.face_first[face], end = topology_.face_first[face + 1], size = end - first;
  const auto after = [&](uint32_t here) { return here + 1 < end ? here + 1 : first; };
  const uint32_t next = after(corner), previous = corner > first ? corner - 1 : end - 1;
  const uint32_t a = topology_.corner_vertex[next], b = topology_.corner_vertex[previous];
  if (a < vertex) stencil.add_neighbor(a);
  if (b < vertex) stencil.add_neighbor(b);
  if (a >= vertex || b >= vertex) return;
  if (size == 3) {
    const uint32_t across = topology_.twin[next];
    if (across == kNone) return;
    const uint32_t opposite = topology_.corner_vertex[topology_.previous(across)];
    if (opposite >= vertex) return;
    stencil.add(a, b, opposite);
    if (!with_twists || topology_.size_of_face_at(across) != 3) return;
    // The triangles beyond the other two edges of the one across: how far their tips are from parallelograms.
    const uint32_t left = tip_across(vertex, topology_.next(across));
    const uint32_t right = tip_across(vertex, topology_.previous(across));
    if (left != kNone && right != kNone) stencil.add_twist(left, right, opposite, opposite);
  } else {
    const uint32_t edge = after(next);
    const uint32_t opposite = topology_.corner_vertex[edge];
    if (opposite >= vertex) return;
    stencil.add(a, b, opposite);
    if (!with_twists || size != 4) return;
    add_quad_twist(vertex, next, false, stencil);
    add_quad_twist(vertex, edge, true, stencil);
  }
}

// The tip of the triangle across an edge, if it is known; else kNone.
uint32_t Stencils::tip_across(uint32_t vertex, uint32_t edge) const {
  const uint32_t across = topology_.twin[edge];
  if (across == kNone || topology_.size_of_face_at(across) != 3) return kNone;
  const uint32_t tip = topology_.corner_vertex[topology_.previous(across)];
  return tip < vertex ? tip : kNone;
}

// The quad across an edge from -> to of the quad that holds `vertex`, one of the ends being the corner opposite to
// `vertex`; entering: `from` is. Its alternating sum, signed as the vertex's own quad has it.
void Stencils::add_quad_twist(uint32_t vertex, uint32_t edge, bool entering, Stencil& stencil) const {
  const uint32_t across = topology_.twin[edge];
  if (across == kNone || topology_.size_of_face_at(across) != 4) return;
  const uint32_t near_from = topology_.corner_vertex[edge], near_to = topology_.corner_vertex[across];
  const uint32_t beyond_from = topology_.corner_vertex[topology_.next(topology_.next(across))];
  const uint32_t beyond_to = topology_.corner_vertex[topology_.previous(across)];
  if (beyond_from >= vertex || beyond_to >= vertex) return;
  if (entering)
    stencil.add_twist(near_to, beyond_from, near_from, beyond_to);
  else
    stencil.add_twist(near_from, beyond_to, near_to, beyond_from);
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
