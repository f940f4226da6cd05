// What lights see first, as depth maps: shadows of directional and spot lights.
#pragma once

#include <memory>
#include <vector>

#include "base/parallel.h"
#include "raster/draw_list.h"
#include "raster/shadows.h"
#include "raster/tile_painter.h"

namespace pac::raster {

// Keeps its memory between frames.
class ShadowMaps {
 public:
  // Draws one map of side x side texels for each light of the scene that can have one, and points `out` at them: valid
  // until the next call. `mesh`: the scene's, posed. A scene has at most kMaxKernelLights lights. Fails as
  // DrawList::build().
  Result<void> draw(const Scene& scene, const Mesh& mesh, int side, const Kernels& kernels, ThreadPool& pool,
                    const std::vector<std::unique_ptr<TilePainter>>& painters, ShadowScene& out);

 private:
  DrawList draw_list_;
  std::vector<Surface> surfaces_;
  std::vector<std::vector<float>> depths_;  // of each light
};

// Tiles first..last - 1 of a frame, by one painter a thread.
void paint_tiles(const PaintInput& input, const std::vector<std::unique_ptr<TilePainter>>& painters, ThreadPool& pool,
                 int first, int last);

}  // namespace pac::raster
