// Pixel rows, 32 at a time; the formulas and the padded copies at a row's end are those of pixel_sse41.cpp. Unpacking
// and packing stay inside 128-bit halves: a pair of them keeps the order, and what does not is put right by a
// permutation.
#include <immintrin.h>

#include <cstddef>
#include <cstdint>

#include "base/kernels/pixel_kernels.h"

namespace pac {
namespace {

using Bytes = __m256i;
constexpr size_t kStep = 32;  // pixels

__m256i load(const uint8_t* p) {
  return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(p));
}
void store(uint8_t* p, __m256i v) {
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(p), v);
}
__m128i load_16(const uint8_t* p) {
  return _mm_loadu_si128(reinterpret_cast<const __m128i*>(p));
}
__m256i load_halves(const uint8_t* low, const uint8_t* high) {
  return _mm256_inserti128_si256(_mm256_castsi128_si256(load_16(low)), load_16(high), 1);
}
__m256i twice(__m128i v) {
  return _mm256_broadcastsi128_si256(v);
}
void copy(uint8_t* to, const uint8_t* from, size_t n) {
  __builtin_memcpy(to, from, n);
}

// Half the difference of either sign; one of the two is zero: 127 + max(h-l, 0) / 2 - max(l-h, 0) / 2.
__m256i difference(__m256i h, __m256i l) {
  const __m256i seven_bits = _mm256_set1_epi8(0x7F);
  const __m256i up = _mm256_and_si256(_mm256_srli_epi16(_mm256_subs_epu8(h, l), 1), seven_bits);
  const __m256i down = _mm256_and_si256(_mm256_srli_epi16(_mm256_subs_epu8(l, h), 1), seven_bits);
  return _mm256_sub_epi8(_mm256_add_epi8(seven_bits, up), down);
}

// Added or subtracted twice with saturation: 2 * |d - 127| needs 9 bits.
__m256i composite(__m256i l, __m256i d) {
  const __m256i zero_difference = _mm256_set1_epi8(127);
  const __m256i up = _mm256_subs_epu8(d, zero_difference), down = _mm256_subs_epu8(zero_difference, d);
  return _mm256_subs_epu8(_mm256_subs_epu8(_mm256_adds_epu8(_mm256_adds_epu8(l, up), up), down), down);
}

// Both factors of a pmaddwd: `low` for the even 16-bit lanes, `high` for the odd ones.
__m256i pair(int low, int high) {
  return _mm256_set1_epi32(static_cast<int>(static_cast<uint32_t>(high) << 16 | (static_cast<uint32_t>(low) & 0xFFFF)));
}

// Four pixels in 32-bit lanes as 16-bit pairs, from 12 bytes that begin `offset` bytes into the vector.
struct PixelPairs {
  __m256i red_green, blue_green;
};
PixelPairs split(__m256i bytes, int offset) {
  const __m256i rg = twice(_mm_setr_epi8(0, -1, 1, -1, 3, -1, 4, -1, 6, -1, 7, -1, 9, -1, 10, -1));
  const __m256i bg = twice(_mm_setr_epi8(2, -1, 1, -1, 5, -1, 4, -1, 8, -1, 7, -1, 11, -1, 10, -1));
  // Added to the even bytes only (offset is 0 or 4: no carry); the odd ones stay -1 and give zero.
  const __m256i from = _mm256_set1_epi16(static_cast<int16_t>(offset));
  return {_mm256_shuffle_epi8(bytes, _mm256_add_epi16(rg, from)),
          _mm256_shuffle_epi8(bytes, _mm256_add_epi16(bg, from))};
}

// 32-bit lanes of which the upper 16 bits are Y, Cb, Cr, 0..255.
struct Ycc {
  __m256i y, cb, cr;
};
// 38470 exceeds a signed 16-bit factor: 22086 of it goes with red, 16384 with blue. So does 32768, but its negative
// fits: cb and cr are subtracted from the center with all signs turned.
Ycc ycc_from_rgb(PixelPairs p) {
  const __m256i half = _mm256_set1_epi32(1 << 15), center = _mm256_set1_epi32((128 << 16) + (1 << 15) - 1);
  const __m256i y = _mm256_add_epi32(_mm256_madd_epi16(p.red_green, pair(19595, 22086)),
                                     _mm256_madd_epi16(p.blue_green, pair(7471, 16384)));
  const __m256i cb = _mm256_add_epi32(_mm256_madd_epi16(p.red_green, pair(11059, 21709)),
                                      _mm256_madd_epi16(p.blue_green, pair(-32768, 0)));
  const __m256i cr = _mm256_add_epi32(_mm256_madd_epi16(p.red_green, pair(-32768, 27439)),
                                      _mm256_madd_epi16(p.blue_green, pair(5329, 0)));
  return {_mm256_add_epi32(y, half), _mm256_sub_epi32(center, cb), _mm256_sub_epi32(center, cr)};
}

// The upper halves of the lanes of four vectors as bytes.
__m256i pack(__m256i a, __m256i b, __m256i c, __m256i d) {
  const auto upper = [](__m256i v) { return _mm256_srli_epi32(v, 16); };
  return _mm256_packus_epi16(_mm256_packs_epi32(upper(a), upper(b)), _mm256_packs_epi32(upper(c), upper(d)));
}

// Four pixels of each half, `at` bytes into its 48; the last load begins four bytes early instead of ending four late.
Ycc convert(const uint8_t* rgb, int i) {
  constexpr int kAt[4] = {0, 12, 24, 32};
  return ycc_from_rgb(split(load_halves(rgb + kAt[i], rgb + 48 + kAt[i]), i == 3 ? 4 : 0));
}

// 96 bytes; the low half does pixels 0..15, the high half 16..31.
void ycc_from_rgb_step(const uint8_t* rgb, uint8_t* y, uint8_t* cb, uint8_t* cr) {
  const Ycc p0 = convert(rgb, 0), p1 = convert(rgb, 1), p2 = convert(rgb, 2), p3 = convert(rgb, 3);
  store(y, pack(p0.y, p1.y, p2.y, p3.y));
  store(cb, pack(p0.cb, p1.cb, p2.cb, p3.cb));
  store(cr, pack(p0.cr, p1.cr, p2.cr, p3.cr));
}

// Cb in the even and Cr in the odd 16-bit lanes: four pixels of each half.
__m256i chroma_of(const Ycc& p) {
  return _mm256_blend_epi16(_mm256_srli_epi32(p.cb, 16), p.cr, 0xAA);
}

// Of two rows' sums of eight pixels, chroma_of() added: averages of four samples each.
__m256i quarter_of_pairs(__m256i first, __m256i second) {
  const __m256 a = _mm256_castsi256_ps(first), b = _mm256_castsi256_ps(second);
  const __m256i even = _mm256_castps_si256(_mm256_shuffle_ps(a, b, 0x88));
  const __m256i odd = _mm256_castps_si256(_mm256_shuffle_ps(a, b, 0xDD));
  const __m256i bias = _mm256_set1_epi64x(0x0002000200010001);
  return _mm256_srli_epi16(_mm256_add_epi16(_mm256_add_epi16(even, odd), bias), 2);
}

// 32 pixels of each row.
void ycc420_from_rgb_step(const uint8_t* upper_rgb, const uint8_t* lower_rgb, uint8_t* upper_y, uint8_t* lower_y,
                          uint8_t* cb, uint8_t* cr) {
  __m256i upper[4], lower[4], sums[4];
  for (int i = 0; i < 4; ++i) {
    const Ycc a = convert(upper_rgb, i), b = convert(lower_rgb, i);
    upper[i] = a.y;
    lower[i] = b.y;
    sums[i] = _mm256_add_epi16(chroma_of(a), chroma_of(b));
  }
  store(upper_y, pack(upper[0], upper[1], upper[2], upper[3]));
  store(lower_y, pack(lower[0], lower[1], lower[2], lower[3]));
  const __m256i mixed = _mm256_packus_epi16(quarter_of_pairs(sums[0], sums[1]), quarter_of_pairs(sums[2], sums[3]));
  const __m256i apart = _mm256_shuffle_epi8(mixed, twice(_mm_setr_epi8(0, 2, 4, 6, 8, 10, 12, 14,  //
                                                                       1, 3, 5, 7, 9, 11, 13, 15)));
  const __m256i both = _mm256_permute4x64_epi64(apart, 0xD8);
  _mm_storeu_si128(reinterpret_cast<__m128i*>(cb), _mm256_castsi256_si128(both));
  _mm_storeu_si128(reinterpret_cast<__m128i*>(cr), _mm256_extracti128_si256(both, 1));
}

void ycc420_from_rgb_rows(const uint8_t* upper_rgb, const uint8_t* lower_rgb, size_t n, uint8_t* upper_y,
                          uint8_t* lower_y, uint8_t* cb, uint8_t* cr) {
  size_t i = 0;
  for (; i + kStep <= n; i += kStep)
    ycc420_from_rgb_step(upper_rgb + 3 * i, lower_rgb + 3 * i, upper_y + i, lower_y + i, cb + i / 2, cr + i / 2);
  if (i == n) return;
  const size_t count = n - i;
  uint8_t rgb[2][3 * kStep] = {}, y[2][kStep], chroma[2][kStep / 2];
  copy(rgb[0], upper_rgb + 3 * i, 3 * count);
  copy(rgb[1], lower_rgb + 3 * i, 3 * count);
  ycc420_from_rgb_step(rgb[0], rgb[1], y[0], y[1], chroma[0], chroma[1]);
  copy(upper_y + i, y[0], count);
  copy(lower_y + i, y[1], count);
  copy(cb + i / 2, chroma[0], count / 2);
  copy(cr + i / 2, chroma[1], count / 2);
}

struct Rgb {
  __m256i r, g, b;  // 16-bit lanes, to be added to y
};
// pmulhrsw gives (x c + 2^14) >> 15, so c is half the fraction of 2^16. Blue's is even: 116130 = 131072 - 2 * 7471.
// Red's is odd, 91881 = 65536 + 26345, but 13175 rounds as 26345 / 2 does for all v in -128..127. Green's two are even.
Rgb offsets_from_chroma(__m256i u, __m256i v) {
  const __m256i half = _mm256_set1_epi32(1 << 14);
  const __m256i red = _mm256_add_epi16(v, _mm256_mulhrs_epi16(v, _mm256_set1_epi16(13175)));
  const __m256i blue = _mm256_add_epi16(_mm256_add_epi16(u, u), _mm256_mulhrs_epi16(u, _mm256_set1_epi16(-7471)));
  const __m256i low = _mm256_madd_epi16(_mm256_unpacklo_epi16(u, v), pair(-11277, -23401));
  const __m256i high = _mm256_madd_epi16(_mm256_unpackhi_epi16(u, v), pair(-11277, -23401));
  const __m256i green = _mm256_packs_epi32(_mm256_srai_epi32(_mm256_add_epi32(low, half), 15),
                                           _mm256_srai_epi32(_mm256_add_epi32(high, half), 15));
  return {red, green, blue};
}

// Of 48 interleaved bytes, in vectors k = 0, 1, 2, byte t of vector k belongs to channel (k + t) % 3: each byte
// position of a channel serves one vector only. So one shuffle brings a channel's samples to their places in all three,
// and blends pick what each vector wants.
struct InterleaveMasks {
  alignas(16) int8_t place[3][16];  // [channel]
  alignas(16) int8_t second[16];    // positions that come from the next channel
  alignas(16) int8_t third[16];     // and from the one after it
};
// even_first: the pixels come as the eight even ones, then the odd ones.
constexpr InterleaveMasks make_interleave_masks(bool even_first) {
  InterleaveMasks masks{};
  for (int t = 0; t < 16; ++t) {
    for (int channel = 0; channel < 3; ++channel) {
      const int k = (channel + 18 - t) % 3, pixel = (16 * k + t) / 3;
      masks.place[channel][t] = static_cast<int8_t>(even_first ? pixel / 2 + pixel % 2 * 8 : pixel);
    }
    masks.second[t] = static_cast<int8_t>(t % 3 == 1 ? -1 : 0);
    masks.third[t] = static_cast<int8_t>(t % 3 == 2 ? -1 : 0);
  }
  return masks;
}
constexpr InterleaveMasks kInterleave = make_interleave_masks(false);
constexpr InterleaveMasks kInterleaveEvenFirst = make_interleave_masks(true);

__m256i mask_of(const int8_t (&bytes)[16]) {
  return twice(_mm_load_si128(reinterpret_cast<const __m128i*>(bytes)));
}
void store_halves(uint8_t* low, uint8_t* high, __m256i v) {
  _mm_storeu_si128(reinterpret_cast<__m128i*>(low), _mm256_castsi256_si128(v));
  _mm_storeu_si128(reinterpret_cast<__m128i*>(high), _mm256_extracti128_si256(v, 1));
}

// 16 pixels of the low halves to low_rgb, 16 of the high halves to high_rgb.
void store_rgb(const InterleaveMasks& masks, __m256i r, __m256i g, __m256i b, uint8_t* low_rgb, uint8_t* high_rgb) {
  const __m256i red = _mm256_shuffle_epi8(r, mask_of(masks.place[0]));
  const __m256i green = _mm256_shuffle_epi8(g, mask_of(masks.place[1]));
  const __m256i blue = _mm256_shuffle_epi8(b, mask_of(masks.place[2]));
  const __m256i second = mask_of(masks.second), third = mask_of(masks.third);
  const auto blend = [&](__m256i x, __m256i y, __m256i z) {
    return _mm256_blendv_epi8(_mm256_blendv_epi8(x, y, second), z, third);
  };
  store_halves(low_rgb, high_rgb, blend(red, green, blue));
  store_halves(low_rgb + 16, high_rgb + 16, blend(green, blue, red));
  store_halves(low_rgb + 32, high_rgb + 32, blend(blue, red, green));
}

void rgb_from_ycc_step(const uint8_t* y, const uint8_t* cb, const uint8_t* cr, uint8_t* rgb) {
  const __m256i zero = _mm256_setzero_si256(), center = _mm256_set1_epi16(128);
  const __m256i luma = load(y), u = load(cb), v = load(cr);
  const Rgb low = offsets_from_chroma(_mm256_sub_epi16(_mm256_unpacklo_epi8(u, zero), center),
                                      _mm256_sub_epi16(_mm256_unpacklo_epi8(v, zero), center));
  const Rgb high = offsets_from_chroma(_mm256_sub_epi16(_mm256_unpackhi_epi8(u, zero), center),
                                       _mm256_sub_epi16(_mm256_unpackhi_epi8(v, zero), center));
  const __m256i luma_low = _mm256_unpacklo_epi8(luma, zero), luma_high = _mm256_unpackhi_epi8(luma, zero);
  const auto channel = [&](__m256i a, __m256i b) {
    return _mm256_packus_epi16(_mm256_add_epi16(luma_low, a), _mm256_add_epi16(luma_high, b));
  };
  const __m256i r = channel(low.r, high.r), g = channel(low.g, high.g), b = channel(low.b, high.b);
  store_rgb(kInterleave, r, g, b, rgb, rgb + 48);
}

// packus works in halves: (a0 b0 | a1 b1) becomes (a0 a1 | b0 b1).
__m256i pack_in_order(__m256i a, __m256i b) {
  return _mm256_permute4x64_epi64(_mm256_packus_epi16(a, b), 0xD8);
}

__m256i sums_of_two(const uint8_t* p) {
  return _mm256_maddubs_epi16(load(p), _mm256_set1_epi8(1));
}

void downsample_h2v1_step(const uint8_t* in, uint8_t* out) {
  const __m256i bias = pair(0, 1);
  const auto half = [&](const uint8_t* p) { return _mm256_srli_epi16(_mm256_add_epi16(sums_of_two(p), bias), 1); };
  store(out, pack_in_order(half(in), half(in + 32)));
}

void downsample_h2v2_step(const uint8_t* a, const uint8_t* b, uint8_t* out) {
  const __m256i bias = pair(1, 2);
  const auto quarter = [&](const uint8_t* p, const uint8_t* q) {
    return _mm256_srli_epi16(_mm256_add_epi16(_mm256_add_epi16(sums_of_two(p), sums_of_two(q)), bias), 2);
  };
  store(out, pack_in_order(quarter(a, b), quarter(a + 32, b + 32)));
}

// 3 a + b in 16-bit lanes, for the low and the high eight samples of each half.
struct Weighted {
  __m256i low, high;
};
Weighted three_to_one(__m256i a, __m256i b) {
  const __m256i weights = _mm256_set1_epi16(0x0103);
  return {_mm256_maddubs_epi16(_mm256_unpacklo_epi8(a, b), weights),
          _mm256_maddubs_epi16(_mm256_unpackhi_epi8(a, b), weights)};
}

// Even outputs in the low bytes, odd ones in the high bytes of each 16-bit lane: interleaved already.
void store_interleaved(uint8_t* out, __m256i even_low, __m256i even_high, __m256i odd_low, __m256i odd_high) {
  const __m256i low = _mm256_or_si256(even_low, _mm256_slli_epi16(odd_low, 8));
  const __m256i high = _mm256_or_si256(even_high, _mm256_slli_epi16(odd_high, 8));
  store(out, _mm256_permute2x128_si256(low, high, 0x20));
  store(out + 32, _mm256_permute2x128_si256(low, high, 0x31));
}

// Reads in[-1] .. in[32].
void upsample_h2v1_step(const uint8_t* in, uint8_t* out) {
  const __m256i here = load(in), one = _mm256_set1_epi16(1), two = _mm256_set1_epi16(2);
  const Weighted even = three_to_one(here, load(in - 1)), odd = three_to_one(here, load(in + 1));
  const auto quarter = [](__m256i sum, __m256i bias) { return _mm256_srli_epi16(_mm256_add_epi16(sum, bias), 2); };
  store_interleaved(out, quarter(even.low, one), quarter(even.high, one), quarter(odd.low, two),
                    quarter(odd.high, two));
}

void upsample_h2v2_step(const uint8_t* near, const uint8_t* far, uint8_t* out) {
  const Weighted here = three_to_one(load(near), load(far)), left = three_to_one(load(near - 1), load(far - 1)),
                 right = three_to_one(load(near + 1), load(far + 1));
  const auto sixteenth = [](__m256i nearer, __m256i farther, int bias) {
    const __m256i three = _mm256_add_epi16(_mm256_add_epi16(nearer, nearer), nearer);
    return _mm256_srli_epi16(
        _mm256_add_epi16(_mm256_add_epi16(three, farther), _mm256_set1_epi16(static_cast<int16_t>(bias))), 4);
  };
  store_interleaved(out, sixteenth(here.low, left.low, 8), sixteenth(here.high, left.high, 8),
                    sixteenth(here.low, right.low, 7), sixteenth(here.high, right.high, 7));
}

Bytes weighted_quarter(Bytes a, Bytes b, int bias) {
  const __m256i rounding = _mm256_set1_epi16(static_cast<int16_t>(bias));
  const Weighted sum = three_to_one(a, b);
  return _mm256_packus_epi16(_mm256_srli_epi16(_mm256_add_epi16(sum.low, rounding), 2),
                             _mm256_srli_epi16(_mm256_add_epi16(sum.high, rounding), 2));
}

#include "base/kernels/pixel_rows_simd.inc"

// Upsampled samples less 128 in 16-bit lanes: those at twice the place of the sample, and those behind them.
struct EvenOdd {
  __m256i even, odd;
};
// Of 32 samples; `low` is of the low eight in each half.
struct Upsampled {
  EvenOdd low, high;
};
// 32 samples, those before each of them, those behind: at a row's ends, its first and last one again.
struct Neighbors {
  __m256i here, before, behind;
  Neighbors(const uint8_t* row, bool is_first, bool is_last) : here(load(row)) {
    before = is_first ? _mm256_alignr_epi8(here, _mm256_permute2x128_si256(here, repeated(row[0]), 0x02), 15)
                      : load(row - 1);
    behind =
        is_last ? _mm256_alignr_epi8(_mm256_permute2x128_si256(here, repeated(row[31]), 0x21), here, 1) : load(row + 1);
  }
  static __m256i repeated(uint8_t sample) { return _mm256_set1_epi8(static_cast<char>(sample)); }
};
Upsampled centered_h2v2(const Neighbors& near, const Neighbors& far) {
  const Weighted left = three_to_one(near.before, far.before), right = three_to_one(near.behind, far.behind);
  const auto sixteenth = [](__m256i pairs, __m256i before, __m256i behind) {
    // 3 (3 near + far), rounded for the even outputs: (sum + 8) >> 4 less 128 is (sum + 8 - 2048) >> 4.
    const __m256i here =
        _mm256_add_epi16(_mm256_maddubs_epi16(pairs, _mm256_set1_epi16(0x0309)), _mm256_set1_epi16(8 - 2048));
    const __m256i odd = _mm256_add_epi16(_mm256_add_epi16(here, behind), _mm256_set1_epi16(-1));
    return EvenOdd{_mm256_srai_epi16(_mm256_add_epi16(here, before), 4), _mm256_srai_epi16(odd, 4)};
  };
  return {sixteenth(_mm256_unpacklo_epi8(near.here, far.here), left.low, right.low),
          sixteenth(_mm256_unpackhi_epi8(near.here, far.here), left.high, right.high)};
}

// Pixels of eight samples of each half.
void rgb_from_upsampled(__m256i luma, const EvenOdd& u, const EvenOdd& v, uint8_t* low_rgb, uint8_t* high_rgb) {
  const Rgb even = offsets_from_chroma(u.even, v.even), odd = offsets_from_chroma(u.odd, v.odd);
  const __m256i luma_even = _mm256_and_si256(luma, _mm256_set1_epi16(255)), luma_odd = _mm256_srli_epi16(luma, 8);
  const auto channel = [&](__m256i a, __m256i b) {
    return _mm256_packus_epi16(_mm256_add_epi16(luma_even, a), _mm256_add_epi16(luma_odd, b));
  };
  store_rgb(kInterleaveEvenFirst, channel(even.r, odd.r), channel(even.g, odd.g), channel(even.b, odd.b), low_rgb,
            high_rgb);
}

// 64 pixels from sample i of the chroma rows on; whether those begin and end there.
void rgb_from_ycc420_step(const uint8_t* y, const uint8_t* const (&chroma)[4], size_t i, bool is_first, bool is_last,
                          uint8_t* rgb) {
  const auto neighbors = [&](size_t row) { return Neighbors(chroma[row] + i, is_first, is_last); };
  const Upsampled u = centered_h2v2(neighbors(0), neighbors(1)), v = centered_h2v2(neighbors(2), neighbors(3));
  rgb_from_upsampled(load_halves(y, y + 32), u.low, v.low, rgb, rgb + 96);
  rgb_from_upsampled(load_halves(y + 16, y + 48), u.high, v.high, rgb + 48, rgb + 144);
}

// From sample i on, where less than 64 pixels are left: of copies.
void rgb_from_ycc420_rest(const uint8_t* y, const uint8_t* const (&chroma)[4], size_t n, size_t i, uint8_t* rgb) {
  const size_t n_chroma = (n + 1) / 2, count = n_chroma - i, n_pixels = n - 2 * i;
  const Surrounded copies[4] = {{chroma[0], n_chroma, i, count},
                                {chroma[1], n_chroma, i, count},
                                {chroma[2], n_chroma, i, count},
                                {chroma[3], n_chroma, i, count}};
  const uint8_t* const rows[4] = {copies[0].bytes, copies[1].bytes, copies[2].bytes, copies[3].bytes};
  uint8_t luma[2 * kStep] = {}, out[6 * kStep];
  copy(luma, y + 2 * i, n_pixels);
  rgb_from_ycc420_step(luma, rows, 1, false, false, out);
  copy(rgb + 6 * i, out, 3 * n_pixels);
}

void rgb_from_ycc420_row(const uint8_t* y, const uint8_t* cb_near, const uint8_t* cb_far, const uint8_t* cr_near,
                         const uint8_t* cr_far, size_t n, uint8_t* rgb) {
  const uint8_t* const chroma[4] = {cb_near, cb_far, cr_near, cr_far};
  const size_t n_chroma = (n + 1) / 2;
  size_t i = 0;
  for (; 2 * i + 2 * kStep <= n; i += kStep)
    rgb_from_ycc420_step(y + 2 * i, chroma, i, i == 0, i + kStep == n_chroma, rgb + 6 * i);
  if (i == n_chroma) return;
  // The last step may begin earlier and do pixels twice, which is cheaper than to do less than a step.
  if (i == 0 || n % 2 != 0) {
    rgb_from_ycc420_rest(y, chroma, n, i, rgb);
    return;
  }
  i = n_chroma - kStep;
  rgb_from_ycc420_step(y + 2 * i, chroma, i, false, true, rgb + 6 * i);
}

}  // namespace

void fill_pixel_avx2(PixelKernels& table) {
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
