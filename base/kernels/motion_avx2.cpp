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

// The scalar file's constants: round(c * 2^13).
constexpr int k0_541 = 4433, k0_765 = 6270, k1_847 = 15137, k1_175 = 9633, k1_961 = 16069, k0_390 = 3196;
constexpr int k0_298 = 2446, k2_053 = 16819, k3_072 = 25172, k1_501 = 12299, k0_899 = 7373, k2_562 = 20995;

// One row of the first block in the low half, of the second in the high half.
struct Block {
  __m256i v[8];
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

// Sums and differences of rows at a distance of 1, 2, 4: the Hadamard transform down the columns.
PAC_INLINE void hadamard(Block& b) {
  for (int half = 1; half < 8; half *= 2)
    for (int i = 0; i < 8; ++i) {
      if ((i & half) != 0) continue;
      const __m256i sum = _mm256_add_epi16(b.v[i], b.v[i + half]);
      b.v[i + half] = _mm256_sub_epi16(b.v[i], b.v[i + half]);
      b.v[i] = sum;
    }
}

// 32-bit values in two vectors.
struct Wide {
  __m256i low, high;
};
Wide operator+(const Wide& a, const Wide& b) {
  return {_mm256_add_epi32(a.low, b.low), _mm256_add_epi32(a.high, b.high)};
}
Wide operator-(const Wide& a, const Wide& b) {
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

// One dimension, forward. First pass: one bit of fraction stays; second: it goes.
template <bool kIsFirst>
PAC_INLINE void fdct_1d(Block& x) {
  constexpr int kShift = kIsFirst ? 12 : 14;
  const __m256i sum07 = _mm256_add_epi16(x.v[0], x.v[7]), difference07 = _mm256_sub_epi16(x.v[0], x.v[7]);
  const __m256i sum16 = _mm256_add_epi16(x.v[1], x.v[6]), difference16 = _mm256_sub_epi16(x.v[1], x.v[6]);
  const __m256i sum25 = _mm256_add_epi16(x.v[2], x.v[5]), difference25 = _mm256_sub_epi16(x.v[2], x.v[5]);
  const __m256i sum34 = _mm256_add_epi16(x.v[3], x.v[4]), difference34 = _mm256_sub_epi16(x.v[3], x.v[4]);

  const __m256i even0 = _mm256_add_epi16(sum07, sum34), even3 = _mm256_sub_epi16(sum07, sum34);
  const __m256i even1 = _mm256_add_epi16(sum16, sum25), even2 = _mm256_sub_epi16(sum16, sum25);
  const auto scale = [](__m256i v) {
    // The second pass's sums stay within +-32640: adding 1 cannot overflow.
    return kIsFirst ? _mm256_slli_epi16(v, 1) : _mm256_srai_epi16(_mm256_add_epi16(v, _mm256_set1_epi16(1)), 1);
  };
  x.v[0] = scale(_mm256_add_epi16(even0, even1));
  x.v[4] = scale(_mm256_sub_epi16(even0, even1));
  const Pairs even23 = interleave(even2, even3);
  x.v[2] = round_shift<kShift>(multiply(even23, k0_541, k0_541 + k0_765));
  x.v[6] = round_shift<kShift>(multiply(even23, k0_541 - k1_847, k0_541));

  const Pairs z =
      interleave(_mm256_add_epi16(difference34, difference16), _mm256_add_epi16(difference25, difference07));
  const Wide odd3 = multiply(z, k1_175 - k1_961, k1_175), odd4 = multiply(z, k1_175, k1_175 - k0_390);
  const Pairs outer = interleave(difference34, difference07), inner = interleave(difference25, difference16);
  x.v[7] = round_shift<kShift>(multiply(outer, k0_298 - k0_899, -k0_899) + odd3);
  x.v[1] = round_shift<kShift>(multiply(outer, -k0_899, k1_501 - k0_899) + odd4);
  x.v[5] = round_shift<kShift>(multiply(inner, k2_053 - k2_562, -k2_562) + odd4);
  x.v[3] = round_shift<kShift>(multiply(inner, -k2_562, k3_072 - k2_562) + odd3);
}

// One dimension, inverse: columns round away 10 bits, rows 19. The 16-bit additions saturate, as the contract says.
template <int kShift>
PAC_INLINE void idct_1d(Block& x) {
  const Pairs even26 = interleave(x.v[2], x.v[6]);
  const Wide even2 = multiply(even26, k0_541 + k0_765, k0_541), even3 = multiply(even26, k0_541, k0_541 - k1_847);
  const auto shift_left_13 = [](__m256i v) {
    const __m256i zero = _mm256_setzero_si256();
    return Wide{_mm256_srai_epi32(_mm256_unpacklo_epi16(zero, v), 3),
                _mm256_srai_epi32(_mm256_unpackhi_epi16(zero, v), 3)};
  };
  const Wide even0 = shift_left_13(_mm256_adds_epi16(x.v[0], x.v[4]));
  const Wide even1 = shift_left_13(_mm256_subs_epi16(x.v[0], x.v[4]));
  const Wide a0 = even0 + even2, a3 = even0 - even2, a1 = even1 + even3, a2 = even1 - even3;

  const Pairs z = interleave(_mm256_adds_epi16(x.v[7], x.v[3]), _mm256_adds_epi16(x.v[5], x.v[1]));
  const Wide odd3 = multiply(z, k1_175 - k1_961, k1_175), odd4 = multiply(z, k1_175, k1_175 - k0_390);
  const Pairs odd71 = interleave(x.v[7], x.v[1]), odd53 = interleave(x.v[5], x.v[3]);
  const Wide b0 = multiply(odd71, k0_298 - k0_899, -k0_899) + odd3;
  const Wide b1 = multiply(odd53, k2_053 - k2_562, -k2_562) + odd4;
  const Wide b2 = multiply(odd53, -k2_562, k3_072 - k2_562) + odd3;
  const Wide b3 = multiply(odd71, -k0_899, k1_501 - k0_899) + odd4;
  x.v[0] = round_shift<kShift>(a0 + b3), x.v[7] = round_shift<kShift>(a0 - b3);
  x.v[1] = round_shift<kShift>(a1 + b2), x.v[6] = round_shift<kShift>(a1 - b2);
  x.v[2] = round_shift<kShift>(a2 + b1), x.v[5] = round_shift<kShift>(a2 - b1);
  x.v[3] = round_shift<kShift>(a3 + b0), x.v[4] = round_shift<kShift>(a3 - b0);
}
// The same where rows 4 to 7 of the input are zero: sums with them vanish, so that their products do.
template <int kShift>
PAC_INLINE void idct_1d_half(Block& x) {
  const __m256i zero = _mm256_setzero_si256();
  const Pairs two = interleave(x.v[2], zero);
  const Wide even2 = multiply(two, k0_541 + k0_765, 0), even3 = multiply(two, k0_541, 0);
  const Wide even0{_mm256_srai_epi32(_mm256_unpacklo_epi16(zero, x.v[0]), 3),
                   _mm256_srai_epi32(_mm256_unpackhi_epi16(zero, x.v[0]), 3)};
  const Wide a0 = even0 + even2, a3 = even0 - even2, a1 = even0 + even3, a2 = even0 - even3;
  const Pairs odd = interleave(x.v[1], x.v[3]);
  const Wide b0 = multiply(odd, k1_175 - k0_899, k1_175 - k1_961);
  const Wide b1 = multiply(odd, k1_175 - k0_390, k1_175 - k2_562);
  const Wide b2 = multiply(odd, k1_175, k3_072 - k2_562 + k1_175 - k1_961);
  const Wide b3 = multiply(odd, k1_501 - k0_899 + k1_175 - k0_390, k1_175);
  x.v[0] = round_shift<kShift>(a0 + b3), x.v[7] = round_shift<kShift>(a0 - b3);
  x.v[1] = round_shift<kShift>(a1 + b2), x.v[6] = round_shift<kShift>(a1 - b2);
  x.v[2] = round_shift<kShift>(a2 + b1), x.v[5] = round_shift<kShift>(a2 - b1);
  x.v[3] = round_shift<kShift>(a3 + b0), x.v[4] = round_shift<kShift>(a3 - b0);
}

bool lower_half_is_zero(const Block& b) {
  const __m256i rows = _mm256_or_si256(_mm256_or_si256(b.v[4], b.v[5]), _mm256_or_si256(b.v[6], b.v[7]));
  return _mm256_testz_si256(rows, rows) != 0;
}

// Columns, then rows.
PAC_INLINE void idct_2d(Block& b) {
  if (lower_half_is_zero(b))
    idct_1d_half<10>(b);
  else
    idct_1d<10>(b);
  b = transpose(b);
  if (lower_half_is_zero(b))
    idct_1d_half<19>(b);
  else
    idct_1d<19>(b);
  b = transpose(b);
}

__m256i join(__m128i first, __m128i second) {
  return _mm256_inserti128_si256(_mm256_castsi128_si256(first), second, 1);
}
// 16 samples' differences: the left block's in the low half.
__m256i difference_row(const uint8_t* source, const uint8_t* prediction) {
  return _mm256_sub_epi16(_mm256_cvtepu8_epi16(load(source)), _mm256_cvtepu8_epi16(load(prediction)));
}
__m256i difference_row_8(const uint8_t* source, const uint8_t* prediction) {
  return _mm256_castsi128_si256(_mm_sub_epi16(widen(load_8(source)), widen(load_8(prediction))));
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

void fdct_residual(const uint8_t* source, ptrdiff_t source_stride, const uint8_t* prediction,
                   ptrdiff_t prediction_stride, size_t n_blocks, int16_t* coefficients) {
  for (size_t i = 0; i < n_blocks; i += 2) {
    const bool is_pair = i + 1 < n_blocks;
    Block block;
    for (int y = 0; y < 8; ++y) {
      const uint8_t* s = source + y * source_stride + 8 * i;
      const uint8_t* p = prediction + y * prediction_stride + 8 * i;
      block.v[y] = is_pair ? difference_row(s, p) : difference_row_8(s, p);
    }
    block = transpose(block);
    fdct_1d<true>(block);
    block = transpose(block);
    fdct_1d<false>(block);
    int16_t* out = coefficients + 64 * i;
    for (int y = 0; y < 8; ++y) store(out + 8 * y, _mm256_castsi256_si128(block.v[y]));
    if (!is_pair) return;
    for (int y = 0; y < 8; ++y) store(out + 64 + 8 * y, _mm256_extracti128_si256(block.v[y], 1));
  }
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
  table.satd16 = satd16;
  table.fdct_residual = fdct_residual;
  table.idct_add = idct<true>;
  table.idct_put = idct<false>;
}

}  // namespace pac
