// One block at a time.
#include <smmintrin.h>

#include <cstddef>
#include <cstdint>

#include "base/kernels/block_kernels.h"

namespace pac {
namespace {

constexpr size_t kBlocks = 1;

struct I4 {
  __m128i v;
};
struct Halves {
  I4 low, high;
};

inline I4 operator+(I4 a, I4 b) {
  return {_mm_add_epi32(a.v, b.v)};
}
inline I4 operator-(I4 a, I4 b) {
  return {_mm_sub_epi32(a.v, b.v)};
}
inline I4 times(I4 a, I4 b) {
  return {_mm_mullo_epi32(a.v, b.v)};
}
inline I4 times(I4 a, int32_t n) {
  return {_mm_mullo_epi32(a.v, _mm_set1_epi32(n))};
}
inline I4 alternating(int32_t a, int32_t b) {
  return {_mm_setr_epi32(a, b, a, b)};
}
template <int kBits>
inline I4 shift_left(I4 a) {
  return {_mm_slli_epi32(a.v, kBits)};
}
template <int kBits>
inline I4 round_shift(I4 a) {
  return {_mm_srai_epi32(_mm_add_epi32(a.v, _mm_set1_epi32(1 << (kBits - 1))), kBits)};
}
inline I4 swap_pairs(I4 a) {
  return {_mm_shuffle_epi32(a.v, 0xB1)};
}
inline I4 even_twice(I4 a) {
  return {_mm_shuffle_epi32(a.v, 0xA0)};
}

inline __m128i load(const void* p) {
  return _mm_loadu_si128(static_cast<const __m128i*>(p));
}

inline Halves dequantized(const int16_t* levels, const uint16_t* steps, int row, bool) {
  const __m128i product = _mm_mullo_epi16(load(levels + 8 * row), load(steps + 8 * row));
  return {{_mm_srai_epi32(_mm_unpacklo_epi16(product, product), 16)},
          {_mm_srai_epi32(_mm_unpackhi_epi16(product, product), 16)}};
}

inline void transpose(I4 (&x)[4]) {
  const __m128i a0 = _mm_unpacklo_epi32(x[0].v, x[1].v), a1 = _mm_unpackhi_epi32(x[0].v, x[1].v);
  const __m128i a2 = _mm_unpacklo_epi32(x[2].v, x[3].v), a3 = _mm_unpackhi_epi32(x[2].v, x[3].v);
  x[0].v = _mm_unpacklo_epi64(a0, a2);
  x[1].v = _mm_unpackhi_epi64(a0, a2);
  x[2].v = _mm_unpacklo_epi64(a1, a3);
  x[3].v = _mm_unpackhi_epi64(a1, a3);
}

// Clamps to a signed byte and adds 128.
inline __m128i to_samples(__m128i low, __m128i high) {
  return _mm_xor_si128(_mm_packs_epi16(low, high), _mm_set1_epi8(static_cast<char>(0x80)));
}

inline void store_4x4(const I4 (&rows)[4], bool, uint8_t* samples, ptrdiff_t stride) {
  alignas(16) uint8_t bytes[16];
  _mm_store_si128(reinterpret_cast<__m128i*>(bytes),
                  to_samples(_mm_packs_epi32(rows[0].v, rows[1].v), _mm_packs_epi32(rows[2].v, rows[3].v)));
  for (int y = 0; y < 4; ++y) __builtin_memcpy(samples + y * stride, bytes + 4 * y, 4);
}

inline void store_2x2(I4 x, bool, uint8_t* samples, ptrdiff_t stride) {
  const __m128i words = _mm_packs_epi32(x.v, x.v);
  const int bytes = _mm_cvtsi128_si32(to_samples(words, words));
  __builtin_memcpy(samples, &bytes, 2);
  __builtin_memcpy(samples + stride, reinterpret_cast<const char*>(&bytes) + 2, 2);
}

#include "base/kernels/reduced_idct_simd.inc"

}  // namespace

void fill_reduced_idct_sse41(BlockKernels& table) {
  table.idct_4x4 = idct_4x4;
  table.idct_2x2 = idct_2x2;
}

}  // namespace pac
