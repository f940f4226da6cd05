// The built-in scenes, each a function of a seed, with a camera path.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "raster/scene.h"
#include "sim/object_motion.h"

namespace pac::sim {

// A part that can move by itself: vertices of SceneSet::fine that no other face uses, and the point about which it
// turns.
struct MovablePart {
  uint32_t first_vertex = 0, vertex_count = 0;
  glm::vec3 pivot{0};
};

// What the splits need of one scene: two models where tessellation (or lighting) differs, one otherwise.
struct SceneSet {
  raster::Scene fine;
  raster::Scene coarse;               // tessellation split: what the client draws; empty mesh = same as fine
  std::vector<uint8_t> local_colors;  // RGBA a vertex of `fine`: lit locally only; empty = lighting is not baked
  std::vector<MovablePart> parts;     // become objects of `fine` through move_parts()
  int width = 512, height = 512;      // the size that the demo uses
  const char* default_split = "texture";
};

struct BuiltinScene {
  const char* name;
  const char* summary;  // one line, for `pac scenes`
  SceneSet (*build)(uint32_t seed);
  raster::Camera (*camera)(int frame, float aspect);  // frame 0 is the still
  // World from object of each of set.parts; at frame 0 all are the identity. Null: nothing moves.
  Transforms (*part_motion)(int frame, const std::vector<MovablePart>& parts) = nullptr;
};

// Makes an object of each part of a scene without a coarse model.
void move_parts(SceneSet& set);

const std::vector<BuiltinScene>& builtin_scenes();
const BuiltinScene* find_scene(std::string_view name);  // null if there is none

}  // namespace pac::sim
