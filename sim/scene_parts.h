// One builder and one camera path a built-in scene: what the registry in scenes.cpp points to.
#pragma once

#include "sim/scenes.h"

namespace pac::sim {

SceneSet build_room(uint32_t seed);
raster::Camera room_camera(int frame, float aspect);
SceneSet build_pin(uint32_t seed);
raster::Camera pin_camera(int frame, float aspect);
SceneSet build_letter(uint32_t seed);
SceneSet build_letter_texture(uint32_t seed);
raster::Camera letter_camera(int frame, float aspect);
SceneSet build_cubes(uint32_t seed);
raster::Camera cubes_camera(int frame, float aspect);

// A camera that circles `center`: at frame 0 at angle `start_rad` (0 = on +z, growing towards +x), one turn in
// `frames_a_turn`.
raster::Camera orbit_camera(int frame, float aspect, glm::vec3 center, float radius, float height, double start_rad,
                            int frames_a_turn, float fov_y_rad);

}  // namespace pac::sim
