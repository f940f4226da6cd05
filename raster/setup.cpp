#include "raster/setup.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace pac::raster {
namespace {

// Pixels whose samples (offsets in [low, high]) may lie in [min, max] of one axis, inside [0, size).
struct PixelRange {
  int32_t first, last;
};
PixelRange pixel_range(int32_t min, int32_t max, int32_t low, int32_t high, int32_t size) {
  return {std::max((min - high + 255) >> 8, 0), std::min((max - low) >> 8, size - 1)};
}

// A sample on an edge belongs to the triangle whose interior is to the right of it, or below it if it is horizontal.
bool is_top_left(int32_t a, int32_t b) {
  return a > 0 || (a == 0 && b > 0);
}

void set_edges(const ScreenVertex& v0, const ScreenVertex& v1, const ScreenVertex& v2, RasterTriangle& out) {
  out.x0 = v0.x;
  out.y0 = v0.y;
  out.a[1] = v2.y - v0.y;
  out.b[1] = v0.x - v2.x;
  out.a[2] = v0.y - v1.y;
  out.b[2] = v1.x - v0.x;
  out.a[0] = -(out.a[1] + out.a[2]);
  out.b[0] = -(out.b[1] + out.b[2]);
  for (int i = 0; i < 3; ++i) out.exclude[i] = is_top_left(out.a[i], out.b[i]) ? 0 : 1;
  const int bits = 64 - std::countl_zero(static_cast<uint64_t>(out.area2));
  out.shift = bits > 31 ? bits - 31 : 0;
}

void set_depth(const ScreenVertex& v0, const ScreenVertex& v1, const ScreenVertex& v2, RasterTriangle& out) {
  const float dz1 = v1.z - v0.z, dz2 = v2.z - v0.z;
  const auto area = static_cast<float>(out.area2);
  out.z0 = v0.z;
  out.dzdx = (static_cast<float>(out.a[1]) * dz1 + static_cast<float>(out.a[2]) * dz2) / area;
  out.dzdy = (static_cast<float>(out.b[1]) * dz1 + static_cast<float>(out.b[2]) * dz2) / area;
  out.z_min = std::min(v0.z, std::min(v1.z, v2.z));
  out.z_max = std::max(v0.z, std::max(v1.z, v2.z));
}

// Perspective correction needs the ratios of 1/w only; bounded below so that the weights never all vanish.
void set_weights(const ScreenVertex& v0, const ScreenVertex& v1, const ScreenVertex& v2, RasterTriangle& out) {
  const float largest = std::max(v0.inverse_w, std::max(v1.inverse_w, v2.inverse_w));
  const ScreenVertex* corners[3] = {&v0, &v1, &v2};
  for (int i = 0; i < 3; ++i) out.w[i] = std::max(corners[i]->inverse_w / largest, 0x1p-40f);
}

}  // namespace

SampleHull sample_hull(std::span<const SampleOffset> pattern) {
  SampleHull hull{255, 255, 0, 0};
  for (const SampleOffset& s : pattern) {
    hull.min_x = std::min<int32_t>(hull.min_x, s.x);
    hull.max_x = std::max<int32_t>(hull.max_x, s.x);
    hull.min_y = std::min<int32_t>(hull.min_y, s.y);
    hull.max_y = std::max<int32_t>(hull.max_y, s.y);
  }
  return hull;
}

SetupResult setup_triangle(const ScreenVertex corners[3], const Viewport& viewport, const SampleHull& hull,
                           RasterTriangle& out) {
  const ScreenVertex &v0 = corners[0], *v1 = &corners[1], *v2 = &corners[2];
  int64_t area2 =
      static_cast<int64_t>(v1->x - v0.x) * (v2->y - v0.y) - static_cast<int64_t>(v2->x - v0.x) * (v1->y - v0.y);
  if (area2 == 0) return SetupResult::degenerate;
  const SetupResult facing = area2 < 0 ? SetupResult::front : SetupResult::back;
  if (area2 < 0) {
    area2 = -area2;
    std::swap(v1, v2);
  }
  const int32_t x_min = std::min(v0.x, std::min(v1->x, v2->x)), x_max = std::max(v0.x, std::max(v1->x, v2->x));
  const int32_t y_min = std::min(v0.y, std::min(v1->y, v2->y)), y_max = std::max(v0.y, std::max(v1->y, v2->y));
  const PixelRange columns = pixel_range(x_min, x_max, hull.min_x, hull.max_x, viewport.width);
  const PixelRange rows = pixel_range(y_min, y_max, hull.min_y, hull.max_y, viewport.height);
  if (columns.first > columns.last || rows.first > rows.last) return SetupResult::missed;
  out.min_x = columns.first;
  out.max_x = columns.last;
  out.min_y = rows.first;
  out.max_y = rows.last;
  out.area2 = area2;
  set_edges(v0, *v1, *v2, out);
  set_depth(v0, *v1, *v2, out);
  set_weights(v0, *v1, *v2, out);
  return facing;
}

}  // namespace pac::raster
