// Polygon meshes as raster/, geomcodec/ and sim/ exchange them. Plain data; no invariants beyond validate().
#pragma once

#include <cstdint>
#include <vector>

#include "base/result.h"

namespace pac {

// One corner. Color is display-referred (sRGB-encoded) RGBA; see raster/README.md for what it means under lighting.
struct Vertex {
  float position[3] = {0, 0, 0};
  float normal[3] = {0, 0, 0};  // unit length where lighting is wanted; (0,0,0) = none
  float texcoord[2] = {0, 0};   // (0,0) = first row, first column of the texture image; v grows downwards
  uint8_t color[4] = {255, 255, 255, 255};
};

// A planar (or nearly so) simple polygon: corners indices[first .. first + count), counter-clockwise seen from its
// front.
struct Face {
  uint32_t first = 0;
  uint32_t count = 0;     // >= 3
  uint32_t material = 0;  // index into the scene's materials
};

struct Mesh {
  std::vector<Vertex> vertices;
  std::vector<uint32_t> indices;  // into vertices
  std::vector<Face> faces;

  // Triangles after every polygon with n corners is cut into n - 2.
  uint64_t triangle_count() const {
    uint64_t count = 0;
    for (const Face& face : faces) count += face.count >= 3 ? face.count - 2 : 0;
    return count;
  }
};

// Every face lies inside `indices` and has >= 3 corners, every index inside `vertices`, every material < n_materials,
// and the triangle count is within limits. Failure::byte_offset is the number of the offending face.
inline Result<void> validate(const Mesh& mesh, uint32_t n_materials, const Limits& limits = {}) {
  for (size_t i = 0; i < mesh.faces.size(); ++i) {
    const Face& face = mesh.faces[i];
    if (face.count < 3) return Failure{Error::corrupt, i, "face with fewer than three corners"};
    if (face.first > mesh.indices.size() || face.count > mesh.indices.size() - face.first)
      return Failure{Error::corrupt, i, "face reaches outside the index list"};
    if (face.material >= n_materials) return Failure{Error::corrupt, i, "face names a material that does not exist"};
    for (uint32_t k = 0; k < face.count; ++k)
      if (mesh.indices[face.first + k] >= mesh.vertices.size())
        return Failure{Error::corrupt, i, "face names a vertex that does not exist"};
  }
  if (mesh.triangle_count() > limits.max_triangles)
    return Failure{Error::limit_exceeded, 0, "mesh has more triangles than the limit"};
  return {};
}

}  // namespace pac
