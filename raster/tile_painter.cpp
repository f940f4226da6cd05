#include "raster/tile_painter.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace pac::raster {
namespace {

// Rows of a part of a picture, before they are written. Inline, or GCC takes it for a function without effect.
template <class T, int kChannels>
[[gnu::always_inline]] inline void prefetch(const ImageView<T, kChannels>& image, int x, int y, int width, int height) {
  if (image.empty()) return;
  constexpr ptrdiff_t kLine = 64;
  const ptrdiff_t bytes = ptrdiff_t{width} * kChannels * ptrdiff_t{sizeof(T)};
  for (int row = y; row < y + height; ++row) {
    const auto* const first = reinterpret_cast<const char*>(image.pixel(x, row));
    for (ptrdiff_t at = 0; at < bytes; at += kLine) __builtin_prefetch(first + at, 1, 2);
    __builtin_prefetch(first + bytes - 1, 1, 2);
  }
}

// Lanes in a mask of eight; base code may not count on the instruction for it.
struct LaneCounts {
  uint8_t of[256] = {};
  constexpr LaneCounts() {
    for (unsigned mask = 1; mask < 256; ++mask) of[mask] = static_cast<uint8_t>(of[mask >> 1] + (mask & 1));
  }
};
constexpr LaneCounts kLanes;

}  // namespace

void TilePainter::paint(const PaintInput& input, int tile) {
  const int tile_x = tile % input.draw_list->tiles_x(), tile_y = tile / input.draw_list->tiles_x();
  const Area area{tile_x * kTileSize, tile_y * kTileSize, std::min(kTileSize, input.width - tile_x * kTileSize),
                  std::min(kTileSize, input.height - tile_y * kTileSize)};
  input.draw_list->triangles_of(tile, triangles_);
  if (triangles_.empty()) return write_background(input, area);
  // Each row is on a page of its own, where the processor by itself sees no pattern: it fetches them meanwhile.
  prefetch(input.color[0], area.x, area.y, area.width, area.height);
  prefetch(input.color[1], area.x, area.y, area.width, area.height);
  prefetch(input.difference, area.x, area.y, area.width, area.height);
  prefetch(input.depth, area.x, area.y - input.first_row, area.width, area.height);
  prefetch(input.id, area.x, area.y - input.first_row, area.width, area.height);
  find_transparent(input);
  const int n_renderings = input.surfaces[1] != nullptr ? 2 : 1;
  const size_t n_samples = input.pattern.size();
  for (int r = 0; r < n_renderings; ++r)
    for (int c = 0; c < 3 && !paints_directly(input, r); ++c)
      std::fill_n(sums_[r] + c * kTilePixels, kTilePixels,
                  static_cast<uint16_t>(n_samples * input.background[c] + n_samples / 2));
  if (has_masked_ || has_blended_) {
    paint_samples(input, area);
    return write_color(input, area);
  }
  write_first_sample(input, area);
  if (!wants_color(input, 0) && !wants_color(input, 1)) return;
  if (n_samples == 1) {
    for (int r = 0; r < n_renderings; ++r)
      if (wants_color(input, r)) shade_first_sample(input, area, r);
  } else {
    for (size_t first = 0; first < n_samples; first += kGridSamples)
      paint_grid(input, area, input.pattern.subspan(first, std::min<size_t>(kGridSamples, n_samples - first)),
                 static_cast<int>(first));
  }
  write_color(input, area);
}

bool TilePainter::wants_color(const PaintInput& input, int rendering) {
  return !input.color[rendering].empty() || !input.difference.empty();
}

// Somebody asks which triangle the first sample shows; else its depth is all that counts. Several samples are shaded
// from their grid.
bool TilePainter::wants_ids(const PaintInput& input) {
  const bool shades = wants_color(input, 0) || wants_color(input, 1);
  return !input.id.empty() || !input.previous.empty() || (shades && input.pattern.size() == 1);
}

SamplePosition TilePainter::position(const Area& area, SampleOffset offset) {
  return {area.x * 256 + offset.x, area.y * 256 + offset.y};
}

// Depth, ids and previous positions; what it rasterizes stays in depth_ and, where it is wanted, ids_.
void TilePainter::write_first_sample(const PaintInput& input, const Area& area) {
  if (input.pattern.size() > 1 && input.depth.empty() && input.id.empty() && input.previous.empty()) return;
  if (takes_first_sample_from_grid(input)) return;
  const SamplePosition origin = position(area, input.pattern[0]);
  rasterize(input, origin);
  write_depth_and_id(input, area);
  if (!input.previous.empty()) write_previous(input, area, origin);
}

// Colors that need nothing but interpolation, with several samples once a pixel, and with one perhaps a texture: they
// go to the target without sums.
bool TilePainter::paints_directly(const PaintInput& input, int rendering) const {
  if (has_masked_ || has_blended_) return false;
  const size_t n_samples = input.pattern.size();
  if (n_samples == 1) return fills_squares(input, rendering);
  return n_samples <= kGridSamples && input.shading_samples[rendering] == 1 && input.has_final_colors[rendering];
}

TilePainter::ColorTarget TilePainter::color_target(const PaintInput& input, const Area& area, int rendering) {
  const RgbView& target = input.color[rendering];
  if (target.empty()) return {rgb_[rendering], ptrdiff_t{3 * kTileSize}};
  return {target.pixel(area.x, area.y), target.stride};
}

void TilePainter::shade_first_sample(const PaintInput& input, const Area& area, int rendering) {
  const SamplePosition origin = position(area, input.pattern[0]);
  if (!paints_directly(input, rendering))
    return shade_ids(input, {rendering, 0, 1, origin, false}, ids_, area.width, area.height, sums_[rendering]);
  const auto [rgb, stride] = color_target(input, area, rendering);
  const TileKernels& kernels = input.kernels->tile;
  if (input.has_final_colors[rendering])
    kernels.paint_colors(ids_, area.width, area.height, triangles_.data(), rendering, origin, input.background, rgb,
                         stride);
  else
    kernels.paint_textured(ids_, area.width, area.height, triangles_.data(), rendering, origin,
                           input.painted[rendering], input.background, rgb, stride);
}

// Colors that need nothing but interpolation and a texture are found square by square, without packs.
bool TilePainter::fills_squares(const PaintInput& input, int rendering) {
  return input.has_final_colors[rendering] || input.painted[rendering] != nullptr;
}

void TilePainter::add_squares(const PaintInput& input, int rendering, std::span<const SampleIds> samples, int width,
                              int height, uint16_t* sums) {
  const TileKernels& kernels = input.kernels->tile;
  const auto n = static_cast<int>(samples.size());
  if (input.has_final_colors[rendering])
    kernels.add_colors(samples.data(), n, width, height, triangles_.data(), rendering, input.background, sums);
  else
    kernels.add_textured(samples.data(), n, width, height, triangles_.data(), rendering, input.painted[rendering],
                         input.background, sums);
}

// What one sample a pixel sees, rows of `ids` from the pass's origin down, to the sums of the same rows.
void TilePainter::shade_ids(const PaintInput& input, const ShadePass& pass, const uint32_t* ids, int width, int height,
                            uint16_t* sums) {
  const TileKernels& kernels = input.kernels->tile;
  if (fills_squares(input, pass.rendering)) {
    const SampleIds sample{ids, pass.origin};
    return add_squares(input, pass.rendering, {&sample, 1}, width, height, sums);
  }
  const bool by_groups = input.shades_lanes[pass.rendering];
  n_packs_ = by_groups ? kernels.collect_groups(ids, width, height, triangles_.data(),
                                                input.has_one_batch[pass.rendering] ? -1 : pass.rendering, packs_)
                       : kernels.collect_packs(ids, width, height, triangles_.data(), packs_);
  shade(input, pass, sums, by_groups ? ids : nullptr);
}

// Each sample a rasterization of its own: tiles with masked or transparent triangles.
void TilePainter::paint_samples(const PaintInput& input, const Area& area) {
  const int n_renderings = input.surfaces[1] != nullptr ? 2 : 1;
  const auto n_samples = static_cast<int>(input.pattern.size());
  for (int s = 0; s < n_samples; ++s) {
    const SamplePosition origin = position(area, input.pattern[static_cast<size_t>(s)]);
    rasterize(input, origin);
    if (s == 0) write_depth_and_id(input, area);
    if (s == 0 && !input.previous.empty()) write_previous(input, area, origin);
    if (!wants_color(input, 0) && !wants_color(input, 1)) return;
    const int n_packs = input.kernels->tile.collect_packs(ids_, area.width, area.height, triangles_.data(), packs_);
    if (n_renderings == 2) std::copy_n(packs_, n_packs, shared_packs_);
    for (int r = 0; r < n_renderings; ++r) {
      if (r == 1) std::copy_n(shared_packs_, n_packs, packs_);  // shade() and blend() use them up
      n_packs_ = n_packs;
      const ShadePass pass{r, s, n_samples, origin, false};
      for (int c = 0; c < 3; ++c) std::fill_n(colors_ + c * kTilePixels, kTilePixels, uint16_t{input.background[c]});
      shade(input, pass, colors_);
      if (has_blended_) blend(input, pass);
      add_sample(input, r);
    }
  }
}

void TilePainter::find_transparent(const PaintInput& input) {
  has_masked_ = has_blended_ = false;
  if (!input.has_transparent) return;
  for (const RasterTriangle* triangle : triangles_) {
    const AlphaMode alpha = (*input.surfaces[0])[triangle->state[0]].alpha;
    has_masked_ = has_masked_ || alpha == AlphaMode::mask;
    has_blended_ = has_blended_ || alpha == AlphaMode::blend;
  }
}

// What is opaque or passes its mask.
void TilePainter::rasterize(const PaintInput& input, SamplePosition origin) {
  if (!has_masked_ && !has_blended_)
    return input.kernels->tile.rasterize_all(triangles_.data(), static_cast<uint32_t>(triangles_.size()), origin,
                                             depth_, wants_ids(input) ? ids_ : nullptr);
  std::fill_n(depth_, kTilePixels, 1.0f);
  std::fill_n(ids_, kTilePixels, 0u);
  for (size_t i = 0; i < triangles_.size(); ++i) {
    const auto number = static_cast<uint32_t>(i + 1);
    const Surface& surface = (*input.surfaces[0])[triangles_[i]->state[0]];
    if (surface.alpha == AlphaMode::mask) rasterize_mask(input, number, surface, {0, 0, 1, origin, false});
    if (surface.alpha != AlphaMode::opaque) continue;
    input.kernels->tile.rasterize(*triangles_[i], number, origin, depth_, ids_);
  }
}

// Packs of the samples where one triangle is nearer than depth_ -> packs_; their depths -> own_depth_.
int TilePainter::visible_packs(const PaintInput& input, const RasterTriangle& triangle, SamplePosition origin) {
  const int tile_x = origin.x >> 8, tile_y = origin.y >> 8;
  const int x0 = std::max(triangle.min_x - tile_x, 0) & ~7, x1 = std::min(triangle.max_x - tile_x, kTileSize - 1);
  const int y0 = std::max(triangle.min_y - tile_y, 0), y1 = std::min(triangle.max_y - tile_y, kTileSize - 1);
  if (x0 > x1 || y0 > y1) return 0;
  const int width = (x1 - x0) / 8 * 8 + 8;
  for (int y = y0; y <= y1; ++y) {
    std::copy_n(depth_ + y * kTileSize + x0, width, own_depth_ + y * kTileSize + x0);
    std::fill_n(own_ids_ + y * kTileSize + x0, width, 0u);
  }
  input.kernels->tile.rasterize(triangle, 1, origin, own_depth_, own_ids_);
  const RasterTriangle* const only = &triangle;
  const int n = input.kernels->tile.collect_packs(own_ids_ + y0 * kTileSize + x0, width, y1 - y0 + 1, &only, packs_);
  for (int i = 0; i < n; ++i) {
    packs_[i].x = static_cast<uint8_t>(packs_[i].x + x0);
    packs_[i].y = static_cast<uint8_t>(packs_[i].y + y0);
  }
  return n;
}

void TilePainter::rasterize_mask(const PaintInput& input, uint32_t number, const Surface& surface,
                                 const ShadePass& pass) {
  const int n = visible_packs(input, *triangles_[number - 1], pass.origin);
  for (int first = 0; first < n; first += kBatchPacks)
    shader_.cut_out(input.kernels->tile, surface, pass, packs_ + first, std::min(kBatchPacks, n - first));
  for (int i = 0; i < n; ++i) {
    const int at = packs_[i].y * kTileSize + packs_[i].x;
    for (int k = 0; k < 8; ++k) {
      if ((packs_[i].mask >> k & 1) == 0) continue;
      depth_[at + k] = own_depth_[at + k];
      ids_[at + k] = number;
    }
  }
}

// Packs of one batch state together, in calls of up to kBatchPacks; uses packs_ up, but not where colors are final:
// then states do not matter. Where triangles are small most packs have few lanes: those are taken apart, and lanes of
// different triangles shaded together; but packs of collect_groups(), with the ids that they are from, stay as they
// are.
void TilePainter::shade(const PaintInput& input, const ShadePass& pass, uint16_t* sums, const uint32_t* group_ids) {
  const std::vector<Surface>& surfaces = *input.surfaces[pass.rendering];
  const bool together = input.has_final_colors[pass.rendering];
  for (int left = n_packs_; left > 0;) {
    const uint32_t state = packs_[0].triangle->state[pass.rendering];
    const Surface& surface = surfaces[state];
    const int few = group_ids != nullptr ? 0 : few_lanes(surface);
    int n = 0, rest = 0;
    n_lanes_ = 0;
    for (int i = 0; i < left; ++i) {
      const LanePack& pack = packs_[i];
      if (!together && pack.triangle->state[pass.rendering] != state) {
        packs_[rest++] = pack;
      } else if (kLanes.of[pack.mask] <= few) {
        for (unsigned mask = pack.mask; mask != 0; mask &= mask - 1) {
          const int k = std::countr_zero(mask);
          lanes_[n_lanes_++] = {pack.triangle, static_cast<uint8_t>(pack.x + k), pack.y, pack.weight[k]};
        }
        if (n_lanes_ + 8 > kBatchLanes) shade_lanes(input, surface, pass, sums);
      } else {
        batch_[n++] = pack;
      }
    }
    left = rest;
    shade_lanes(input, surface, pass, sums);
    shade_packs(input, surface, pass, batch_, n, sums, group_ids);
  }
}

void TilePainter::shade_packs(const PaintInput& input, const Surface& surface, const ShadePass& pass,
                              const LanePack* packs, int n, uint16_t* sums, const uint32_t* group_ids) {
  for (int i = 0; i < n; i += kBatchPacks) {
    const int count = std::min(kBatchPacks, n - i);
    const ShadedBatch shaded =
        group_ids == nullptr
            ? shader_.shade(input.kernels->tile, surface, pass, packs + i, count)
            : shader_.shade_groups(input.kernels->tile, surface, pass, packs + i, count, group_ids, triangles_.data());
    input.kernels->tile.accumulate(packs + i, count, pass.weighted, shaded.color, shaded.texels, shaded.added,
                                   input.background, sums);
  }
}

// Packs with so many lanes or fewer are taken apart: a lane by itself costs about as much as half a pack's
// interpolation, and an eighth of everything after it, which is next to nothing where colors are only interpolated.
int TilePainter::few_lanes(const Surface& surface) {
  if (!BatchShader::shades_lanes(surface)) return 0;
  return surface.textured || surface.fogged || surface.lit == Surface::Lit::per_sample ? 4 : 1;
}

void TilePainter::shade_lanes(const PaintInput& input, const Surface& surface, const ShadePass& pass, uint16_t* sums) {
  if (n_lanes_ == 0) return;
  const ShadedBatch shaded = shader_.shade_lanes(input.kernels->tile, surface, pass, lanes_, n_lanes_);
  input.kernels->tile.accumulate_lanes(lanes_, n_lanes_, pass.weighted, shaded.color, shaded.texels, shaded.added,
                                       input.background, sums);
  n_lanes_ = 0;
}

// Transparent triangles over colors_, in the order of the scene.
void TilePainter::blend(const PaintInput& input, const ShadePass& pass) {
  for (const RasterTriangle* triangle : triangles_) {
    if ((*input.surfaces[0])[triangle->state[0]].alpha != AlphaMode::blend) continue;
    const Surface& surface = (*input.surfaces[pass.rendering])[triangle->state[pass.rendering]];
    const int n = visible_packs(input, *triangle, pass.origin);
    for (int i = 0; i < n; i += kBatchPacks) {
      const int count = std::min(kBatchPacks, n - i);
      const ShadedBatch shaded = shader_.shade(input.kernels->tile, surface, pass, packs_ + i, count);
      input.kernels->tile.blend(packs_ + i, count, shaded.color, shaded.texels, shaded.added, shaded.alpha, colors_);
    }
  }
}

// Sums start at the background's.
void TilePainter::add_sample(const PaintInput& input, int rendering) {
  for (int c = 0; c < 3; ++c)
    for (int i = c * kTilePixels; i < (c + 1) * kTilePixels; ++i)
      sums_[rendering][i] = static_cast<uint16_t>(sums_[rendering][i] + colors_[i] - input.background[c]);
}

void TilePainter::write_depth_and_id(const PaintInput& input, const Area& area) const {
  if (input.depth.empty() && input.id.empty()) return;
  for (int y = 0; y < area.height; ++y) {
    if (!input.depth.empty()) std::copy_n(depth_ + y * kTileSize, area.width, input.depth_at(area.x, area.y + y));
    if (input.id.empty()) continue;
    uint32_t* out = input.id_at(area.x, area.y + y);
    for (int x = 0; x < area.width; ++x) {
      const uint32_t id = ids_[y * kTileSize + x];
      out[x] = id == 0 ? 0 : triangles_[id - 1]->id;
    }
  }
}

void TilePainter::clear_previous(const PaintInput& input, const Area& area) {
  for (int y = 0; y < area.height; ++y) {
    float* out = input.previous.pixel(area.x, area.y + y);
    for (int x = 0; x < area.width; ++x, out += 3) {
      out[0] = out[1] = kNoPrevious;
      out[2] = 1.0f;
    }
  }
}

// A tile that no triangle touches.
void TilePainter::write_background(const PaintInput& input, const Area& area) {
  uint8_t row[3 * kTileSize];
  for (int i = 0; i < 3 * kTileSize; ++i) row[i] = input.background[i % 3];
  for (int y = 0; y < area.height; ++y) {
    for (const RgbView& color : input.color)
      if (!color.empty()) std::copy_n(row, 3 * area.width, color.pixel(area.x, area.y + y));
    if (!input.difference.empty())
      input.kernels->pixel.difference_row(row, row, input.difference.pixel(area.x, area.y + y),
                                          3 * static_cast<size_t>(area.width));
    if (!input.depth.empty()) std::fill_n(input.depth_at(area.x, area.y + y), area.width, 1.0f);
    if (!input.id.empty()) std::fill_n(input.id_at(area.x, area.y + y), area.width, 0u);
  }
  if (!input.previous.empty()) clear_previous(input, area);
}

// Interpolates the previous frame's clip coordinates: they are affine on the triangle, so perspective-correct
// interpolation and one division give the exact place.
void TilePainter::write_previous(const PaintInput& input, const Area& area, SamplePosition origin) {
  clear_previous(input, area);
  const int n = input.kernels->tile.collect_packs(ids_, area.width, area.height, triangles_.data(), packs_);
  const auto half_width = 0.5f * static_cast<float>(input.width), half_height = 0.5f * static_cast<float>(input.height);
  const float offset_x = static_cast<float>(128 - (origin.x & 255)),
              offset_y = static_cast<float>(128 - (origin.y & 255));
  const auto rounded = [](float pixels, float offset) {  // from the sample to the pixel's center
    constexpr float kLimit = 0x1p20f;
    const float fixed = std::floor(std::min(std::max(pixels, -kLimit), kLimit) * 256.0f + (offset + 0.5f));
    return fixed * (1.0f / 256.0f);
  };
  for (int first = 0; first < n; first += kBatchPacks) {
    const int count = std::min(kBatchPacks, n - first);
    const InterpolateTarget target{2, 4, rows_, nullptr, 0, 0, 0, 0};
    input.kernels->tile.interpolate(packs_ + first, count, origin, target);
    for (int lane = 0; lane < 8 * count; ++lane) {
      const LanePack& pack = packs_[first + lane / 8];
      if ((pack.mask >> (lane & 7) & 1) == 0 || pack.x + (lane & 7) >= area.width) continue;
      const float* clip = rows_ + lane;
      const float w = clip[3 * kBatchLanes], z = clip[2 * kBatchLanes];
      if (!(w >= 0x1p-60f && z >= -w)) continue;
      const float inverse_w = 1.0f / w;
      float* out = input.previous.pixel(area.x + pack.x + (lane & 7), area.y + pack.y);
      out[0] = rounded((clip[0] * inverse_w) * half_width + half_width, offset_x);
      out[1] = rounded(half_height - (clip[kBatchLanes] * inverse_w) * half_height, offset_y);
      out[2] = (z * inverse_w) * 0.5f + 0.5f;
    }
  }
}

void TilePainter::write_color(const PaintInput& input, const Area& area) {
  const int shift = std::countr_zero(static_cast<unsigned>(input.pattern.size()));
  const int n_renderings = input.surfaces[1] != nullptr ? 2 : 1;
  const bool painted[2] = {paints_directly(input, 0), n_renderings < 2 || paints_directly(input, 1)};
  if (painted[0] && painted[1] && input.difference.empty()) return;
  for (int y = 0; y < area.height; ++y) {
    uint8_t* at[2];
    for (int r = 0; r < n_renderings; ++r) {
      at[r] = input.color[r].empty() ? rgb_[r] + 3 * kTileSize * y : input.color[r].pixel(area.x, area.y + y);
      if (!painted[r]) input.kernels->tile.resolve_row(sums_[r] + y * kTileSize, shift, area.width, at[r]);
    }
    if (!input.difference.empty())
      input.kernels->pixel.difference_row(at[0], at[1], input.difference.pixel(area.x, area.y + y),
                                          3 * static_cast<size_t>(area.width));
  }
}

}  // namespace pac::raster
