// Four pixels at a time; the filter takes one point, its columns in the eight lanes of a register.
#include <arm_neon.h>

#include <cstddef>
#include <cstdint>

#include "base/kernels/warp_kernels.h"

namespace pac {
namespace {

// ---- Places ----

inline float32x4_t coordinate(const ReprojectionRow& row, int c, float32x4_t column, float32x4_t u) {
  const float32x4_t across = vaddq_f32(vdupq_n_f32(row.origin[c]), vmulq_f32(column, vdupq_n_f32(row.per_pixel[c])));
  return vaddq_f32(across, vmulq_f32(u, vdupq_n_f32(row.per_depth[c])));
}

// Comparisons with what is not a number fail; -2^31 is kWarpNowhere.
inline int32x4_t nearest(float32x4_t position_64, uint32x4_t somewhere) {
  const uint32x4_t fits = vandq_u32(vcaltq_f32(position_64, vdupq_n_f32(2147483648.0f)), somewhere);
  return vbslq_s32(fits, vcvtnq_s32_f32(position_64), vdupq_n_s32(kWarpNowhere));
}

inline void reproject(const ReprojectionRow& row, float32x4_t column, float32x4_t depth, int32_t* x_64, int32_t* y_64,
                      float* u_before) {
  const float32x4_t u = vsubq_f32(vdupq_n_f32(1.0f), depth);
  const float32x4_t w = coordinate(row, 3, column, u);
  const uint32x4_t somewhere = vcgtq_f32(w, vdupq_n_f32(8.6736174e-19f));
  const float32x4_t r = vdivq_f32(vdupq_n_f32(1.0f), w);
  const float32x4_t before = vmulq_f32(coordinate(row, 2, column, u), r);
  vst1q_s32(x_64, nearest(vmulq_f32(coordinate(row, 0, column, u), r), somewhere));
  vst1q_s32(y_64, nearest(vmulq_f32(coordinate(row, 1, column, u), r), somewhere));
  const uint32x4_t is_number = vandq_u32(somewhere, vceqq_f32(before, before));
  vst1q_f32(u_before, vreinterpretq_f32_u32(vandq_u32(vreinterpretq_u32_f32(before), is_number)));
}

// Columns from `start` on.
inline void reproject_columns(const ReprojectionRow& row, size_t start, const float* depth, size_t n, int32_t* x_64,
                              int32_t* y_64, float* u_before) {
  const float first[4] = {0, 1, 2, 3};
  float32x4_t column = vaddq_f32(vdupq_n_f32(static_cast<float>(static_cast<int32_t>(start))), vld1q_f32(first));
  size_t i = 0;
  for (; i + 4 <= n; i += 4) {
    reproject(row, column, vld1q_f32(depth + i), x_64 + i, y_64 + i, u_before + i);
    column = vaddq_f32(column, vdupq_n_f32(4.0f));  // exact below 2^24
  }
  if (i == n) return;
  float last_depth[4] = {}, last_u[4];
  int32_t last_x[4], last_y[4];
  __builtin_memcpy(last_depth, depth + i, (n - i) * sizeof(float));
  reproject(row, column, vld1q_f32(last_depth), last_x, last_y, last_u);
  __builtin_memcpy(x_64 + i, last_x, (n - i) * sizeof(int32_t));
  __builtin_memcpy(y_64 + i, last_y, (n - i) * sizeof(int32_t));
  __builtin_memcpy(u_before + i, last_u, (n - i) * sizeof(float));
}

void reproject_row(const ReprojectionRow& row, const float* depth, size_t n, int32_t* x_64, int32_t* y_64,
                   float* u_before) {
  reproject_columns(row, 0, depth, n, x_64, y_64, u_before);
}

// ---- Filter ----

// rows(k): eight samples of row k of the patch.
template <class Rows>
inline int16_t filter_point(const Rows& rows, const int16_t* taps_x, const int16_t* taps_y) {
  int32x4_t low = vdupq_n_s32(128), high = low;
  for (int k = 0; k < kWarpTaps; ++k) {
    const int16x8_t row = rows(k);
    low = vmlal_n_s16(low, vget_low_s16(row), taps_y[k]);
    high = vmlal_n_s16(high, vget_high_s16(row), taps_y[k]);
  }
  // Columns 6 and 7 may not fit 16 bits where they hold anything, but their coefficients are 0.
  const int16x8_t x = vld1q_s16(taps_x);
  const int32x4_t sums = vmlal_s16(vmull_s16(vmovn_s32(vshrq_n_s32(low, 8)), vget_low_s16(x)),
                                   vmovn_s32(vshrq_n_s32(high, 8)), vget_high_s16(x));
  const int32_t done = (vaddvq_s32(sums) + 512) >> 10;
  const int32_t bounded = done < -kLargestCarried ? -kLargestCarried : done;
  return static_cast<int16_t>(bounded > kLargestCarried ? kLargestCarried : bounded);
}

void filter_points(const int16_t* plane, ptrdiff_t stride, const int16_t* taps, const int32_t* x_64,
                   const int32_t* y_64, const uint8_t* state, size_t n, int16_t* out) {
  for (size_t i = 0; i < n; ++i) {
    out[i] = 0;
    if (state[i] == kWarpAbsent) continue;
    const int16_t* at = plane + ((y_64[i] >> 6) - kWarpTapsBefore) * stride + (x_64[i] >> 6) - kWarpTapsBefore;
    out[i] = filter_point([&](int k) { return vld1q_s16(at + k * stride); },
                          taps + kWarpTapStride * (x_64[i] & (kWarpPhases - 1)),
                          taps + kWarpTapStride * (y_64[i] & (kWarpPhases - 1)));
  }
}

// 0xFFFFFFFF where keys without their smooth bits belong to the wanted one.
inline uint32x4_t belongs(const uint32_t* keys, uint32x4_t wanted) {
  const uint32x4_t apart = vsubq_u32(vandq_u32(vld1q_u32(keys), vdupq_n_u32(kKeyBits)), wanted);
  return vcleq_u32(vaddq_u32(apart, vdupq_n_u32(kKeyTolerance)), vdupq_n_u32(2 * kKeyTolerance));
}

inline int16_t filter_shown(const int16_t* plane, ptrdiff_t stride, const uint32_t* map, ptrdiff_t map_stride,
                            uint32_t wanted_key, int16_t stand_in, const int16_t* taps_x, const int16_t* taps_y) {
  const uint32x4_t wanted = vdupq_n_u32(wanted_key);
  const auto row = [&](int k) {
    const uint32_t* keys = map + k * map_stride;
    const uint16x8_t mask = vcombine_u16(vmovn_u32(belongs(keys, wanted)), vmovn_u32(belongs(keys + 4, wanted)));
    return vbslq_s16(mask, vld1q_s16(plane + k * stride), vdupq_n_s16(stand_in));
  };
  return filter_point(row, taps_x, taps_y);
}

#include "base/kernels/warp_points_simd.inc"

// ---- Rows ----

inline void add_eight(const uint8_t* base, const int16_t* carried, uint8_t* out) {
  const int16x8_t wide = vreinterpretq_s16_u16(vmovl_u8(vld1_u8(base)));
  vst1_u8(out, vqmovun_s16(vaddq_s16(wide, vrshrq_n_s16(vld1q_s16(carried), kCarriedBits))));
}

// (a x + b y + 32768) >> 16; whole numbers of x and y are added outside, see composite_eight().
inline int16x8_t rounded_sum(int16x8_t x, int16_t a, int16x8_t y, int16_t b) {
  const int32x4_t low = vmlal_n_s16(vmull_n_s16(vget_low_s16(x), a), vget_low_s16(y), b);
  const int32x4_t high = vmlal_n_s16(vmull_n_s16(vget_high_s16(x), a), vget_high_s16(y), b);
  return vcombine_s16(vrshrn_n_s32(low, 16), vrshrn_n_s32(high, 16));
}

// 91881 = 65536 + 26345, 116130 = 131072 - 14942 and -46802 = -65536 + 18734.
inline void composite_eight(const uint8_t* low, const int16_t* carried, const int16_t* chroma_u,
                            const int16_t* chroma_v, uint8_t* rgb) {
  const uint8x8x3_t from = vld3_u8(low);
  const int16x8_t d = vrshrq_n_s16(vld1q_s16(carried), kCarriedBits), u = vld1q_s16(chroma_u), v = vld1q_s16(chroma_v);
  const int16x8_t red = vaddq_s16(vaddq_s16(d, v), rounded_sum(v, 26345, u, 0));
  const int16x8_t green = vaddq_s16(vsubq_s16(d, v), rounded_sum(u, -22554, v, 18734));
  const int16x8_t blue = vaddq_s16(vaddq_s16(d, vaddq_s16(u, u)), rounded_sum(u, -14942, v, 0));
  const auto shown = [](uint8x8_t base, int16x8_t added) {
    return vqmovun_s16(vaddq_s16(vreinterpretq_s16_u16(vmovl_u8(base)), added));
  };
  const uint8x8x3_t to = {{shown(from.val[0], red), shown(from.val[1], green), shown(from.val[2], blue)}};
  vst3_u8(rgb, to);
}

#include "base/kernels/warp_rows_simd.inc"

}  // namespace

void fill_warp_neon(WarpKernels& table) {
  table.reproject_row = reproject_row;
  table.find_points = find_points;
  table.filter_points = filter_points;
  table.filter_both = filter_both;
  table.filter_edges = filter_edges;
  table.add_carried_row = add_carried_row;
  table.composite_signed_row = composite_signed_row;
}

}  // namespace pac
