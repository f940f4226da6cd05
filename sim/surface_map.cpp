#include "sim/surface_map.h"

#include <algorithm>

namespace pac::sim {

namespace {

uint8_t apart(uint32_t a, uint32_t b) {
  // One comparison: the difference is in -kKeyTolerance..kKeyTolerance.
  return static_cast<uint8_t>(a - b + uint32_t{kKeyTolerance} > 2 * uint32_t{kKeyTolerance} ? 1 : 0);
}

// 1 where the keys at x, x + 1 and below them do not belong together. Reads n + 1 of each.
void mark_mixed(const uint32_t* here, const uint32_t* below, int n, uint8_t* mixed) {
  for (int x = 0; x < n; ++x)
    mixed[x] = static_cast<uint8_t>(apart(here[x], here[x + 1]) | apart(here[x], below[x]) |
                                    apart(below[x], below[x + 1]) | apart(here[x + 1], below[x + 1]));
}

// Whatever is 1 spreads to its eight neighbors. Reads one more on both sides.
void spread(const uint8_t* above, const uint8_t* here, const uint8_t* below, int n, uint8_t* out) {
  for (int x = 0; x < n; ++x)
    out[x] = static_cast<uint8_t>((above[x - 1] | above[x] | above[x + 1]) | (here[x - 1] | here[x] | here[x + 1]) |
                                  (below[x - 1] | below[x] | below[x + 1]));
}

}  // namespace

SurfaceMap::SurfaceMap(int width, int height)
    : keys_(width + 2 * kBorder, height + 2 * kBorder), mixed_(width + 2, height + 2), wider_(width + 2, height + 2) {}

void SurfaceMap::set(PlaneView<const float> depth, PlaneView<const uint32_t> id, std::span<const uint32_t> surfaces,
                     const WarpKernels& kernels) {
  for (int y = 0; y < height(); ++y)
    kernels.surface_keys_row(id.row(y), depth.row(y), surfaces.data(), surfaces.size(), static_cast<size_t>(width()),
                             written_row(y));
}

void SurfaceMap::set_half(const SurfaceMap& full) {
  for (int y = 0; y < height(); ++y) {
    const uint32_t* from = full.row(2 * y);
    uint32_t* to = written_row(y);
    for (int x = 0; x < width(); ++x) to[x] = from[2 * x];
  }
}

void SurfaceMap::find_smooth() {
  const int w = width(), h = height();
  const auto at = [](GrayImage& image, int y) { return image.row(y + 1) + 1; };
  for (int y = 0; y < h; ++y) {
    uint32_t *here = written_row(y), *below = written_row(std::min(y + 1, h - 1));
    here[w] = here[w - 1];  // the last column and row go on outside
    below[w] = below[w - 1];
    mark_mixed(here, below, w, at(mixed_, y));
  }
  for (int y = 0; y < h; ++y) spread(at(mixed_, y - 1), at(mixed_, y), at(mixed_, y + 1), w, at(wider_, y));
  std::vector<uint8_t> widest(static_cast<size_t>(w));
  for (int y = 0; y < h; ++y) {
    spread(at(wider_, y - 1), at(wider_, y), at(wider_, y + 1), w, widest.data());
    uint32_t* keys = written_row(y);
    for (int x = 0; x < w; ++x) keys[x] |= widest[static_cast<size_t>(x)] != 0 ? 0 : kKeySmooth;
    keys[w] = 0;
  }
}

}  // namespace pac::sim
