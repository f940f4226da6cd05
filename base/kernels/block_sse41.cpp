// 8x8 blocks: eight 16-bit lanes hold a row (or, between the two passes of a transform, a column). A one-dimensional
// transform works down the eight vectors, a transposition turns the block between the passes.
#include <smmintrin.h>

#include <cstddef>
#include <cstdint>

#include "base/kernels/block_kernels.h"

namespace pac {
namespace {

// The scalar file's constants: round(c * 2^13).
constexpr int k0_541 = 4433, k0_765 = 6270, k1_847 = 15137, k1_175 = 9633, k1_961 = 16069, k0_390 = 3196;
constexpr int k0_298 = 2446, k2_053 = 16819, k3_072 = 25172, k1_501 = 12299, k0_899 = 7373, k2_562 = 20995;

struct Block {
  __m128i v[8];
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

// (x + 2^(s-1)) >> s, saturated to 16 bits.
template <int kShift>
__m128i round_shift(const Wide& x) {
  const __m128i half = _mm_set1_epi32(1 << (kShift - 1));
  return _mm_packs_epi32(_mm_srai_epi32(_mm_add_epi32(x.low, half), kShift),
                         _mm_srai_epi32(_mm_add_epi32(x.high, half), kShift));
}

// One dimension, forward. First pass: shift 11, two bits of fraction stay; second: shift 15.
template <bool kIsFirst>
void fdct_1d(Block& x) {
  constexpr int kShift = kIsFirst ? 11 : 15;
  const __m128i sum07 = _mm_add_epi16(x.v[0], x.v[7]), difference07 = _mm_sub_epi16(x.v[0], x.v[7]);
  const __m128i sum16 = _mm_add_epi16(x.v[1], x.v[6]), difference16 = _mm_sub_epi16(x.v[1], x.v[6]);
  const __m128i sum25 = _mm_add_epi16(x.v[2], x.v[5]), difference25 = _mm_sub_epi16(x.v[2], x.v[5]);
  const __m128i sum34 = _mm_add_epi16(x.v[3], x.v[4]), difference34 = _mm_sub_epi16(x.v[3], x.v[4]);

  const __m128i even0 = _mm_add_epi16(sum07, sum34), even3 = _mm_sub_epi16(sum07, sum34);
  const __m128i even1 = _mm_add_epi16(sum16, sum25), even2 = _mm_sub_epi16(sum16, sum25);
  const auto scale = [](__m128i v) {
    // The second pass's sums reach -2^15 .. 2^15 - 2^8: adding 2 cannot overflow.
    return kIsFirst ? _mm_slli_epi16(v, 2) : _mm_srai_epi16(_mm_add_epi16(v, _mm_set1_epi16(2)), 2);
  };
  x.v[0] = scale(_mm_add_epi16(even0, even1));
  x.v[4] = scale(_mm_sub_epi16(even0, even1));
  const Pairs even23 = interleave(even2, even3);
  x.v[2] = round_shift<kShift>(multiply(even23, k0_541, k0_541 + k0_765));
  x.v[6] = round_shift<kShift>(multiply(even23, k0_541 - k1_847, k0_541));

  const Pairs z = interleave(_mm_add_epi16(difference34, difference16), _mm_add_epi16(difference25, difference07));
  const Wide odd3 = multiply(z, k1_175 - k1_961, k1_175), odd4 = multiply(z, k1_175, k1_175 - k0_390);
  const Pairs outer = interleave(difference34, difference07), inner = interleave(difference25, difference16);
  x.v[7] = round_shift<kShift>(multiply(outer, k0_298 - k0_899, -k0_899) + odd3);
  x.v[1] = round_shift<kShift>(multiply(outer, -k0_899, k1_501 - k0_899) + odd4);
  x.v[5] = round_shift<kShift>(multiply(inner, k2_053 - k2_562, -k2_562) + odd4);
  x.v[3] = round_shift<kShift>(multiply(inner, -k2_562, k3_072 - k2_562) + odd3);
}

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

// One dimension, inverse: columns round away 11 bits, rows 18. The 16-bit additions wrap, as the contract says.
template <int kShift>
void idct_1d(Block& x) {
  const Pairs even26 = interleave(x.v[2], x.v[6]);
  const Wide even2 = multiply(even26, k0_541 + k0_765, k0_541), even3 = multiply(even26, k0_541, k0_541 - k1_847);
  const auto shift_left_13 = [](__m128i v) {
    const __m128i zero = _mm_setzero_si128();
    return Wide{_mm_srai_epi32(_mm_unpacklo_epi16(zero, v), 3), _mm_srai_epi32(_mm_unpackhi_epi16(zero, v), 3)};
  };
  const Wide even0 = shift_left_13(_mm_add_epi16(x.v[0], x.v[4]));
  const Wide even1 = shift_left_13(_mm_sub_epi16(x.v[0], x.v[4]));
  const Wide a0 = even0 + even2, a3 = even0 - even2, a1 = even1 + even3, a2 = even1 - even3;

  const Pairs z = interleave(_mm_add_epi16(x.v[7], x.v[3]), _mm_add_epi16(x.v[5], x.v[1]));
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

// pshufb masks that bring to each vector of eight zigzag positions what it takes from each natural row; -1 gives zero.
struct ZigzagMasks {
  alignas(16) int8_t mask[8][8][16];  // [output vector][natural row]
};
constexpr ZigzagMasks make_zigzag_masks() {
  ZigzagMasks masks{};
  for (int out = 0; out < 8; ++out)
    for (int row = 0; row < 8; ++row)
      for (int lane = 0; lane < 8; ++lane) {
        const int natural = kNaturalFromZigzag[8 * out + lane];
        const bool is_here = natural / 8 == row;
        masks.mask[out][row][2 * lane] = static_cast<int8_t>(is_here ? natural % 8 * 2 : -1);
        masks.mask[out][row][2 * lane + 1] = static_cast<int8_t>(is_here ? natural % 8 * 2 + 1 : -1);
      }
  return masks;
}
constexpr ZigzagMasks kZigzag = make_zigzag_masks();

// Zigzag positions 8 kOut .. 8 kOut + 7, which lie in these natural rows only.
template <int kOut, int... kRows>
__m128i gather(const Block& natural) {
  __m128i result = _mm_setzero_si128();
  ((result = _mm_or_si128(result, _mm_shuffle_epi8(natural.v[kRows], load(kZigzag.mask[kOut][kRows])))), ...);
  return result;
}
Block zigzag_from_natural(const Block& b) {
  return {{gather<0, 0, 1, 2>(b), gather<1, 0, 1, 2, 3, 4>(b), gather<2, 1, 2, 3, 4, 5, 6>(b), gather<3, 0, 1, 2, 3>(b),
           gather<4, 4, 5, 6, 7>(b), gather<5, 1, 2, 3, 4, 5, 6>(b), gather<6, 3, 4, 5, 6, 7>(b),
           gather<7, 5, 6, 7>(b)}};
}

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
