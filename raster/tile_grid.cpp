// Tiles with several samples a pixel: the grid of what they see, and which of them share a color.
#include <algorithm>

#include "raster/tile_painter.h"

namespace pac::raster {

void TilePainter::paint_grid(const PaintInput& input, const Area& area, std::span<const SampleOffset> offsets,
                             int first_sample) {
  grid_ = {static_cast<int>(offsets.size()), {}, {}, whole_, near_z_, far_z_, grid_ids_, grid_depth_};
  for (size_t s = 0; s < kGridSamples; ++s) {
    const SampleOffset offset = offsets[s % offsets.size()];
    grid_.x[s] = offset.x;
    grid_.y[s] = offset.y;
  }
  const SamplePosition corner{area.x * 256, area.y * 256};
  input.kernels->tile.rasterize_grid(triangles_.data(), static_cast<uint32_t>(triangles_.size()), corner, grid_);
  if (first_sample == 0 && takes_first_sample_from_grid(input)) {
    const bool has_depth = !input.depth.empty(), has_ids = !input.id.empty();
    const FirstSampleTarget target{has_depth ? input.depth_at(area.x, area.y) : depth_,
                                   has_depth ? input.depth.stride : kTileSize,
                                   has_ids ? input.id_at(area.x, area.y) : ids_, has_ids ? input.id.stride : kTileSize};
    if (has_depth || has_ids)
      input.kernels->tile.first_sample(grid_, area.width, area.height, triangles_.data(), corner, target);
  }
  // The one whose shading leaves the packs as they are goes first.
  const int first = input.has_final_colors[1] ? 1 : 0;
  const int renderings[2] = {first, 1 - first};
  bool wanted[2] = {wants_color(input, 0), input.surfaces[1] != nullptr && wants_color(input, 1)};
  for (int r = 0; r < 2; ++r) {
    if (!wanted[r] || !paints_directly(input, r)) continue;
    const ColorTarget target = color_target(input, area, r);
    input.kernels->tile.paint_grid(grid_, area.width, area.height, triangles_.data(), r, position(area, {128, 128}),
                                   input.background, target.rgb, target.stride);
    wanted[r] = false;
  }
  if (wanted[0] && wanted[1] && input.shading_samples[0] == input.shading_samples[1])
    return shade_grid(input, area, renderings, first_sample);
  for (const int& rendering : renderings)
    if (wanted[rendering]) shade_grid(input, area, {&rendering, 1}, first_sample);
}

// Depth and ids come with the colors: previous positions alone need a rasterization of their own.
bool TilePainter::takes_first_sample_from_grid(const PaintInput& input) const {
  return input.pattern.size() > 1 && input.previous.empty() && (wants_color(input, 0) || wants_color(input, 1)) &&
         !has_masked_ && !has_blended_;
}

// Every sample by itself; all at the pixel's center; or those of each quarter of the pixel at its center.
int TilePainter::list_groups(int shading_samples, int first_sample, ShadingGroup groups[kGridSamples]) const {
  const uint32_t all = (1u << grid_.n) - 1;
  if (shading_samples == 0) {
    for (int s = 0; s < grid_.n; ++s)
      groups[s] = {1u << s, {static_cast<uint8_t>(grid_.x[s]), static_cast<uint8_t>(grid_.y[s])}, first_sample + s};
    return grid_.n;
  }
  if (shading_samples == 1) {
    groups[0] = {all, {128, 128}, 0};
    return 1;
  }
  for (int quarter = 0; quarter < 4; ++quarter) {
    const int right = quarter & 1, below = quarter >> 1;
    groups[quarter] = {0, {static_cast<uint8_t>(64 + 128 * right), static_cast<uint8_t>(64 + 128 * below)}, quarter};
    for (int s = 0; s < grid_.n; ++s)
      if (grid_.x[s] / 128 == right && grid_.y[s] / 128 == below) groups[quarter].samples |= 1u << s;
  }
  return 4;
}

// Renderings with the same shading_samples: what is seen is listed once for all of them.
void TilePainter::shade_grid(const PaintInput& input, const Area& area, std::span<const int> renderings,
                             int first_sample) {
  ShadingGroup groups[kGridSamples];
  const int shading_samples = input.shading_samples[renderings[0]];
  const int n_groups = list_groups(shading_samples, first_sample, groups);
  if (shading_samples == 0) {
    const std::span<const ShadingGroup> samples{groups, static_cast<size_t>(n_groups)};
    int left[2], n_left = 0;
    for (const int r : renderings)
      if (!add_textured_grid(input, area, r)) left[n_left++] = r;
    renderings = {left, static_cast<size_t>(n_left)};
    if (renderings.empty()) return;
    if (std::all_of(renderings.begin(), renderings.end(), [&](int r) { return fills_squares(input, r); }))
      return shade_each_sample(input, area, renderings, samples);
    for (const int& rendering : renderings) shade_each_sample(input, area, {&rendering, 1}, samples);
    return;
  }
  for (int row = 0; row < area.height; row += kGridRows)
    for (int i = 0; i < n_groups; ++i) {
      if (groups[i].samples == 0) continue;
      const int n = input.kernels->tile.collect_grid(
          grid_, groups[i].samples, row, std::min(row + kGridRows, area.height), area.width, triangles_.data(), packs_);
      const bool keep = renderings.size() > 1 && !input.has_final_colors[renderings[0]];  // shade() uses them up
      if (keep) std::copy_n(packs_, n, shared_packs_);
      for (const int& rendering : renderings) {
        if (keep && &rendering != renderings.data()) std::copy_n(shared_packs_, n, packs_);
        n_packs_ = n;
        shade(input, {rendering, groups[i].number, shading_samples, position(area, groups[i].place), true},
              sums_[rendering]);
      }
    }
}

// Textured squares of pixels with all their samples, which show the same triangle more often than squares of as many
// pixels with one sample each.
bool TilePainter::add_textured_grid(const PaintInput& input, const Area& area, int rendering) {
  if (grid_.n != kGridSamples || input.has_final_colors[rendering] || input.painted[rendering] == nullptr) return false;
  input.kernels->tile.add_textured_grid(grid_, area.width, area.height, triangles_.data(), rendering,
                                        position(area, {0, 0}), input.painted[rendering], input.background,
                                        sums_[rendering]);
  return true;
}

// All samples of the grid, each with a color: of one rendering, or of several that fill squares.
void TilePainter::shade_each_sample(const PaintInput& input, const Area& area, std::span<const int> renderings,
                                    std::span<const ShadingGroup> samples) {
  const int rendering = renderings[0];
  const bool by_squares = fills_squares(input, rendering);  // each of which shows what is whole
  const auto count = static_cast<int>(input.pattern.size());
  const auto pass = [&](const ShadingGroup& sample) {  // inside of triangles, as groups that are not whole
    return ShadePass{
        rendering, sample.number, count, position(area, sample.place), false, input.shades_lanes[rendering]};
  };
  n_whole_packs_ = 0;
  if (!by_squares) take_whole_groups(area, rendering);
  for (const ShadingGroup& sample : samples) shade_whole_groups(input, pass(sample), sums_[rendering]);
  for (int row = 0; row < area.height; row += kGridRows) {
    const int n_rows = std::min(kGridRows, area.height - row);
    split_by_sample(area, row, n_rows);
    SampleIds seen[kGridSamples];
    for (size_t s = 0; s < samples.size(); ++s) {
      const SamplePosition first = position(area, samples[s].place);
      seen[s] = {sample_ids_[s], {first.x, first.y + 256 * row}};
    }
    if (by_squares) {
      for (const int r : renderings)
        add_squares(input, r, {seen, samples.size()}, area.width, n_rows, sums_[r] + row * kTileSize);
      continue;
    }
    for (size_t s = 0; s < samples.size(); ++s) {
      ShadePass rows = pass(samples[s]);
      rows.origin = seen[s].origin;
      shade_ids(input, rows, seen[s].ids, area.width, n_rows, sums_[rendering] + row * kTileSize);
    }
  }
  put_whole_groups_back();
}

// What each sample of a few rows sees -> sample_ids_.
void TilePainter::split_by_sample(const Area& area, int first_row, int n_rows) {
  const auto n_samples = static_cast<size_t>(grid_.n);
  for (int i = 0; i < n_rows * kTileSize; i += 8) {
    const int at = first_row * kTileSize + i, n_inside = std::clamp(area.width - i % kTileSize, 0, 8);
    uint32_t seen[8] = {};
    std::copy_n(whole_ + at, n_inside, seen);
    for (size_t s = 0; s < n_samples; ++s) std::copy_n(seen, 8, sample_ids_[s] + i);
    for (int k = 0; k < n_inside; ++k) {
      if (seen[k] != kSplitPixel) continue;
      const uint32_t* const ids = grid_ids_ + static_cast<size_t>(at + k) * kGridSamples;
      for (size_t s = 0; s < n_samples; ++s) sample_ids_[s][i + k] = ids[s];
    }
  }
}

// Groups of eight pixels that show one triangle at all samples -> whole_packs_, by material: every sample shades them
// alike, so they are listed once. Out of the grid, which is left with the others.
void TilePainter::take_whole_groups(const Area& area, int rendering) {
  n_whole_packs_ = 0;
  for (int y = 0; y < area.height; ++y)
    for (int x = 0; x < area.width; x += 8) {
      uint32_t* const group = whole_ + y * kTileSize + x;
      const uint32_t id = group[0];
      if (id == 0 || id == kSplitPixel || std::any_of(group + 1, group + 8, [&](uint32_t i) { return i != id; }))
        continue;
      whole_packs_[n_whole_packs_++] = {triangles_[id - 1], static_cast<uint8_t>(x), static_cast<uint8_t>(y), 0xFF, {}};
      whole_ids_[y * (kTileSize / 8) + x / 8] = id;
      std::fill_n(group, 8, 0u);
    }
  std::sort(whole_packs_, whole_packs_ + n_whole_packs_, [&](const LanePack& a, const LanePack& b) {
    const uint32_t state_a = a.triangle->state[rendering], state_b = b.triangle->state[rendering];
    if (state_a != state_b) return state_a < state_b;
    return a.y != b.y ? a.y < b.y : a.x < b.x;
  });
}

void TilePainter::put_whole_groups_back() {
  for (int i = 0; i < n_whole_packs_; ++i) {
    const LanePack& pack = whole_packs_[i];
    std::fill_n(whole_ + pack.y * kTileSize + pack.x, 8, whole_ids_[pack.y * (kTileSize / 8) + pack.x / 8]);
  }
}

void TilePainter::shade_whole_groups(const PaintInput& input, const ShadePass& pass, uint16_t* sums) {
  for (int first = 0, last = 0; first < n_whole_packs_; first = last) {
    const uint32_t state = whole_packs_[first].triangle->state[pass.rendering];
    while (last < n_whole_packs_ && whole_packs_[last].triangle->state[pass.rendering] == state) ++last;
    shade_packs(input, (*input.surfaces[pass.rendering])[state], pass, whole_packs_ + first, last - first, sums);
  }
}

}  // namespace pac::raster
