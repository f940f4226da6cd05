#include "sim/scenes.h"

#include "base/exact_math.h"
#include "sim/scene_parts.h"

namespace pac::sim {

const std::vector<BuiltinScene>& builtin_scenes() {
  static const std::vector<BuiltinScene> scenes = {
      {"room", "a furnished room of 1131 polygons, radiosity vertex colors, textures [Levoy95 fig 2]", build_room,
       room_camera},
      {"pin", "a bowling pin, bicubic patches diced twice and shaded at the vertices [Levoy95 fig 3]", build_pin,
       pin_camera},
      {"letter", "an extruded letter: Phong, texture and antialiasing against aliased Gouraud [Levoy95 fig 4]",
       build_letter, letter_camera},
      {"letter-texture", "the same letter, split by texture only [Levoy95 fig 5]", build_letter_texture, letter_camera},
      {"cubes", "textured cubes that turn before the camera [Levoy95 web page]", build_cubes, cubes_camera},
  };
  return scenes;
}

const BuiltinScene* find_scene(std::string_view name) {
  for (const BuiltinScene& scene : builtin_scenes())
    if (name == scene.name) return &scene;
  return nullptr;
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
