// Pixel rows, 16 at a time. A row's last pixels go through padded copies on the stack, so that nothing outside the row
// is touched and no second, scalar version of each formula is needed.
#include <arm_neon.h>

#include <cstddef>
#include <cstdint>

#include "base/kernels/pixel_kernels.h"

namespace pac {
namespace {

constexpr size_t kStep = 16;  // pixels

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

template <class Operation>
void for_each_sample(const uint8_t* a, const uint8_t* b, uint8_t* out, size_t n, Operation operation) {
  size_t i = 0;
  for (; i + kStep <= n; i += kStep) vst1q_u8(out + i, operation(vld1q_u8(a + i), vld1q_u8(b + i)));
  if (i == n) return;
  uint8_t last_a[kStep] = {}, last_b[kStep] = {}, last_out[kStep];
  copy(last_a, a + i, n - i);
  copy(last_b, b + i, n - i);
  vst1q_u8(last_out, operation(vld1q_u8(last_a), vld1q_u8(last_b)));
  copy(out + i, last_out, n - i);
}

void difference_row(const uint8_t* h, const uint8_t* l, uint8_t* d, size_t n) {
  for_each_sample(h, l, d, n, [](uint8x16_t a, uint8x16_t b) { return difference(a, b); });
}

void composite_row(const uint8_t* l, const uint8_t* d, uint8_t* c, size_t n) {
  for_each_sample(l, d, c, n, [](uint8x16_t a, uint8x16_t b) { return composite(a, b); });
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

void ycc_from_rgb_row(const uint8_t* rgb, size_t n, uint8_t* y, uint8_t* cb, uint8_t* cr) {
  size_t i = 0;
  for (; i + kStep <= n; i += kStep) ycc_from_rgb_step(rgb + 3 * i, y + i, cb + i, cr + i);
  if (i == n) return;
  uint8_t last_rgb[3 * kStep] = {}, last[3][kStep];
  copy(last_rgb, rgb + 3 * i, 3 * (n - i));
  ycc_from_rgb_step(last_rgb, last[0], last[1], last[2]);
  copy(y + i, last[0], n - i);
  copy(cb + i, last[1], n - i);
  copy(cr + i, last[2], n - i);
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

void rgb_from_ycc_row(const uint8_t* y, const uint8_t* cb, const uint8_t* cr, size_t n, uint8_t* rgb) {
  size_t i = 0;
  for (; i + kStep <= n; i += kStep) rgb_from_ycc_step(y + i, cb + i, cr + i, rgb + 3 * i);
  if (i == n) return;
  uint8_t last[3][kStep] = {}, last_rgb[3 * kStep];
  copy(last[0], y + i, n - i);
  copy(last[1], cb + i, n - i);
  copy(last[2], cr + i, n - i);
  rgb_from_ycc_step(last[0], last[1], last[2], last_rgb);
  copy(rgb + 3 * i, last_rgb, 3 * (n - i));
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

void downsample_h2v1_row(const uint8_t* in, size_t n, uint8_t* out) {
  size_t i = 0;
  for (; i + kStep <= n; i += kStep) downsample_h2v1_step(in + 2 * i, out + i);
  if (i == n) return;
  uint8_t last_in[2 * kStep] = {}, last_out[kStep];
  copy(last_in, in + 2 * i, 2 * (n - i));
  downsample_h2v1_step(last_in, last_out);
  copy(out + i, last_out, n - i);
}

void downsample_h2v2_step(const uint8_t* a, const uint8_t* b, uint8_t* out) {
  const auto quarter = [](const uint8_t* p, const uint8_t* q) {
    return vshrn_n_u16(vpadalq_u8(vpadalq_u8(alternate(1, 2), vld1q_u8(p)), vld1q_u8(q)), 2);
  };
  vst1q_u8(out, vcombine_u8(quarter(a, b), quarter(a + 16, b + 16)));
}

void downsample_h2v2_row(const uint8_t* a, const uint8_t* b, size_t n, uint8_t* out) {
  size_t i = 0;
  for (; i + kStep <= n; i += kStep) downsample_h2v2_step(a + 2 * i, b + 2 * i, out + i);
  if (i == n) return;
  uint8_t last_a[2 * kStep] = {}, last_b[2 * kStep] = {}, last_out[kStep];
  copy(last_a, a + 2 * i, 2 * (n - i));
  copy(last_b, b + 2 * i, 2 * (n - i));
  downsample_h2v2_step(last_a, last_b, last_out);
  copy(out + i, last_out, n - i);
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

// A step's inputs with the sample before and the one after, copied where the row ends inside them.
struct Surrounded {
  uint8_t bytes[kStep + 2] = {};
  Surrounded(const uint8_t* row, size_t n, size_t at, size_t count) {
    bytes[0] = row[at == 0 ? 0 : at - 1];
    copy(bytes + 1, row + at, count);
    bytes[count + 1] = row[at + count == n ? n - 1 : at + count];
  }
};

// Steps that have both neighbors read the row itself, the first and last ones a surrounded copy.
void upsample_h2v1_row(const uint8_t* in, size_t n, uint8_t* out) {
  for (size_t i = 0; i < n; i += kStep) {
    if (i > 0 && i + kStep < n) {
      upsample_h2v1_step(in + i, out + 2 * i);
      continue;
    }
    const size_t count = n - i < kStep ? n - i : kStep;
    const Surrounded edge(in, n, i, count);
    uint8_t edge_out[2 * kStep];
    upsample_h2v1_step(edge.bytes + 1, edge_out);
    copy(out + 2 * i, edge_out, 2 * count);
  }
}

void upsample_h2v2_step(const uint8_t* near, const uint8_t* far, uint8_t* out) {
  const auto column = [&](ptrdiff_t at) { return three_to_one(vld1q_u8(near + at), vld1q_u8(far + at)); };
  const Weighted here = column(0), left = column(-1), right = column(1);
  const auto blend = [&](const Weighted& farther) {
    return Weighted{vmlaq_n_u16(farther.low, here.low, 3), vmlaq_n_u16(farther.high, here.high, 3)};
  };
  vst2q_u8(out, {{reduce<4>(blend(left), 8), reduce<4>(blend(right), 7)}});
}

void upsample_h2v2_row(const uint8_t* near, const uint8_t* far, size_t n, uint8_t* out) {
  for (size_t i = 0; i < n; i += kStep) {
    if (i > 0 && i + kStep < n) {
      upsample_h2v2_step(near + i, far + i, out + 2 * i);
      continue;
    }
    const size_t count = n - i < kStep ? n - i : kStep;
    const Surrounded edge_near(near, n, i, count), edge_far(far, n, i, count);
    uint8_t edge_out[2 * kStep];
    upsample_h2v2_step(edge_near.bytes + 1, edge_far.bytes + 1, edge_out);
    copy(out + 2 * i, edge_out, 2 * count);
  }
}

void upsample_h1v2_row(const uint8_t* near, const uint8_t* far, int bias, size_t n, uint8_t* out) {
  for_each_sample(near, far, out, n,
                  [bias](uint8x16_t a, uint8x16_t b) { return reduce<2>(three_to_one(a, b), bias); });
}

// A piece of the row at a time, through buffers: chroma with a sample more on
// both sides, whose outputs are not used.
void rgb_from_ycc420_row(const uint8_t* y, const uint8_t* cb_near, const uint8_t* cb_far, const uint8_t* cr_near,
                         const uint8_t* cr_far, size_t n, uint8_t* rgb) {
  constexpr size_t kPiece = 96;  // chroma samples
  const size_t n_chroma = (n + 1) / 2;
  for (size_t i = 0; i < n_chroma; i += kPiece) {
    const size_t count = n_chroma - i < kPiece ? n_chroma - i : kPiece;
    const auto upsample = [&](const uint8_t* near, const uint8_t* far, uint8_t* out) {
      uint8_t wide[2][kPiece + 2];
      const uint8_t* rows[2] = {near, far};
      for (int r = 0; r < 2; ++r) {
        wide[r][0] = rows[r][i == 0 ? 0 : i - 1];
        copy(wide[r] + 1, rows[r] + i, count);
        wide[r][count + 1] = rows[r][i + count == n_chroma ? n_chroma - 1 : i + count];
      }
      upsample_h2v2_row(wide[0], wide[1], count + 2, out);
    };
    uint8_t cb[2 * kPiece + 4], cr[2 * kPiece + 4];
    upsample(cb_near, cb_far, cb);
    upsample(cr_near, cr_far, cr);
    rgb_from_ycc_row(y + 2 * i, cb + 2, cr + 2, n - 2 * i < 2 * count ? n - 2 * i : 2 * count, rgb + 6 * i);
  }
}

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
