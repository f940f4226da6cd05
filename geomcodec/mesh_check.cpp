#include "geomcodec/mesh_check.h"

#include <cmath>

#include "geomcodec/container.h"

namespace pac::geomcodec {
namespace {

Result<void> check_vertices(const QuantizedMesh& mesh) {
  if (mesh.normal_bits != 0 && (mesh.normal_bits < 2 || mesh.normal_bits > 16))
    return Failure{Error::bad_argument, 0, "normal bits are not 0 or in 2..16"};
  if (mesh.texcoord_bits < 0 || mesh.texcoord_bits > 16)
    return Failure{Error::bad_argument, 0, "texture coordinate bits are not in 0..16"};
  if (!std::isfinite(mesh.texcoord_origin[0]) || !std::isfinite(mesh.texcoord_origin[1]) ||
      !std::isfinite(mesh.texcoord_step) || !(mesh.texcoord_step > 0))
    return Failure{Error::bad_argument, 0, "grid of the texture is not finite or has no step"};
  const uint32_t highest = (1u << mesh.position_bits) - 1;
  const uint32_t highest_normal = mesh.normal_bits == 0 ? 0 : (1u << mesh.normal_bits) - 2;
  const uint32_t highest_texcoord = (1u << mesh.texcoord_bits) - 1;
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    for (const uint16_t coordinate : mesh.vertices[v].position)
      if (coordinate > highest) return Failure{Error::bad_argument, v, "coordinate above the grid"};
    for (const uint16_t component : mesh.vertices[v].normal)
      if (component > highest_normal) return Failure{Error::bad_argument, v, "normal above its grid"};
    for (const uint16_t component : mesh.vertices[v].texcoord)
      if (component > highest_texcoord) return Failure{Error::bad_argument, v, "texture coordinate above its grid"};
  }
  return {};
}

Result<void> check_face_values(const QuantizedMesh& mesh) {
  const bool none = mesh.face_bits == 0 && mesh.face_components == 0;
  if (!none && (mesh.face_bits < 1 || mesh.face_bits > 16 || mesh.face_components < 1 || mesh.face_components > 4))
    return Failure{Error::bad_argument, 0, "values of faces are not 1..4 of 1..16 bits"};
  if (mesh.face_values.size() != mesh.faces.size() * static_cast<size_t>(mesh.face_components))
    return Failure{Error::bad_argument, 0, "values of faces are not as many as the mesh says"};
  for (size_t i = 0; i < mesh.face_values.size(); ++i)
    if (mesh.face_values[i] >> mesh.face_bits != 0)
      return Failure{Error::bad_argument, i, "value of a face above its bits"};
  return {};
}

}  // namespace

Result<void> check_mesh(const QuantizedMesh& mesh) {
  if (mesh.position_bits < 1 || mesh.position_bits > 16)
    return Failure{Error::bad_argument, 0, "position bits are not in 1..16"};
  for (int axis = 0; axis < 3; ++axis)
    if (!std::isfinite(mesh.origin[axis]) || !std::isfinite(mesh.step[axis]) || !(mesh.step[axis] > 0))
      return Failure{Error::bad_argument, 0, "grid is not finite or has no step"};
  uint64_t n_corners = 0;
  for (size_t f = 0; f < mesh.faces.size(); ++f) {
    const Face& face = mesh.faces[f];
    n_corners += face.count;
    if (face.count < 3) return Failure{Error::bad_argument, f, "face with fewer than three corners"};
    if (face.first > mesh.indices.size() || face.count > mesh.indices.size() - face.first)
      return Failure{Error::bad_argument, f, "face reaches outside the index list"};
    for (uint32_t k = 0; k < face.count; ++k)
      if (mesh.indices[face.first + k] >= mesh.vertices.size())
        return Failure{Error::bad_argument, f, "face names a vertex that does not exist"};
  }
  if (mesh.vertices.size() > kMaxCount || n_corners > kMaxCount)
    return Failure{Error::bad_argument, 0, "mesh has more than 2^31 - 1 vertices or corners"};
  PAC_CHECK(check_face_values(mesh));
  return check_vertices(mesh);
}

}  // namespace pac::geomcodec
