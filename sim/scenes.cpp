#include "sim/scenes.h"

#include <algorithm>

#include "base/exact_math.h"
#include "sim/scene_parts.h"

namespace pac::sim {

const std::vector<BuiltinScene>& builtin_scenes() {
  static const std::vector<BuiltinScene> scenes = {
      {"room", "a furnished room of 1131 polygons, radiosity vertex colors, textures [Levoy95 fig 2]", build_room,
       room_camera, room_motion},
      {"pin", "a bowling pin, bicubic patches diced twice and shaded at the vertices [Levoy95 fig 3]", build_pin,
       pin_camera},
      {"letter", "an extruded letter: Phong, texture and antialiasing against aliased Gouraud [Levoy95 fig 4]",
       build_letter, letter_camera},
      {"letter-texture", "the same letter, split by texture only [Levoy95 fig 5]", build_letter_texture, letter_camera},
      {"cubes", "textured cubes that turn before the camera [Levoy95 web page]", build_cubes, cubes_camera,
       cubes_motion},
  };
  return scenes;
}

const BuiltinScene* find_scene(std::string_view name) {
  for (const BuiltinScene& scene : builtin_scenes())
    if (name == scene.name) return &scene;
  return nullptr;
}

void move_parts(SceneSet& set) {
  PAC_ASSERT(set.coarse.mesh.faces.empty());
  for (const MovablePart& part : set.parts) {
    raster::Object object;
    object.first_vertex = part.first_vertex;
    object.vertex_count = part.vertex_count;
    set.fine.objects.push_back(object);
  }
}

MovablePart part_since(const raster::Scene& scene, size_t first_vertex) {
  const std::vector<Vertex>& vertices = scene.mesh.vertices;
  PAC_ASSERT(first_vertex < vertices.size());
  MovablePart part;
  part.first_vertex = static_cast<uint32_t>(first_vertex);
  part.vertex_count = static_cast<uint32_t>(vertices.size() - first_vertex);
  for (int axis = 0; axis < 3; ++axis) {
    float low = vertices[first_vertex].position[axis], high = low;
    for (size_t i = first_vertex; i < vertices.size(); ++i) {
      low = std::min(low, vertices[i].position[axis]);
      high = std::max(high, vertices[i].position[axis]);
    }
    part.pivot[axis] = 0.5f * (low + high);
  }
  return part;
}

glm::mat4 turned_about_y(glm::vec3 pivot, double angle_rad, const double shift[3]) {
  const double c = exact_cos(angle_rad), s = exact_sin(angle_rad);
  const auto x = static_cast<double>(pivot.x), z = static_cast<double>(pivot.z);
  glm::mat4 m(1.0f);
  m[0][0] = m[2][2] = static_cast<float>(c);
  m[0][2] = static_cast<float>(-s);
  m[2][0] = static_cast<float>(s);
  m[3][0] = static_cast<float>((x - (c * x + s * z)) + shift[0]);
  m[3][1] = static_cast<float>(shift[1]);
  m[3][2] = static_cast<float>((z - (c * z - s * x)) + shift[2]);
  return m;
}

raster::Camera orbit_camera(int frame, float aspect, glm::vec3 center, float radius, float height, double start_rad,
                            int frames_a_turn, float fov_y_rad) {
  const double turns = static_cast<double>(frame % frames_a_turn) / frames_a_turn;
  const double angle = start_rad + 2.0 * kPi * turns;
  const glm::vec3 eye = center + glm::vec3(radius * static_cast<float>(exact_sin(angle)), height,
                                           radius * static_cast<float>(exact_cos(angle)));
  return raster::make_camera(eye, center, {0, 1, 0}, fov_y_rad, aspect, radius * 0.1f, radius * 4.0f);
}

}  // namespace pac::sim
