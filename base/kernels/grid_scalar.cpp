// Normative definitions of the kernels for several samples a pixel at once: each sample is what rasterize() of
// tile_scalar.cpp makes of it.
#include <algorithm>

#include "base/kernels/tile_kernels.h"

namespace pac {
namespace {

bool is_inside(const RasterTriangle& t, int64_t x, int64_t y) {
  for (int i = 0; i < 3; ++i) {
    const int64_t edge = (i == 0 ? t.area2 : 0) + t.a[i] * x + t.b[i] * y;
    if (edge < t.exclude[i]) return false;
  }
  return true;
}

float depth_at(const RasterTriangle& t, int32_t x, int32_t y) {
  const float z = (t.z0 + static_cast<float>(y) * t.dzdy) + static_cast<float>(x) * t.dzdx;
  return std::min(std::max(z, t.z_min), t.z_max);
}

// Here whole pixels are background: the first triangle that touches one splits it.
void split(const SampleGrid& grid, int at) {
  if (grid.whole[at] == kSplitPixel) return;
  std::fill_n(grid.ids + at * kGridSamples, kGridSamples, grid.whole[at]);
  std::fill_n(grid.depth + at * kGridSamples, kGridSamples, 1.0f);
  grid.whole[at] = kSplitPixel;
}

void rasterize_one(const RasterTriangle& t, uint32_t id, SamplePosition origin, const SampleGrid& grid) {
  const int tile_x = origin.x >> 8, tile_y = origin.y >> 8;
  const int first_x = std::max(t.min_x - tile_x, 0), last_x = std::min(t.max_x - tile_x, kTileSize - 1);
  const int first_y = std::max(t.min_y - tile_y, 0), last_y = std::min(t.max_y - tile_y, kTileSize - 1);
  for (int py = first_y; py <= last_y; ++py)
    for (int px = first_x; px <= last_x; ++px)
      for (int s = 0; s < grid.n; ++s) {
        const int32_t x = origin.x + 256 * px + grid.x[s] - t.x0, y = origin.y + 256 * py + grid.y[s] - t.y0;
        if (!is_inside(t, x, y)) continue;
        const int pixel = py * kTileSize + px;
        split(grid, pixel);
        const float z = depth_at(t, x, y);
        const int at = pixel * kGridSamples + s;
        if (!(z < grid.depth[at])) continue;
        grid.depth[at] = z;
        grid.ids[at] = id;
      }
}

void rasterize_grid(const RasterTriangle* const* triangles, uint32_t n, SamplePosition origin, const SampleGrid& grid) {
  std::fill_n(grid.whole, kTileSize * kTileSize, 0u);
  std::fill_n(grid.near_z, kTileSize * kTileSize, 1.0f);
  std::fill_n(grid.far_z, kTileSize * kTileSize, 1.0f);
  for (uint32_t i = 0; i < n; ++i) rasterize_one(*triangles[i], i + 1, origin, grid);
}

void first_sample(const SampleGrid& grid, int width, int height, const RasterTriangle* const* triangles,
                  SamplePosition origin, const FirstSampleTarget& target) {
  for (int py = 0; py < height; ++py)
    for (int px = 0; px < width; ++px) {
      const int at = py * kTileSize + px;
      const bool is_split = grid.whole[at] == kSplitPixel;
      const uint32_t id = is_split ? grid.ids[at * kGridSamples] : grid.whole[at];
      float& depth = target.depth[py * target.depth_stride + px];
      uint32_t& shown = target.ids[py * target.id_stride + px];
      depth = 1.0f;
      shown = 0;
      if (id == 0) continue;
      const RasterTriangle& t = *triangles[id - 1];
      depth = depth_at(t, origin.x + 256 * px + grid.x[0] - t.x0, origin.y + 256 * py + grid.y[0] - t.y0);
      shown = t.id;
    }
}

// The packs of one group of eight pixels, in the order in which their triangles come by.
struct GroupPacks {
  LanePack* packs;
  int n = 0;
  uint32_t ids[8 * kGridSamples];
  int x, y;
  const RasterTriangle* const* triangles;

  void add(uint32_t id, int lane, int count) {
    int i = 0;
    while (i < n && ids[i] != id) ++i;
    if (i == n) {
      ids[n] = id;
      packs[n++] = {triangles[id - 1], static_cast<uint8_t>(x), static_cast<uint8_t>(y), 0, {}};
    }
    packs[i].mask = static_cast<uint8_t>(packs[i].mask | 1 << lane);
    packs[i].weight[lane] = static_cast<uint8_t>(packs[i].weight[lane] + count);
  }
};

int collect_grid(const SampleGrid& grid, uint32_t samples, int first_row, int last_row, int width,
                 const RasterTriangle* const* triangles, LanePack* packs) {
  int n = 0;
  for (int y = first_row; y < last_row; ++y)
    for (int x = 0; x < width; x += 8) {
      GroupPacks group;
      group.packs = packs + n;
      group.x = x;
      group.y = y;
      group.triangles = triangles;
      for (int k = 0; k < 8; ++k) {
        const int pixel = y * kTileSize + x + k;
        for (int s = 0; s < grid.n; ++s) {
          const uint32_t whole = grid.whole[pixel];
          const uint32_t id = whole == kSplitPixel ? grid.ids[pixel * kGridSamples + s] : whole;
          if ((samples >> s & 1) != 0 && id != 0) group.add(id, k, 1);
        }
      }
      n += group.n;
    }
  return n;
}

// The rounded final color of a triangle at a pixel's place of shading.
void color_at(const TileKernels& table, const RasterTriangle& t, int px, int py, SamplePosition origin, int rendering,
              bool inside, int color[3]) {
  float rows[3 * kBatchLanes];
  const LanePack pack{&t, static_cast<uint8_t>(px & ~7), static_cast<uint8_t>(py), 0xFF, {}};
  table.interpolate(&pack, 1, origin, {rendering, 3, rows, nullptr, 0, 0, 0, 0, inside});
  for (int c = 0; c < 3; ++c) {
    const float value = rows[c * kBatchLanes + (px & 7)];
    color[c] = static_cast<int>(std::clamp(value, 0.0f, 255.0f) + 0.5f);
  }
}

void paint_grid(const SampleGrid& grid, int width, int height, const RasterTriangle* const* triangles, int rendering,
                SamplePosition origin, const uint8_t background[3], uint8_t* rgb, ptrdiff_t stride) {
  TileKernels table{};
  fill_tile_scalar(table);
  for (int py = 0; py < height; ++py)
    for (int px = 0; px < width; ++px) {
      const int at = py * kTileSize + px;
      const uint32_t whole = grid.whole[at];
      const uint32_t* const ids = grid.ids + at * kGridSamples;
      const bool inside =
          whole != kSplitPixel || std::all_of(ids, ids + grid.n, [&](uint32_t i) { return i == ids[0]; });
      uint32_t shown = 0;
      int sums[3] = {grid.n / 2, grid.n / 2, grid.n / 2}, color[3] = {background[0], background[1], background[2]};
      for (int s = 0; s < grid.n; ++s) {
        const uint32_t id = whole == kSplitPixel ? ids[s] : whole;
        if (id != shown && id != 0) color_at(table, *triangles[id - 1], px, py, origin, rendering, inside, color);
        if (id != shown && id == 0) std::copy_n(background, 3, color);
        shown = id;
        for (int c = 0; c < 3; ++c) sums[c] += color[c];
      }
      for (int c = 0; c < 3; ++c) rgb[py * stride + 3 * px + c] = static_cast<uint8_t>(sums[c] / grid.n);
    }
}

}  // namespace

void fill_grid_scalar(TileKernels& table) {
  table.rasterize_grid = rasterize_grid;
  table.first_sample = first_sample;
  table.collect_grid = collect_grid;
  table.paint_grid = paint_grid;
}

}  // namespace pac
