// Triangle setup: edge functions, depth plane and bounds of three snapped corners.
#pragma once

#include <span>

#include "base/kernels/front_kernels.h"
#include "raster/clip.h"
#include "raster/sample_pattern.h"

namespace pac::raster {

// The hull of the sample offsets of a pixel.
struct SampleHull {
  int32_t min_x, min_y, max_x, max_y;
};
SampleHull sample_hull(std::span<const SampleOffset> pattern);

enum class SetupResult : uint8_t {
  front,       // counter-clockwise on the screen; corners 1 and 2 are exchanged in `out`
  back,        // clockwise on the screen, as `out` wants it
  degenerate,  // zero area after snapping
  missed,      // between sample positions or outside the image, as FrontKernels::setup_triangles() says
};

SetupRules setup_rules(const Viewport& viewport, const SampleHull& hull);

// Fills all of `out` but id, state and attributes.
SetupResult setup_triangle(const ScreenVertex corners[3], const Viewport& viewport, const SampleHull& hull,
                           RasterTriangle& out);

}  // namespace pac::raster
