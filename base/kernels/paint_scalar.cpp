// Textured colors of a tile: normative as a sequence of the kernels of tile_scalar.cpp and texture_scalar.cpp.
#include <algorithm>

#include "base/kernels/tile_kernels.h"

namespace pac {
namespace {

// Calls visit(pack, colors) for each group of eight pixels and state in it: three rows of bytes as 8 floats.
template <class Visit>
void for_each_pack(const uint32_t* ids, int width, int height, const RasterTriangle* const* triangles, int rendering,
                   SamplePosition origin, const PaintedSurface* surfaces, Visit&& visit) {
  TileKernels table{};
  fill_tile_scalar(table);
  LanePack packs[kTileSize * kTileSize];
  const int n = table.collect_groups(ids, width, height, triangles, rendering, packs);
  float rows[5 * kBatchLanes], lod[8], texels[3 * kBatchLanes], colors[3][8];
  for (int p = 0; p < n; ++p) {
    const PaintedSurface& surface = surfaces[packs[p].triangle->state[rendering]];
    const TextureSampler* const texture = surface.texture;
    InterpolateTarget target{rendering, 3, rows, nullptr, 3, 0, 0, surface.lod_bias};
    if (texture != nullptr) {
      target.n_attributes = 5;
      target.lod = lod;
      target.width = static_cast<float>(texture->width[0]);
      target.height = static_cast<float>(texture->height[0]);
    }
    table.interpolate_groups(packs + p, 1, ids, triangles, origin, target);
    if (texture != nullptr)
      table.sample_texture(*texture, 8, rows + 3 * kBatchLanes, rows + 4 * kBatchLanes, lod, texels);
    for (int c = 0; c < 3; ++c)
      for (int k = 0; k < 8; ++k) {
        float value = rows[c * kBatchLanes + k];
        if (texture != nullptr) value = (value * texels[c * kBatchLanes + k]) * (1.0f / 255.0f);
        colors[c][k] = std::min(std::max(value, 0.0f), 255.0f) + 0.5f;
      }
    visit(packs[p], colors);
  }
}

void add_textured(const SampleIds* samples, int n_samples, int width, int height,
                  const RasterTriangle* const* triangles, int rendering, const PaintedSurface* surfaces,
                  const uint8_t background[3], uint16_t* sums) {
  const auto add = [&](const LanePack& pack, const float(&colors)[3][8]) {
    for (int k = 0; k < 8; ++k)
      for (int c = 0; c < 3 && (pack.mask >> k & 1) != 0; ++c) {
        uint16_t& sum = sums[(c * kTileSize + pack.y) * kTileSize + pack.x + k];
        sum = static_cast<uint16_t>(sum + static_cast<int>(colors[c][k]) - background[c]);
      }
  };
  for (int s = 0; s < n_samples; ++s)
    for_each_pack(samples[s].ids, width, height, triangles, rendering, samples[s].origin, surfaces, add);
}

void add_textured_grid(const SampleGrid& grid, int width, int height, const RasterTriangle* const* triangles,
                       int rendering, SamplePosition origin, const PaintedSurface* surfaces,
                       const uint8_t background[3], uint16_t* sums) {
  for (int s = 0; s < kGridSamples; ++s) {
    uint32_t ids[kTileSize * kTileSize];
    for (int at = 0; at < kTileSize * kTileSize; ++at)
      ids[at] = grid.whole[at] == kSplitPixel ? grid.ids[at * kGridSamples + s] : grid.whole[at];
    const SampleIds sample{ids, {origin.x + grid.x[s], origin.y + grid.y[s]}};
    add_textured(&sample, 1, width, height, triangles, rendering, surfaces, background, sums);
  }
}

void paint_textured(const uint32_t* ids, int width, int height, const RasterTriangle* const* triangles, int rendering,
                    SamplePosition origin, const PaintedSurface* surfaces, const uint8_t background[3], uint8_t* rgb,
                    ptrdiff_t stride) {
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < 3 * width; ++x) rgb[y * stride + x] = background[x % 3];
  for_each_pack(ids, width, height, triangles, rendering, origin, surfaces,
                [&](const LanePack& pack, const float(&colors)[3][8]) {
                  for (int k = 0; k < 8 && pack.x + k < width; ++k)
                    for (int c = 0; c < 3 && (pack.mask >> k & 1) != 0; ++c)
                      rgb[pack.y * stride + 3 * (pack.x + k) + c] = static_cast<uint8_t>(colors[c][k]);
                });
}

}  // namespace

void fill_paint_scalar(TileKernels& table) {
  table.add_textured = add_textured;
  table.add_textured_grid = add_textured_grid;
  table.paint_textured = paint_textured;
}

}  // namespace pac
