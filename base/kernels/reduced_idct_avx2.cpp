// Two blocks at a time, one in each 128-bit half. An odd last block goes through both halves and is stored once.
#include <immintrin.h>

#include <cstddef>
#include <cstdint>

#include "base/kernels/block_kernels.h"

namespace pac {
namespace {

constexpr size_t kBlocks = 2;

struct I4 {
  __m256i v;
};
struct Halves {
  I4 low, high;
};

inline I4 operator+(I4 a, I4 b) {
  return {_mm256_add_epi32(a.v, b.v)};
}
inline I4 operator-(I4 a, I4 b) {
  return {_mm256_sub_epi32(a.v, b.v)};
}
inline I4 times(I4 a, I4 b) {
  return {_mm256_mullo_epi32(a.v, b.v)};
}
inline I4 times(I4 a, int32_t n) {
  return {_mm256_mullo_epi32(a.v, _mm256_set1_epi32(n))};
}
inline I4 alternating(int32_t a, int32_t b) {
  return {_mm256_setr_epi32(a, b, a, b, a, b, a, b)};
}
template <int kBits>
inline I4 shift_left(I4 a) {
  return {_mm256_slli_epi32(a.v, kBits)};
}
template <int kBits>
inline I4 round_shift(I4 a) {
  return {_mm256_srai_epi32(_mm256_add_epi32(a.v, _mm256_set1_epi32(1 << (kBits - 1))), kBits)};
}
inline I4 swap_pairs(I4 a) {
  return {_mm256_shuffle_epi32(a.v, 0xB1)};
}
inline I4 even_twice(I4 a) {
  return {_mm256_shuffle_epi32(a.v, 0xA0)};
}

inline __m128i load(const void* p) {
  return _mm_loadu_si128(static_cast<const __m128i*>(p));
}

inline Halves dequantized(const int16_t* levels, const uint16_t* steps, int row, bool is_pair) {
  const __m128i first = load(levels + 8 * row), second = is_pair ? load(levels + 64 + 8 * row) : first;
  const __m256i both = _mm256_inserti128_si256(_mm256_castsi128_si256(first), second, 1);
  const __m256i product = _mm256_mullo_epi16(both, _mm256_broadcastsi128_si256(load(steps + 8 * row)));
  return {{_mm256_srai_epi32(_mm256_unpacklo_epi16(product, product), 16)},
          {_mm256_srai_epi32(_mm256_unpackhi_epi16(product, product), 16)}};
}

inline void transpose(I4 (&x)[4]) {
  const __m256i a0 = _mm256_unpacklo_epi32(x[0].v, x[1].v), a1 = _mm256_unpackhi_epi32(x[0].v, x[1].v);
  const __m256i a2 = _mm256_unpacklo_epi32(x[2].v, x[3].v), a3 = _mm256_unpackhi_epi32(x[2].v, x[3].v);
  x[0].v = _mm256_unpacklo_epi64(a0, a2);
  x[1].v = _mm256_unpackhi_epi64(a0, a2);
  x[2].v = _mm256_unpacklo_epi64(a1, a3);
  x[3].v = _mm256_unpackhi_epi64(a1, a3);
}

// Clamps to a signed byte and adds 128. The first block's samples in bytes 0..15, the second's in 16..31.
struct Samples {
  alignas(32) uint8_t bytes[32];
  Samples(__m256i low, __m256i high) {
    const __m256i clamped = _mm256_packs_epi16(low, high);
    _mm256_store_si256(reinterpret_cast<__m256i*>(bytes),
                       _mm256_xor_si256(clamped, _mm256_set1_epi8(static_cast<char>(0x80))));
  }
};

inline void store_4x4(const I4 (&rows)[4], bool is_pair, uint8_t* samples, ptrdiff_t stride) {
  const Samples all(_mm256_packs_epi32(rows[0].v, rows[1].v), _mm256_packs_epi32(rows[2].v, rows[3].v));
  for (int y = 0; y < 4; ++y) {
    __builtin_memcpy(samples + y * stride, all.bytes + 4 * y, 4);
    if (is_pair) __builtin_memcpy(samples + y * stride + 4, all.bytes + 16 + 4 * y, 4);
  }
}

inline void store_2x2(I4 x, bool is_pair, uint8_t* samples, ptrdiff_t stride) {
  const __m256i words = _mm256_packs_epi32(x.v, x.v);
  const Samples all(words, words);
  for (int y = 0; y < 2; ++y) {
    __builtin_memcpy(samples + y * stride, all.bytes + 2 * y, 2);
    if (is_pair) __builtin_memcpy(samples + y * stride + 2, all.bytes + 16 + 2 * y, 2);
  }
}

#include "base/kernels/reduced_idct_simd.inc"

}  // namespace

void fill_reduced_idct_avx2(BlockKernels& table) {
  table.idct_4x4 = idct_4x4;
  table.idct_2x2 = idct_2x2;
}

}  // namespace pac
