// 8x8 blocks: eight 16-bit lanes hold a row (or, between the two passes of a transform, a column). A one-dimensional
// transform works down the eight vectors, a transposition turns the block between the passes.
#include <smmintrin.h>

#include <cstddef>
#include <cstdint>

#include "base/kernels/block_kernels.h"

namespace pac {
namespace {

using Lanes = __m128i;
struct Block {
  Lanes v[8];
};

__m128i load(const void* p) {
  return _mm_loadu_si128(static_cast<const __m128i*>(p));
}
void store(void* p, __m128i v) {
  _mm_storeu_si128(static_cast<__m128i*>(p), v);
}

Block transpose(const Block& b) {
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

// Eight 32-bit values in two vectors.
struct Wide {
  __m128i low, high;
};
Wide operator+(const Wide& a, const Wide& b) {
  return {_mm_add_epi32(a.low, b.low), _mm_add_epi32(a.high, b.high)};
}
Wide operator-(const Wide& a, const Wide& b) {
  return {_mm_sub_epi32(a.low, b.low), _mm_sub_epi32(a.high, b.high)};
}

// Two vectors' lanes side by side, ready for pmaddwd.
struct Pairs {
  __m128i low, high;
};
Pairs interleave(__m128i a, __m128i b) {
  return {_mm_unpacklo_epi16(a, b), _mm_unpackhi_epi16(a, b)};
}
// a * ca + b * cb of the interleaved a and b; exact: both factors are 16-bit.
Wide multiply(const Pairs& ab, int ca, int cb) {
  const __m128i factors =
      _mm_set1_epi32(static_cast<int>(static_cast<uint32_t>(cb) << 16 | (static_cast<uint32_t>(ca) & 0xFFFF)));
  return {_mm_madd_epi16(ab.low, factors), _mm_madd_epi16(ab.high, factors)};
}

template <int kShift>
Wide plus_half(const Wide& x) {
  const __m128i half = _mm_set1_epi32(1 << (kShift - 1));
  return {_mm_add_epi32(x.low, half), _mm_add_epi32(x.high, half)};
}
template <int kShift>
__m128i shift_right(const Wide& x) {
  return _mm_packs_epi32(_mm_srai_epi32(x.low, kShift), _mm_srai_epi32(x.high, kShift));
}

__m128i add(__m128i a, __m128i b) {
  return _mm_add_epi16(a, b);
}
__m128i subtract(__m128i a, __m128i b) {
  return _mm_sub_epi16(a, b);
}
__m128i four_times(__m128i v) {
  return _mm_slli_epi16(v, 2);
}
__m128i quarter(__m128i v) {
  return _mm_srai_epi16(_mm_add_epi16(v, _mm_set1_epi16(2)), 2);
}
__m128i level_shifted(__m128i dc) {
  return dc;
}
Wide widen_by_13(__m128i v) {
  const __m128i zero = _mm_setzero_si128();
  return {_mm_srai_epi32(_mm_unpacklo_epi16(zero, v), 3), _mm_srai_epi32(_mm_unpackhi_epi16(zero, v), 3)};
}

#include "base/kernels/block_transforms_simd.inc"

void fdct_islow(const uint8_t* samples, ptrdiff_t stride, size_t n_blocks, int16_t* coefficients) {
  for (size_t i = 0; i < n_blocks; ++i) {
    Block block;
    for (int row = 0; row < 8; ++row) {
      const __m128i bytes = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(samples + row * stride + 8 * i));
      block.v[row] = _mm_sub_epi16(_mm_cvtepu8_epi16(bytes), _mm_set1_epi16(128));
    }
    block = transpose(block);
    fdct_1d<true>(block);
    block = transpose(block);
    fdct_1d<false>(block);
    for (int row = 0; row < 8; ++row) store(coefficients + 64 * i + 8 * row, block.v[row]);
  }
}

// Only the DC level: every sample is the same.
void idct_dc(int level, int step, uint8_t* samples, ptrdiff_t stride) {
  const auto dc = static_cast<int16_t>(static_cast<uint16_t>(level * step));
  const __m128i value = _mm_set1_epi16(dc);
  const __m128i column = _mm_adds_epi16(_mm_adds_epi16(value, value), _mm_adds_epi16(value, value));
  // (4 dc + 16) >> 5 in the contract's saturated form; the saturated addition only meets values that clamp anyway.
  const __m128i row = _mm_srai_epi16(_mm_adds_epi16(column, _mm_set1_epi16(16)), 5);
  const __m128i bytes = _mm_xor_si128(_mm_packs_epi16(row, row), _mm_set1_epi8(static_cast<char>(0x80)));
  for (int y = 0; y < 8; ++y) _mm_storel_epi64(reinterpret_cast<__m128i*>(samples + y * stride), bytes);
}

void idct_block(const int16_t* levels, const uint16_t* steps, uint8_t* samples, ptrdiff_t stride) {
  Block block;
  for (int row = 0; row < 8; ++row) block.v[row] = _mm_mullo_epi16(load(levels + 8 * row), load(steps + 8 * row));
  idct_1d<11>(block);
  block = transpose(block);
  idct_1d<18>(block);
  block = transpose(block);
  const __m128i center = _mm_set1_epi8(static_cast<char>(0x80));  // adds 128 to a signed byte
  for (int row = 0; row < 8; row += 2) {
    const __m128i bytes = _mm_xor_si128(_mm_packs_epi16(block.v[row], block.v[row + 1]), center);
    _mm_storel_epi64(reinterpret_cast<__m128i*>(samples + row * stride), bytes);
    _mm_storel_epi64(reinterpret_cast<__m128i*>(samples + (row + 1) * stride), _mm_unpackhi_epi64(bytes, bytes));
  }
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

__m128i zeros() {
  return _mm_setzero_si128();
}
__m128i either(__m128i a, __m128i b) {
  return _mm_or_si128(a, b);
}
__m128i shuffle(__m128i v, const int8_t (&mask)[16]) {
  return _mm_shuffle_epi8(v, load(mask));
}

#include "base/kernels/block_zigzag_simd.inc"

void quantize(const int16_t* coefficients, const BlockQuantizer& quantizer, size_t n_blocks, int16_t* levels,
              uint64_t* nonzero) {
  for (size_t i = 0; i < n_blocks; ++i) {
    Block block;
    for (int row = 0; row < 8; ++row) {
      const __m128i c = load(coefficients + 64 * i + 8 * row);
      const __m128i n = _mm_add_epi16(_mm_abs_epi16(c), load(quantizer.bias + 8 * row));
      const __m128i level =
          _mm_mulhi_epu16(_mm_mulhi_epu16(n, load(quantizer.reciprocal + 8 * row)), load(quantizer.scale + 8 * row));
      block.v[row] = _mm_sign_epi16(level, c);  // c == 0 gives 0, as its level does
    }
    block = zigzag_from_natural(block);
    uint64_t zeros = 0;
    for (int k = 0; k < 8; k += 2) {
      store(levels + 64 * i + 8 * k, block.v[k]);
      store(levels + 64 * i + 8 * k + 8, block.v[k + 1]);
      const __m128i bytes = _mm_packs_epi16(block.v[k], block.v[k + 1]);  // zero exactly where the level is
      const int mask = _mm_movemask_epi8(_mm_cmpeq_epi8(bytes, _mm_setzero_si128()));
      zeros |= static_cast<uint64_t>(static_cast<uint32_t>(mask)) << 8 * k;
    }
    nonzero[i] = ~zeros;
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

void fill_block_sse41(BlockKernels& table) {
  table.fdct_islow = fdct_islow;
  table.idct_islow = idct_islow;
  table.quantize = quantize;
  table.fdct_quantize = fdct_quantize;
}

}  // namespace pac
