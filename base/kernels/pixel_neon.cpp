// Pixel rows, 16 at a time. A row's last pixels go through padded copies on the stack, so that nothing outside the row
// is touched and no second, scalar version of each formula is needed.
#include <arm_neon.h>

#include <cstddef>
#include <cstdint>

#include "base/kernels/pixel_kernels.h"

namespace pac {
namespace {

using Bytes = uint8x16_t;
constexpr size_t kStep = 16;  // pixels

Bytes load(const uint8_t* p) {
  return vld1q_u8(p);
}
void store(uint8_t* p, Bytes v) {
  vst1q_u8(p, v);
}

void copy(uint8_t* to, const uint8_t* from, size_t n) {
  __builtin_memcpy(to, from, n);
}

// 127 + max(h-l, 0) / 2 - max(l-h, 0) / 2; one of the two is zero.
uint8x16_t difference(uint8x16_t h, uint8x16_t l) {
  const uint8x16_t up = vshrq_n_u8(vqsubq_u8(h, l), 1), down = vshrq_n_u8(vqsubq_u8(l, h), 1);
  return vsubq_u8(vaddq_u8(vdupq_n_u8(127), up), down);
}

// Added or subtracted twice with saturation: 2 * |d - 127| needs 9 bits.
uint8x16_t composite(uint8x16_t l, uint8x16_t d) {
  const uint8x16_t zero_difference = vdupq_n_u8(127);
  const uint8x16_t up = vqsubq_u8(d, zero_difference), down = vqsubq_u8(zero_difference, d);
  return vqsubq_u8(vqsubq_u8(vqaddq_u8(vqaddq_u8(l, up), up), down), down);
}

struct Ycc {
  uint16x4_t y, cb, cr;
};
// Four pixels. Every partial sum of cb and cr stays in 0 .. 2^24: the center is added first, so unsigned lanes serve.
Ycc ycc_from_rgb(uint16x4_t r, uint16x4_t g, uint16x4_t b) {
  const uint32x4_t center = vdupq_n_u32((128u << 16) + (1u << 15) - 1);
  const uint32x4_t y = vmlal_n_u16(vmlal_n_u16(vmull_n_u16(r, 19595), g, 38470), b, 7471);
  const uint32x4_t cb = vmlsl_n_u16(vmlsl_n_u16(vmlal_n_u16(center, b, 32768), r, 11059), g, 21709);
  const uint32x4_t cr = vmlsl_n_u16(vmlsl_n_u16(vmlal_n_u16(center, r, 32768), g, 27439), b, 5329);
  return {vrshrn_n_u32(y, 16), vshrn_n_u32(cb, 16), vshrn_n_u32(cr, 16)};
}

struct YccBytes {
  uint8x8_t y, cb, cr;
};
YccBytes ycc_from_rgb(uint8x8_t red, uint8x8_t green, uint8x8_t blue) {
  const uint16x8_t r = vmovl_u8(red), g = vmovl_u8(green), b = vmovl_u8(blue);
  const Ycc low = ycc_from_rgb(vget_low_u16(r), vget_low_u16(g), vget_low_u16(b));
  const Ycc high = ycc_from_rgb(vget_high_u16(r), vget_high_u16(g), vget_high_u16(b));
  return {vmovn_u16(vcombine_u16(low.y, high.y)), vmovn_u16(vcombine_u16(low.cb, high.cb)),
          vmovn_u16(vcombine_u16(low.cr, high.cr))};
}

void ycc_from_rgb_step(const uint8_t* rgb, uint8_t* y, uint8_t* cb, uint8_t* cr) {
  const uint8x16x3_t p = vld3q_u8(rgb);
  const YccBytes low = ycc_from_rgb(vget_low_u8(p.val[0]), vget_low_u8(p.val[1]), vget_low_u8(p.val[2]));
  const YccBytes high = ycc_from_rgb(vget_high_u8(p.val[0]), vget_high_u8(p.val[1]), vget_high_u8(p.val[2]));
  vst1q_u8(y, vcombine_u8(low.y, high.y));
  vst1q_u8(cb, vcombine_u8(low.cb, high.cb));
  vst1q_u8(cr, vcombine_u8(low.cr, high.cr));
}

// (c v + 32768) >> 16 in 16-bit lanes, for eight v and a 16-bit c.
int16x8_t scaled(int16x8_t v, int16_t c) {
  return vcombine_s16(vrshrn_n_s32(vmull_n_s16(vget_low_s16(v), c), 16),
                      vrshrn_n_s32(vmull_n_s16(vget_high_s16(v), c), 16));
}

struct RgbBytes {
  uint8x8_t r, g, b;
};
// What of a factor exceeds 16 bits is taken out as whole multiples: 91881 = 65536 + 26345, 116130 = 131072 - 14942,
// -46802 = -65536 + 18734.
RgbBytes rgb_from_ycc(uint8x8_t luma, uint8x8_t cb, uint8x8_t cr) {
  const int16x8_t y = vreinterpretq_s16_u16(vmovl_u8(luma));
  const int16x8_t u = vreinterpretq_s16_u16(vsubl_u8(cb, vdup_n_u8(128)));
  const int16x8_t v = vreinterpretq_s16_u16(vsubl_u8(cr, vdup_n_u8(128)));
  const int16x8_t r = vaddq_s16(vaddq_s16(y, v), scaled(v, 26345));
  const int16x8_t b = vaddq_s16(vaddq_s16(y, vaddq_s16(u, u)), scaled(u, -14942));
  const int32x4_t g_low = vmlal_n_s16(vmull_n_s16(vget_low_s16(u), -22554), vget_low_s16(v), 18734);
  const int32x4_t g_high = vmlal_n_s16(vmull_n_s16(vget_high_s16(u), -22554), vget_high_s16(v), 18734);
  const int16x8_t g = vaddq_s16(vsubq_s16(y, v), vcombine_s16(vrshrn_n_s32(g_low, 16), vrshrn_n_s32(g_high, 16)));
  return {vqmovun_s16(r), vqmovun_s16(g), vqmovun_s16(b)};
}

void rgb_from_ycc_step(const uint8_t* y, const uint8_t* cb, const uint8_t* cr, uint8_t* rgb) {
  const uint8x16_t luma = vld1q_u8(y), u = vld1q_u8(cb), v = vld1q_u8(cr);
  const RgbBytes low = rgb_from_ycc(vget_low_u8(luma), vget_low_u8(u), vget_low_u8(v));
  const RgbBytes high = rgb_from_ycc(vget_high_u8(luma), vget_high_u8(u), vget_high_u8(v));
  vst3q_u8(rgb, {{vcombine_u8(low.r, high.r), vcombine_u8(low.g, high.g), vcombine_u8(low.b, high.b)}});
}

// `even` in the even 16-bit lanes, `odd` in the odd ones.
uint16x8_t alternate(uint32_t even, uint32_t odd) {
  return vreinterpretq_u16_u32(vdupq_n_u32(even | odd << 16));
}

void downsample_h2v1_step(const uint8_t* in, uint8_t* out) {
  const uint16x8_t bias = alternate(0, 1);
  vst1q_u8(out, vcombine_u8(vshrn_n_u16(vpadalq_u8(bias, vld1q_u8(in)), 1),
                            vshrn_n_u16(vpadalq_u8(bias, vld1q_u8(in + 16)), 1)));
}

void downsample_h2v2_step(const uint8_t* a, const uint8_t* b, uint8_t* out) {
  const auto quarter = [](const uint8_t* p, const uint8_t* q) {
    return vshrn_n_u16(vpadalq_u8(vpadalq_u8(alternate(1, 2), vld1q_u8(p)), vld1q_u8(q)), 2);
  };
  vst1q_u8(out, vcombine_u8(quarter(a, b), quarter(a + 16, b + 16)));
}

// 3 a + b in 16-bit lanes, for the low and the high eight samples.
struct Weighted {
  uint16x8_t low, high;
};
Weighted three_to_one(uint8x16_t a, uint8x16_t b) {
  const uint8x8_t three = vdup_n_u8(3);
  return {vmlal_u8(vmovl_u8(vget_low_u8(b)), vget_low_u8(a), three),
          vmlal_u8(vmovl_u8(vget_high_u8(b)), vget_high_u8(a), three)};
}

// (sum + bias) >> kShift of both halves.
template <int kShift>
uint8x16_t reduce(const Weighted& sum, int bias) {
  const uint16x8_t rounding = vdupq_n_u16(static_cast<uint16_t>(bias));
  return vcombine_u8(vshrn_n_u16(vaddq_u16(sum.low, rounding), kShift),
                     vshrn_n_u16(vaddq_u16(sum.high, rounding), kShift));
}

// Reads in[-1] .. in[16].
void upsample_h2v1_step(const uint8_t* in, uint8_t* out) {
  const uint8x16_t here = vld1q_u8(in);
  const uint8x16_t even = reduce<2>(three_to_one(here, vld1q_u8(in - 1)), 1);
  const uint8x16_t odd = reduce<2>(three_to_one(here, vld1q_u8(in + 1)), 2);
  vst2q_u8(out, {{even, odd}});
}

void upsample_h2v2_step(const uint8_t* near, const uint8_t* far, uint8_t* out) {
  const auto column = [&](ptrdiff_t at) { return three_to_one(vld1q_u8(near + at), vld1q_u8(far + at)); };
  const Weighted here = column(0), left = column(-1), right = column(1);
  const auto blend = [&](const Weighted& farther) {
    return Weighted{vmlaq_n_u16(farther.low, here.low, 3), vmlaq_n_u16(farther.high, here.high, 3)};
  };
  vst2q_u8(out, {{reduce<4>(blend(left), 8), reduce<4>(blend(right), 7)}});
}

Bytes weighted_quarter(Bytes a, Bytes b, int bias) {
  return reduce<2>(three_to_one(a, b), bias);
}

#include "base/kernels/pixel_rows_simd.inc"
#include "base/kernels/rgb_ycc420_simd.inc"
#include "base/kernels/ycc420_simd.inc"

}  // namespace

void fill_pixel_neon(PixelKernels& table) {
  table.difference_row = difference_row;
  table.composite_row = composite_row;
  table.ycc_from_rgb_row = ycc_from_rgb_row;
  table.ycc420_from_rgb_rows = ycc420_from_rgb_rows;
  table.rgb_from_ycc_row = rgb_from_ycc_row;
  table.downsample_h2v1_row = downsample_h2v1_row;
  table.downsample_h2v2_row = downsample_h2v2_row;
  table.upsample_h2v1_row = upsample_h2v1_row;
  table.upsample_h2v2_row = upsample_h2v2_row;
  table.upsample_h1v2_row = upsample_h1v2_row;
  table.rgb_from_ycc420_row = rgb_from_ycc420_row;
}

}  // namespace pac
