// Reprojection: where the content of a pixel was in the frame before, and picking it up there by a 6x6 filter.
#pragma once

#include <cstddef>
#include <cstdint>

namespace pac {

// One row of pixels in homogeneous coordinates of the earlier window. With u = 1 - depth (window z), pixel i has
//   c = (origin[c] + i * per_pixel[c]) + u * per_depth[c]      in float, in this order, for c = x, y, u, w
// and lay at (x / w, y / w) pixels, at 1 - depth = u / w. The terms of w have one sign, so that nothing cancels.
struct ReprojectionRow {
  float origin[4], per_pixel[4], per_depth[4];
};

constexpr int kWarpTaps = 6;  // of the filter, in each direction: at -2 .. +3 from the position's floor
constexpr int kWarpTapsBefore = 2;
constexpr int kWarpPhases = 64;    // a pixel
constexpr int kWarpTapStride = 8;  // coefficients of one phase in the table; the last two are 0
constexpr int32_t kWarpNowhere = INT32_MIN;

// A point near the edge of what it shows, whose taps all lie inside the picture. Offsets are of its tap (-2, -2).
struct EdgePoint {
  int32_t plane_offset, map_offset;
  uint32_t surface;  // that it shows
  float u;           // 1 - depth there
  int16_t stand_in;  // for taps that show something else, -255..255
};

// Two points of a surface belong together where their u differ by at most this share of the larger.
constexpr float kWarpDepthTolerance = 1.0f / 16;

constexpr int kEdgePatch = kWarpTaps * kWarpTapStride;  // samples of one point's patch: 6 rows of 8

struct WarpKernels {
  // Positions of n pixels, any n >= 0: x_64 = floor(64 x / w + 0.5), clamped to +-2^24 before (y_64 alike), and
  // u_before = u / w. Where w <= 2^-60 or any is not a number: kWarpNowhere in x_64 and y_64, 0 in u_before. Exactly n
  // values of each array are touched.
  void (*reproject_row)(const ReprojectionRow& row, const float* depth, size_t n, int32_t* x_64, int32_t* y_64,
                        float* u_before);

  // n points of a plane of 16-bit samples in -255..255. Point i starts at plane + offset[i] (its tap -2, -2; rows are
  // `stride` apart), at the phases phase_x[i] and phase_y[i] (0..63), rows of `taps` [kWarpPhases][kWarpTapStride]
  // whose sum is 128 and whose absolute sum is at most 255:
  //   v[j]   = (sum over k of taps[phase_y][k] * sample(j, k) + 1) >> 1        fits 16 bits
  //   out[i] = (sum over j of taps[phase_x][j] * v[j] + 4096) >> 13
  // Reads 8 samples of each of the 6 rows.
  void (*filter_points)(const int16_t* plane, ptrdiff_t stride, const int16_t* taps, const int32_t* offset,
                        const uint8_t* phase_x, const uint8_t* phase_y, size_t n, int16_t* out);

  // The samples around n points, point i in patches[i * kEdgePatch ...], as filter_points wants them with a stride of
  // 8: where the maps (rows `map_stride` apart) hold the point's surface, and a u with |u - point's| <=
  // kWarpDepthTolerance * (the larger one), the plane's; elsewhere the stand_in. Columns 6 and 7 hold anything. Reads 8
  // entries of each of the 6 rows.
  void (*cut_patches)(const int16_t* plane, ptrdiff_t stride, const uint32_t* surface, const float* u,
                      ptrdiff_t map_stride, const EdgePoint* points, size_t n, int16_t* patches);
};

// One per instruction set: overwrites the entries that it improves.
void fill_warp_scalar(WarpKernels& table);
void fill_warp_sse41(WarpKernels& table);

}  // namespace pac
