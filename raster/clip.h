// From world space to the fixed-point screen: transform, outcodes, clipping, projection.
#pragma once

#include <cstdint>

#include "base/kernels/front_kernels.h"
#include "raster/scene.h"

namespace pac::raster {

// Image size and what follows from it. Coordinates on the screen are 24.8 pixels from the top left corner.
struct Viewport {
  int width, height;
  // Triangles are clipped where |x| > guard_x w or |y| > guard_y w: 16383 pixels from the image's center, so that
  // differences of coordinates stay below 2^23 and edge functions exact.
  float guard_x, guard_y;
};
Viewport make_viewport(int width, int height);
// What the front end's kernels read.
ScreenTransform screen_transform(const glm::mat4& clip_from_world, const Viewport& viewport);

struct ClipVertex {
  float x, y, z, w;
  float weight[3];  // of the triangle's corners
};

// A vertex in clip space and, if no kOutClip bit is set, on the screen.
struct TransformedVertex {
  float x, y, z, w;
  ScreenVertex screen;
  uint32_t outcode;
};

// As FrontKernels::transform_vertices().
TransformedVertex transform_vertex(const ScreenTransform& transform, const float position[3]);

// Clips a triangle against the planes in `planes` (Outcode bits). Writes up to kMaxClipVertices corners of a convex
// polygon, in order; returns how many, 0 if nothing is left. An edge is always cut from its inside end, so that
// neighbors that share it get the same point, bit for bit.
constexpr int kMaxClipVertices = 9;
int clip_triangle(const TransformedVertex* const corners[3], uint32_t planes, const Viewport& viewport,
                  ClipVertex out[kMaxClipVertices]);

// False if w is too small to divide by.
bool project_vertex(const ClipVertex& vertex, const ScreenTransform& transform, ScreenVertex& out);

}  // namespace pac::raster
