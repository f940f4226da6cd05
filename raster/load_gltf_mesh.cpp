// Primitives [glTF 2.0 s.3.7.2] to faces: triangles, strips and fans.
#include <algorithm>
#include <cmath>

#include "base/exact_math.h"
#include "raster/load_gltf_scene.h"

namespace pac::raster {
namespace {

constexpr uint64_t kTriangles = 4, kStrip = 5, kFan = 6;

uint8_t encoded_byte(double linear, double scale) {
  return static_cast<uint8_t>(scale * 255 * srgb_from_linear(std::clamp(linear, 0.0, 1.0)) + 0.5);
}

// Transpose of the inverse, times |determinant|; false where the mesh is mirrored, so that corners change their order.
bool normal_columns(const Affine& a, double out[3][3]) {
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) {
      const int r1 = (row + 1) % 3, r2 = (row + 2) % 3, c1 = (column + 1) % 3, c2 = (column + 2) % 3;
      out[column][row] = a.m[c1][r1] * a.m[c2][r2] - a.m[c2][r1] * a.m[c1][r2];
    }
  const double determinant = (a.m[0][0] * out[0][0] + a.m[1][0] * out[1][0]) + a.m[2][0] * out[2][0];
  if (determinant >= 0) return true;
  for (int i = 0; i < 9; ++i) out[i / 3][i % 3] = -out[i / 3][i % 3];
  return false;
}

struct Attributes {
  GltfFloats position, normal, texcoord, color;
};

Result<void> read_attribute(const GltfFile& file, const Json& primitive, const std::string& name, size_t least,
                            size_t most, const Limits& limits, GltfFloats& out) {
  const Json attributes = primitive["attributes"];
  PAC_TRY(const uint32_t number, get_index(file, attributes, name, file.accessors.size()));
  if (number == kNoIndex) return {};
  PAC_TRY(out, read_floats(file, number, least, most, limits));
  return {};
}

Result<Attributes> read_attributes(const GltfFile& file, const Json& primitive, const GltfMaterial& material,
                                   const Limits& limits) {
  Attributes a;
  PAC_CHECK(read_attribute(file, primitive, "POSITION", 3, 3, limits, a.position));
  PAC_CHECK(read_attribute(file, primitive, "NORMAL", 3, 3, limits, a.normal));
  PAC_CHECK(read_attribute(file, primitive, "COLOR_0", 3, 4, limits, a.color));
  if (material.material.texture >= 0)
    PAC_CHECK(
        read_attribute(file, primitive, "TEXCOORD_" + std::to_string(material.texcoord_set), 2, 2, limits, a.texcoord));
  for (const GltfFloats* other : {&a.normal, &a.texcoord, &a.color})
    if (other->width > 0 && other->count < a.position.count)
      return file.failure(Error::corrupt, primitive, "attributes of a primitive have different counts");
  return a;
}

void append_vertices(const Attributes& a, const Affine& world, const double normals[3][3], const GltfMaterial& material,
                     Mesh& mesh) {
  for (size_t i = 0; i < a.position.count; ++i) {
    Vertex vertex;
    const float* p = a.position.values.data() + 3 * i;
    for (int row = 0; row < 3; ++row)
      vertex.position[row] = static_cast<float>(
          ((world.m[0][row] * p[0] + world.m[1][row] * p[1]) + world.m[2][row] * p[2]) + world.m[3][row]);
    if (a.normal.width > 0) {
      const float* n = a.normal.values.data() + 3 * i;
      double turned[3], square = 0;
      for (int row = 0; row < 3; ++row) {
        turned[row] = (normals[0][row] * n[0] + normals[1][row] * n[1]) + normals[2][row] * n[2];
        square += turned[row] * turned[row];
      }
      const double length = std::sqrt(square);
      for (int row = 0; row < 3; ++row)
        vertex.normal[row] = length > 0 && std::isfinite(length) ? static_cast<float>(turned[row] / length) : 0.0f;
    }
    for (size_t k = 0; k < 2 && a.texcoord.width > 0; ++k) {
      const double* row = material.texcoord_map[k];
      const float* t = a.texcoord.values.data() + 2 * i;
      vertex.texcoord[k] = static_cast<float>((row[0] * t[0] + row[1] * t[1]) + row[2]);
    }
    for (size_t c = 0; c < 3; ++c) {
      const double scale = material.material.lit ? 1.0 : double{material.base_color[c]};
      const double linear = a.color.width > 0 ? double{a.color.values[a.color.width * i + c]} : 1.0;
      vertex.color[c] = encoded_byte(linear, scale);
    }
    if (a.color.width == 4)
      vertex.color[3] = static_cast<uint8_t>(std::clamp(double{a.color.values[4 * i + 3]}, 0.0, 1.0) * 255 + 0.5);
    mesh.vertices.push_back(vertex);
  }
}

// Corners of triangle i of a primitive [s.3.7.2.1, figure of the topologies].
void corners_of(uint64_t mode, size_t i, size_t out[3]) {
  if (mode == kTriangles) {
    for (size_t k = 0; k < 3; ++k) out[k] = 3 * i + k;
  } else if (mode == kStrip) {
    out[0] = i;
    out[1] = i + 1 + i % 2;
    out[2] = i + 2 - i % 2;
  } else {
    out[0] = i + 1;
    out[1] = i + 2;
    out[2] = 0;
  }
}

Result<void> add_primitive(const GltfFile& file, const Json& primitive, const Affine& world,
                           const std::vector<GltfMaterial>& materials, const Limits& limits, LoadedScene& loaded) {
  PAC_TRY(const uint32_t positions, get_index(file, primitive["attributes"], "POSITION", file.accessors.size()));
  if (primitive["extensions"]["KHR_draco_mesh_compression"].exists() &&
      (positions == kNoIndex || !file.accessors[positions]["bufferView"].exists()))
    return file.failure(Error::unsupported, primitive, "mesh is compressed by KHR_draco_mesh_compression");
  PAC_TRY(const uint64_t mode, get_integer(file, primitive, "mode", kTriangles));
  if (mode > kFan) return file.failure(Error::corrupt, primitive, "unknown mode of a primitive");
  if (mode < kTriangles) {
    loaded.warnings.push_back({"points and lines are not drawn", "", file.json_offset + primitive.offset()});
    return {};
  }
  if (primitive["targets"].exists())
    loaded.warnings.push_back({"morph targets are not applied", "", file.json_offset + primitive.offset()});
  PAC_TRY(uint32_t material, get_index(file, primitive, "material", file.materials.size()));
  if (material == kNoIndex) material = static_cast<uint32_t>(file.materials.size());
  PAC_TRY(const Attributes attributes, read_attributes(file, primitive, materials[material], limits));
  PAC_TRY(const uint32_t index_accessor, get_index(file, primitive, "indices", file.accessors.size()));
  std::vector<uint32_t> indices;
  if (index_accessor != kNoIndex) {
    PAC_TRY(indices, read_indices(file, index_accessor, limits));
  }
  const size_t n_corners = index_accessor != kNoIndex ? indices.size() : attributes.position.count;
  const size_t n_triangles = mode == kTriangles ? n_corners / 3 : n_corners < 3 ? 0 : n_corners - 2;
  Mesh& mesh = loaded.scene.mesh;
  if (n_triangles > limits.max_triangles - std::min<uint64_t>(limits.max_triangles, mesh.faces.size()) ||
      attributes.position.count > limits.max_bytes / sizeof(Vertex) - mesh.vertices.size())
    return file.failure(Error::limit_exceeded, primitive, "more triangles or vertices than the limit");
  for (const uint32_t index : indices)
    if (index >= attributes.position.count)
      return file.failure(Error::corrupt, file.accessors[index_accessor], "index out of range");

  double normals[3][3];
  const bool upright = normal_columns(world, normals);
  const uint32_t first_vertex = static_cast<uint32_t>(mesh.vertices.size());
  append_vertices(attributes, world, normals, materials[material], mesh);
  for (size_t i = 0; i < n_triangles; ++i) {
    size_t corners[3];
    corners_of(mode, i, corners);
    if (!upright) std::swap(corners[1], corners[2]);
    mesh.faces.push_back({static_cast<uint32_t>(mesh.indices.size()), 3, material});
    for (const size_t corner : corners)
      mesh.indices.push_back(first_vertex +
                             (index_accessor != kNoIndex ? indices[corner] : static_cast<uint32_t>(corner)));
  }
  return {};
}

}  // namespace

Result<void> add_gltf_mesh(const GltfFile& file, uint32_t mesh, const Affine& world_from_mesh,
                           const std::vector<GltfMaterial>& materials, const Limits& limits, LoadedScene& loaded) {
  for (const Json& primitive : file.meshes[mesh]["primitives"].elements())
    PAC_CHECK(add_primitive(file, primitive, world_from_mesh, materials, limits, loaded));
  return {};
}

}  // namespace pac::raster
