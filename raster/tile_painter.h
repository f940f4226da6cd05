// The back end: one tile at a time, visibility first, then each covered sample shaded once, then what is transparent
// over it, then the box filter.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/kernels/kernels.h"
#include "raster/batch_shader.h"
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
  bool has_final_colors[2];                 // of each rendering: BatchShader::has_final_colors() of all its surfaces
  bool shades_lanes[2];                     // the same of BatchShader::shades_lanes()
  const PaintedSurface* painted[2];         // one a surface, where the same of has_painted_colors(); else null
  bool has_one_batch[2];                    // of each rendering: all surfaces have the same `batch`
  bool has_transparent;                     // some material's alpha is not opaque
  uint8_t background[3];
  RgbView color[2];
  RgbView difference;  // only with two renderings
  PlaneView<float> depth;
  PlaneView<uint32_t> id;
  ImageView<float, 3> previous;
  int first_row;  // of the picture: where depth and id begin

  float* depth_at(int x, int y) const { return depth.pixel(x, y - first_row); }
  uint32_t* id_at(int x, int y) const { return id.pixel(x, y - first_row); }
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
  struct ColorTarget {
    uint8_t* rgb;  // of the tile's first pixel
    ptrdiff_t stride;
  };
  static bool wants_color(const PaintInput& input, int rendering);
  static bool wants_ids(const PaintInput& input);
  static SamplePosition position(const Area& area, SampleOffset offset);
  void shade_first_sample(const PaintInput& input, const Area& area, int rendering);
  static bool fills_squares(const PaintInput& input, int rendering);
  void add_squares(const PaintInput& input, int rendering, std::span<const SampleIds> samples, int width, int height,
                   uint16_t* sums);
  void shade_ids(const PaintInput& input, const ShadePass& pass, const uint32_t* ids, int width, int height,
                 uint16_t* sums);
  void paint_grid(const PaintInput& input, const Area& area, std::span<const SampleOffset> offsets, int first_sample);
  void shade_grid(const PaintInput& input, const Area& area, std::span<const int> renderings, int first_sample);
  bool add_textured_grid(const PaintInput& input, const Area& area, int rendering);
  void shade_each_sample(const PaintInput& input, const Area& area, std::span<const int> renderings,
                         std::span<const ShadingGroup> samples);
  void split_by_sample(const Area& area, int first_row, int n_rows);
  int list_groups(int shading_samples, int first_sample, ShadingGroup groups[kGridSamples]) const;
  void write_first_sample(const PaintInput& input, const Area& area);
  void paint_samples(const PaintInput& input, const Area& area);
  void find_transparent(const PaintInput& input);
  void rasterize(const PaintInput& input, SamplePosition origin);
  void rasterize_mask(const PaintInput& input, uint32_t number, const Surface& surface, const ShadePass& pass);
  int visible_packs(const PaintInput& input, const RasterTriangle& triangle, SamplePosition origin);
  void shade(const PaintInput& input, const ShadePass& pass, uint16_t* sums, const uint32_t* group_ids = nullptr);
  void shade_packs(const PaintInput& input, const Surface& surface, const ShadePass& pass, const LanePack* packs, int n,
                   uint16_t* sums, const uint32_t* group_ids = nullptr);
  bool paints_directly(const PaintInput& input, int rendering) const;
  ColorTarget color_target(const PaintInput& input, const Area& area, int rendering);
  void take_whole_groups(const Area& area, int rendering);
  void put_whole_groups_back();
  void shade_whole_groups(const PaintInput& input, const ShadePass& pass, uint16_t* sums);
  void shade_lanes(const PaintInput& input, const Surface& surface, const ShadePass& pass, uint16_t* sums);
  static int few_lanes(const Surface& surface);
  void blend(const PaintInput& input, const ShadePass& pass);
  void add_sample(const PaintInput& input, int rendering);
  bool takes_first_sample_from_grid(const PaintInput& input) const;
  void write_depth_and_id(const PaintInput& input, const Area& area) const;
  void write_previous(const PaintInput& input, const Area& area, SamplePosition origin);
  void write_color(const PaintInput& input, const Area& area);
  static void write_background(const PaintInput& input, const Area& area);
  static void clear_previous(const PaintInput& input, const Area& area);

  alignas(64) float depth_[kTilePixels];
  alignas(64) uint32_t ids_[kTilePixels];  // 1 + index into triangles_; 0 = background
  alignas(64) uint16_t sums_[2][3 * kTilePixels];
  alignas(64) uint8_t rgb_[2][3 * kTilePixels];  // of renderings that have no target but count for the difference
  alignas(64) float rows_[4 * kBatchLanes];
  BatchShader shader_;
  // Of tiles with masked or transparent triangles.
  bool has_masked_ = false, has_blended_ = false;
  alignas(64) float own_depth_[kTilePixels];      // of one triangle alone, where it is nearer than depth_ ...
  alignas(64) uint32_t own_ids_[kTilePixels];     // ... and 1 there
  alignas(64) uint16_t colors_[3 * kTilePixels];  // of one sample
  std::vector<const RasterTriangle*> triangles_;  // that may touch the tile
  alignas(64) uint32_t whole_[kTilePixels];
  alignas(64) float near_z_[kTilePixels], far_z_[kTilePixels];
  alignas(64) uint32_t grid_ids_[kTilePixels * kGridSamples];
  alignas(64) float grid_depth_[kTilePixels * kGridSamples];
  SampleGrid grid_;
  // Room for the worst rows of a grid, see collect_grid().
  static constexpr int kGridRows = 8, kMostPacks = kGridRows * kTileSize * kGridSamples;
  LanePack packs_[kMostPacks], batch_[kMostPacks], shared_packs_[kMostPacks];
  int n_packs_ = 0;
  alignas(64) uint32_t sample_ids_[kGridSamples][kGridRows * kTileSize];
  LanePack whole_packs_[kTilePixels / 8];
  uint32_t whole_ids_[kTilePixels / 8];
  int n_whole_packs_ = 0;
  LaneSample lanes_[kBatchLanes];  // of packs with few, before they are shaded
  int n_lanes_ = 0;
};

}  // namespace pac::raster
