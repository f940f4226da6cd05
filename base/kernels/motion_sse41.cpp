// Motion-compensated coding in 128-bit vectors, one block at a time.
#include <smmintrin.h>

#include <cstddef>
#include <cstdint>

#include "base/kernels/motion_kernels.h"

#define PAC_INLINE inline __attribute__((always_inline))

namespace pac {
namespace {

#include "base/kernels/motion_simd.inc"

// One row a vector.
using Lanes = __m128i;
struct Block {
  Lanes v[8];
};

PAC_INLINE Block transpose(const Block& b) {
  const __m128i a0 = _mm_unpacklo_epi16(b.v[0], b.v[1]), a1 = _mm_unpackhi_epi16(b.v[0], b.v[1]);
  const __m128i a2 = _mm_unpacklo_epi16(b.v[2], b.v[3]), a3 = _mm_unpackhi_epi16(b.v[2], b.v[3]);
  const __m128i a4 = _mm_unpacklo_epi16(b.v[4], b.v[5]), a5 = _mm_unpackhi_epi16(b.v[4], b.v[5]);
  const __m128i a6 = _mm_unpacklo_epi16(b.v[6], b.v[7]), a7 = _mm_unpackhi_epi16(b.v[6], b.v[7]);
  const __m128i c0 = _mm_unpacklo_epi32(a0, a2), c1 = _mm_unpackhi_epi32(a0, a2);  // columns 0 1, 2 3 of rows 0..3
  const __m128i c2 = _mm_unpacklo_epi32(a1, a3), c3 = _mm_unpackhi_epi32(a1, a3);  // columns 4 5, 6 7
  const __m128i c4 = _mm_unpacklo_epi32(a4, a6), c5 = _mm_unpackhi_epi32(a4, a6);  // the same of rows 4..7
  const __m128i c6 = _mm_unpacklo_epi32(a5, a7), c7 = _mm_unpackhi_epi32(a5, a7);
  return {{_mm_unpacklo_epi64(c0, c4), _mm_unpackhi_epi64(c0, c4), _mm_unpacklo_epi64(c1, c5),
           _mm_unpackhi_epi64(c1, c5), _mm_unpacklo_epi64(c2, c6), _mm_unpackhi_epi64(c2, c6),
           _mm_unpacklo_epi64(c3, c7), _mm_unpackhi_epi64(c3, c7)}};
}

// 32-bit values in two vectors.
struct Wide {
  __m128i low, high;
};
PAC_INLINE Wide operator+(const Wide& a, const Wide& b) {
  return {_mm_add_epi32(a.low, b.low), _mm_add_epi32(a.high, b.high)};
}
PAC_INLINE Wide operator-(const Wide& a, const Wide& b) {
  return {_mm_sub_epi32(a.low, b.low), _mm_sub_epi32(a.high, b.high)};
}

// Two vectors' lanes side by side, ready for pmaddwd.
struct Pairs {
  __m128i low, high;
};
PAC_INLINE Pairs interleave(__m128i a, __m128i b) {
  return {_mm_unpacklo_epi16(a, b), _mm_unpackhi_epi16(a, b)};
}
// a * ca + b * cb of the interleaved a and b; exact: both factors are 16-bit.
PAC_INLINE Wide multiply(const Pairs& ab, int ca, int cb) {
  const __m128i factors =
      _mm_set1_epi32(static_cast<int>(static_cast<uint32_t>(cb) << 16 | (static_cast<uint32_t>(ca) & 0xFFFF)));
  return {_mm_madd_epi16(ab.low, factors), _mm_madd_epi16(ab.high, factors)};
}

// (x + 2^(s-1)) >> s, saturated to 16 bits.
template <int kShift>
PAC_INLINE __m128i round_shift(const Wide& x) {
  const __m128i half = _mm_set1_epi32(1 << (kShift - 1));
  return _mm_packs_epi32(_mm_srai_epi32(_mm_add_epi32(x.low, half), kShift),
                         _mm_srai_epi32(_mm_add_epi32(x.high, half), kShift));
}

PAC_INLINE Lanes add(Lanes a, Lanes b) {
  return _mm_add_epi16(a, b);
}
PAC_INLINE Lanes subtract(Lanes a, Lanes b) {
  return _mm_sub_epi16(a, b);
}
PAC_INLINE Lanes add_saturated(Lanes a, Lanes b) {
  return _mm_adds_epi16(a, b);
}
PAC_INLINE Lanes subtract_saturated(Lanes a, Lanes b) {
  return _mm_subs_epi16(a, b);
}
PAC_INLINE Lanes twice(Lanes v) {
  return _mm_slli_epi16(v, 1);
}
PAC_INLINE Lanes half(Lanes v) {
  return _mm_srai_epi16(_mm_add_epi16(v, _mm_set1_epi16(1)), 1);
}
PAC_INLINE Lanes zeros() {
  return _mm_setzero_si128();
}
PAC_INLINE Lanes either(Lanes a, Lanes b) {
  return _mm_or_si128(a, b);
}
PAC_INLINE bool is_zero(Lanes v) {
  return _mm_testz_si128(v, v) != 0;
}
PAC_INLINE Wide widen_by_13(Lanes v) {
  return {_mm_srai_epi32(_mm_unpacklo_epi16(zeros(), v), 3), _mm_srai_epi32(_mm_unpackhi_epi16(zeros(), v), 3)};
}

PAC_INLINE Lanes larger(Lanes a, Lanes b) {
  return _mm_max_epi16(a, _mm_abs_epi16(b));
}

#include "base/kernels/motion_transforms_simd.inc"

__m128i difference_row(const uint8_t* source, const uint8_t* prediction) {
  return _mm_sub_epi16(widen(load_8(source)), widen(load_8(prediction)));
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
    __m128i sum = _mm_setzero_si128();
    for (const __m128i v : block.v) sum = _mm_add_epi32(sum, _mm_madd_epi16(_mm_abs_epi16(v), _mm_set1_epi16(1)));
    total += (sum_of_4(sum) + 2) >> 2;
  }
  return total;
}

#include "base/kernels/motion_errors_simd.inc"

uint32_t fdct_macroblock(const PredictedSamples& samples, int threshold, int16_t* coefficients) {
  const __m128i below = _mm_set1_epi16(static_cast<int16_t>(threshold - 1));
  uint32_t reaching = 0;
  for (int i = 0; i < 6; ++i) {
    const Block block = transformed_errors(samples, i);
    for (int y = 0; y < 8; ++y) store(coefficients + 64 * i + 8 * y, block.v[y]);
    const int above = _mm_movemask_epi8(_mm_cmpgt_epi16(largest_magnitudes(block), below));
    reaching |= (above != 0 ? uint32_t{1} : 0) << i;
  }
  return reaching;
}

template <bool kAdd>
void idct(const int16_t* coefficients, size_t n_blocks, uint8_t* const* samples, const ptrdiff_t* strides) {
  for (size_t i = 0; i < n_blocks; ++i) {
    Block block;
    for (int y = 0; y < 8; ++y) block.v[y] = load(coefficients + 64 * i + 8 * static_cast<size_t>(y));
    idct_2d(block);
    for (int y = 0; y < 8; ++y) {
      uint8_t* p = samples[i] + y * strides[i];
      const __m128i row = kAdd ? _mm_adds_epi16(block.v[y], widen(load_8(p))) : block.v[y];
      store_8(p, _mm_packus_epi16(row, row));
    }
  }
}

}  // namespace

void fill_motion_sse41(MotionKernels& table) {
  fill_shared(table);
  table.satd16 = satd16;
  table.fdct_macroblock = fdct_macroblock;
  table.fdct_reaching = fdct_macroblock;
  table.idct_add = idct<true>;
  table.idct_put = idct<false>;
}

}  // namespace pac
