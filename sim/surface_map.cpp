#include "sim/surface_map.h"

#include <algorithm>

namespace pac::sim {

SurfaceMap::SurfaceMap(int width, int height)
    : keys_(width + 2 * kBorder, height + 2 * kBorder), mixed_(width + 4, kRows + 1) {}

void SurfaceMap::set(PlaneView<const float> depth, PlaneView<const uint32_t> id, std::span<const uint32_t> surfaces,
                     const WarpKernels& kernels) {
  for (int y = 0; y < height(); ++y)
    kernels.surface_keys_row(id.row(y), depth.row(y), surfaces.empty() ? nullptr : surfaces.data(), surfaces.size(),
                             static_cast<size_t>(width()), written_row(y));
}

void SurfaceMap::set_half(const SurfaceMap& full) {
  for (int y = 0; y < height(); ++y) {
    const uint32_t* from = full.row(2 * y);
    uint32_t* to = written_row(y);
    for (int x = 0; x < width(); ++x) to[x] = from[2 * x];
  }
}

void SurfaceMap::find_smooth(const WarpKernels& kernels) {
  const int w = width(), h = height();
  if (w == 0 || h == 0) return;
  const auto mixed_row = [&](int y) { return mixed_.row(y < 0 || y >= h ? kRows : y % kRows); };
  for (int marked = 0, y = 0; y < h; ++y) {
    for (; marked <= std::min(y + kRows / 2, h - 1); ++marked) {
      uint32_t *here = written_row(marked), *below = written_row(std::min(marked + 1, h - 1));
      here[w] = here[w - 1];  // the last column and row go on outside
      below[w] = below[w - 1];
      kernels.mark_mixed(here, below, static_cast<size_t>(w), mixed_row(marked) + kRows / 2);
      here[w] = 0;
    }
    const uint8_t* rows[kRows];
    for (int k = 0; k < kRows; ++k) rows[k] = mixed_row(y - kRows / 2 + k);
    kernels.mark_smooth(rows, static_cast<size_t>(w), written_row(y));
  }
}

}  // namespace pac::sim
