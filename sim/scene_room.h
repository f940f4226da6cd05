// The room's parts: each adds its polygons to the builder. Metres; x to the right, y up, z towards the camera, the back
// wall at z = 0, the left wall (with the window) at x = 0.
#pragma once

#include <cstdint>

#include "sim/scene_builder.h"
#include "sim/scenes.h"

namespace pac::sim {

constexpr float kRoomWidth = 5.4f, kRoomDepth = 6.4f, kRoomHeight = 2.75f;

// Indices of the room's materials.
struct RoomMaterials {
  uint32_t floor, wall, ceiling, beam, trim, brick, stone, soot, ember, glass, curtain, brass, rug, walnut, oak, fabric,
      tartan, cushion, books, paper, landscape, seascape, still_life, abstract, frame, shade, bulb, porcelain, apple,
      orange;
};

RoomMaterials add_room_materials(SceneBuilder& builder, uint32_t seed);  // scene_room_materials.cpp

// The fixed parts (scene_room_shell.cpp).
void add_shell(SceneBuilder& builder, const RoomMaterials& materials);
void add_window(SceneBuilder& builder, const RoomMaterials& materials);
void add_fireplace(SceneBuilder& builder, const RoomMaterials& materials);
// Rug, and the sunlit pieces of floor and rug; faces from the returned number on are in the sun.
size_t add_rug_and_sun(SceneBuilder& builder, const RoomMaterials& materials);

// Furniture (scene_room_furniture.cpp); each in its own frame: feet on y = 0, facing +z.
void add_table(SceneBuilder& builder, const RoomMaterials& materials);
void add_chair(SceneBuilder& builder, const RoomMaterials& materials);
void add_armchair(SceneBuilder& builder, const RoomMaterials& materials);
void add_bookshelf(SceneBuilder& builder, const RoomMaterials& materials, uint32_t seed);
void add_cabinet(SceneBuilder& builder, const RoomMaterials& materials);
void add_lamp(SceneBuilder& builder, const RoomMaterials& materials);

// Small things (scene_room_objects.cpp).
void add_vase(SceneBuilder& builder, const RoomMaterials& materials, glm::vec3 foot);
void add_fruit(SceneBuilder& builder, glm::vec3 center, float radius, uint32_t material);
void add_book(SceneBuilder& builder, const RoomMaterials& materials, glm::vec3 low, glm::vec3 high);
// Hangs on a wall: `center` on the wall, `right` along it, `out` into the room (unit vectors).
void add_painting(SceneBuilder& builder, const RoomMaterials& materials, uint32_t canvas, glm::vec3 center,
                  glm::vec3 right, glm::vec3 out, float width, float height);

// All of the above in place: 1131 polygons, whatever the seed. Faces from the returned number on are in the sun.
// scene_room.cpp. `parts`, where not null: what can move, the vase and the chair beside the table, are appended.
size_t furnish_room(SceneBuilder& builder, const RoomMaterials& materials, uint32_t seed,
                    std::vector<MovablePart>* parts = nullptr);

// The way sunlight travels, x = 1: through the window, down, a little towards the camera.
constexpr float kSunDown = 0.66f, kSunForward = 0.30f;

// The window opening in the left wall.
constexpr float kWindowNear = 2.8f, kWindowFar = 1.2f, kWindowSill = 0.85f, kWindowTop = 2.25f;

}  // namespace pac::sim
