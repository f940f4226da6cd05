#include "raster/clip.h"

#include <algorithm>
#include <cmath>

namespace pac::raster {
namespace {

constexpr float kFarGuard = 16.0f;
constexpr float kLargest = 0x1p100f;
constexpr float kSmallestW = 0x1p-100f;

uint32_t outcode(const TransformedVertex& v, const Viewport& viewport) {
  const auto finite = [](float f) { return std::fabs(f) <= kLargest; };  // false for NaN
  if (!finite(v.x) || !finite(v.y) || !finite(v.z) || !finite(v.w)) return kNotFinite;
  const float gx = viewport.guard_x * v.w, gy = viewport.guard_y * v.w;
  // Without branches: which sides a vertex is on has no pattern.
  const auto bit = [](bool outside, uint32_t plane) { return outside ? plane : 0u; };
  const uint32_t near_far =
      bit(v.z < -v.w, kOutNear) | bit(v.z > kFarGuard * v.w, kOutFarGuard) | bit(v.z > v.w, kOutFar);
  const uint32_t guard = bit(v.x > gx, kOutGuardRight) | bit(v.x < -gx, kOutGuardLeft) | bit(v.y > gy, kOutGuardTop) |
                         bit(v.y < -gy, kOutGuardBottom);
  const uint32_t view =
      bit(v.x > v.w, kOutRight) | bit(v.x < -v.w, kOutLeft) | bit(v.y > v.w, kOutTop) | bit(v.y < -v.w, kOutBottom);
  return near_far | guard | view;
}

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

// Rounds to the nearest 1/256 pixel; clamped, so that the conversion is defined and the guard band holds.
int32_t snapped(float coordinate, float center) {
  constexpr float kGuard = 16384.0f * 256.0f;
  const float offset = std::min(std::max(coordinate, -kGuard), kGuard);
  return static_cast<int32_t>(std::floor(offset + 0.5f)) + static_cast<int32_t>(center);
}

ScreenVertex projected(float x, float y, float z, float w, const Viewport& viewport) {
  const float inverse_w = 1.0f / w;
  const float center_x = static_cast<float>(viewport.width) * 128.0f;  // exact: width <= 2^15
  const float center_y = static_cast<float>(viewport.height) * 128.0f;
  ScreenVertex out;
  out.x = snapped((x * inverse_w) * center_x, center_x);
  out.y = snapped(-((y * inverse_w) * center_y), center_y);
  out.z = std::max((z * inverse_w) * 0.5f + 0.5f, 0.0f);
  out.inverse_w = inverse_w;
  return out;
}

}  // namespace

Viewport make_viewport(int width, int height) {
  constexpr float kGuardPixels = 16383.0f;
  return {width, height, 2.0f * kGuardPixels / static_cast<float>(std::max(width, 1)),
          2.0f * kGuardPixels / static_cast<float>(std::max(height, 1))};
}

TransformedVertex transform_vertex(const glm::mat4& m, const Viewport& viewport, const float position[3]) {
  const float px = position[0], py = position[1], pz = position[2];
  TransformedVertex v;
  v.x = ((m[0][0] * px + m[1][0] * py) + m[2][0] * pz) + m[3][0];
  v.y = ((m[0][1] * px + m[1][1] * py) + m[2][1] * pz) + m[3][1];
  v.z = ((m[0][2] * px + m[1][2] * py) + m[2][2] * pz) + m[3][2];
  v.w = ((m[0][3] * px + m[1][3] * py) + m[2][3] * pz) + m[3][3];
  v.outcode = outcode(v, viewport);
  v.screen = {0, 0, 0, 1};
  if ((v.outcode & (kOutClip | kNotFinite)) == 0) {
    // Inside both guard planes w >= 0; a vertex at w = 0 is the center of projection.
    if (v.w >= kSmallestW)
      v.screen = projected(v.x, v.y, v.z, v.w, viewport);
    else
      v.outcode = kNotFinite;
  }
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

bool project_vertex(const ClipVertex& vertex, const Viewport& viewport, ScreenVertex& out) {
  if (!(vertex.w >= kSmallestW)) return false;
  out = projected(vertex.x, vertex.y, vertex.z, vertex.w, viewport);
  return true;
}

}  // namespace pac::raster
