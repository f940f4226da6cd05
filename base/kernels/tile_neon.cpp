// Eight lanes in two registers.
#include <arm_neon.h>

#include "base/kernels/front_kernels.h"
#include "base/kernels/tile_kernels.h"

namespace pac {
namespace {

struct F8 {
  float32x4_t lo, hi;
};
struct I8 {
  int32x4_t lo, hi;
};
struct M8 {
  uint32x4_t lo, hi;
};

inline F8 load(const float* p) {
  return {vld1q_f32(p), vld1q_f32(p + 4)};
}
inline I8 load(const int32_t* p) {
  return {vld1q_s32(p), vld1q_s32(p + 4)};
}
inline I8 load_bytes(const uint8_t* p) {
  const uint16x8_t words = vmovl_u8(vld1_u8(p));
  return {vreinterpretq_s32_u32(vmovl_u16(vget_low_u16(words))),
          vreinterpretq_s32_u32(vmovl_u16(vget_high_u16(words)))};
}
inline void store(float* p, F8 a) {
  vst1q_f32(p, a.lo);
  vst1q_f32(p + 4, a.hi);
}
inline void store(int32_t* p, I8 a) {
  vst1q_s32(p, a.lo);
  vst1q_s32(p + 4, a.hi);
}
inline F8 splat(float a) {
  return {vdupq_n_f32(a), vdupq_n_f32(a)};
}
inline I8 splat(int32_t a) {
  return {vdupq_n_s32(a), vdupq_n_s32(a)};
}
inline I8 kRamp() {
  constexpr int32_t kLanes[8] = {0, 1, 2, 3, 4, 5, 6, 7};
  return load(kLanes);
}
inline F8 operator+(F8 a, F8 b) {
  return {vaddq_f32(a.lo, b.lo), vaddq_f32(a.hi, b.hi)};
}
inline F8 operator-(F8 a, F8 b) {
  return {vsubq_f32(a.lo, b.lo), vsubq_f32(a.hi, b.hi)};
}
inline F8 operator*(F8 a, F8 b) {
  return {vmulq_f32(a.lo, b.lo), vmulq_f32(a.hi, b.hi)};
}
inline F8 operator/(F8 a, F8 b) {
  return {vdivq_f32(a.lo, b.lo), vdivq_f32(a.hi, b.hi)};
}
inline F8 square_root(F8 a) {
  return {vsqrtq_f32(a.lo), vsqrtq_f32(a.hi)};
}
inline F8 round_down(F8 a) {
  return {vrndmq_f32(a.lo), vrndmq_f32(a.hi)};
}
// Not vminq and vmaxq: those differ from std::min and std::max for NaN and signed zeros.
inline F8 smaller(F8 a, F8 b) {
  return {vbslq_f32(vcltq_f32(b.lo, a.lo), b.lo, a.lo), vbslq_f32(vcltq_f32(b.hi, a.hi), b.hi, a.hi)};
}
inline F8 larger(F8 a, F8 b) {
  return {vbslq_f32(vcltq_f32(a.lo, b.lo), b.lo, a.lo), vbslq_f32(vcltq_f32(a.hi, b.hi), b.hi, a.hi)};
}
inline F8 to_float(I8 a) {
  return {vcvtq_f32_s32(a.lo), vcvtq_f32_s32(a.hi)};
}
inline I8 truncate(F8 a) {
  return {vcvtq_s32_f32(a.lo), vcvtq_s32_f32(a.hi)};
}
inline F8 as_float(I8 a) {
  return {vreinterpretq_f32_s32(a.lo), vreinterpretq_f32_s32(a.hi)};
}
inline I8 as_int(F8 a) {
  return {vreinterpretq_s32_f32(a.lo), vreinterpretq_s32_f32(a.hi)};
}
inline I8 operator+(I8 a, I8 b) {
  return {vaddq_s32(a.lo, b.lo), vaddq_s32(a.hi, b.hi)};
}
inline I8 operator-(I8 a, I8 b) {
  return {vsubq_s32(a.lo, b.lo), vsubq_s32(a.hi, b.hi)};
}
inline I8 operator*(I8 a, I8 b) {
  return {vmulq_s32(a.lo, b.lo), vmulq_s32(a.hi, b.hi)};
}
inline I8 operator&(I8 a, I8 b) {
  return {vandq_s32(a.lo, b.lo), vandq_s32(a.hi, b.hi)};
}
inline I8 operator|(I8 a, I8 b) {
  return {vorrq_s32(a.lo, b.lo), vorrq_s32(a.hi, b.hi)};
}
template <int kBits>
inline I8 shift_right(I8 a) {
  return {vshrq_n_s32(a.lo, kBits), vshrq_n_s32(a.hi, kBits)};
}
template <int kBits>
inline I8 shift_left(I8 a) {
  return {vshlq_n_s32(a.lo, kBits), vshlq_n_s32(a.hi, kBits)};
}
inline I8 shift_right(I8 a, I8 n) {
  return {vshlq_s32(a.lo, vnegq_s32(n.lo)), vshlq_s32(a.hi, vnegq_s32(n.hi))};
}
inline I8 smaller(I8 a, I8 b) {
  return {vminq_s32(a.lo, b.lo), vminq_s32(a.hi, b.hi)};
}
inline I8 larger(I8 a, I8 b) {
  return {vmaxq_s32(a.lo, b.lo), vmaxq_s32(a.hi, b.hi)};
}
// Of all lanes.
inline int32_t least_of(I8 a) {
  return vminvq_s32(vminq_s32(a.lo, a.hi));
}
inline int32_t greatest_of(I8 a) {
  return vmaxvq_s32(vmaxq_s32(a.lo, a.hi));
}
inline M8 operator<(F8 a, F8 b) {
  return {vcltq_f32(a.lo, b.lo), vcltq_f32(a.hi, b.hi)};
}
inline M8 operator<=(F8 a, F8 b) {
  return {vcleq_f32(a.lo, b.lo), vcleq_f32(a.hi, b.hi)};
}
inline M8 operator>=(F8 a, F8 b) {
  return {vcgeq_f32(a.lo, b.lo), vcgeq_f32(a.hi, b.hi)};
}
inline M8 operator<(I8 a, I8 b) {
  return {vcltq_s32(a.lo, b.lo), vcltq_s32(a.hi, b.hi)};
}
inline M8 operator&(M8 a, M8 b) {
  return {vandq_u32(a.lo, b.lo), vandq_u32(a.hi, b.hi)};
}
inline M8 not_negative(I8 a) {
  return {vcgezq_s32(a.lo), vcgezq_s32(a.hi)};
}
inline F8 select(M8 m, F8 a, F8 b) {
  return {vbslq_f32(m.lo, a.lo, b.lo), vbslq_f32(m.hi, a.hi, b.hi)};
}
inline I8 select(M8 m, I8 a, I8 b) {
  return {vbslq_s32(m.lo, a.lo, b.lo), vbslq_s32(m.hi, a.hi, b.hi)};
}
inline F8 select_negative(I8 m, F8 a, F8 b) {
  return {vbslq_f32(vcltzq_s32(m.lo), a.lo, b.lo), vbslq_f32(vcltzq_s32(m.hi), a.hi, b.hi)};
}
inline uint32_t bits(M8 m) {
  constexpr uint32_t kLow[4] = {1, 2, 4, 8}, kHigh[4] = {16, 32, 64, 128};
  return vaddvq_u32(vorrq_u32(vandq_u32(m.lo, vld1q_u32(kLow)), vandq_u32(m.hi, vld1q_u32(kHigh))));
}
inline M8 equal_to(I8 a, uint32_t value) {
  const int32x4_t wanted = vdupq_n_s32(static_cast<int32_t>(value));
  return {vceqq_s32(a.lo, wanted), vceqq_s32(a.hi, wanted)};
}
inline uint32_t matching_lanes(I8 a, uint32_t value) {
  return bits(equal_to(a, value));
}
inline I8 look_up(const int32_t table[16], I8 at) {
  alignas(16) int32_t lanes[8];
  store(lanes, at);
  for (int32_t& lane : lanes) lane = table[lane];
  return load(lanes);
}
inline void store_rgb(uint8_t* p, I8 red, I8 green, I8 blue) {
  const auto bytes = [](I8 v) { return vqmovun_s16(vcombine_s16(vqmovn_s32(v.lo), vqmovn_s32(v.hi))); };
  vst3_u8(p, uint8x8x3_t{{bytes(red), bytes(green), bytes(blue)}});
}

using LaneMask16 = uint16x8_t;
inline LaneMask16 lane_mask_16(uint8_t mask) {
  constexpr uint16_t kBit[8] = {1, 2, 4, 8, 16, 32, 64, 128};
  return vtstq_u16(vdupq_n_u16(mask), vld1q_u16(kBit));
}
// Adds eight values in [-4080, 4080] to 16-bit sums in the lanes of the mask.
inline void add_masked(uint16_t* sums, I8 values, LaneMask16 mask) {
  const int16x8_t packed = vcombine_s16(vmovn_s32(values.lo), vmovn_s32(values.hi));
  vst1q_u16(sums, vaddq_u16(vld1q_u16(sums), vandq_u16(vreinterpretq_u16_s16(packed), mask)));
}

inline void transpose(float32x4_t v[4]) {
  const float32x4x2_t t01 = vtrnq_f32(v[0], v[1]), t23 = vtrnq_f32(v[2], v[3]);
  v[0] = vcombine_f32(vget_low_f32(t01.val[0]), vget_low_f32(t23.val[0]));
  v[1] = vcombine_f32(vget_low_f32(t01.val[1]), vget_low_f32(t23.val[1]));
  v[2] = vcombine_f32(vget_high_f32(t01.val[0]), vget_high_f32(t23.val[0]));
  v[3] = vcombine_f32(vget_high_f32(t01.val[1]), vget_high_f32(t23.val[1]));
}
template <int kFrom = 0>
[[gnu::always_inline]] inline void load_columns(const float* const at[8], F8 rows[4]) {
  float32x4_t low[4], high[4];
  for (int k = 0; k < 4; ++k) {
    low[k] = vld1q_f32(at[k] + kFrom);
    high[k] = vld1q_f32(at[k + 4] + kFrom);
  }
  transpose(low);
  transpose(high);
  for (int k = 0; k < 4; ++k) rows[k] = {low[k], high[k]};
}
template <int kFrom = 0>
[[gnu::always_inline]] inline void store_columns(float* const at[8], const F8 rows[4]) {
  float32x4_t low[4], high[4];
  for (int k = 0; k < 4; ++k) {
    low[k] = rows[k].lo;
    high[k] = rows[k].hi;
  }
  transpose(low);
  transpose(high);
  for (int k = 0; k < 4; ++k) {
    vst1q_f32(at[k] + kFrom, low[k]);
    vst1q_f32(at[k + 4] + kFrom, high[k]);
  }
}

struct LevelTaps;
void filter_bilinear(const uint8_t* texels, const LevelTaps& taps, float* out);
void filter_trilinear(const uint8_t* texels, const LevelTaps& fine, const LevelTaps& coarse, I8 fraction, float* out);
void resolve_row(const uint16_t* sums, int shift, int width, uint8_t* rgb);

#include "base/kernels/tile_simd.inc"

// a + (b - a) * fraction / 256: sqrdmulh rounds as the scalar code does; fractions below 256 never saturate.
inline int16x8_t mix(int16x8_t a, int16x8_t b, int16x8_t fraction_q15) {
  return vaddq_s16(a, vqrdmulhq_s16(vsubq_s16(b, a), fraction_q15));
}
inline int16x4_t mix(int16x4_t a, int16x4_t b, int16x4_t fraction_q15) {
  return vadd_s16(a, vqrdmulh_s16(vsub_s16(b, a), fraction_q15));
}

struct LaneFractions {
  int32_t x[8], y[8];
};
inline LaneFractions fractions(const LevelTaps& taps) {
  LaneFractions f;
  store(f.x, taps.fraction_x);
  store(f.y, taps.fraction_y);
  return f;
}

// One bilinear filter: rgba in 1/128 minus 128.
inline int16x4_t bilinear_one(const uint8_t* texels, const LevelTaps& taps, const LaneFractions& f, int k) {
  const auto load_pair = [&](int32_t at) {
    return vmovl_s8(vreinterpret_s8_u8(veor_u8(vld1_u8(texels + 4 * ptrdiff_t{at}), vdup_n_u8(128))));
  };
  const int16x8_t top = load_pair(taps.top[k]), bottom = load_pair(taps.bottom[k]);
  const auto lower = static_cast<int16_t>(f.y[k]);
  const int16x8_t rows = vmlaq_n_s16(vmulq_n_s16(top, static_cast<int16_t>(128 - lower)), bottom, lower);
  return mix(vget_low_s16(rows), vget_high_s16(rows), vdup_n_s16(static_cast<int16_t>(f.x[k] << 7)));
}

inline void store_channel(int16x4_t words, float* out) {
  const float32x4_t value = vcvtq_f32_s32(vmovl_s16(words));
  vst1q_f32(out, vaddq_f32(vmulq_f32(value, vdupq_n_f32(1.0f / 128.0f)), vdupq_n_f32(128.0f)));
}

// Four lanes of rgba.
inline void store_texels(const int16x4_t t[4], float* out) {
  const int16x4x2_t t02 = vzip_s16(t[0], t[2]), t13 = vzip_s16(t[1], t[3]);
  const int16x4x2_t rg = vzip_s16(t02.val[0], t13.val[0]), ba = vzip_s16(t02.val[1], t13.val[1]);
  store_channel(rg.val[0], out);
  store_channel(rg.val[1], out + kBatchLanes);
  store_channel(ba.val[0], out + 2 * kBatchLanes);
}

void filter_trilinear(const uint8_t* texels, const LevelTaps& fine, const LevelTaps& coarse, I8 fraction, float* out) {
  const LaneFractions f = fractions(fine), c = fractions(coarse);
  int32_t level[8];
  store(level, fraction);
  for (int half = 0; half < 8; half += 4) {
    int16x4_t result[4];
    for (int k = 0; k < 4; ++k)
      result[k] = mix(bilinear_one(texels, fine, f, half + k), bilinear_one(texels, coarse, c, half + k),
                      vdup_n_s16(static_cast<int16_t>(level[half + k] << 7)));
    store_texels(result, out + half);
  }
}

void filter_bilinear(const uint8_t* texels, const LevelTaps& taps, float* out) {
  const LaneFractions f = fractions(taps);
  for (int half = 0; half < 8; half += 4) {
    int16x4_t result[4];
    for (int k = 0; k < 4; ++k) result[k] = bilinear_one(texels, taps, f, half + k);
    store_texels(result, out + half);
  }
}

void resolve_row(const uint16_t* sums, int shift, int width, uint8_t* rgb) {
  const int16x8_t count = vdupq_n_s16(static_cast<int16_t>(-shift));
  const auto bytes = [&](const uint16_t* plane) { return vmovn_u16(vshlq_u16(vld1q_u16(plane), count)); };
  constexpr int kPlane = kTileSize * kTileSize;
  for (int x = 0; x < width; x += 8) {
    const uint8x8x3_t pixels{{bytes(sums + x), bytes(sums + kPlane + x), bytes(sums + 2 * kPlane + x)}};
    if (width - x >= 8) {
      vst3_u8(rgb + 3 * x, pixels);
    } else {
      uint8_t last[24];
      vst3_u8(last, pixels);
      __builtin_memcpy(rgb + 3 * x, last, 3 * static_cast<size_t>(width - x));
    }
  }
}

}  // namespace

void fill_tile_neon(TileKernels& table) {
  fill_table(table);
}

void fill_front_neon(FrontKernels& table) {
  fill_front(table);
}

}  // namespace pac
