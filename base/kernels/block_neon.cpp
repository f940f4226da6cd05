// 8x8 blocks: eight 16-bit lanes hold a row (or, between the two passes of a transform, a column). A one-dimensional
// transform works down the eight vectors, a transposition turns the block between the passes.
#include <arm_neon.h>

#include <cstddef>
#include <cstdint>

#include "base/kernels/block_kernels.h"

namespace pac {
namespace {

using Lanes = int16x8_t;
struct Block {
  Lanes v[8];
};

Block transpose(const Block& b) {
  int32x4_t a[8];  // pairs of rows, their columns interleaved
  for (int i = 0; i < 8; i += 2) {
    a[i] = vreinterpretq_s32_s16(vtrn1q_s16(b.v[i], b.v[i + 1]));      // columns 0 2 4 6
    a[i + 1] = vreinterpretq_s32_s16(vtrn2q_s16(b.v[i], b.v[i + 1]));  // columns 1 3 5 7
  }
  int64x2_t c[8];  // four rows
  for (int i = 0; i < 2; ++i) {
    for (int odd = 0; odd < 2; ++odd) {
      const int32x4_t upper = a[4 * i + odd], lower = a[4 * i + 2 + odd];
      c[4 * i + odd] = vreinterpretq_s64_s32(vtrn1q_s32(upper, lower));      // columns odd, odd + 4
      c[4 * i + 2 + odd] = vreinterpretq_s64_s32(vtrn2q_s32(upper, lower));  // columns odd + 2, odd + 6
    }
  }
  Block out;
  for (int i = 0; i < 4; ++i) {
    out.v[i] = vreinterpretq_s16_s64(vtrn1q_s64(c[i], c[4 + i]));
    out.v[4 + i] = vreinterpretq_s16_s64(vtrn2q_s64(c[i], c[4 + i]));
  }
  return out;
}

// Eight 32-bit values in two vectors.
struct Wide {
  int32x4_t low, high;
};
Wide operator+(const Wide& a, const Wide& b) {
  return {vaddq_s32(a.low, b.low), vaddq_s32(a.high, b.high)};
}
Wide operator-(const Wide& a, const Wide& b) {
  return {vsubq_s32(a.low, b.low), vsubq_s32(a.high, b.high)};
}
struct Pairs {
  int16x8_t a, b;
};
Pairs interleave(int16x8_t a, int16x8_t b) {
  return {a, b};
}
// a * ca + b * cb.
Wide multiply(const Pairs& ab, int ca, int cb) {
  const auto fa = static_cast<int16_t>(ca), fb = static_cast<int16_t>(cb);
  return {vmlal_n_s16(vmull_n_s16(vget_low_s16(ab.a), fa), vget_low_s16(ab.b), fb),
          vmlal_n_s16(vmull_n_s16(vget_high_s16(ab.a), fa), vget_high_s16(ab.b), fb)};
}
// (x + 2^(s-1)) >> s, saturated to 16 bits, at no cost for the rounding: so nothing is added before.
template <int kShift>
const Wide& plus_half(const Wide& x) {
  return x;
}
template <int kShift>
int16x8_t shift_right(const Wide& x) {
  return vcombine_s16(vqmovn_s32(vrshrq_n_s32(x.low, kShift)), vqmovn_s32(vrshrq_n_s32(x.high, kShift)));
}

int16x8_t add(int16x8_t a, int16x8_t b) {
  return vaddq_s16(a, b);
}
int16x8_t subtract(int16x8_t a, int16x8_t b) {
  return vsubq_s16(a, b);
}
int16x8_t four_times(int16x8_t v) {
  return vshlq_n_s16(v, 2);
}
int16x8_t quarter(int16x8_t v) {
  return vrshrq_n_s16(v, 2);
}
int16x8_t level_shifted(int16x8_t dc) {
  return dc;
}
Wide widen_by_13(int16x8_t v) {
  return {vshll_n_s16(vget_low_s16(v), 13), vshll_n_s16(vget_high_s16(v), 13)};
}

#include "base/kernels/block_transforms_simd.inc"

void fdct_islow(const uint8_t* samples, ptrdiff_t stride, size_t n_blocks, int16_t* coefficients) {
  for (size_t i = 0; i < n_blocks; ++i) {
    Block block;
    for (int row = 0; row < 8; ++row)
      block.v[row] = vreinterpretq_s16_u16(vsubl_u8(vld1_u8(samples + row * stride + 8 * i), vdup_n_u8(128)));
    block = transpose(block);
    fdct_1d<true>(block);
    block = transpose(block);
    fdct_1d<false>(block);
    for (int row = 0; row < 8; ++row) vst1q_s16(coefficients + 64 * i + 8 * row, block.v[row]);
  }
}

// Clamps to a signed byte and adds 128.
uint8x8_t sample_row(int16x8_t v) {
  return veor_u8(vreinterpret_u8_s8(vqmovn_s16(v)), vdup_n_u8(0x80));
}

// Only the DC level: every sample is the same.
void idct_dc(int level, int step, uint8_t* samples, ptrdiff_t stride) {
  const auto dc = static_cast<int16_t>(static_cast<uint16_t>(level * step));
  const uint8x8_t row = sample_row(vrshrq_n_s16(vqshlq_n_s16(vdupq_n_s16(dc), 2), 5));
  for (int y = 0; y < 8; ++y) vst1_u8(samples + y * stride, row);
}

void idct_block(const int16_t* levels, const uint16_t* steps, uint8_t* samples, ptrdiff_t stride) {
  Block block;
  for (int row = 0; row < 8; ++row)
    block.v[row] = vmulq_s16(vld1q_s16(levels + 8 * row), vreinterpretq_s16_u16(vld1q_u16(steps + 8 * row)));
  idct_1d<11>(block);
  block = transpose(block);
  idct_1d<18>(block);
  block = transpose(block);
  for (int row = 0; row < 8; ++row) vst1_u8(samples + row * stride, sample_row(block.v[row]));
}

void idct_islow(const int16_t* levels, const uint16_t* steps, const uint8_t* last, size_t n_blocks, uint8_t* samples,
                ptrdiff_t stride) {
  for (size_t i = 0; i < n_blocks; ++i) {
    if (last[i] == 0)
      idct_dc(levels[64 * i], steps[0], samples + 8 * i, stride);
    else
      idct_block(levels + 64 * i, steps, samples + 8 * i, stride);
  }
}

// Byte numbers for the two table look-ups that bring levels into zigzag order: one from natural rows 0..3, one from
// rows 4..7. Out of range (255) gives zero in the first and keeps the first's value in the second.
struct ZigzagIndices {
  alignas(16) uint8_t upper[8][16], lower[8][16];
};
constexpr ZigzagIndices make_zigzag_indices() {
  ZigzagIndices indices{};
  for (int out = 0; out < 8; ++out)
    for (int byte = 0; byte < 16; ++byte) {
      const int from = 2 * kNaturalFromZigzag[8 * out + byte / 2] + byte % 2;
      indices.upper[out][byte] = static_cast<uint8_t>(from < 64 ? from : 255);
      indices.lower[out][byte] = static_cast<uint8_t>(from < 64 ? 255 : from - 64);
    }
  return indices;
}
constexpr ZigzagIndices kZigzag = make_zigzag_indices();

Block zigzag_from_natural(const Block& b) {
  const auto row = [&b](int i) { return vreinterpretq_u8_s16(b.v[i]); };
  const uint8x16x4_t upper = {{row(0), row(1), row(2), row(3)}}, lower = {{row(4), row(5), row(6), row(7)}};
  Block out;
  for (int i = 0; i < 8; ++i) {
    const uint8x16_t from_upper = vqtbl4q_u8(upper, vld1q_u8(kZigzag.upper[i]));
    out.v[i] = vreinterpretq_s16_u8(vqtbx4q_u8(from_upper, lower, vld1q_u8(kZigzag.lower[i])));
  }
  return out;
}

// The upper 16 bits of the unsigned products.
uint16x8_t multiply_high(uint16x8_t a, uint16x8_t b) {
  return vcombine_u16(vshrn_n_u32(vmull_u16(vget_low_u16(a), vget_low_u16(b)), 16),
                      vshrn_n_u32(vmull_u16(vget_high_u16(a), vget_high_u16(b)), 16));
}

// Bit k set where lane k is not zero.
uint64_t nonzero_lanes(int16x8_t v) {
  constexpr uint16_t kBits[8] = {1, 2, 4, 8, 16, 32, 64, 128};
  return vaddvq_u16(vandq_u16(vtstq_s16(v, v), vld1q_u16(kBits)));
}

void quantize(const int16_t* coefficients, const BlockQuantizer& quantizer, size_t n_blocks, int16_t* levels,
              uint64_t* nonzero) {
  for (size_t i = 0; i < n_blocks; ++i) {
    Block block;
    for (int row = 0; row < 8; ++row) {
      const int16x8_t c = vld1q_s16(coefficients + 64 * i + 8 * row);
      const uint16x8_t n = vaddq_u16(vreinterpretq_u16_s16(vabsq_s16(c)), vld1q_u16(quantizer.bias + 8 * row));
      const uint16x8_t level = multiply_high(multiply_high(n, vld1q_u16(quantizer.reciprocal + 8 * row)),
                                             vld1q_u16(quantizer.scale + 8 * row));
      const int16x8_t sign = vshrq_n_s16(c, 15);  // 0 or -1: (level ^ sign) - sign
      block.v[row] = vsubq_s16(veorq_s16(vreinterpretq_s16_u16(level), sign), sign);
    }
    block = zigzag_from_natural(block);
    uint64_t mask = 0;
    for (int k = 0; k < 8; ++k) {
      vst1q_s16(levels + 64 * i + 8 * k, block.v[k]);
      mask |= nonzero_lanes(block.v[k]) << 8 * k;
    }
    nonzero[i] = mask;
  }
}

void fdct_quantize(const uint8_t* samples, ptrdiff_t stride, size_t n_blocks, const BlockQuantizer& quantizer,
                   int16_t* levels, uint64_t* nonzero) {
  for (size_t i = 0; i < n_blocks; ++i) {
    alignas(16) int16_t coefficients[64];
    fdct_islow(samples + 8 * i, stride, 1, coefficients);
    quantize(coefficients, quantizer, 1, levels + 64 * i, nonzero + i);
  }
}

}  // namespace

void fill_block_neon(BlockKernels& table) {
  table.fdct_islow = fdct_islow;
  table.idct_islow = idct_islow;
  table.quantize = quantize;
  table.fdct_quantize = fdct_quantize;
}

}  // namespace pac
