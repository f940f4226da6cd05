// Motion-compensated coding: distances and predictions in 128-bit vectors, transforms of two blocks at a time: each
// 128-bit half does to its block what motion_sse41.cpp does. An odd last block goes through both halves.
#include <immintrin.h>

#include <cstddef>
#include <cstdint>

#include "base/kernels/motion_kernels.h"

#define PAC_INLINE inline __attribute__((always_inline))

namespace pac {
namespace {

#include "base/kernels/motion_simd.inc"

// One row of the first block in the low half, of the second in the high half.
using Lanes = __m256i;
struct Block {
  Lanes v[8];
};

PAC_INLINE Block transpose(const Block& b) {
  const __m256i a0 = _mm256_unpacklo_epi16(b.v[0], b.v[1]), a1 = _mm256_unpackhi_epi16(b.v[0], b.v[1]);
  const __m256i a2 = _mm256_unpacklo_epi16(b.v[2], b.v[3]), a3 = _mm256_unpackhi_epi16(b.v[2], b.v[3]);
  const __m256i a4 = _mm256_unpacklo_epi16(b.v[4], b.v[5]), a5 = _mm256_unpackhi_epi16(b.v[4], b.v[5]);
  const __m256i a6 = _mm256_unpacklo_epi16(b.v[6], b.v[7]), a7 = _mm256_unpackhi_epi16(b.v[6], b.v[7]);
  const __m256i c0 = _mm256_unpacklo_epi32(a0, a2),
                c1 = _mm256_unpackhi_epi32(a0, a2);  // columns 0 1, 2 3 of rows 0..3
  const __m256i c2 = _mm256_unpacklo_epi32(a1, a3), c3 = _mm256_unpackhi_epi32(a1, a3);  // columns 4 5, 6 7
  const __m256i c4 = _mm256_unpacklo_epi32(a4, a6), c5 = _mm256_unpackhi_epi32(a4, a6);  // the same of rows 4..7
  const __m256i c6 = _mm256_unpacklo_epi32(a5, a7), c7 = _mm256_unpackhi_epi32(a5, a7);
  return {{_mm256_unpacklo_epi64(c0, c4), _mm256_unpackhi_epi64(c0, c4), _mm256_unpacklo_epi64(c1, c5),
           _mm256_unpackhi_epi64(c1, c5), _mm256_unpacklo_epi64(c2, c6), _mm256_unpackhi_epi64(c2, c6),
           _mm256_unpacklo_epi64(c3, c7), _mm256_unpackhi_epi64(c3, c7)}};
}

// 32-bit values in two vectors.
struct Wide {
  __m256i low, high;
};
PAC_INLINE Wide operator+(const Wide& a, const Wide& b) {
  return {_mm256_add_epi32(a.low, b.low), _mm256_add_epi32(a.high, b.high)};
}
PAC_INLINE Wide operator-(const Wide& a, const Wide& b) {
  return {_mm256_sub_epi32(a.low, b.low), _mm256_sub_epi32(a.high, b.high)};
}

// Two vectors' lanes side by side, ready for pmaddwd.
struct Pairs {
  __m256i low, high;
};
PAC_INLINE Pairs interleave(__m256i a, __m256i b) {
  return {_mm256_unpacklo_epi16(a, b), _mm256_unpackhi_epi16(a, b)};
}
// a * ca + b * cb of the interleaved a and b; exact: both factors are 16-bit.
PAC_INLINE Wide multiply(const Pairs& ab, int ca, int cb) {
  const __m256i factors =
      _mm256_set1_epi32(static_cast<int>(static_cast<uint32_t>(cb) << 16 | (static_cast<uint32_t>(ca) & 0xFFFF)));
  return {_mm256_madd_epi16(ab.low, factors), _mm256_madd_epi16(ab.high, factors)};
}

// (x + 2^(s-1)) >> s, saturated to 16 bits.
template <int kShift>
PAC_INLINE __m256i round_shift(const Wide& x) {
  const __m256i half = _mm256_set1_epi32(1 << (kShift - 1));
  return _mm256_packs_epi32(_mm256_srai_epi32(_mm256_add_epi32(x.low, half), kShift),
                            _mm256_srai_epi32(_mm256_add_epi32(x.high, half), kShift));
}

PAC_INLINE Lanes add(Lanes a, Lanes b) {
  return _mm256_add_epi16(a, b);
}
PAC_INLINE Lanes subtract(Lanes a, Lanes b) {
  return _mm256_sub_epi16(a, b);
}
PAC_INLINE Lanes add_saturated(Lanes a, Lanes b) {
  return _mm256_adds_epi16(a, b);
}
PAC_INLINE Lanes subtract_saturated(Lanes a, Lanes b) {
  return _mm256_subs_epi16(a, b);
}
PAC_INLINE Lanes twice(Lanes v) {
  return _mm256_slli_epi16(v, 1);
}
PAC_INLINE Lanes half(Lanes v) {
  return _mm256_srai_epi16(_mm256_add_epi16(v, _mm256_set1_epi16(1)), 1);
}
PAC_INLINE Lanes zeros() {
  return _mm256_setzero_si256();
}
PAC_INLINE Lanes either(Lanes a, Lanes b) {
  return _mm256_or_si256(a, b);
}
PAC_INLINE bool is_zero(Lanes v) {
  return _mm256_testz_si256(v, v) != 0;
}
PAC_INLINE Wide widen_by_13(Lanes v) {
  return {_mm256_srai_epi32(_mm256_unpacklo_epi16(zeros(), v), 3),
          _mm256_srai_epi32(_mm256_unpackhi_epi16(zeros(), v), 3)};
}

PAC_INLINE Lanes larger(Lanes a, Lanes b) {
  return _mm256_max_epi16(a, _mm256_abs_epi16(b));
}

#include "base/kernels/motion_transforms_simd.inc"

__m256i join(__m128i first, __m128i second) {
  return _mm256_inserti128_si256(_mm256_castsi128_si256(first), second, 1);
}
// 16 samples' differences: the left block's in the low half.
__m256i difference_row(__m128i source, __m128i prediction) {
  return _mm256_sub_epi16(_mm256_cvtepu8_epi16(source), _mm256_cvtepu8_epi16(prediction));
}
__m256i difference_row(const uint8_t* source, const uint8_t* prediction) {
  return difference_row(load(source), load(prediction));
}

// Between four samples: sixteen rows in eight registers, a row and the eighth below it in the halves.
struct AveragedPair {
  __m256i mean, odd;
};
PAC_INLINE __m256i rows_8_apart(const uint8_t* samples, ptrdiff_t stride) {
  return join(load(samples), load(samples + 8 * stride));
}
PAC_INLINE AveragedPair average_right_pair(const uint8_t* samples, ptrdiff_t stride) {
  const __m256i a = rows_8_apart(samples, stride), b = rows_8_apart(samples + 1, stride);
  return {_mm256_avg_epu8(a, b), _mm256_xor_si256(a, b)};
}
uint32_t sad16_between_four(const uint8_t* source, ptrdiff_t source_stride, const uint8_t* reference,
                            ptrdiff_t reference_stride) {
  const __m256i ones = _mm256_set1_epi8(1);
  __m256i sum = _mm256_setzero_si256();
  AveragedPair above = average_right_pair(reference, reference_stride);
  for (int y = 0; y < 8; ++y) {
    const AveragedPair below = average_right_pair(reference + (y + 1) * reference_stride, reference_stride);
    const __m256i mean = _mm256_avg_epu8(above.mean, below.mean);  // as average_4() does it
    const __m256i rounded =
        _mm256_and_si256(_mm256_or_si256(above.odd, below.odd), _mm256_xor_si256(above.mean, below.mean));
    const __m256i prediction = _mm256_sub_epi8(mean, _mm256_and_si256(rounded, ones));
    sum = _mm256_add_epi32(sum, _mm256_sad_epu8(prediction, rows_8_apart(source + y * source_stride, source_stride)));
    above = below;
  }
  return low_32(sum_of_halves(_mm_add_epi32(_mm256_castsi256_si128(sum), _mm256_extracti128_si256(sum, 1))));
}

uint32_t satd16(const uint8_t* source, ptrdiff_t source_stride, const uint8_t* prediction,
                ptrdiff_t prediction_stride) {
  uint32_t total = 0;
  for (int half = 0; half < 2; ++half, source += 8 * source_stride, prediction += 8 * prediction_stride) {
    Block block;
    for (int y = 0; y < 8; ++y)
      block.v[y] = difference_row(source + y * source_stride, prediction + y * prediction_stride);
    hadamard(block);
    block = transpose(block);
    hadamard(block);
    __m256i sum = _mm256_setzero_si256();
    for (const __m256i v : block.v)
      sum = _mm256_add_epi32(sum, _mm256_madd_epi16(_mm256_abs_epi16(v), _mm256_set1_epi16(1)));
    total += (sum_of_4(_mm256_castsi256_si128(sum)) + 2) >> 2;
    total += (sum_of_4(_mm256_extracti128_si256(sum, 1)) + 2) >> 2;
  }
  return total;
}

// Transforms both blocks, stores them one after the other. Bit 0 and 1: which of them has a coefficient above `below`.
PAC_INLINE uint32_t transform_pair(Block& block, __m256i below, int16_t* coefficients) {
  fdct_2d(block);
  for (int y = 0; y < 8; ++y) {
    store(coefficients + 8 * y, _mm256_castsi256_si128(block.v[y]));
    store(coefficients + 64 + 8 * y, _mm256_extracti128_si256(block.v[y], 1));
  }
  const auto above = static_cast<uint32_t>(_mm256_movemask_epi8(_mm256_cmpgt_epi16(largest_magnitudes(block), below)));
  return ((above & 0xFFFF) != 0 ? 1u : 0u) | (above >> 16 != 0 ? 2u : 0u);
}

// What is left of the threshold for the squares of a block's differences. The DCT keeps the sum of squares: with E of
// the differences no coefficient, times 8, is above 8 sqrt(E), and the transform's own rounding adds less than 4.
__m256i squares_that_reach(int threshold) {
  const int sure = threshold < 4 ? 0 : threshold - 4;
  return _mm256_set1_epi32(sure * sure / 64);
}
// Both blocks' squares sum to less.
PAC_INLINE bool is_weak_pair(const Block& block, __m256i limit) {
  __m256i sum = _mm256_setzero_si256();
  for (const __m256i v : block.v) sum = _mm256_add_epi32(sum, _mm256_madd_epi16(v, v));
  sum = _mm256_add_epi32(sum, _mm256_shuffle_epi32(sum, 0x4E));
  sum = _mm256_add_epi32(sum, _mm256_shuffle_epi32(sum, 0xB1));
  return _mm256_movemask_epi8(_mm256_cmpgt_epi32(limit, sum)) == -1;
}

template <bool kOnlyReaching>
uint32_t fdct_macroblock(const PredictedSamples& samples, int threshold, int16_t* coefficients) {
  const __m256i below = _mm256_set1_epi16(static_cast<int16_t>(threshold - 1));
  const __m256i limit = squares_that_reach(threshold);
  uint32_t reaching = 0;
  Block block;
  for (int half = 0; half < 2; ++half) {
    const uint8_t* source = samples.source[0] + 8 * half * samples.source_stride[0];
    const uint8_t* prediction = samples.prediction[0] + 8 * half * samples.prediction_stride[0];
    for (int y = 0; y < 8; ++y)
      block.v[y] = difference_row(source + y * samples.source_stride[0], prediction + y * samples.prediction_stride[0]);
    if (kOnlyReaching && is_weak_pair(block, limit)) continue;
    reaching |= transform_pair(block, below, coefficients + 128 * half) << (2 * half);
  }
  const TwoReferences source{samples.source[1], samples.source[2]};
  const TwoReferences prediction{samples.prediction[1], samples.prediction[2]};
  for (int y = 0; y < 8; ++y)
    block.v[y] = difference_row(source.row(y * samples.source_stride[1], y * samples.source_stride[2]),
                                prediction.row(y * samples.prediction_stride[1], y * samples.prediction_stride[2]));
  if (kOnlyReaching && is_weak_pair(block, limit)) return reaching;
  return reaching | transform_pair(block, below, coefficients + 256) << 4;
}

template <bool kAdd>
void idct(const int16_t* coefficients, size_t n_blocks, uint8_t* const* samples, const ptrdiff_t* strides) {
  for (size_t i = 0; i < n_blocks; i += 2) {
    const size_t second = i + 1 < n_blocks ? i + 1 : i;
    Block block;
    for (size_t y = 0; y < 8; ++y)
      block.v[y] = join(load(coefficients + 64 * i + 8 * y), load(coefficients + 64 * second + 8 * y));
    idct_2d(block);
    for (int y = 0; y < 8; ++y) {
      uint8_t* p = samples[i] + y * strides[i];
      uint8_t* q = samples[second] + y * strides[second];
      __m256i row = block.v[y];
      if constexpr (kAdd) row = _mm256_adds_epi16(row, _mm256_cvtepu8_epi16(_mm_unpacklo_epi64(load_8(p), load_8(q))));
      const __m128i bytes = _mm_packus_epi16(_mm256_castsi256_si128(row), _mm256_extracti128_si256(row, 1));
      store_8(p, bytes);
      if (second != i) store_8(q, _mm_srli_si128(bytes, 8));
    }
  }
}

}  // namespace

void fill_motion_avx2(MotionKernels& table) {
  fill_shared(table);
  table.sad16_half[3] = sad16_between_four;
  table.satd16 = satd16;
  table.fdct_macroblock = fdct_macroblock<false>;
  table.fdct_reaching = fdct_macroblock<true>;
  table.idct_add = idct<true>;
  table.idct_put = idct<false>;
}

}  // namespace pac
