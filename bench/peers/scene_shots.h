// Scenes by name and their frames drawn once: what the programs here code in many ways.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "base/result.h"
#include "raster/scene.h"
#include "sim/scenes.h"
#include "sim/video_sequence.h"

namespace pac::bench {

// A program that measures has nothing to say without it.
template <class T>
T need(Result<T> result, const char* what) {
  if (result.ok()) return std::move(*result);
  std::fprintf(stderr, "%s: %s\n", what, result.failure().text);
  std::exit(1);
}

struct NamedScene {
  std::string name;
  sim::SceneSet set;
  const sim::BuiltinScene* builtin = nullptr;  // null where it came from a file or is `fence`
  bool moves = false;                          // its parts are objects that move
  bool has_moving_lights = false;

  raster::Camera camera(int frame, float aspect) const;
};

// A built-in scene, NAME+moving for one whose parts move, NAME+lights (of any) for one whose lights go round, the path
// of a model, or `fence`: hundreds of bars thinner than a pixel before textured ground, where the client's polygons say
// little of what H looks like.
NamedScene load_scene(const std::string& name);

// H, L, D, depth and ids of every frame.
struct Sequence {
  int width = 0, height = 0, samples = 1;  // samples: of L
  bool differs_in_light = false;           // sim::Split::differs_in_light()
  raster::Scene low;                       // objects where the first shot has them
  std::vector<sim::Shot> shots;
  uint64_t resident_model_bytes = 0;
  double draw_low_ms = 0;  // CPU time a frame: L, depth and ids alone
};

// width = 0: the scene's own size; else the longer side is scaled to it. antialiased sides have `samples` a pixel.
Sequence draw(NamedScene& scene, const std::string& split_name, int frames, int longer_side = 0, int samples = 16);

double cpu_ms();           // of this process
double children_cpu_ms();  // of the programs that it ran

}  // namespace pac::bench
