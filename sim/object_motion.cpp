#include "sim/object_motion.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/exact_math.h"

namespace pac::sim {

Transforms transforms_of(const raster::Scene& scene) {
  Transforms transforms;
  for (const raster::Object& object : scene.objects) transforms.push_back(object.world_from_object);
  return transforms;
}

bool is_transform(const glm::mat4& matrix) {
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 3; ++row)
      if (!(std::fabs(matrix[column][row]) <= 0x1p60f)) return false;
    if (matrix[column][3] != (column == 3 ? 1.0f : 0.0f)) return false;
  }
  return true;
}

bool same_transform(const glm::mat4& a, const glm::mat4& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

Result<void> move_objects(std::span<const glm::mat4> transforms, raster::Scene& scene) {
  if (transforms.size() != scene.objects.size())
    return Failure{Error::bad_argument, transforms.size(), "as many transforms as the model has objects are needed"};
  for (size_t i = 0; i < transforms.size(); ++i)
    if (!is_transform(transforms[i])) return Failure{Error::bad_argument, i, "object's transform is not affine"};
  for (size_t i = 0; i < transforms.size(); ++i) {
    raster::Object& object = scene.objects[i];
    object.previous_world_from_object = object.world_from_object;
    object.world_from_object = transforms[i];
  }
  return {};
}

Result<void> check_objects(const raster::Scene& scene) {
  const uint64_t n_vertices = scene.mesh.vertices.size();
  std::vector<size_t> order(scene.objects.size());
  for (size_t i = 0; i < order.size(); ++i) {
    const raster::Object& object = scene.objects[i];
    if (uint64_t{object.first_vertex} + object.vertex_count > n_vertices)
      return Failure{Error::corrupt, i, "object names vertices that do not exist"};
    if (!is_transform(object.world_from_object)) return Failure{Error::corrupt, i, "object's transform is not affine"};
    order[i] = i;
  }
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    const raster::Object &left = scene.objects[a], &right = scene.objects[b];
    return left.first_vertex != right.first_vertex ? left.first_vertex < right.first_vertex
                                                   : left.vertex_count < right.vertex_count;
  });
  for (size_t i = 1; i < order.size(); ++i) {
    const raster::Object &left = scene.objects[order[i - 1]], &right = scene.objects[order[i]];
    if (uint64_t{left.first_vertex} + left.vertex_count > right.first_vertex)
      return Failure{Error::corrupt, order[i], "two objects move the same vertex"};
  }
  return {};
}

void move_lights(raster::Scene& scene) {
  for (raster::Light& light : scene.lights) {
    light.object = static_cast<int32_t>(scene.objects.size());
    scene.objects.push_back({0, 0, glm::mat4(1.0f), glm::mat4(1.0f)});
  }
}

void add_light_transforms(int frame, size_t n_lights, Transforms& out) {
  const double angle = 2 * kPi * frame / kLightTurnFrames;
  const auto cosine = static_cast<float>(exact_cos(angle)), sine = static_cast<float>(exact_sin(angle));
  glm::mat4 turn(1.0f);
  turn[0][0] = turn[2][2] = cosine;
  turn[0][2] = -sine;
  turn[2][0] = sine;
  out.insert(out.end(), n_lights, turn);
}

std::vector<uint32_t> movers_of(const raster::Scene& scene) {
  if (scene.objects.empty()) return {};
  std::vector<uint32_t> of_vertex(scene.mesh.vertices.size(), kStands);
  for (size_t i = 0; i < scene.objects.size(); ++i) {
    const raster::Object& object = scene.objects[i];
    std::fill_n(of_vertex.begin() + object.first_vertex, object.vertex_count, static_cast<uint32_t>(i + 1));
  }
  std::vector<uint32_t> movers(scene.mesh.faces.size() + 1, kStands);
  for (size_t f = 0; f < scene.mesh.faces.size(); ++f) {
    const Face& face = scene.mesh.faces[f];
    if (face.count == 0) continue;
    uint32_t mover = of_vertex[scene.mesh.indices[face.first]];
    for (uint32_t k = 1; k < face.count; ++k)
      if (of_vertex[scene.mesh.indices[face.first + k]] != mover) mover = kTorn;
    movers[f + 1] = mover;
  }
  return movers;
}

}  // namespace pac::sim
