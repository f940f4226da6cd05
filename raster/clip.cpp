#include "raster/clip.h"

#include <algorithm>

namespace pac::raster {
namespace {

#include "base/kernels/front_one_simd.inc"

// >= 0 inside.
float distance(const ClipVertex& v, uint32_t plane, const Viewport& viewport) {
  switch (plane) {
    case kOutNear:
      return v.z + v.w;
    case kOutFarGuard:
      return kFarGuard * v.w - v.z;
    case kOutGuardRight:
      return viewport.guard_x * v.w - v.x;
    case kOutGuardLeft:
      return viewport.guard_x * v.w + v.x;
    case kOutGuardTop:
      return viewport.guard_y * v.w - v.y;
    default:
      return viewport.guard_y * v.w + v.y;
  }
}

ClipVertex crossing(const ClipVertex& inside, const ClipVertex& outside, float d_inside, float d_outside) {
  const float t = d_inside / (d_inside - d_outside);
  ClipVertex v;
  v.x = inside.x + t * (outside.x - inside.x);
  v.y = inside.y + t * (outside.y - inside.y);
  v.z = inside.z + t * (outside.z - inside.z);
  v.w = inside.w + t * (outside.w - inside.w);
  for (int i = 0; i < 3; ++i) v.weight[i] = inside.weight[i] + t * (outside.weight[i] - inside.weight[i]);
  return v;
}

// One plane of Sutherland and Hodgman's algorithm. Returns the new number of corners.
int clip_against(uint32_t plane, const Viewport& viewport, const ClipVertex* in, int n, ClipVertex* out) {
  int count = 0;
  for (int i = 0; i < n; ++i) {
    const ClipVertex &from = in[i], &to = in[(i + 1) % n];
    const float d_from = distance(from, plane, viewport), d_to = distance(to, plane, viewport);
    if (d_from >= 0) out[count++] = from;
    if (d_from >= 0 && d_to < 0) out[count++] = crossing(from, to, d_from, d_to);
    if (d_from < 0 && d_to >= 0) out[count++] = crossing(to, from, d_to, d_from);
  }
  return count;
}

}  // namespace

Viewport make_viewport(int width, int height) {
  constexpr float kGuardPixels = 16383.0f;
  return {width, height, 2.0f * kGuardPixels / static_cast<float>(std::max(width, 1)),
          2.0f * kGuardPixels / static_cast<float>(std::max(height, 1))};
}

ScreenTransform screen_transform(const glm::mat4& m, const Viewport& viewport) {
  ScreenTransform out;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) out.m[row][column] = m[column][row];
  out.guard_x = viewport.guard_x;
  out.guard_y = viewport.guard_y;
  out.center_x = static_cast<float>(viewport.width) * 128.0f;  // exact: width <= 2^15
  out.center_y = static_cast<float>(viewport.height) * 128.0f;
  return out;
}

TransformedVertex transform_vertex(const ScreenTransform& transform, const float position[3]) {
  TransformedVertex v;
  float clip[4];
  v.outcode = one_vertex(transform, position, clip, v.screen);
  v.x = clip[0];
  v.y = clip[1];
  v.z = clip[2];
  v.w = clip[3];
  return v;
}

int clip_triangle(const TransformedVertex* const corners[3], uint32_t planes, const Viewport& viewport,
                  ClipVertex out[kMaxClipVertices]) {
  ClipVertex other[kMaxClipVertices];
  for (int i = 0; i < 3; ++i) {
    const TransformedVertex& v = *corners[i];
    out[i] = {v.x, v.y, v.z, v.w, {i == 0 ? 1.0f : 0.0f, i == 1 ? 1.0f : 0.0f, i == 2 ? 1.0f : 0.0f}};
  }
  int n = 3;
  for (uint32_t plane = kOutNear; plane <= kOutGuardBottom && n >= 3; plane <<= 1) {
    if ((planes & plane) == 0) continue;
    n = clip_against(plane, viewport, out, n, other);
    std::copy(other, other + n, out);
  }
  return n >= 3 ? n : 0;
}

bool project_vertex(const ClipVertex& vertex, const ScreenTransform& transform, ScreenVertex& out) {
  if (!(vertex.w >= kSmallestW)) return false;
  out = one_projected(transform, vertex.x, vertex.y, vertex.z, vertex.w);
  return true;
}

}  // namespace pac::raster
