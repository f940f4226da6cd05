// One block at a time.
#include <arm_neon.h>

#include <cstddef>
#include <cstdint>

#include "base/kernels/block_kernels.h"

namespace pac {
namespace {

constexpr size_t kBlocks = 1;

struct I4 {
  int32x4_t v;
};
struct Halves {
  I4 low, high;
};

inline I4 operator+(I4 a, I4 b) {
  return {vaddq_s32(a.v, b.v)};
}
inline I4 operator-(I4 a, I4 b) {
  return {vsubq_s32(a.v, b.v)};
}
inline I4 times(I4 a, I4 b) {
  return {vmulq_s32(a.v, b.v)};
}
inline I4 times(I4 a, int32_t n) {
  return {vmulq_n_s32(a.v, n)};
}
inline I4 alternating(int32_t a, int32_t b) {
  const int32_t lanes[4] = {a, b, a, b};
  return {vld1q_s32(lanes)};
}
template <int kBits>
inline I4 shift_left(I4 a) {
  return {vshlq_n_s32(a.v, kBits)};
}
// vrshrq would not wrap in its sum.
template <int kBits>
inline I4 round_shift(I4 a) {
  return {vshrq_n_s32(vaddq_s32(a.v, vdupq_n_s32(1 << (kBits - 1))), kBits)};
}
inline I4 swap_pairs(I4 a) {
  return {vrev64q_s32(a.v)};
}
inline I4 even_twice(I4 a) {
  return {vtrn1q_s32(a.v, a.v)};
}

inline Halves dequantized(const int16_t* levels, const uint16_t* steps, int row, bool) {
  const int16x8_t product = vmulq_s16(vld1q_s16(levels + 8 * row), vreinterpretq_s16_u16(vld1q_u16(steps + 8 * row)));
  return {{vmovl_s16(vget_low_s16(product))}, {vmovl_s16(vget_high_s16(product))}};
}

inline void transpose(I4 (&x)[4]) {
  const auto wide = [](int32x4_t v) { return vreinterpretq_s64_s32(v); };
  const auto narrow = [](int64x2_t v) { return vreinterpretq_s32_s64(v); };
  const int64x2_t a0 = wide(vtrn1q_s32(x[0].v, x[1].v)), a1 = wide(vtrn2q_s32(x[0].v, x[1].v));
  const int64x2_t a2 = wide(vtrn1q_s32(x[2].v, x[3].v)), a3 = wide(vtrn2q_s32(x[2].v, x[3].v));
  x[0].v = narrow(vtrn1q_s64(a0, a2));
  x[1].v = narrow(vtrn1q_s64(a1, a3));
  x[2].v = narrow(vtrn2q_s64(a0, a2));
  x[3].v = narrow(vtrn2q_s64(a1, a3));
}

// Clamps to a signed byte and adds 128.
inline uint8x8_t to_samples(int32x4_t low, int32x4_t high) {
  const int16x8_t words = vcombine_s16(vqmovn_s32(low), vqmovn_s32(high));
  return veor_u8(vreinterpret_u8_s8(vqmovn_s16(words)), vdup_n_u8(0x80));
}

inline void store_4x4(const I4 (&rows)[4], bool, uint8_t* samples, ptrdiff_t stride) {
  uint8_t bytes[16];
  vst1_u8(bytes, to_samples(rows[0].v, rows[1].v));
  vst1_u8(bytes + 8, to_samples(rows[2].v, rows[3].v));
  for (int y = 0; y < 4; ++y) __builtin_memcpy(samples + y * stride, bytes + 4 * y, 4);
}

inline void store_2x2(I4 x, bool, uint8_t* samples, ptrdiff_t stride) {
  uint8_t bytes[8];
  vst1_u8(bytes, to_samples(x.v, x.v));
  __builtin_memcpy(samples, bytes, 2);
  __builtin_memcpy(samples + stride, bytes + 2, 2);
}

#include "base/kernels/reduced_idct_simd.inc"

}  // namespace

void fill_reduced_idct_neon(BlockKernels& table) {
  table.idct_4x4 = idct_4x4;
  table.idct_2x2 = idct_2x2;
}

}  // namespace pac
