// Pixel rows, 16 at a time. A row's last pixels go through padded copies on the stack, so that nothing outside the row
// is touched and no second, scalar version of each formula is needed.
#include <smmintrin.h>

#include <cstddef>
#include <cstdint>

#include "base/kernels/pixel_kernels.h"

namespace pac {
namespace {

using Bytes = __m128i;
constexpr size_t kStep = 16;  // pixels

__m128i load(const uint8_t* p) {
  return _mm_loadu_si128(reinterpret_cast<const __m128i*>(p));
}
void store(uint8_t* p, __m128i v) {
  _mm_storeu_si128(reinterpret_cast<__m128i*>(p), v);
}
void copy(uint8_t* to, const uint8_t* from, size_t n) {
  __builtin_memcpy(to, from, n);
}

// Half the difference of either sign; one of the two is zero: 127 + max(h-l, 0) / 2 - max(l-h, 0) / 2.
__m128i difference(__m128i h, __m128i l) {
  const __m128i seven_bits = _mm_set1_epi8(0x7F);
  const __m128i up = _mm_and_si128(_mm_srli_epi16(_mm_subs_epu8(h, l), 1), seven_bits);
  const __m128i down = _mm_and_si128(_mm_srli_epi16(_mm_subs_epu8(l, h), 1), seven_bits);
  return _mm_sub_epi8(_mm_add_epi8(seven_bits, up), down);
}

// Added or subtracted twice with saturation: 2 * |d - 127| needs 9 bits.
__m128i composite(__m128i l, __m128i d) {
  const __m128i zero_difference = _mm_set1_epi8(127);
  const __m128i up = _mm_subs_epu8(d, zero_difference), down = _mm_subs_epu8(zero_difference, d);
  return _mm_subs_epu8(_mm_subs_epu8(_mm_adds_epu8(_mm_adds_epu8(l, up), up), down), down);
}

// Both factors of a pmaddwd: `low` for the even 16-bit lanes, `high` for the odd ones.
__m128i pair(int low, int high) {
  return _mm_set1_epi32(static_cast<int>(static_cast<uint32_t>(high) << 16 | (static_cast<uint32_t>(low) & 0xFFFF)));
}

// Four pixels in 32-bit lanes as 16-bit pairs, from 12 bytes that begin `offset` bytes into the vector.
struct PixelPairs {
  __m128i red_green, blue_green;
};
PixelPairs split(__m128i bytes, int offset) {
  const __m128i rg = _mm_setr_epi8(0, -1, 1, -1, 3, -1, 4, -1, 6, -1, 7, -1, 9, -1, 10, -1);
  const __m128i bg = _mm_setr_epi8(2, -1, 1, -1, 5, -1, 4, -1, 8, -1, 7, -1, 11, -1, 10, -1);
  // Added to the even bytes only (offset is 0 or 4: no carry); the odd ones stay -1 and give zero.
  const __m128i from = _mm_set1_epi16(static_cast<int16_t>(offset));
  return {_mm_shuffle_epi8(bytes, _mm_add_epi16(rg, from)), _mm_shuffle_epi8(bytes, _mm_add_epi16(bg, from))};
}

struct Ycc {
  __m128i y, cb, cr;  // 32-bit lanes, 0..255
};
// 38470 exceeds a signed 16-bit factor: 22086 of it goes with red, 16384 with blue. The factor 32768 is a shift by 15.
Ycc ycc_from_rgb(PixelPairs p) {
  const __m128i half = _mm_set1_epi32(1 << 15), center = _mm_set1_epi32((128 << 16) + (1 << 15) - 1);
  const __m128i y =
      _mm_add_epi32(_mm_madd_epi16(p.red_green, pair(19595, 22086)), _mm_madd_epi16(p.blue_green, pair(7471, 16384)));
  const __m128i blue_15 = _mm_srli_epi32(_mm_slli_epi32(p.blue_green, 16), 1);
  const __m128i red_15 = _mm_srli_epi32(_mm_slli_epi32(p.red_green, 16), 1);
  const __m128i cb = _mm_add_epi32(_mm_madd_epi16(p.red_green, pair(-11059, -21709)), _mm_add_epi32(blue_15, center));
  const __m128i cr = _mm_add_epi32(_mm_madd_epi16(p.blue_green, pair(-5329, -27439)), _mm_add_epi32(red_15, center));
  return {_mm_srli_epi32(_mm_add_epi32(y, half), 16), _mm_srli_epi32(cb, 16), _mm_srli_epi32(cr, 16)};
}

__m128i pack(__m128i a, __m128i b, __m128i c, __m128i d) {
  return _mm_packus_epi16(_mm_packs_epi32(a, b), _mm_packs_epi32(c, d));
}

// 48 bytes; the last load begins four bytes early instead of ending four late.
void ycc_from_rgb_step(const uint8_t* rgb, uint8_t* y, uint8_t* cb, uint8_t* cr) {
  const Ycc p0 = ycc_from_rgb(split(load(rgb), 0)), p1 = ycc_from_rgb(split(load(rgb + 12), 0));
  const Ycc p2 = ycc_from_rgb(split(load(rgb + 24), 0)), p3 = ycc_from_rgb(split(load(rgb + 32), 4));
  store(y, pack(p0.y, p1.y, p2.y, p3.y));
  store(cb, pack(p0.cb, p1.cb, p2.cb, p3.cb));
  store(cr, pack(p0.cr, p1.cr, p2.cr, p3.cr));
}

struct Rgb {
  __m128i r, g, b;  // 16-bit lanes, to be added to y
};
// pmulhrsw gives (x c + 2^14) >> 15, so c is half the fraction of 2^16. Blue's is even: 116130 = 131072 - 2 * 7471.
// Red's is odd, 91881 = 65536 + 26345, but 13175 rounds as 26345 / 2 does for all v in -128..127. Green's two are even.
Rgb offsets_from_chroma(__m128i u, __m128i v) {
  const __m128i half = _mm_set1_epi32(1 << 14);
  const __m128i red = _mm_add_epi16(v, _mm_mulhrs_epi16(v, _mm_set1_epi16(13175)));
  const __m128i blue = _mm_add_epi16(_mm_add_epi16(u, u), _mm_mulhrs_epi16(u, _mm_set1_epi16(-7471)));
  const __m128i low = _mm_madd_epi16(_mm_unpacklo_epi16(u, v), pair(-11277, -23401));
  const __m128i high = _mm_madd_epi16(_mm_unpackhi_epi16(u, v), pair(-11277, -23401));
  const __m128i green =
      _mm_packs_epi32(_mm_srai_epi32(_mm_add_epi32(low, half), 15), _mm_srai_epi32(_mm_add_epi32(high, half), 15));
  return {red, green, blue};
}

// Byte j of output vector k is channel (16k + j) % 3 of pixel (16k + j) / 3.
struct InterleaveMasks {
  alignas(16) int8_t mask[3][3][16];  // [vector][channel]
};
constexpr InterleaveMasks make_interleave_masks() {
  InterleaveMasks masks{};
  for (int k = 0; k < 3; ++k)
    for (int channel = 0; channel < 3; ++channel)
      for (int j = 0; j < 16; ++j)
        masks.mask[k][channel][j] = static_cast<int8_t>((16 * k + j) % 3 == channel ? (16 * k + j) / 3 : -1);
  return masks;
}
constexpr InterleaveMasks kInterleave = make_interleave_masks();

__m128i interleave(const int8_t (&masks)[3][16], __m128i r, __m128i g, __m128i b) {
  const auto pick = [](__m128i from, const int8_t* mask) {
    return _mm_shuffle_epi8(from, _mm_load_si128(reinterpret_cast<const __m128i*>(mask)));
  };
  return _mm_or_si128(_mm_or_si128(pick(r, masks[0]), pick(g, masks[1])), pick(b, masks[2]));
}

void rgb_from_ycc_step(const uint8_t* y, const uint8_t* cb, const uint8_t* cr, uint8_t* rgb) {
  const __m128i zero = _mm_setzero_si128(), center = _mm_set1_epi16(128);
  const __m128i luma = load(y), u = load(cb), v = load(cr);
  const Rgb low = offsets_from_chroma(_mm_sub_epi16(_mm_unpacklo_epi8(u, zero), center),
                                      _mm_sub_epi16(_mm_unpacklo_epi8(v, zero), center));
  const Rgb high = offsets_from_chroma(_mm_sub_epi16(_mm_unpackhi_epi8(u, zero), center),
                                       _mm_sub_epi16(_mm_unpackhi_epi8(v, zero), center));
  const __m128i luma_low = _mm_unpacklo_epi8(luma, zero), luma_high = _mm_unpackhi_epi8(luma, zero);
  const auto channel = [&](__m128i a, __m128i b) {
    return _mm_packus_epi16(_mm_add_epi16(luma_low, a), _mm_add_epi16(luma_high, b));
  };
  const __m128i r = channel(low.r, high.r), g = channel(low.g, high.g), b = channel(low.b, high.b);
  for (size_t k = 0; k < 3; ++k) store(rgb + 16 * k, interleave(kInterleave.mask[k], r, g, b));
}

__m128i sums_of_two(const uint8_t* p) {
  return _mm_maddubs_epi16(load(p), _mm_set1_epi8(1));
}

void downsample_h2v1_step(const uint8_t* in, uint8_t* out) {
  const __m128i bias = pair(0, 1);
  const auto half = [&](const uint8_t* p) { return _mm_srli_epi16(_mm_add_epi16(sums_of_two(p), bias), 1); };
  store(out, _mm_packus_epi16(half(in), half(in + 16)));
}

void downsample_h2v2_step(const uint8_t* a, const uint8_t* b, uint8_t* out) {
  const __m128i bias = pair(1, 2);
  const auto quarter = [&](const uint8_t* p, const uint8_t* q) {
    return _mm_srli_epi16(_mm_add_epi16(_mm_add_epi16(sums_of_two(p), sums_of_two(q)), bias), 2);
  };
  store(out, _mm_packus_epi16(quarter(a, b), quarter(a + 16, b + 16)));
}

// 3 a + b in 16-bit lanes, for the low and the high eight samples.
struct Weighted {
  __m128i low, high;
};
Weighted three_to_one(__m128i a, __m128i b) {
  const __m128i weights = _mm_set1_epi16(0x0103);
  return {_mm_maddubs_epi16(_mm_unpacklo_epi8(a, b), weights), _mm_maddubs_epi16(_mm_unpackhi_epi8(a, b), weights)};
}

// Even outputs in the low bytes, odd ones in the high bytes of each 16-bit lane: interleaved already.
void store_interleaved(uint8_t* out, __m128i even_low, __m128i even_high, __m128i odd_low, __m128i odd_high) {
  store(out, _mm_or_si128(even_low, _mm_slli_epi16(odd_low, 8)));
  store(out + 16, _mm_or_si128(even_high, _mm_slli_epi16(odd_high, 8)));
}

// Reads in[-1] .. in[16].
void upsample_h2v1_step(const uint8_t* in, uint8_t* out) {
  const __m128i here = load(in), one = _mm_set1_epi16(1), two = _mm_set1_epi16(2);
  const Weighted even = three_to_one(here, load(in - 1)), odd = three_to_one(here, load(in + 1));
  const auto quarter = [](__m128i sum, __m128i bias) { return _mm_srli_epi16(_mm_add_epi16(sum, bias), 2); };
  store_interleaved(out, quarter(even.low, one), quarter(even.high, one), quarter(odd.low, two),
                    quarter(odd.high, two));
}

void upsample_h2v2_step(const uint8_t* near, const uint8_t* far, uint8_t* out) {
  const Weighted here = three_to_one(load(near), load(far)), left = three_to_one(load(near - 1), load(far - 1)),
                 right = three_to_one(load(near + 1), load(far + 1));
  const auto sixteenth = [](__m128i nearer, __m128i farther, int bias) {
    const __m128i three = _mm_add_epi16(_mm_add_epi16(nearer, nearer), nearer);
    return _mm_srli_epi16(_mm_add_epi16(_mm_add_epi16(three, farther), _mm_set1_epi16(static_cast<int16_t>(bias))), 4);
  };
  store_interleaved(out, sixteenth(here.low, left.low, 8), sixteenth(here.high, left.high, 8),
                    sixteenth(here.low, right.low, 7), sixteenth(here.high, right.high, 7));
}

Bytes weighted_quarter(Bytes a, Bytes b, int bias) {
  const __m128i rounding = _mm_set1_epi16(static_cast<int16_t>(bias));
  const Weighted sum = three_to_one(a, b);
  return _mm_packus_epi16(_mm_srli_epi16(_mm_add_epi16(sum.low, rounding), 2),
                          _mm_srli_epi16(_mm_add_epi16(sum.high, rounding), 2));
}

#include "base/kernels/pixel_rows_simd.inc"
#include "base/kernels/rgb_ycc420_simd.inc"
#include "base/kernels/ycc420_simd.inc"

}  // namespace

void fill_pixel_sse41(PixelKernels& table) {
  table.difference_row = difference_row;
  table.composite_row = composite_row;
  table.ycc_from_rgb_row = ycc_from_rgb_row;
  table.ycc420_from_rgb_rows = ycc420_from_rgb_rows;
  table.rgb_from_ycc_row = rgb_from_ycc_row;
  table.downsample_h2v1_row = downsample_h2v1_row;
  table.downsample_h2v2_row = downsample_h2v2_row;
  table.upsample_h2v1_row = upsample_h2v1_row;
  table.upsample_h2v2_row = upsample_h2v2_row;
  table.upsample_h1v2_row = upsample_h1v2_row;
  table.rgb_from_ycc420_row = rgb_from_ycc420_row;
}

}  // namespace pac
