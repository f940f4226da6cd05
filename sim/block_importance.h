// How much an error counts in each 8x8 block of a still [Levoy95 s.5]: by what the renderer knows of the block and by
// what the application says that it is worth. Of the encoder only: a JPEG holds tables and levels as ever.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "base/image.h"
#include "base/result.h"
#include "raster/renderer.h"
#include "raster/scene.h"
#include "sim/quantizer_adaptation.h"

namespace pac::sim {

// What a block shows, the last that holds: more than half of it a texture's; more than half of it a surface with
// highlights; a place where neighboring pixels belong to different materials or objects, or to faces whose normals are
// more than 26 degrees apart; one where the farther is 1.11 times as far away as the nearer.
enum class BlockClass : uint8_t { flat, textured, specular, edge, silhouette };
constexpr size_t kBlockClasses = 5;
constexpr std::array<std::string_view, kBlockClasses> kBlockClassNames = {"flat", "textured", "specular", "edge",
                                                                          "silhouette"};

struct ImportanceOptions {
  std::array<double, kBlockClasses> of_class = {1, 1, 1, 1, 1};  // times that an error counts, 1/16..16
  Foreground foreground;                                         // on top of it; materials of H

  bool is_on() const;
};

// "edge=2,flat=1.5": the classes named; the others stay as they are. Fails with bad_argument: a name that is none, no
// number within 1/16..16 behind it.
Result<void> read_class_weights(std::string_view text, std::array<double, kBlockClasses>& of_class);

struct BlockImportance {
  std::vector<BlockClass> classes;  // ceil(height / 8) rows of ceil(width / 8)
  std::vector<float> importance;    // of mean 1; empty where the options are off
  GrayImage edge_band;              // 255 within 2 pixels of an edge or silhouette, else 0
};

// Of what `quality` shows of `scene` at the renderer's size. Draws it once more, with one sample a pixel. Fails as
// Renderer::render; bad_argument: weights outside their range, or as worth_of_ids().
Result<BlockImportance> find_importance(raster::Renderer& renderer, const raster::Scene& scene,
                                        const raster::Camera& camera, const raster::RenderQuality& quality, int width,
                                        int height, const ImportanceOptions& options);

}  // namespace pac::sim
