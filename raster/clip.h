// From world space to the fixed-point screen: transform, outcodes, clipping, projection.
#pragma once

#include <cstdint>

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

// Sides of the clipping planes and of the view volume on which a vertex lies.
enum Outcode : uint32_t {
  kOutNear = 1,      // z < -w
  kOutFarGuard = 2,  // z > 16 w: beyond the far plane the depth test rejects; this keeps depth bounded
  kOutGuardRight = 4,
  kOutGuardLeft = 8,
  kOutGuardTop = 16,
  kOutGuardBottom = 32,
  kOutClip = 63,  // crossing any of these needs clipping
  kOutRight = 64,
  kOutLeft = 128,
  kOutTop = 256,
  kOutBottom = 512,
  kOutFar = 1024,
  kOutView = kOutNear | 1984,  // all three corners beyond one of these: nothing to see
  kNotFinite = 2048,           // not a number, infinite or beyond 2^100: the triangle is dropped
};

struct ClipVertex {
  float x, y, z, w;
  float weight[3];  // of the triangle's corners
};

struct ScreenVertex {
  int32_t x, y;     // 24.8 pixels
  float z;          // window depth, >= 0; up to 8.5 beyond the far plane
  float inverse_w;  // > 0
};

// A vertex in clip space and, if no kOutClip bit is set, on the screen.
struct TransformedVertex {
  float x, y, z, w;
  ScreenVertex screen;
  uint32_t outcode;
};

TransformedVertex transform_vertex(const glm::mat4& clip_from_world, const Viewport& viewport, const float position[3]);

// Clips a triangle against the planes in `planes` (Outcode bits). Writes up to kMaxClipVertices corners of a convex
// polygon, in order; returns how many, 0 if nothing is left. An edge is always cut from its inside end, so that
// neighbors that share it get the same point, bit for bit.
constexpr int kMaxClipVertices = 9;
int clip_triangle(const TransformedVertex* const corners[3], uint32_t planes, const Viewport& viewport,
                  ClipVertex out[kMaxClipVertices]);

// False if w is too small to divide by.
bool project_vertex(const ClipVertex& vertex, const Viewport& viewport, ScreenVertex& out);

}  // namespace pac::raster
