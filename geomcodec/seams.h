// Points and vertices. The walk goes over points: positions, each coded once, however many vertices share it. Where
// normals, texture coordinates or colors differ between the faces at a point it has several vertices; this code tells
// which one each corner uses. FORMAT.md section 5.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "geomcodec/geomcodec.h"
#include "geomcodec/topology.h"

namespace pac::geomcodec {

// Vertices of equal position are one point; points are numbered by first appearance.
struct Points {
  std::vector<uint32_t> of_vertex;
  uint32_t count = 0;
};
Points find_points(std::span<const QuantizedVertex> vertices);

// Which vertices the corners of a walked mesh use. Vertices are numbered by first appearance.
struct Seams {
  std::vector<uint32_t> corner_vertex;  // per corner; empty where every point has one vertex: then it is that
  std::vector<uint32_t> vertex_point;   // per vertex: its point
  std::vector<uint32_t> sibling;        // per vertex: the one before it at the same point, or kNone

  uint32_t n_vertices() const { return static_cast<uint32_t>(vertex_point.size()); }
};

struct CodedSeams {
  Seams seams;
  std::vector<uint32_t> mesh_vertex;  // per coded vertex: its number in the mesh
  std::vector<uint8_t> bytes;         // empty if every point has one vertex
};
// points: the walked topology, whose corner_vertex are points; mesh_corner_vertex: the mesh's vertex of each of its
// corners.
CodedSeams encode_seams(const Topology& points, std::span<const uint32_t> mesh_corner_vertex, uint32_t n_mesh_vertices);
Result<Seams> decode_seams(std::span<const uint8_t> bytes, const Topology& points, uint32_t n_vertices);

// The mesh as its attributes see it: vertices instead of points, edges that are seams without twins.
Topology cut_at_seams(const Topology& points, const Seams& seams);

}  // namespace pac::geomcodec
