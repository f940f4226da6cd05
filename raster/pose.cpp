#include "raster/pose.h"

#include <algorithm>
#include <cmath>

namespace pac::raster {
namespace {

constexpr float kLargest = 0x1p60f;

bool is_finite(const glm::mat4& m) {
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row)
      if (!(std::fabs(m[column][row]) <= kLargest)) return false;
  return true;
}

void transform_point(const glm::mat4& m, const float in[3], float out[3]) {
  const float x = in[0], y = in[1], z = in[2];
  for (int row = 0; row < 3; ++row) out[row] = ((m[0][row] * x + m[1][row] * y) + m[2][row] * z) + m[3][row];
}

// The cofactors of the upper left 3x3: its inverse transpose times its determinant. The sign of the determinant is
// kept out, so that a mirrored object's normals still point outwards.
struct NormalMatrix {
  float cofactor[3][3];  // [row][column]
};
NormalMatrix normal_matrix(const glm::mat4& m) {
  NormalMatrix n{};
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) {
      const int r1 = (row + 1) % 3, r2 = (row + 2) % 3, c1 = (column + 1) % 3, c2 = (column + 2) % 3;
      n.cofactor[row][column] = m[c1][r1] * m[c2][r2] - m[c2][r1] * m[c1][r2];
    }
  const float determinant = (m[0][0] * n.cofactor[0][0] + m[1][0] * n.cofactor[0][1]) + m[2][0] * n.cofactor[0][2];
  if (determinant < 0)
    for (auto& row : n.cofactor)
      for (float& value : row) value = -value;
  return n;
}

}  // namespace

Result<void> pose_mesh(const Scene& scene, Mesh& out) {
  out = scene.mesh;
  for (size_t i = 0; i < scene.objects.size(); ++i) {
    const Object& object = scene.objects[i];
    if (object.first_vertex > out.vertices.size() || object.vertex_count > out.vertices.size() - object.first_vertex)
      return Failure{Error::corrupt, i, "object names vertices that do not exist"};
    if (!is_finite(object.world_from_object) || !is_finite(object.previous_world_from_object))
      return Failure{Error::corrupt, i, "object's transform is not finite"};
    const NormalMatrix normals = normal_matrix(object.world_from_object);
    for (uint32_t v = 0; v < object.vertex_count; ++v) {
      Vertex& vertex = out.vertices[object.first_vertex + v];
      float position[3];
      transform_point(object.world_from_object, vertex.position, position);
      std::copy_n(position, 3, vertex.position);
      const float n[3] = {vertex.normal[0], vertex.normal[1], vertex.normal[2]};
      for (int row = 0; row < 3; ++row)
        vertex.normal[row] =
            (normals.cofactor[row][0] * n[0] + normals.cofactor[row][1] * n[1]) + normals.cofactor[row][2] * n[2];
    }
  }
  return {};
}

void previous_clip_positions(const Scene& scene, const Camera& previous_camera, ThreadPool& pool,
                             std::vector<float>& out) {
  const std::vector<Vertex>& vertices = scene.mesh.vertices;
  out.resize(4 * vertices.size());
  const glm::mat4& m = previous_camera.clip_from_world;
  constexpr size_t kRange = 4096;
  const size_t n_ranges = (vertices.size() + kRange - 1) / kRange;
  pool.for_each(static_cast<int64_t>(n_ranges), [&](int64_t range) {
    const size_t first = static_cast<size_t>(range) * kRange, last = std::min(first + kRange, vertices.size());
    for (size_t i = first; i < last; ++i) {
      float p[3] = {vertices[i].position[0], vertices[i].position[1], vertices[i].position[2]};
      for (const Object& object : scene.objects) {
        if (i < object.first_vertex || i - object.first_vertex >= object.vertex_count) continue;
        float moved[3];
        transform_point(object.previous_world_from_object, p, moved);
        std::copy_n(moved, 3, p);
      }
      float* clip = out.data() + 4 * i;
      bool finite = true;
      for (int row = 0; row < 4; ++row) {
        clip[row] = ((m[0][row] * p[0] + m[1][row] * p[1]) + m[2][row] * p[2]) + m[3][row];
        finite = finite && std::fabs(clip[row]) <= kLargest;
      }
      if (finite) continue;
      clip[0] = clip[1] = clip[2] = 0;
      clip[3] = -1;
    }
  });
}

Light posed_light(const Scene& scene, const Light& light) {
  if (light.object < 0 || static_cast<size_t>(light.object) >= scene.objects.size()) return light;
  const glm::mat4& m = scene.objects[static_cast<size_t>(light.object)].world_from_object;
  Light posed = light;
  for (int row = 0; row < 3; ++row) {
    const auto turned = [&](const glm::vec3& v) { return (m[0][row] * v[0] + m[1][row] * v[1]) + m[2][row] * v[2]; };
    posed.direction[row] = turned(light.direction);
    posed.position[row] = turned(light.position) + m[3][row];
  }
  return posed;
}

}  // namespace pac::raster
