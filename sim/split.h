// What the client draws and what the server sends: the partitioning strategies of [Levoy95 s.4], by name.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "base/result.h"
#include "raster/renderer.h"
#include "raster/scene.h"
#include "sim/scenes.h"

namespace pac::sim {

enum class Model : uint8_t { fine, coarse };    // which of the two models of a SceneSet
enum class Lighting : uint8_t { full, local };  // the colors of the mesh, or SceneSet::local_colors instead of them

// One partitioning strategy. The high-quality rendering H always draws the fine model under full lighting.
struct Split {
  std::string name;  // canonical: the parts in the order of split_names(), joined by commas
  raster::RenderQuality high, low;
  Model low_model = Model::fine;
  Lighting low_lighting = Lighting::full;

  // H and L differ only in RenderQuality and have equal samples: one traversal gives both (Renderer::render_pair).
  bool single_pass() const {
    return low_model == Model::fine && low_lighting == Lighting::full && high.samples == low.samples;
  }

  // L has H's textures under less light.
  bool differs_in_light() const {
    return high.texture == low.texture && (low_lighting != Lighting::full || high.lighting != low.lighting);
  }
};

struct SplitOptions {
  int samples = 16;  // of an antialiased side: 1, 4, 16 or 64 a pixel
  // L's colors are computed once for each triangle of a pixel (RenderQuality::shading_samples = 1) where L is
  // antialiased and untextured: about a third of the client's time for drawing. For video; stills are drawn as the
  // paper drew them.
  bool quick_low = false;
};

// The parts that make_split knows:
//   texture       H textured, L not; both antialiased [Levoy95 s.4.1]
//   tessellation  H draws the fine model, L the coarse one [s.4.2]
//   shading       H Phong, antialiased, textured; L Gouraud, 1 sample, no texture [s.4.3, the one that fails]
//   antialiasing  as texture, with 1 sample on both sides [s.4.3, last paragraph]
//   lighting      H the colors of the full (radiosity) solution, L those of local lighting; where materials are lit, H
//                 soft shadows and ambient occlusion, L the same lights without; textures on both sides
// Whatever a part does not name is equal on both sides: textures on, back faces culled where the material allows,
// `samples` a pixel, and interpolation by Phong where the scene has lit materials (figure 5), by Gouraud where all
// colors are baked (figures 2 and 3).
const char* const* split_names();                  // null-terminated
const char* split_summary(std::string_view part);  // one line, or null for an unknown part

// The split called `names`: one part, or several joined by commas ("texture,tessellation"), in any order, repeats
// ignored. Where parts disagree, the lower quality wins on each side.
// Fails with bad_argument: unknown name, empty list, samples not 1, 4, 16 or 64; or this scene cannot do it:
// tessellation without a coarse model (loaded models: see add_coarse_model), lighting without baked local colors
// or lit materials, lighting together with tessellation where it is baked (the coarse model has one set of colors).
Result<Split> make_split(std::string_view names, const SceneSet& scene, const SplitOptions& options = {});

// Whether lights matter: some material is lit.
bool has_lit_materials(const SceneSet& scene);

// The model that L draws, and nothing more: fine or coarse geometry, local colors where the split says so, and where
// L is untextured each texture cut down to its mean color (the 1x1 level). Copies; keeps nothing of `scene`.
raster::Scene low_scene(const SceneSet& scene, const Split& split);

// Polygons (faces, as the paper counts them) that each side draws.
uint64_t high_polygon_count(const SceneSet& scene);
uint64_t low_polygon_count(const SceneSet& scene, const Split& split);

}  // namespace pac::sim
