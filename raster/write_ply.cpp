#include <algorithm>
#include <bit>
#include <string>

#include "raster/load_ply.h"

namespace pac::raster {
namespace {

void put(std::vector<uint8_t>& out, const std::string& text) {
  out.insert(out.end(), text.begin(), text.end());
}
void put_u32(std::vector<uint8_t>& out, uint32_t value) {
  for (int shift = 0; shift < 32; shift += 8) out.push_back(static_cast<uint8_t>(value >> shift));
}
void put_float(std::vector<uint8_t>& out, float value) {
  put_u32(out, std::bit_cast<uint32_t>(value));
}

// Which optional properties the mesh needs.
struct Content {
  bool normals = false, texcoords = false, materials = false, long_faces = false;

  explicit Content(const Mesh& mesh) {
    for (const Vertex& vertex : mesh.vertices) {
      normals = normals || vertex.normal[0] != 0 || vertex.normal[1] != 0 || vertex.normal[2] != 0;
      texcoords = texcoords || vertex.texcoord[0] != 0 || vertex.texcoord[1] != 0;
    }
    for (const Face& face : mesh.faces) {
      materials = materials || face.material != 0;
      long_faces = long_faces || face.count > 255;
    }
  }
};

std::string header_of(const Mesh& mesh, const Content& content) {
  std::string header = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(mesh.vertices.size()) +
                       "\nproperty float x\nproperty float y\nproperty float z\n";
  if (content.normals) header += "property float nx\nproperty float ny\nproperty float nz\n";
  if (content.texcoords) header += "property float s\nproperty float t\n";
  header += "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n";
  header += "element face " + std::to_string(mesh.faces.size()) + "\n";
  header +=
      content.long_faces ? "property list uint uint vertex_indices\n" : "property list uchar uint vertex_indices\n";
  if (content.materials) header += "property uint material_index\n";
  return header + "end_header\n";
}

}  // namespace

std::vector<uint8_t> write_ply(const Mesh& mesh) {
  const Content content(mesh);
  std::vector<uint8_t> out;
  put(out, header_of(mesh, content));
  for (const Vertex& vertex : mesh.vertices) {
    for (const float coordinate : vertex.position) put_float(out, coordinate);
    for (int axis = 0; axis < 3 && content.normals; ++axis) put_float(out, vertex.normal[axis]);
    if (content.texcoords) {
      put_float(out, vertex.texcoord[0]);
      put_float(out, 1.0f - vertex.texcoord[1]);  // PLY's t grows upwards
    }
    out.insert(out.end(), vertex.color, vertex.color + 4);
  }
  for (const Face& face : mesh.faces) {
    if (content.long_faces)
      put_u32(out, face.count);
    else
      out.push_back(static_cast<uint8_t>(face.count));
    for (uint32_t k = 0; k < face.count; ++k) put_u32(out, mesh.indices[face.first + k]);
    if (content.materials) put_u32(out, face.material);
  }
  return out;
}

}  // namespace pac::raster
