// The back end: one tile at a time, visibility first, then each covered sample shaded once, then the box filter.
#pragma once

#include <cstdint>
#include <vector>

#include "base/kernels/kernels.h"
#include "raster/draw_list.h"
#include "raster/renderer.h"
#include "raster/sample_pattern.h"
#include "raster/surface.h"

namespace pac::raster {

struct PaintInput {
  const DrawList* draw_list;
  const Kernels* kernels;
  std::span<const SampleOffset> pattern;
  int width, height;
  const std::vector<Surface>* surfaces[2];  // [1] null: one rendering
  int shading_samples[2];                   // of each rendering, as RenderQuality
  uint8_t background[3];
  RgbView color[2];
  RgbView difference;  // only with two renderings
  PlaneView<float> depth;
  PlaneView<uint32_t> id;
  ImageView<float, 3> previous;
};

// The working memory of one thread.
class TilePainter {
 public:
  void paint(const PaintInput& input, int tile);

 private:
  static constexpr int kTilePixels = kTileSize * kTileSize;

  // Pixels of the tile inside the image.
  struct Area {
    int x, y, width, height;
  };
  // Samples of a pixel that are shaded as one, at `place`.
  struct ShadingGroup {
    uint32_t samples;  // bits, of the grid
    SampleOffset place;
    int number;  // of the group among all of the pixel
  };
  // What one pass over the tile shades.
  struct Pass {
    int rendering;
    int number, count;  // of shading groups a pixel
    SamplePosition origin;
    bool weighted;  // the packs' lanes stand for several samples
  };
  static bool wants_color(const PaintInput& input, int rendering);
  static SamplePosition position(const Area& area, SampleOffset offset);
  void shade_first_sample(const PaintInput& input, const Area& area);
  void paint_grid(const PaintInput& input, const Area& area, std::span<const SampleOffset> offsets, int first_sample);
  void shade_grid(const PaintInput& input, const Area& area, int rendering, int first_sample);
  int list_groups(int shading_samples, int first_sample, ShadingGroup groups[kGridSamples]) const;
  void write_first_sample(const PaintInput& input, const Area& area);
  void rasterize(const PaintInput& input, SamplePosition origin);
  void shade(const PaintInput& input, const Pass& pass);
  void shade_batch(const PaintInput& input, const Pass& pass, const Surface& surface, const LanePack* packs, int n);
  const float* cast_shadows_of(const PaintInput& input, const Pass& pass, const Surface& surface, const LanePack* packs,
                               int n);
  void write_depth_and_id(const PaintInput& input, const Area& area) const;
  void write_previous(const PaintInput& input, const Area& area, SamplePosition origin);
  void write_color(const PaintInput& input, const Area& area) const;

  alignas(64) float depth_[kTilePixels];
  alignas(64) uint32_t ids_[kTilePixels];  // 1 + index into triangles_; 0 = background
  alignas(64) uint16_t sums_[2][3 * kTilePixels];
  alignas(64) float rows_[kMaxAttributes * kBatchLanes];
  alignas(64) float lod_[kBatchLanes];
  alignas(64) float texels_[3 * kBatchLanes];
  alignas(64) float specular_[3 * kBatchLanes];
  alignas(64) float visibility_[(kMaxKernelLights + 1) * kBatchLanes];
  std::vector<const RasterTriangle*> triangles_;
  alignas(64) uint32_t whole_[kTilePixels];
  alignas(64) float near_z_[kTilePixels], far_z_[kTilePixels];
  alignas(64) uint32_t grid_ids_[kTilePixels * kGridSamples];
  alignas(64) float grid_depth_[kTilePixels * kGridSamples];
  SampleGrid grid_;
  // Room for the worst rows of a grid, see collect_grid().
  static constexpr int kGridRows = 8, kMostPacks = kGridRows * kTileSize * kGridSamples;
  LanePack packs_[kMostPacks], batch_[kMostPacks], shared_packs_[kTilePixels];
  int n_packs_ = 0;
};

}  // namespace pac::raster
