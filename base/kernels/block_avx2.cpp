// 8x8 blocks, two at a time: each 128-bit half does to its block what block_sse41.cpp does; nothing crosses the halves
// between loading and storing. An odd last block goes through both halves and is stored once.
#include <immintrin.h>

#include <cstddef>
#include <cstdint>

#include "base/kernels/block_kernels.h"

namespace pac {
namespace {

// One row of the first block in the low half, of the second in the high half.
using Lanes = __m256i;
struct Block {
  Lanes v[8];
};

__m128i load(const void* p) {
  return _mm_loadu_si128(static_cast<const __m128i*>(p));
}
__m256i twice(__m128i v) {
  return _mm256_broadcastsi128_si256(v);
}
__m256i join(__m128i first, __m128i second) {
  return _mm256_inserti128_si256(_mm256_castsi128_si256(first), second, 1);
}
void store(void* p, __m128i v) {
  _mm_storeu_si128(static_cast<__m128i*>(p), v);
}
__m128i first_of(__m256i v) {
  return _mm256_castsi256_si128(v);
}
__m128i second_of(__m256i v) {
  return _mm256_extracti128_si256(v, 1);
}

Block transpose(const Block& b) {
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

// Eight 32-bit values in two vectors.
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
Pairs interleave(__m256i a, __m256i b) {
  return {_mm256_unpacklo_epi16(a, b), _mm256_unpackhi_epi16(a, b)};
}
// a * ca + b * cb of the interleaved a and b; exact: both factors are 16-bit.
Wide multiply(const Pairs& ab, int ca, int cb) {
  const __m256i factors =
      _mm256_set1_epi32(static_cast<int>(static_cast<uint32_t>(cb) << 16 | (static_cast<uint32_t>(ca) & 0xFFFF)));
  return {_mm256_madd_epi16(ab.low, factors), _mm256_madd_epi16(ab.high, factors)};
}

// 2^(s-1), which rounds what is then shifted right by s. Added once to a term that several sums share.
template <int kShift>
Wide plus_half(const Wide& x) {
  const __m256i half = _mm256_set1_epi32(1 << (kShift - 1));
  return {_mm256_add_epi32(x.low, half), _mm256_add_epi32(x.high, half)};
}
// x >> s, saturated to 16 bits.
template <int kShift>
__m256i shift_right(const Wide& x) {
  return _mm256_packs_epi32(_mm256_srai_epi32(x.low, kShift), _mm256_srai_epi32(x.high, kShift));
}

__m256i add(__m256i a, __m256i b) {
  return _mm256_add_epi16(a, b);
}
__m256i subtract(__m256i a, __m256i b) {
  return _mm256_sub_epi16(a, b);
}
__m256i four_times(__m256i v) {
  return _mm256_slli_epi16(v, 2);
}
__m256i quarter(__m256i v) {
  return _mm256_srai_epi16(_mm256_add_epi16(v, _mm256_set1_epi16(2)), 2);
}
__m256i level_shifted(__m256i dc) {
  return _mm256_sub_epi16(dc, _mm256_set1_epi16(8 * 128));
}
Wide widen_by_13(__m256i v) {
  const __m256i zero = _mm256_setzero_si256();
  return {_mm256_srai_epi32(_mm256_unpacklo_epi16(zero, v), 3), _mm256_srai_epi32(_mm256_unpackhi_epi16(zero, v), 3)};
}

#include "base/kernels/block_transforms_simd.inc"

__m128i load_8(const uint8_t* p) {
  return _mm_loadl_epi64(reinterpret_cast<const __m128i*>(p));
}

// Columns of samples as 16-bit rows: bytes are transposed, which takes half the steps that words would. Of one block:
// the second half is zero.
Block load_transposed(const uint8_t* samples, ptrdiff_t stride, bool is_pair) {
  __m256i rows[4];  // two rows' bytes side by side
  for (int i = 0; i < 4; ++i) {
    const uint8_t *const upper = samples + 2 * i * stride, *const lower = upper + stride;
    const __m128i a = is_pair ? load(upper) : load_8(upper), b = is_pair ? load(lower) : load_8(lower);
    rows[i] = join(_mm_unpacklo_epi8(a, b), _mm_unpackhi_epi8(a, b));
  }
  const __m256i a0 = _mm256_unpacklo_epi16(rows[0], rows[1]), a1 = _mm256_unpackhi_epi16(rows[0], rows[1]);
  const __m256i a2 = _mm256_unpacklo_epi16(rows[2], rows[3]), a3 = _mm256_unpackhi_epi16(rows[2], rows[3]);
  const __m256i columns[4] = {_mm256_unpacklo_epi32(a0, a2), _mm256_unpackhi_epi32(a0, a2),
                              _mm256_unpacklo_epi32(a1, a3), _mm256_unpackhi_epi32(a1, a3)};  // two in each
  Block block;
  for (int i = 0; i < 4; ++i) {
    block.v[2 * i] = _mm256_unpacklo_epi8(columns[i], _mm256_setzero_si256());
    block.v[2 * i + 1] = _mm256_unpackhi_epi8(columns[i], _mm256_setzero_si256());
  }
  return block;
}

Block fdct_pair(const uint8_t* samples, ptrdiff_t stride, bool is_pair) {
  Block block = load_transposed(samples, stride, is_pair);
  fdct_1d<true>(block);
  block = transpose(block);
  fdct_1d<false>(block);
  return block;
}

void fdct_islow(const uint8_t* samples, ptrdiff_t stride, size_t n_blocks, int16_t* coefficients) {
  for (size_t i = 0; i < n_blocks; i += 2) {
    const bool is_pair = i + 1 < n_blocks;
    const Block block = fdct_pair(samples + 8 * i, stride, is_pair);
    for (int row = 0; row < 8; ++row) store(coefficients + 64 * i + 8 * row, first_of(block.v[row]));
    if (!is_pair) return;
    for (int row = 0; row < 8; ++row) store(coefficients + 64 * i + 64 + 8 * row, second_of(block.v[row]));
  }
}

// Only the DC level: every sample is the same. Returns it eight times.
__m128i idct_dc(int level, int step) {
  const auto dc = static_cast<int16_t>(static_cast<uint16_t>(level * step));
  const __m128i value = _mm_set1_epi16(dc);
  const __m128i column = _mm_adds_epi16(_mm_adds_epi16(value, value), _mm_adds_epi16(value, value));
  // (4 dc + 16) >> 5 in the contract's saturated form; the saturated addition only meets values that clamp anyway.
  const __m128i row = _mm_srai_epi16(_mm_adds_epi16(column, _mm_set1_epi16(16)), 5);
  return _mm_xor_si128(_mm_packs_epi16(row, row), _mm_set1_epi8(static_cast<char>(0x80)));
}

// Both rows' 16 samples, or the first block's 8.
void store_row(uint8_t* p, __m128i samples, bool is_pair) {
  if (is_pair)
    store(p, samples);
  else
    _mm_storel_epi64(reinterpret_cast<__m128i*>(p), samples);
}

// The sums of one dimension before the shift where inputs 4..7 are zero: half of the flow graph, its rotations joined
// into one multiplication each. Of the low or the high four lanes, as `unpack` takes them.
template <int kShift, class Unpack>
void idct_sums_low(const Block& x, Unpack&& unpack, __m256i (&sums)[8]) {
  const auto multiply_pair = [](__m256i ab, int ca, int cb) {
    return _mm256_madd_epi16(ab, _mm256_set1_epi32(static_cast<int>(static_cast<uint32_t>(cb) << 16 |
                                                                    (static_cast<uint32_t>(ca) & 0xFFFF))));
  };
  const __m256i zero = _mm256_setzero_si256(), half = _mm256_set1_epi32(1 << (kShift - 1));
  const __m256i even20 = unpack(x.v[2], zero), odd31 = unpack(x.v[3], x.v[1]);
  const __m256i even0 = _mm256_add_epi32(_mm256_srai_epi32(unpack(zero, x.v[0]), 3), half);
  const __m256i even2 = multiply_pair(even20, k0_541 + k0_765, 0), even3 = multiply_pair(even20, k0_541, 0);
  const __m256i a[4] = {_mm256_add_epi32(even0, even2), _mm256_add_epi32(even0, even3), _mm256_sub_epi32(even0, even3),
                        _mm256_sub_epi32(even0, even2)};
  const __m256i b[4] = {multiply_pair(odd31, k1_175, k1_501 - k0_899 + k1_175 - k0_390),
                        multiply_pair(odd31, k3_072 - k2_562 + k1_175 - k1_961, k1_175),
                        multiply_pair(odd31, k1_175 - k2_562, k1_175 - k0_390),
                        multiply_pair(odd31, k1_175 - k1_961, k1_175 - k0_899)};
  for (int i = 0; i < 4; ++i) {
    sums[i] = _mm256_add_epi32(a[i], b[i]);
    sums[7 - i] = _mm256_sub_epi32(a[i], b[i]);
  }
}
__m256i unpack_low(__m256i a, __m256i b) {
  return _mm256_unpacklo_epi16(a, b);
}
__m256i unpack_high(__m256i a, __m256i b) {
  return _mm256_unpackhi_epi16(a, b);
}

// First dimension: columns 0..3 of the result, transposed. The other columns are zero and so is what comes of them.
void idct_columns_low(Block& x) {
  __m256i sums[8];
  idct_sums_low<11>(x, unpack_low, sums);
  for (__m256i& row : sums) row = _mm256_srai_epi32(row, 11);
  const __m256i rows02 = _mm256_packs_epi32(sums[0], sums[2]), rows13 = _mm256_packs_epi32(sums[1], sums[3]);
  const __m256i rows46 = _mm256_packs_epi32(sums[4], sums[6]), rows57 = _mm256_packs_epi32(sums[5], sums[7]);
  const __m256i a0 = _mm256_unpacklo_epi16(rows02, rows13), a2 = _mm256_unpackhi_epi16(rows02, rows13);
  const __m256i a4 = _mm256_unpacklo_epi16(rows46, rows57), a6 = _mm256_unpackhi_epi16(rows46, rows57);
  const __m256i c0 = _mm256_unpacklo_epi32(a0, a2),
                c2 = _mm256_unpackhi_epi32(a0, a2);  // columns 0 1, 2 3 of rows 0..3
  const __m256i c4 = _mm256_unpacklo_epi32(a4, a6), c6 = _mm256_unpackhi_epi32(a4, a6);  // the same of rows 4..7
  x.v[0] = _mm256_unpacklo_epi64(c0, c4), x.v[1] = _mm256_unpackhi_epi64(c0, c4);
  x.v[2] = _mm256_unpacklo_epi64(c2, c6), x.v[3] = _mm256_unpackhi_epi64(c2, c6);
}

void idct_rows_low(Block& x) {
  __m256i low[8], high[8];
  idct_sums_low<18>(x, unpack_low, low);
  idct_sums_low<18>(x, unpack_high, high);
  for (int i = 0; i < 8; ++i) x.v[i] = shift_right<18>({low[i], high[i]});
}

// Columns of sample values less 128 in 16 bits to rows of samples, two blocks side by side.
void store_transposed(const Block& x, bool is_pair, uint8_t* samples, ptrdiff_t stride) {
  const __m256i p04 = _mm256_packs_epi16(x.v[0], x.v[4]), p15 = _mm256_packs_epi16(x.v[1], x.v[5]);
  const __m256i p26 = _mm256_packs_epi16(x.v[2], x.v[6]), p37 = _mm256_packs_epi16(x.v[3], x.v[7]);
  const __m256i a02 = _mm256_unpacklo_epi8(p04, p26), a46 = _mm256_unpackhi_epi8(p04, p26);
  const __m256i a13 = _mm256_unpacklo_epi8(p15, p37), a57 = _mm256_unpackhi_epi8(p15, p37);
  const __m256i low0 = _mm256_unpacklo_epi8(a02, a13), low4 = _mm256_unpackhi_epi8(a02, a13);    // columns 0..3
  const __m256i high0 = _mm256_unpacklo_epi8(a46, a57), high4 = _mm256_unpackhi_epi8(a46, a57);  // columns 4..7
  const __m256i rows[4] = {_mm256_unpacklo_epi32(low0, high0), _mm256_unpackhi_epi32(low0, high0),
                           _mm256_unpacklo_epi32(low4, high4), _mm256_unpackhi_epi32(low4, high4)};
  const __m256i center = _mm256_set1_epi8(static_cast<char>(0x80));  // adds 128 to a signed byte
  for (int i = 0; i < 4; ++i) {
    // (row of first, next row of first | row of second, next row of second) -> rows of both side by side
    const __m256i both = _mm256_permute4x64_epi64(_mm256_xor_si256(rows[i], center), 0xD8);
    store_row(samples + 2 * i * stride, first_of(both), is_pair);
    store_row(samples + (2 * i + 1) * stride, second_of(both), is_pair);
  }
}

// kIsLow: only the levels of the first four rows and columns are not zero.
template <bool kIsLow>
void idct_pair(const int16_t* levels, const uint16_t* steps, bool is_pair, uint8_t* samples, ptrdiff_t stride) {
  Block block;
  for (int row = 0; row < (kIsLow ? 4 : 8); ++row) {
    const __m128i first = load(levels + 8 * row);
    const __m256i both = is_pair ? join(first, load(levels + 64 + 8 * row)) : twice(first);
    block.v[row] = _mm256_mullo_epi16(both, twice(load(steps + 8 * row)));
  }
  if constexpr (kIsLow) {
    idct_columns_low(block);
    idct_rows_low(block);
  } else {
    idct_1d<11>(block);
    block = transpose(block);
    idct_1d<18>(block);
  }
  store_transposed(block, is_pair, samples, stride);
}

void idct_islow(const int16_t* levels, const uint16_t* steps, const uint8_t* last, size_t n_blocks, uint8_t* samples,
                ptrdiff_t stride) {
  constexpr int kLastLow = 9;  // zigzag positions 0..9 lie in rows and columns 0..3
  for (size_t i = 0; i < n_blocks; i += 2, levels += 128, samples += 16) {
    const bool is_pair = i + 1 < n_blocks;
    const int end = is_pair && last[i + 1] > last[i] ? last[i + 1] : last[i];
    if (end > kLastLow) {
      idct_pair<false>(levels, steps, is_pair, samples, stride);
    } else if (end > 0) {
      idct_pair<true>(levels, steps, is_pair, samples, stride);
    } else {
      const __m128i first = idct_dc(levels[0], steps[0]);
      const __m128i both = is_pair ? _mm_unpacklo_epi64(first, idct_dc(levels[64], steps[0])) : first;
      for (int y = 0; y < 8; ++y) store_row(samples + y * stride, both, is_pair);
    }
  }
}

__m256i zeros() {
  return _mm256_setzero_si256();
}
__m256i either(__m256i a, __m256i b) {
  return _mm256_or_si256(a, b);
}
__m256i shuffle(__m256i v, const int8_t (&mask)[16]) {
  return _mm256_shuffle_epi8(v, twice(load(mask)));
}

#include "base/kernels/block_zigzag_simd.inc"

// A BlockQuantizer for both halves.
struct PairQuantizer {
  explicit PairQuantizer(const BlockQuantizer& quantizer) {
    for (int row = 0; row < 8; ++row) {
      bias[row] = twice(load(quantizer.bias + 8 * row));
      reciprocal[row] = twice(load(quantizer.reciprocal + 8 * row));
      scale[row] = twice(load(quantizer.scale + 8 * row));
    }
  }
  __m256i bias[8], reciprocal[8], scale[8];
};

// Levels of two blocks in natural order.
Block quantized(const Block& c, const PairQuantizer& quantizer) {
  Block block;
  for (int row = 0; row < 8; ++row) {
    const __m256i n = _mm256_add_epi16(_mm256_abs_epi16(c.v[row]), quantizer.bias[row]);
    const __m256i level = _mm256_mulhi_epu16(_mm256_mulhi_epu16(n, quantizer.reciprocal[row]), quantizer.scale[row]);
    block.v[row] = _mm256_sign_epi16(level, c.v[row]);  // c == 0 gives 0, as its level does
  }
  return block;
}

// To zigzag order and masks; the second block's only if it is_pair.
void store_levels(const Block& natural, bool is_pair, int16_t* levels, uint64_t* nonzero) {
  const Block block = zigzag_from_natural(natural);
  uint64_t first_zeros = 0, second_zeros = 0;
  for (int k = 0; k < 8; k += 2) {
    const __m256i bytes = _mm256_packs_epi16(block.v[k], block.v[k + 1]);  // zero exactly where the level is
    const auto mask = static_cast<uint32_t>(_mm256_movemask_epi8(_mm256_cmpeq_epi8(bytes, _mm256_setzero_si256())));
    first_zeros |= static_cast<uint64_t>(mask & 0xFFFF) << 8 * k;
    second_zeros |= static_cast<uint64_t>(mask >> 16) << 8 * k;
  }
  for (int k = 0; k < 8; ++k) store(levels + 8 * k, first_of(block.v[k]));
  nonzero[0] = ~first_zeros;
  if (!is_pair) return;
  for (int k = 0; k < 8; ++k) store(levels + 64 + 8 * k, second_of(block.v[k]));
  nonzero[1] = ~second_zeros;
}

void quantize(const int16_t* coefficients, const BlockQuantizer& quantizer, size_t n_blocks, int16_t* levels,
              uint64_t* nonzero) {
  const PairQuantizer both(quantizer);
  for (size_t i = 0; i < n_blocks; i += 2) {
    const int16_t* in = coefficients + 64 * i;
    const bool is_pair = i + 1 < n_blocks;
    Block block;
    for (int row = 0; row < 8; ++row) {
      const __m128i first = load(in + 8 * row);
      block.v[row] = is_pair ? join(first, load(in + 64 + 8 * row)) : twice(first);
    }
    store_levels(quantized(block, both), is_pair, levels + 64 * i, nonzero + i);
  }
}

void fdct_quantize(const uint8_t* samples, ptrdiff_t stride, size_t n_blocks, const BlockQuantizer& quantizer,
                   int16_t* levels, uint64_t* nonzero) {
  const PairQuantizer both(quantizer);
  for (size_t i = 0; i < n_blocks; i += 2) {
    const bool is_pair = i + 1 < n_blocks;
    store_levels(quantized(fdct_pair(samples + 8 * i, stride, is_pair), both), is_pair, levels + 64 * i, nonzero + i);
  }
}

}  // namespace

void fill_block_avx2(BlockKernels& table) {
  table.fdct_islow = fdct_islow;
  table.idct_islow = idct_islow;
  table.quantize = quantize;
  table.fdct_quantize = fdct_quantize;
}

}  // namespace pac
