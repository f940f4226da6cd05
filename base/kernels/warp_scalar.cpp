#include <cmath>

#include "base/kernels/warp_kernels.h"

namespace pac {
namespace {

constexpr float kLargest = 262144.0f;         // 2^18 pixels: 2^24 in 1/64
constexpr float kSmallestW = 8.6736174e-19f;  // 2^-60

float clamped(float value) {
  return value < -kLargest ? -kLargest : value > kLargest ? kLargest : value;
}

int32_t in_64ths(float position) {
  return static_cast<int32_t>(std::floor(clamped(position) * 64.0f + 0.5f));
}

void reproject_row(const ReprojectionRow& row, const float* depth, size_t n, int32_t* x_64, int32_t* y_64,
                   float* u_before) {
  for (size_t i = 0; i < n; ++i) {
    const float u = 1.0f - depth[i], column = static_cast<float>(static_cast<int32_t>(i));
    float at[4];
    for (int c = 0; c < 4; ++c) at[c] = (row.origin[c] + column * row.per_pixel[c]) + u * row.per_depth[c];
    const float x = at[0] / at[3], y = at[1] / at[3], before = at[2] / at[3];
    const bool somewhere = at[3] > kSmallestW && x == x && y == y && before == before;
    x_64[i] = somewhere ? in_64ths(x) : kWarpNowhere;
    y_64[i] = somewhere ? in_64ths(y) : kWarpNowhere;
    u_before[i] = somewhere ? before : 0.0f;
  }
}

int16_t filter_point(const int16_t* at, ptrdiff_t stride, const int16_t* taps_x, const int16_t* taps_y) {
  int32_t sum = 4096;
  for (int j = 0; j < kWarpTaps; ++j) {
    int32_t v = 1;
    for (int k = 0; k < kWarpTaps; ++k) v += taps_y[k] * at[k * stride + j];
    sum += taps_x[j] * (v >> 1);
  }
  return static_cast<int16_t>(sum >> 13);
}

void filter_points(const int16_t* plane, ptrdiff_t stride, const int16_t* taps, const int32_t* offset,
                   const uint8_t* phase_x, const uint8_t* phase_y, size_t n, int16_t* out) {
  for (size_t i = 0; i < n; ++i)
    out[i] =
        filter_point(plane + offset[i], stride, taps + kWarpTapStride * phase_x[i], taps + kWarpTapStride * phase_y[i]);
}

void cut_patches(const int16_t* plane, ptrdiff_t stride, const uint32_t* surface, const float* u, ptrdiff_t map_stride,
                 const EdgePoint* points, size_t n, int16_t* patches) {
  for (size_t i = 0; i < n; ++i) {
    const EdgePoint& point = points[i];
    for (int k = 0; k < kWarpTaps; ++k)
      for (int j = 0; j < kWarpTaps; ++j) {
        const ptrdiff_t at = point.map_offset + k * map_stride + j;
        const float larger = u[at] > point.u ? u[at] : point.u;
        const bool same_depth = std::fabs(u[at] - point.u) <= kWarpDepthTolerance * larger;
        const bool is_shown = surface[at] == point.surface && same_depth;
        patches[static_cast<ptrdiff_t>(i) * kEdgePatch + k * kWarpTapStride + j] =
            is_shown ? plane[point.plane_offset + k * stride + j] : point.stand_in;
      }
  }
}

}  // namespace

void fill_warp_scalar(WarpKernels& table) {
  table.reproject_row = reproject_row;
  table.filter_points = filter_points;
  table.cut_patches = cut_patches;
}

}  // namespace pac
