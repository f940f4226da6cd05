// The encoder's mesh as the walk over its faces asks for it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/mesh.h"
#include "geomcodec/connectivity.h"

namespace pac::geomcodec {

// The faces of the encoder's mesh by directed edge.
class EdgeIndex {
 public:
  // left_out: per face, whether it is as good as taken from the start; empty if none is. It must outlive the index.
  EdgeIndex(std::span<const uint32_t> indices, std::span<const Face> faces, std::span<const uint8_t> left_out,
            uint32_t n_vertices);
  // A face that is not taken and has an edge from -> to: the lowest one. Its number and the corner at `from`.
  bool find(uint32_t from, uint32_t to, uint32_t& face, uint32_t& corner);
  // The lowest face that is not taken; there must be one.
  uint32_t lowest_free() {
    while (taken_[lowest_free_] != 0) ++lowest_free_;
    return lowest_free_;
  }
  void take(uint32_t face) { taken_[face] = 1; }
  void restart();  // as before any face was taken

 private:
  struct Edge {
    uint32_t to, face, corner;
    bool operator<(const Edge& o) const {
      if (to != o.to) return to < o.to;
      return face != o.face ? face < o.face : corner < o.corner;
    }
  };
  std::vector<uint32_t> first_;  // per vertex: its edges are edges_[first_[v]] .. edges_[first_[v + 1] - 1], sorted
  std::vector<Edge> edges_;
  std::vector<uint32_t> free_offset_;  // at the first edge of each run of equal (from, to): edges known to be taken
  std::span<const uint8_t> left_out_;
  std::vector<uint8_t> taken_;
  uint32_t lowest_free_ = 0;
};

// What only the encoder has: its mesh, and how far it is coded.
struct WalkSource {
  WalkSource(std::span<const uint32_t> mesh_indices, std::span<const Face> mesh_faces,
             std::span<const uint8_t> left_out, uint32_t n_vertices)
      : indices(mesh_indices),
        faces(mesh_faces),
        edges(mesh_indices, mesh_faces, left_out, n_vertices),
        coded_vertex(n_vertices, kNone) {
    order.vertex.reserve(n_vertices);
    order.face.reserve(mesh_faces.size());
    order.first_corner.reserve(mesh_faces.size());
  }
  void restart();  // for a second walk
  std::span<const uint32_t> indices;
  std::span<const Face> faces;
  EdgeIndex edges;
  std::vector<uint32_t> coded_vertex;  // per mesh vertex: its coded number, or kNone
  WalkOrder order;
  uint32_t face = 0, first_corner = 0;  // the face being coded

  uint32_t mesh_vertex(uint32_t k) const {
    const Face& f = faces[face];
    return indices[f.first + (first_corner + k) % f.count];
  }
};

}  // namespace pac::geomcodec
