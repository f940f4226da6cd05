// The faces of a mesh as coded: polygons over vertices that are numbered by first appearance, and which edges they
// share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pac::geomcodec {

inline constexpr uint32_t kNone = 0xFFFFFFFFu;  // no corner, no vertex
inline constexpr uint32_t kOpen = 0xFFFFFFFEu;  // while walking: an edge that may still find its other face

// Corner c of a face stands for the directed edge from its vertex to that of the next corner of the face.
struct Topology {
  std::vector<uint32_t> face_first = {0};  // n_faces + 1: face f has corners face_first[f] .. face_first[f + 1] - 1
  std::vector<uint32_t> corner_vertex;
  std::vector<uint32_t> corner_face;  // empty with all_triangles: use face_at()
  std::vector<uint32_t> twin;         // the corner whose edge joins the same vertices the other way round, or kNone
  uint32_t n_vertices = 0;            // those that faces use
  uint32_t n_degenerate_corners =
      0;  // the last ones, of degenerate faces (degenerate_faces.h): stencils do not see them
  // Parts of as many points as one before are expected where that is, moved (PositionParts).
  bool parts_repeat_by_size = false;
  // Every face has three corners, or four: then numbers alone tell which corners follow.
  bool all_triangles = false, all_quads = false;

  uint32_t n_faces() const { return static_cast<uint32_t>(face_first.size()) - 1; }
  uint32_t n_corners() const { return static_cast<uint32_t>(corner_vertex.size()); }
  uint32_t face_size(uint32_t face) const { return face_first[face + 1] - face_first[face]; }
  uint32_t face_at(uint32_t corner) const { return all_triangles ? corner / 3 : corner_face[corner]; }
  uint32_t size_of_face_at(uint32_t corner) const {
    return all_triangles ? 3 : all_quads ? 4 : face_size(corner_face[corner]);
  }
  uint32_t next(uint32_t corner) const {
    if (all_triangles) return corner % 3 == 2 ? corner - 2 : corner + 1;
    if (all_quads) return (corner & ~3u) | ((corner + 1) & 3);
    const uint32_t face = corner_face[corner];
    return corner + 1 < face_first[face + 1] ? corner + 1 : face_first[face];
  }
  uint32_t previous(uint32_t corner) const {
    if (all_triangles) return corner % 3 == 0 ? corner + 2 : corner - 1;
    if (all_quads) return (corner & ~3u) | ((corner + 3) & 3);
    const uint32_t face = corner_face[corner];
    return corner > face_first[face] ? corner - 1 : face_first[face + 1] - 1;
  }
};

}  // namespace pac::geomcodec
