// SCENE on the command line: the name of a built-in scene or the path of an OBJ, PLY or glTF file.
#pragma once

#include <optional>
#include <string>

#include "raster/node_animation.h"
#include "sim/cli/command.h"
#include "sim/scenes.h"

namespace pac::cli {

struct SceneSource {
  std::string name;
  sim::SceneSet set;
  const sim::BuiltinScene* builtin = nullptr;  // null where it came from a file

  // Built-in scenes bring their path; a model from a file is orbited.
  raster::Camera camera(int frame, float aspect) const;

  raster::NodeAnimation animation;  // of a glTF file; empty where nothing moves
  // Moves the objects of set.fine to where they are at frame / frames_per_second, their previous transforms to one
  // frame before.
  void pose(int frame, int frames_per_second);

  // Parts of a built-in scene or nodes of a glTF file can move.
  bool can_move() const;
  // Where the objects are in that frame, once move_parts() made objects of a built-in scene's parts.
  sim::Transforms transforms(int frame, int frames_per_second);
};

constexpr int kStillFramesPerSecond = 20;  // of --frame, as Table I
constexpr uint32_t kSceneSeed = 1;         // of the built-in scenes, everywhere

// MTL files and textures are read beside the model; what is missing there is a warning on stderr (unless --quiet).
// Empty after a message. Names that are neither a scene nor a file get the nearest scene suggested.
std::optional<SceneSource> load_scene(const std::string& name, const Options& options);

// The help text of the SCENE operand.
constexpr const char* kSceneHelp = "a built-in scene ('pac scenes') or an OBJ, PLY or glTF file";

}  // namespace pac::cli
