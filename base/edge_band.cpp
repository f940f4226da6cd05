#include "base/edge_band.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace pac {
namespace {

// Marks both pixels of every pair of neighbors that `differ` (x, y, x', y').
template <class Differ>
GrayImage mark_edges(int width, int height, const Differ& differ) {
  GrayImage marks(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      if (x + 1 < width && differ(x, y, x + 1, y)) *marks.pixel(x, y) = *marks.pixel(x + 1, y) = 255;
      if (y + 1 < height && differ(x, y, x, y + 1)) *marks.pixel(x, y) = *marks.pixel(x, y + 1) = 255;
    }
  return marks;
}

// Spreads marks along a line of n samples, `stride` apart, by `reach` samples both ways.
void spread_line(uint8_t* line, int n, ptrdiff_t stride, int reach, std::vector<uint8_t>& scratch) {
  scratch.assign(static_cast<size_t>(n), 0);
  int last = -reach - 1;  // nearest mark seen so far
  for (int i = 0; i < n; ++i) {
    if (line[i * stride] != 0) last = i;
    if (i - last <= reach) scratch[static_cast<size_t>(i)] = 255;
  }
  last = n + reach;
  for (int i = n - 1; i >= 0; --i) {
    if (line[i * stride] != 0) last = i;
    if (last - i <= reach) scratch[static_cast<size_t>(i)] = 255;
  }
  for (int i = 0; i < n; ++i) line[i * stride] = scratch[static_cast<size_t>(i)];
}

GrayImage spread(GrayImage marks, int reach) {
  std::vector<uint8_t> scratch;
  for (int y = 0; y < marks.height(); ++y) spread_line(marks.row(y), marks.width(), 1, reach, scratch);
  for (int x = 0; x < marks.width(); ++x)
    spread_line(marks.pixel(x, 0), marks.height(), marks.stride(), reach, scratch);
  return marks;
}

}  // namespace

GrayImage edge_band(PlaneView<const uint32_t> id, int reach) {
  PAC_ASSERT(reach >= 1);
  return spread(mark_edges(id.width, id.height,
                           [&](int x, int y, int x2, int y2) { return *id.pixel(x, y) != *id.pixel(x2, y2); }),
                reach - 1);
}

GrayImage edge_band(PlaneView<const float> depth, float relative_step, int reach) {
  PAC_ASSERT(reach >= 1);
  const auto differ = [&](int x, int y, int x2, int y2) {
    const float p = *depth.pixel(x, y), q = *depth.pixel(x2, y2);
    return p != q && std::abs(p - q) > relative_step * std::min(p, q);
  };
  return spread(mark_edges(depth.width, depth.height, differ), reach - 1);
}

MaskedError masked_rms(ConstRgbView reference, ConstRgbView test, PlaneView<const uint8_t> mask) {
  PAC_ASSERT(!reference.empty() && reference.width == test.width && reference.height == test.height &&
             mask.width == test.width && mask.height == test.height);
  MaskedError error;
  uint64_t squares = 0;
  for (int y = 0; y < mask.height; ++y)
    for (int x = 0; x < mask.width; ++x) {
      if (*mask.pixel(x, y) == 0) continue;
      ++error.n_pixels;
      for (int c = 0; c < 3; ++c) {
        const int d = reference.pixel(x, y)[c] - test.pixel(x, y)[c];
        squares += static_cast<uint64_t>(d * d);
      }
    }
  if (error.n_pixels > 0)
    error.rms = std::sqrt(static_cast<double>(squares) / (3 * static_cast<double>(error.n_pixels)));
  return error;
}

}  // namespace pac
