// One builder and one camera path a built-in scene: what the registry in scenes.cpp points to.
#pragma once

#include "sim/scenes.h"

namespace pac::sim {

SceneSet build_room(uint32_t seed);
raster::Camera room_camera(int frame, float aspect);
Transforms room_motion(int frame, const std::vector<MovablePart>& parts);
SceneSet build_pin(uint32_t seed);
raster::Camera pin_camera(int frame, float aspect);
SceneSet build_letter(uint32_t seed);
SceneSet build_letter_texture(uint32_t seed);
raster::Camera letter_camera(int frame, float aspect);
SceneSet build_cubes(uint32_t seed);
raster::Camera cubes_camera(int frame, float aspect);
Transforms cubes_motion(int frame, const std::vector<MovablePart>& parts);

// The vertices from `first_vertex` (there is one) to the last, about the middle of their bounding box.
MovablePart part_since(const raster::Scene& scene, size_t first_vertex);

// Turned about the vertical through `pivot` (from +z towards +x), then shifted.
glm::mat4 turned_about_y(glm::vec3 pivot, double angle_rad, const double shift[3]);

// A camera that circles `center`: at frame 0 at angle `start_rad` (0 = on +z, growing towards +x), one turn in
// `frames_a_turn`.
raster::Camera orbit_camera(int frame, float aspect, glm::vec3 center, float radius, float height, double start_rad,
                            int frames_a_turn, float fov_y_rad);

}  // namespace pac::sim
