// Rows of sums, sixteen pixels at a time.
#include <immintrin.h>

#include <cstddef>
#include <cstdint>

#include "base/kernels/warp_kernels.h"

namespace pac {
namespace {

#include "base/kernels/warp_avx2_memory_simd.inc"

// Of samples with bits below the point, rounded.
inline __m256i whole(__m256i carried) {
  return _mm256_srai_epi16(_mm256_add_epi16(carried, _mm256_set1_epi16(1 << (kCarriedBits - 1))), kCarriedBits);
}

void add_carried_row(const uint8_t* base, const int16_t* carried, size_t n, uint8_t* out) {
  const auto sixteen = [](const uint8_t* from, const int16_t* added) {
    const __m256i wide = _mm256_cvtepu8_epi16(_mm_loadu_si128(reinterpret_cast<const __m128i*>(from)));
    const __m256i sum = _mm256_add_epi16(wide, whole(load_16(added)));
    return _mm_packus_epi16(_mm256_castsi256_si128(sum), _mm256_extracti128_si256(sum, 1));
  };
  size_t i = 0;
  for (; i + 16 <= n; i += 16) {
    prefetch(base, static_cast<ptrdiff_t>(i + n));  // the next row
    prefetch(out, static_cast<ptrdiff_t>(i + n));
    _mm_storeu_si128(reinterpret_cast<__m128i*>(out + i), sixteen(base + i, carried + i));
  }
  if (i == n) return;
  uint8_t last_base[16] = {}, last_out[16];
  int16_t last_carried[16] = {};
  __builtin_memcpy(last_base, base + i, n - i);
  __builtin_memcpy(last_carried, carried + i, (n - i) * sizeof(int16_t));
  _mm_storeu_si128(reinterpret_cast<__m128i*>(last_out), sixteen(last_base, last_carried));
  __builtin_memcpy(out + i, last_out, n - i);
}

// Sixteen samples of a row of chroma between two, with two bits below the point.
inline __m256i upsampled_column(const int16_t* near, const int16_t* far) {
  const __m256i half = _mm256_set1_epi16(4);
  const __m256i a = _mm256_srai_epi16(_mm256_add_epi16(load_16(near), half), 3);
  const __m256i b = _mm256_srai_epi16(_mm256_add_epi16(load_16(far), half), 3);
  return _mm256_add_epi16(_mm256_add_epi16(a, b), _mm256_add_epi16(a, a));
}

void upsample_carried_row(const int16_t* near, const int16_t* far, size_t n, int16_t* out) {
  // Of the column before the first, the last lane counts.
  __m256i before = _mm256_broadcastw_epi16(_mm256_castsi256_si128(upsampled_column(near - 1, far - 1)));
  __m256i here = upsampled_column(near, far);
  for (size_t i = 0; i < n; i += 16) {
    const __m256i after = upsampled_column(near + i + 16, far + i + 16);
    const __m256i left = _mm256_alignr_epi8(here, _mm256_permute2x128_si256(before, here, 0x21), 14);
    const __m256i right = _mm256_alignr_epi8(_mm256_permute2x128_si256(here, after, 0x21), here, 2);
    const __m256i nearer =
        _mm256_add_epi16(_mm256_add_epi16(here, here), _mm256_add_epi16(here, _mm256_set1_epi16(32)));
    const __m256i even = _mm256_srai_epi16(_mm256_add_epi16(nearer, left), 6);
    const __m256i odd = _mm256_srai_epi16(_mm256_add_epi16(nearer, right), 6);
    const __m256i low = _mm256_unpacklo_epi16(even, odd), high = _mm256_unpackhi_epi16(even, odd);
    const __m256i upper = _mm256_permute2x128_si256(low, high, 0x20),
                  lower = _mm256_permute2x128_si256(low, high, 0x31);
    before = here;
    here = after;
    if (i + 16 <= n) {
      store(out + 2 * i, upper);
      store(out + 2 * i + 16, lower);
      continue;
    }
    int16_t last[32];
    store(last, upper);
    store(last + 16, lower);
    __builtin_memcpy(out + 2 * i, last, 2 * (n - i) * sizeof(int16_t));
  }
}

// (a x + b y + 32768) >> 16 of 16-bit lanes, a and b within 16 bits.
inline __m256i rounded_sum(__m256i x, int a, __m256i y, int b) {
  const __m256i factors =
      _mm256_set1_epi32(static_cast<int>(static_cast<uint32_t>(b) << 16 | (static_cast<uint32_t>(a) & 0xFFFF)));
  const __m256i half = _mm256_set1_epi32(1 << 15);
  const __m256i low = _mm256_add_epi32(_mm256_madd_epi16(_mm256_unpacklo_epi16(x, y), factors), half);
  const __m256i high = _mm256_add_epi32(_mm256_madd_epi16(_mm256_unpackhi_epi16(x, y), factors), half);
  return _mm256_packs_epi32(_mm256_srai_epi32(low, 16), _mm256_srai_epi32(high, 16));
}

// The same shuffle in both halves.
inline __m256i shuffled(__m256i v, __m128i by) {
  return _mm256_shuffle_epi8(v, _mm256_broadcastsi128_si256(by));
}

inline __m256i two_halves(__m128i low, __m128i high) {
  return _mm256_inserti128_si256(_mm256_castsi128_si256(low), high, 1);
}

// Sixteen pixels, 48 bytes: eight of them, 24 bytes, in each half. 91881 = 65536 + 26345, 116130 = 131072 - 14942 and
// -46802 = -65536 + 18734: whole numbers of v and u stay outside of the products.
inline void composite_sixteen(const uint8_t* low, const int16_t* carried, const int16_t* chroma_u,
                              const int16_t* chroma_v, uint8_t* rgb) {
  const auto sixteen_at = [&](size_t i) { return _mm_loadu_si128(reinterpret_cast<const __m128i*>(low + i)); };
  const auto eight_at = [&](size_t i) { return _mm_loadl_epi64(reinterpret_cast<const __m128i*>(low + i)); };
  const __m256i first = two_halves(sixteen_at(0), sixteen_at(24)), last = two_halves(eight_at(16), eight_at(40));
  const auto channel = [&](__m128i from_first, __m128i from_last, __m256i added) {
    const __m256i bytes = _mm256_or_si256(shuffled(first, from_first), shuffled(last, from_last));
    const __m256i sum = _mm256_add_epi16(bytes, added);
    return _mm256_packus_epi16(sum, sum);
  };
  const __m256i d = whole(load_16(carried)), u = load_16(chroma_u), v = load_16(chroma_v);
  const __m256i red = _mm256_add_epi16(_mm256_add_epi16(d, v), rounded_sum(v, 26345, u, 0));
  const __m256i green = _mm256_add_epi16(_mm256_sub_epi16(d, v), rounded_sum(u, -22554, v, 18734));
  const __m256i blue = _mm256_add_epi16(_mm256_add_epi16(d, _mm256_add_epi16(u, u)), rounded_sum(u, -14942, v, 0));
  const __m256i r = channel(_mm_setr_epi8(0, -1, 3, -1, 6, -1, 9, -1, 12, -1, 15, -1, -1, -1, -1, -1),
                            _mm_setr_epi8(-1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, 2, -1, 5, -1), red);
  const __m256i g = channel(_mm_setr_epi8(1, -1, 4, -1, 7, -1, 10, -1, 13, -1, -1, -1, -1, -1, -1, -1),
                            _mm_setr_epi8(-1, -1, -1, -1, -1, -1, -1, -1, -1, -1, 0, -1, 3, -1, 6, -1), green);
  const __m256i b = channel(_mm_setr_epi8(2, -1, 5, -1, 8, -1, 11, -1, 14, -1, -1, -1, -1, -1, -1, -1),
                            _mm_setr_epi8(-1, -1, -1, -1, -1, -1, -1, -1, -1, -1, 1, -1, 4, -1, 7, -1), blue);
  const __m256i rg = _mm256_unpacklo_epi8(r, g);
  const auto place = [&](__m128i from_rg, __m128i from_b) {
    return _mm256_or_si256(shuffled(rg, from_rg), shuffled(b, from_b));
  };
  const __m256i begin = place(_mm_setr_epi8(0, 1, -1, 2, 3, -1, 4, 5, -1, 6, 7, -1, 8, 9, -1, 10),
                              _mm_setr_epi8(-1, -1, 0, -1, -1, 1, -1, -1, 2, -1, -1, 3, -1, -1, 4, -1));
  const __m256i end = place(_mm_setr_epi8(11, -1, 12, 13, -1, 14, 15, -1, -1, -1, -1, -1, -1, -1, -1, -1),
                            _mm_setr_epi8(-1, 5, -1, -1, 6, -1, -1, 7, -1, -1, -1, -1, -1, -1, -1, -1));
  const auto at = [&](size_t i) { return reinterpret_cast<__m128i*>(rgb + i); };
  _mm_storeu_si128(at(0), _mm256_castsi256_si128(begin));
  _mm_storel_epi64(at(16), _mm256_castsi256_si128(end));
  _mm_storeu_si128(at(24), _mm256_extracti128_si256(begin, 1));
  _mm_storel_epi64(at(40), _mm256_extracti128_si256(end, 1));
}

void composite_signed_row(const uint8_t* low, const int16_t* carried, const int16_t* u, const int16_t* v, size_t n,
                          uint8_t* rgb) {
  size_t i = 0;
  for (; i + 16 <= n; i += 16) composite_sixteen(low + 3 * i, carried + i, u + i, v + i, rgb + 3 * i);
  if (i == n) return;
  uint8_t last_low[48] = {}, last_rgb[48];
  int16_t last[3][16] = {};
  __builtin_memcpy(last_low, low + 3 * i, 3 * (n - i));
  __builtin_memcpy(last[0], carried + i, (n - i) * sizeof(int16_t));
  __builtin_memcpy(last[1], u + i, (n - i) * sizeof(int16_t));
  __builtin_memcpy(last[2], v + i, (n - i) * sizeof(int16_t));
  composite_sixteen(last_low, last[0], last[1], last[2], last_rgb);
  __builtin_memcpy(rgb + 3 * i, last_rgb, 3 * (n - i));
}

}  // namespace

void fill_warp_rows_avx2(WarpKernels& table) {
  table.add_carried_row = add_carried_row;
  table.upsample_carried_row = upsample_carried_row;
  table.composite_signed_row = composite_signed_row;
}

}  // namespace pac
