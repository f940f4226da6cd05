#include "sim/scenes.h"

namespace pac::sim {

const std::vector<BuiltinScene>& builtin_scenes() {
  static const std::vector<BuiltinScene> scenes;
  return scenes;
}

const BuiltinScene* find_scene(std::string_view name) {
  for (const BuiltinScene& scene : builtin_scenes())
    if (name == scene.name) return &scene;
  return nullptr;
}

}  // namespace pac::sim
