// Motion-compensated coding in NEON's 128-bit vectors, one row of 16 or 8 samples and one block at a time.
#include <arm_neon.h>

#include <cstddef>
#include <cstdint>

#include "base/kernels/motion_kernels.h"

#define PAC_INLINE inline __attribute__((always_inline))

namespace pac {
namespace {

// ---- Prediction and distances --------------------------------------------------------------------------------------

// Rows of 16 samples, and rows of 8 of two references side by side.
struct OneReference {
  const uint8_t* samples;
  PAC_INLINE uint8x16_t row(ptrdiff_t at) const { return vld1q_u8(samples + at); }
};
struct TwoReferences {
  const uint8_t* first;
  const uint8_t* second;
  PAC_INLINE uint8x16_t row(ptrdiff_t at) const { return vcombine_u8(vld1_u8(first + at), vld1_u8(second + at)); }
};

// The sums of a row and its right neighbors.
struct RowSums {
  uint16x8_t low, high;
};
template <class Reference>
PAC_INLINE RowSums sum_right(const Reference& reference, ptrdiff_t at) {
  const uint8x16_t a = reference.row(at), b = reference.row(at + 1);
  return {vaddl_u8(vget_low_u8(a), vget_low_u8(b)), vaddl_u8(vget_high_u8(a), vget_high_u8(b))};
}
PAC_INLINE uint8x16_t average_4(const RowSums& top, const RowSums& bottom) {
  return vcombine_u8(vrshrn_n_u16(vaddq_u16(top.low, bottom.low), 2),
                     vrshrn_n_u16(vaddq_u16(top.high, bottom.high), 2));
}

// Calls use(y, prediction) for each row.
template <int kKind, class Reference, class Use>
PAC_INLINE void for_each_prediction(const Reference& reference, ptrdiff_t stride, int height, const Use& use) {
  if constexpr (kKind == 0) {
    for (int y = 0; y < height; ++y) use(y, reference.row(y * stride));
  } else if constexpr (kKind == 1) {
    for (int y = 0; y < height; ++y) use(y, vrhaddq_u8(reference.row(y * stride), reference.row(y * stride + 1)));
  } else if constexpr (kKind == 2) {
    uint8x16_t above = reference.row(0);
    for (int y = 0; y < height; ++y) {
      const uint8x16_t below = reference.row((y + 1) * stride);
      use(y, vrhaddq_u8(above, below));
      above = below;
    }
  } else {
    RowSums above = sum_right(reference, 0);
    for (int y = 0; y < height; ++y) {
      const RowSums below = sum_right(reference, (y + 1) * stride);
      use(y, average_4(above, below));
      above = below;
    }
  }
}

template <int kKind>
void predict16(const uint8_t* reference, ptrdiff_t reference_stride, uint8_t* prediction, ptrdiff_t prediction_stride,
               int height) {
  for_each_prediction<kKind>(OneReference{reference}, reference_stride, height,
                             [&](int y, uint8x16_t row) { vst1q_u8(prediction + y * prediction_stride, row); });
}
template <int kKind>
void predict8_pair(const uint8_t* const references[2], ptrdiff_t reference_stride, uint8_t* const predictions[2],
                   ptrdiff_t prediction_stride) {
  const TwoReferences both = {references[0], references[1]};
  uint8_t* const first = predictions[0];
  uint8_t* const second = predictions[1];
  for_each_prediction<kKind>(both, reference_stride, 8, [&](int y, uint8x16_t row) {
    vst1_u8(first + y * prediction_stride, vget_low_u8(row));
    vst1_u8(second + y * prediction_stride, vget_high_u8(row));
  });
}

template <int kKind>
uint32_t sad16_half(const uint8_t* source, ptrdiff_t source_stride, const uint8_t* reference,
                    ptrdiff_t reference_stride) {
  uint16x8_t sum = vdupq_n_u16(0);  // 16 rows of two differences a lane: below 2^14
  for_each_prediction<kKind>(OneReference{reference}, reference_stride, 16, [&](int y, uint8x16_t row) {
    sum = vpadalq_u8(sum, vabdq_u8(row, vld1q_u8(source + y * source_stride)));
  });
  return vaddlvq_u16(sum);
}

void sad16_x4(const uint8_t* source, ptrdiff_t source_stride, const uint8_t* const* references,
              ptrdiff_t reference_stride, uint32_t* sads) {
  for (int i = 0; i < 4; ++i) sads[i] = sad16_half<0>(source, source_stride, references[i], reference_stride);
}

uint32_t sad8(const uint8_t* source, ptrdiff_t source_stride, const uint8_t* reference, ptrdiff_t reference_stride) {
  uint16x8_t sum = vdupq_n_u16(0);
  for (int y = 0; y < 8; ++y)
    sum = vabal_u8(sum, vld1_u8(source + y * source_stride), vld1_u8(reference + y * reference_stride));
  return vaddlvq_u16(sum);
}

void sad8_across(const uint8_t* source, ptrdiff_t source_stride, const uint8_t* reference, ptrdiff_t reference_stride,
                 int n, uint32_t* sads) {
  for (int k = 0; k < n; ++k) sads[k] = sad8(source, source_stride, reference + 2 * k, reference_stride);
}

void sad16_quarters(const uint8_t* source, ptrdiff_t source_stride, const uint8_t* reference,
                    ptrdiff_t reference_stride, uint32_t* sads) {
  for (int i = 0; i < 4; ++i)
    sads[i] = sad8(source + (i >> 1) * 8 * source_stride + (i & 1) * 8, source_stride,
                   reference + (i >> 1) * 8 * reference_stride + (i & 1) * 8, reference_stride);
}

uint32_t sse(const uint8_t* a, ptrdiff_t a_stride, const uint8_t* b, ptrdiff_t b_stride, int width, int height) {
  uint32x4_t sum = vdupq_n_u32(0);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; x += 8) {
      const uint8x8_t difference = vabd_u8(vld1_u8(a + y * a_stride + x), vld1_u8(b + y * b_stride + x));
      sum = vpadalq_u16(sum, vmull_u8(difference, difference));
    }
  return vaddvq_u32(sum);
}

void moments16(const uint8_t* source, ptrdiff_t stride, uint32_t* sum, uint32_t* sum_of_squares) {
  uint16x8_t sums = vdupq_n_u16(0);
  uint32x4_t squares = vdupq_n_u32(0);
  for (int y = 0; y < 16; ++y) {
    const uint8x16_t row = vld1q_u8(source + y * stride);
    sums = vpadalq_u8(sums, row);
    squares = vpadalq_u16(squares, vmull_u8(vget_low_u8(row), vget_low_u8(row)));
    squares = vpadalq_u16(squares, vmull_u8(vget_high_u8(row), vget_high_u8(row)));
  }
  *sum = vaddlvq_u16(sums);
  *sum_of_squares = vaddvq_u32(squares);
}

// Four squares: their means in 16 bits.
uint16x4_t means_of_four(const uint8_t* samples, ptrdiff_t stride) {
  uint16x8_t pairs = vpaddlq_u8(vld1q_u8(samples));
  for (int row = 1; row < 4; ++row) pairs = vpadalq_u8(pairs, vld1q_u8(samples + row * stride));
  return vrshrn_n_u32(vpaddlq_u16(pairs), 4);
}
void means_4x4(const uint8_t* samples, ptrdiff_t stride, int n, uint8_t* means) {
  int i = 0;
  for (; i + 8 <= n; i += 8)
    vst1_u8(means + i, vmovn_u16(vcombine_u16(means_of_four(samples + 4 * i, stride),
                                              means_of_four(samples + 4 * i + 16, stride))));
  for (; i < n; i += 4) {
    const uint16x4_t four = means_of_four(samples + 4 * i, stride);
    const uint32_t bytes = vget_lane_u32(vreinterpret_u32_u8(vmovn_u16(vcombine_u16(four, four))), 0);
    __builtin_memcpy(means + i, &bytes, 4);
  }
}

void average(uint8_t* prediction, ptrdiff_t prediction_stride, const uint8_t* other, ptrdiff_t other_stride, int width,
             int height) {
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; x += 8) {
      uint8_t* p = prediction + y * prediction_stride + x;
      vst1_u8(p, vrhadd_u8(vld1_u8(p), vld1_u8(other + y * other_stride + x)));
    }
}

// ---- Transforms ----------------------------------------------------------------------------------------------------

using Lanes = int16x8_t;
// One row a vector.
struct Block {
  Lanes v[8];
};

// 32-bit values in two vectors.
struct Wide {
  int32x4_t low, high;
};
PAC_INLINE Wide operator+(const Wide& a, const Wide& b) {
  return {vaddq_s32(a.low, b.low), vaddq_s32(a.high, b.high)};
}
PAC_INLINE Wide operator-(const Wide& a, const Wide& b) {
  return {vsubq_s32(a.low, b.low), vsubq_s32(a.high, b.high)};
}

struct Pairs {
  Lanes a, b;
};
PAC_INLINE Pairs interleave(Lanes a, Lanes b) {
  return {a, b};
}
PAC_INLINE Wide multiply(const Pairs& ab, int ca, int cb) {
  const auto factor_a = static_cast<int16_t>(ca), factor_b = static_cast<int16_t>(cb);
  return {vmlal_n_s16(vmull_n_s16(vget_low_s16(ab.a), factor_a), vget_low_s16(ab.b), factor_b),
          vmlal_n_s16(vmull_n_s16(vget_high_s16(ab.a), factor_a), vget_high_s16(ab.b), factor_b)};
}
template <int kShift>
PAC_INLINE Lanes round_shift(const Wide& x) {
  return vcombine_s16(vqmovn_s32(vrshrq_n_s32(x.low, kShift)), vqmovn_s32(vrshrq_n_s32(x.high, kShift)));
}
PAC_INLINE Lanes add(Lanes a, Lanes b) {
  return vaddq_s16(a, b);
}
PAC_INLINE Lanes subtract(Lanes a, Lanes b) {
  return vsubq_s16(a, b);
}
PAC_INLINE Lanes add_saturated(Lanes a, Lanes b) {
  return vqaddq_s16(a, b);
}
PAC_INLINE Lanes subtract_saturated(Lanes a, Lanes b) {
  return vqsubq_s16(a, b);
}
PAC_INLINE Lanes twice(Lanes v) {
  return vshlq_n_s16(v, 1);
}
PAC_INLINE Lanes half(Lanes v) {
  return vrshrq_n_s16(v, 1);
}
PAC_INLINE Lanes zeros() {
  return vdupq_n_s16(0);
}
PAC_INLINE Lanes either(Lanes a, Lanes b) {
  return vorrq_s16(a, b);
}
PAC_INLINE bool is_zero(Lanes v) {
  return vmaxvq_u16(vreinterpretq_u16_s16(v)) == 0;
}
PAC_INLINE Wide widen_by_13(Lanes v) {
  return {vshll_n_s16(vget_low_s16(v), 13), vshll_n_s16(vget_high_s16(v), 13)};
}

PAC_INLINE Lanes low_halves(int32x4_t a, int32x4_t b) {
  return vreinterpretq_s16_s64(vtrn1q_s64(vreinterpretq_s64_s32(a), vreinterpretq_s64_s32(b)));
}
PAC_INLINE Lanes high_halves(int32x4_t a, int32x4_t b) {
  return vreinterpretq_s16_s64(vtrn2q_s64(vreinterpretq_s64_s32(a), vreinterpretq_s64_s32(b)));
}
// Pairs of rows, then of pairs, then of fours change places across the diagonal.
PAC_INLINE Block transpose(const Block& b) {
  int32x4_t even[4], odd[4];  // of rows 2i and 2i + 1: their even columns, their odd ones
  for (int i = 0; i < 4; ++i) {
    even[i] = vreinterpretq_s32_s16(vtrn1q_s16(b.v[2 * i], b.v[2 * i + 1]));
    odd[i] = vreinterpretq_s32_s16(vtrn2q_s16(b.v[2 * i], b.v[2 * i + 1]));
  }
  const int32x4_t column0 = vtrn1q_s32(even[0], even[1]), column2 = vtrn2q_s32(even[0], even[1]);  // and 4, 6
  const int32x4_t column1 = vtrn1q_s32(odd[0], odd[1]), column3 = vtrn2q_s32(odd[0], odd[1]);      // and 5, 7
  const int32x4_t lower0 = vtrn1q_s32(even[2], even[3]), lower2 = vtrn2q_s32(even[2], even[3]);    // rows 4..7
  const int32x4_t lower1 = vtrn1q_s32(odd[2], odd[3]), lower3 = vtrn2q_s32(odd[2], odd[3]);
  return {{low_halves(column0, lower0), low_halves(column1, lower1), low_halves(column2, lower2),
           low_halves(column3, lower3), high_halves(column0, lower0), high_halves(column1, lower1),
           high_halves(column2, lower2), high_halves(column3, lower3)}};
}

PAC_INLINE Lanes larger(Lanes a, Lanes b) {
  return vmaxq_s16(a, vabsq_s16(b));
}

#include "base/kernels/motion_transforms_simd.inc"

PAC_INLINE Lanes difference_row(const uint8_t* source, const uint8_t* prediction) {
  return vreinterpretq_s16_u16(vsubl_u8(vld1_u8(source), vld1_u8(prediction)));
}

uint32_t satd16(const uint8_t* source, ptrdiff_t source_stride, const uint8_t* prediction,
                ptrdiff_t prediction_stride) {
  uint32_t total = 0;
  for (int at = 0; at < 4; ++at) {
    const uint8_t* s = source + (at >> 1) * 8 * source_stride + (at & 1) * 8;
    const uint8_t* p = prediction + (at >> 1) * 8 * prediction_stride + (at & 1) * 8;
    Block block;
    for (int y = 0; y < 8; ++y) block.v[y] = difference_row(s + y * source_stride, p + y * prediction_stride);
    hadamard(block);
    block = transpose(block);
    hadamard(block);
    uint32x4_t sum = vdupq_n_u32(0);
    for (const Lanes v : block.v) sum = vpadalq_u16(sum, vreinterpretq_u16_s16(vabsq_s16(v)));
    total += (vaddvq_u32(sum) + 2) >> 2;
  }
  return total;
}

#include "base/kernels/motion_errors_simd.inc"

uint32_t fdct_macroblock(const PredictedSamples& samples, int threshold, int16_t* coefficients) {
  uint32_t reaching = 0;
  for (int i = 0; i < 6; ++i) {
    const Block block = transformed_errors(samples, i);
    for (int y = 0; y < 8; ++y) vst1q_s16(coefficients + 64 * i + 8 * y, block.v[y]);
    reaching |= (vmaxvq_s16(largest_magnitudes(block)) >= threshold ? uint32_t{1} : 0) << i;
  }
  return reaching;
}

template <bool kAdd>
void idct(const int16_t* coefficients, size_t n_blocks, uint8_t* const* samples, const ptrdiff_t* strides) {
  for (size_t i = 0; i < n_blocks; ++i) {
    Block block;
    for (size_t y = 0; y < 8; ++y) block.v[y] = vld1q_s16(coefficients + 64 * i + 8 * y);
    idct_2d(block);
    for (int y = 0; y < 8; ++y) {
      uint8_t* p = samples[i] + y * strides[i];
      Lanes row = block.v[y];
      if constexpr (kAdd) row = vqaddq_s16(row, vreinterpretq_s16_u16(vmovl_u8(vld1_u8(p))));
      vst1_u8(p, vqmovun_s16(row));
    }
  }
}

void idct_dc_add(int dc, uint8_t* samples, ptrdiff_t stride) {
  const Lanes error = vdupq_n_s16(static_cast<int16_t>((dc + 4) >> 3));
  for (int y = 0; y < 8; ++y) {
    uint8_t* p = samples + y * stride;
    vst1_u8(p, vqmovun_s16(vaddq_s16(error, vreinterpretq_s16_u16(vmovl_u8(vld1_u8(p))))));
  }
}

}  // namespace

void fill_motion_neon(MotionKernels& table) {
  table.sad16 = sad16_half<0>;
  table.sad16_x4 = sad16_x4;
  table.sad16_quarters = sad16_quarters;
  table.sad8 = sad8;
  table.sad16_half[0] = sad16_half<0>, table.sad16_half[1] = sad16_half<1>;
  table.sad16_half[2] = sad16_half<2>, table.sad16_half[3] = sad16_half<3>;
  table.satd16 = satd16;
  table.sse = sse;
  table.moments16 = moments16;
  table.sad8_across = sad8_across;
  table.means_4x4 = means_4x4;
  table.predict16[0] = predict16<0>, table.predict16[1] = predict16<1>;
  table.predict16[2] = predict16<2>, table.predict16[3] = predict16<3>;
  table.predict8_pair[0] = predict8_pair<0>, table.predict8_pair[1] = predict8_pair<1>;
  table.predict8_pair[2] = predict8_pair<2>, table.predict8_pair[3] = predict8_pair<3>;
  table.average = average;
  table.fdct_macroblock = fdct_macroblock;
  table.fdct_reaching = fdct_macroblock;
  table.idct_add = idct<true>;
  table.idct_put = idct<false>;
  table.idct_dc_add = idct_dc_add;
}

}  // namespace pac
