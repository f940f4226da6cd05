#include "raster/setup.h"

#include <algorithm>

namespace pac::raster {
namespace {

#include "base/kernels/front_one_simd.inc"

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

SetupRules setup_rules(const Viewport& viewport, const SampleHull& hull) {
  return {viewport.width, viewport.height, hull.min_x, hull.min_y, hull.max_x, hull.max_y};
}

SetupResult setup_triangle(const ScreenVertex corners[3], const Viewport& viewport, const SampleHull& hull,
                           RasterTriangle& out) {
  switch (one_triangle(setup_rules(viewport, hull), corners[0], &corners[1], &corners[2], out)) {
    case OneResult::front:
      return SetupResult::front;
    case OneResult::back:
      return SetupResult::back;
    case OneResult::degenerate:
      return SetupResult::degenerate;
    default:
      return SetupResult::missed;
  }
}

}  // namespace pac::raster
