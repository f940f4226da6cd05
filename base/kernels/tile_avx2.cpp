// Eight lanes in one register.
#include <immintrin.h>

#include "base/kernels/front_kernels.h"
#include "base/kernels/tile_kernels.h"

namespace pac {
namespace {

struct F8 {
  __m256 v;
};
struct I8 {
  __m256i v;
};
struct M8 {
  __m256 v;
};

inline F8 load(const float* p) {
  return {_mm256_loadu_ps(p)};
}
inline I8 load(const int32_t* p) {
  return {_mm256_loadu_si256(reinterpret_cast<const __m256i*>(p))};
}
inline I8 load_bytes(const uint8_t* p) {
  return {_mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(p)))};
}
inline void store(float* p, F8 a) {
  _mm256_storeu_ps(p, a.v);
}
inline void store(int32_t* p, I8 a) {
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(p), a.v);
}
inline F8 splat(float a) {
  return {_mm256_set1_ps(a)};
}
inline I8 splat(int32_t a) {
  return {_mm256_set1_epi32(a)};
}
inline I8 kRamp() {
  return {_mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7)};
}
inline F8 operator+(F8 a, F8 b) {
  return {_mm256_add_ps(a.v, b.v)};
}
inline F8 operator-(F8 a, F8 b) {
  return {_mm256_sub_ps(a.v, b.v)};
}
inline F8 operator*(F8 a, F8 b) {
  return {_mm256_mul_ps(a.v, b.v)};
}
inline F8 operator/(F8 a, F8 b) {
  return {_mm256_div_ps(a.v, b.v)};
}
inline F8 square_root(F8 a) {
  return {_mm256_sqrt_ps(a.v)};
}
inline F8 round_down(F8 a) {
  return {_mm256_floor_ps(a.v)};
}
inline F8 smaller(F8 a, F8 b) {
  return {_mm256_min_ps(b.v, a.v)};
}
inline F8 larger(F8 a, F8 b) {
  return {_mm256_max_ps(b.v, a.v)};
}
inline F8 to_float(I8 a) {
  return {_mm256_cvtepi32_ps(a.v)};
}
inline I8 truncate(F8 a) {
  return {_mm256_cvttps_epi32(a.v)};
}
inline F8 as_float(I8 a) {
  return {_mm256_castsi256_ps(a.v)};
}
inline I8 as_int(F8 a) {
  return {_mm256_castps_si256(a.v)};
}
inline I8 operator+(I8 a, I8 b) {
  return {_mm256_add_epi32(a.v, b.v)};
}
inline I8 operator-(I8 a, I8 b) {
  return {_mm256_sub_epi32(a.v, b.v)};
}
inline I8 operator*(I8 a, I8 b) {
  return {_mm256_mullo_epi32(a.v, b.v)};
}
inline I8 operator&(I8 a, I8 b) {
  return {_mm256_and_si256(a.v, b.v)};
}
inline I8 operator|(I8 a, I8 b) {
  return {_mm256_or_si256(a.v, b.v)};
}
template <int kBits>
inline I8 shift_right(I8 a) {
  return {_mm256_srai_epi32(a.v, kBits)};
}
template <int kBits>
inline I8 shift_left(I8 a) {
  return {_mm256_slli_epi32(a.v, kBits)};
}
inline I8 shift_right(I8 a, I8 n) {
  return {_mm256_srav_epi32(a.v, n.v)};
}
inline I8 smaller(I8 a, I8 b) {
  return {_mm256_min_epi32(a.v, b.v)};
}
inline I8 larger(I8 a, I8 b) {
  return {_mm256_max_epi32(a.v, b.v)};
}
// Of all lanes.
inline int32_t least_of(I8 a) {
  __m128i m = _mm_min_epi32(_mm256_castsi256_si128(a.v), _mm256_extracti128_si256(a.v, 1));
  m = _mm_min_epi32(m, _mm_shuffle_epi32(m, 0x4E));
  return _mm_cvtsi128_si32(_mm_min_epi32(m, _mm_shuffle_epi32(m, 0xB1)));
}
inline int32_t greatest_of(I8 a) {
  __m128i m = _mm_max_epi32(_mm256_castsi256_si128(a.v), _mm256_extracti128_si256(a.v, 1));
  m = _mm_max_epi32(m, _mm_shuffle_epi32(m, 0x4E));
  return _mm_cvtsi128_si32(_mm_max_epi32(m, _mm_shuffle_epi32(m, 0xB1)));
}
inline M8 operator<(F8 a, F8 b) {
  return {_mm256_cmp_ps(a.v, b.v, _CMP_LT_OQ)};
}
inline M8 operator<=(F8 a, F8 b) {
  return {_mm256_cmp_ps(a.v, b.v, _CMP_LE_OQ)};
}
inline M8 operator>=(F8 a, F8 b) {
  return {_mm256_cmp_ps(a.v, b.v, _CMP_GE_OQ)};
}
inline M8 operator<(I8 a, I8 b) {
  return {_mm256_castsi256_ps(_mm256_cmpgt_epi32(b.v, a.v))};
}
inline M8 operator&(M8 a, M8 b) {
  return {_mm256_and_ps(a.v, b.v)};
}
inline M8 not_negative(I8 a) {
  return {_mm256_castsi256_ps(_mm256_cmpgt_epi32(a.v, _mm256_set1_epi32(-1)))};
}
inline F8 select(M8 m, F8 a, F8 b) {
  return {_mm256_blendv_ps(b.v, a.v, m.v)};
}
inline I8 select(M8 m, I8 a, I8 b) {
  return {_mm256_blendv_epi8(b.v, a.v, _mm256_castps_si256(m.v))};
}
inline F8 select_negative(I8 m, F8 a, F8 b) {
  return {_mm256_blendv_ps(b.v, a.v, _mm256_castsi256_ps(m.v))};
}
inline uint32_t bits(M8 m) {
  return static_cast<uint32_t>(_mm256_movemask_ps(m.v));
}
inline M8 equal_to(I8 a, uint32_t value) {
  return {_mm256_castsi256_ps(_mm256_cmpeq_epi32(a.v, _mm256_set1_epi32(static_cast<int32_t>(value))))};
}
inline uint32_t matching_lanes(I8 a, uint32_t value) {
  return bits(equal_to(a, value));
}
inline I8 look_up(const int32_t table[16], I8 at) {
  const auto* const halves = reinterpret_cast<const __m256i*>(table);
  const __m256i low = _mm256_permutevar8x32_epi32(_mm256_loadu_si256(halves), at.v);
  const __m256i high = _mm256_permutevar8x32_epi32(_mm256_loadu_si256(halves + 1), at.v);
  return {_mm256_blendv_epi8(low, high, _mm256_cmpgt_epi32(at.v, _mm256_set1_epi32(7)))};
}
// Halves hold red, green, blue and blue of four lanes. Stored: bytes 0..11 of the first half and 0..3 of the second,
// then the rest of that.
inline void store_rgb(uint8_t* p, I8 red, I8 green, I8 blue) {
  const __m256i order = _mm256_setr_epi8(0, 4, 8, 1, 5, 9, 2, 6, 10, 3, 7, 11, -1, -1, -1, -1,  //
                                         5, 9, 2, 6, 10, 3, 7, 11, -1, -1, -1, -1, 0, 4, 8, 1);
  const __m256i planes = _mm256_packus_epi16(_mm256_packs_epi32(red.v, green.v), _mm256_packs_epi32(blue.v, blue.v));
  const __m256i bytes = _mm256_shuffle_epi8(planes, order);
  const __m128i high = _mm256_extracti128_si256(bytes, 1);
  auto* at = reinterpret_cast<__m128i*>(p);
  _mm_storeu_si128(at, _mm_blend_epi32(_mm256_castsi256_si128(bytes), high, 8));
  _mm_storel_epi64(reinterpret_cast<__m128i*>(p + 16), high);
}

using LaneMask16 = __m128i;
inline LaneMask16 lane_mask_16(uint8_t mask) {
  const __m128i bit = _mm_setr_epi16(1, 2, 4, 8, 16, 32, 64, 128);
  return _mm_cmpeq_epi16(_mm_and_si128(_mm_set1_epi16(mask), bit), bit);
}
// Adds eight values in [-4080, 4080] to 16-bit sums in the lanes of the mask.
inline void add_masked(uint16_t* sums, I8 values, LaneMask16 mask) {
  const __m128i packed = _mm_packs_epi32(_mm256_castsi256_si128(values.v), _mm256_extracti128_si256(values.v, 1));
  auto* at = reinterpret_cast<__m128i*>(sums);
  _mm_storeu_si128(at, _mm_add_epi16(_mm_loadu_si128(at), _mm_and_si128(packed, mask)));
}

// Two 4x4 transpositions, of the registers' low halves and of their high halves.
inline void transpose_halves(const __m256 in[4], __m256 out[4]) {
  const __m256 t0 = _mm256_unpacklo_ps(in[0], in[1]), t1 = _mm256_unpackhi_ps(in[0], in[1]);
  const __m256 t2 = _mm256_unpacklo_ps(in[2], in[3]), t3 = _mm256_unpackhi_ps(in[2], in[3]);
  out[0] = _mm256_shuffle_ps(t0, t2, 0x44);
  out[1] = _mm256_shuffle_ps(t0, t2, 0xEE);
  out[2] = _mm256_shuffle_ps(t1, t3, 0x44);
  out[3] = _mm256_shuffle_ps(t1, t3, 0xEE);
}
// Written out: compilers keep what loops store into arrays of structures in memory.
template <int kFrom = 0>
[[gnu::always_inline]] inline void load_columns(const float* const at[8], F8 rows[4]) {
  const auto pair = [at](int k) {
    return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(at[k] + kFrom)), _mm_loadu_ps(at[k + 4] + kFrom),
                                1);
  };
  const __m256 in[4] = {pair(0), pair(1), pair(2), pair(3)};
  __m256 out[4];
  transpose_halves(in, out);
  rows[0].v = out[0];
  rows[1].v = out[1];
  rows[2].v = out[2];
  rows[3].v = out[3];
}
template <int kFrom = 0>
[[gnu::always_inline]] inline void store_columns(float* const at[8], const F8 rows[4]) {
  const __m256 in[4] = {rows[0].v, rows[1].v, rows[2].v, rows[3].v};
  __m256 out[4];
  transpose_halves(in, out);
  for (int k = 0; k < 4; ++k) {
    _mm_storeu_ps(at[k] + kFrom, _mm256_castps256_ps128(out[k]));
    _mm_storeu_ps(at[k + 4] + kFrom, _mm256_extractf128_ps(out[k], 1));
  }
}

struct LevelTaps;
void filter_bilinear(const uint8_t* texels, const LevelTaps& taps, float* out);
void filter_trilinear(const uint8_t* texels, const LevelTaps& fine, const LevelTaps& coarse, I8 fraction, float* out);
void resolve_row(const uint16_t* sums, int shift, int width, uint8_t* rgb);

#include "base/kernels/tile_simd.inc"

// The eight lanes' low halves: lanes 0..3 in the low 128 bits, 4..7 in the high ones, 4 x 16 bits each.
inline __m256i pack_pair(I8 low, I8 high) {
  return _mm256_packs_epi32(low.v, high.v);  // per 128 bits: four of `low`, four of `high`
}

// 16-bit word i of each half, four times.
inline __m256i broadcast_word(__m256i v, int i) {
  const auto pair = static_cast<int16_t>((2 * i + 1) << 8 | 2 * i);
  return _mm256_shuffle_epi8(v, _mm256_set1_epi16(pair));
}
// Word i of each half four times, then word i + 4 four times.
inline __m256i broadcast_words(__m256i v, int i) {
  const auto low = static_cast<int16_t>((2 * i + 1) << 8 | 2 * i), high = static_cast<int16_t>(low + 0x0808);
  return _mm256_shuffle_epi8(
      v, _mm256_setr_epi16(low, low, low, low, high, high, high, high, low, low, low, low, high, high, high, high));
}

inline __m128i load_pairs(const uint8_t* texels, int32_t first, int32_t second) {
  const auto* const low = reinterpret_cast<const __m128i*>(texels + 4 * ptrdiff_t{first});
  const auto* const high = reinterpret_cast<const __m64*>(texels + 4 * ptrdiff_t{second});
  return _mm_castps_si128(_mm_loadh_pi(_mm_castsi128_ps(_mm_loadl_epi64(low)), high));
}

// Lane k of the low half and lane k + 4 in the high half: [fine pair | coarse pair] each, offset to signed bytes.
inline __m256i load_quad(const uint8_t* texels, const int32_t* fine, const int32_t* coarse, int k) {
  const __m256i both = _mm256_inserti128_si256(_mm256_castsi128_si256(load_pairs(texels, fine[k], coarse[k])),
                                               load_pairs(texels, fine[k + 4], coarse[k + 4]), 1);
  return _mm256_xor_si256(both, _mm256_set1_epi8(-128));
}

// a + (b - a) * fraction, fraction in Q15.
inline __m256i mix(__m256i a, __m256i b, __m256i fraction) {
  return _mm256_add_epi16(a, _mm256_mulhrs_epi16(_mm256_sub_epi16(b, a), fraction));
}

// Vertical weights (128 - f, f) as unsigned bytes, `low` and `high` packed per half.
inline __m256i vertical_weights(I8 low, I8 high) {
  const __m256i f = pack_pair(low, high);
  return _mm256_or_si256(_mm256_sub_epi16(_mm256_set1_epi16(128), f), _mm256_slli_epi16(f, 8));
}

// Two bilinear filters a half: [first's rgba | second's rgba] in 1/128 minus 128.
inline __m256i bilinear_quad(__m256i top, __m256i bottom, __m256i weights_y, __m256i weights_x, int k) {
  const __m256i first = _mm256_maddubs_epi16(broadcast_word(weights_y, k), _mm256_unpacklo_epi8(top, bottom));
  const __m256i second = _mm256_maddubs_epi16(broadcast_word(weights_y, k + 4), _mm256_unpackhi_epi8(top, bottom));
  return mix(_mm256_unpacklo_epi64(first, second), _mm256_unpackhi_epi64(first, second), broadcast_words(weights_x, k));
}

inline F8 channel_row(__m256i words) {
  const F8 value{_mm256_cvtepi32_ps(_mm256_srai_epi32(words, 16))};
  return value * splat(1.0f / 128.0f) + splat(128.0f);
}

// Four results with rgba of lane k in the low 64 bits of the low half and lane k + 4 in those of the high half.
inline void store_texels(__m256i t0, __m256i t1, __m256i t2, __m256i t3, float* out) {
  const __m256i t01 = _mm256_unpacklo_epi16(t0, t1), t23 = _mm256_unpacklo_epi16(t2, t3);
  const __m256i rg = _mm256_unpacklo_epi32(t01, t23), ba = _mm256_unpackhi_epi32(t01, t23);
  store(out, channel_row(_mm256_unpacklo_epi16(rg, rg)));
  store(out + kBatchLanes, channel_row(_mm256_unpackhi_epi16(rg, rg)));
  store(out + 2 * kBatchLanes, channel_row(_mm256_unpacklo_epi16(ba, ba)));
}

void filter_trilinear(const uint8_t* texels, const LevelTaps& fine, const LevelTaps& coarse, I8 fraction, float* out) {
  const __m256i weights_y = vertical_weights(fine.fraction_y, coarse.fraction_y);
  const __m256i weights_x = _mm256_slli_epi16(pack_pair(fine.fraction_x, coarse.fraction_x), 7);
  const __m256i weights_level = _mm256_slli_epi16(pack_pair(fraction, fraction), 7);
  __m256i result[4];
  for (int k = 0; k < 4; ++k) {
    const __m256i top = load_quad(texels, fine.top, coarse.top, k);
    const __m256i bottom = load_quad(texels, fine.bottom, coarse.bottom, k);
    const __m256i both = bilinear_quad(top, bottom, weights_y, weights_x, k);
    result[k] = mix(both, _mm256_unpackhi_epi64(both, both), broadcast_word(weights_level, k));
  }
  store_texels(result[0], result[1], result[2], result[3], out);
}

// Lanes 2, 3 and 6, 7 ride where the coarse level would be.
void filter_bilinear(const uint8_t* texels, const LevelTaps& taps, float* out) {
  const __m256i fy = _mm256_packs_epi32(taps.fraction_y.v, taps.fraction_y.v);
  const __m256i fx = _mm256_packs_epi32(taps.fraction_x.v, taps.fraction_x.v);
  // Words 0, 1, -, -, 2, 3: lane k at word k, lane k + 2 at word k + 4.
  const __m256i order =
      _mm256_setr_epi8(0, 1, 2, 3, 0, 1, 2, 3, 4, 5, 6, 7, 4, 5, 6, 7, 0, 1, 2, 3, 0, 1, 2, 3, 4, 5, 6, 7, 4, 5, 6, 7);
  const __m256i y = _mm256_shuffle_epi8(fy, order);
  const __m256i weights_y = _mm256_or_si256(_mm256_sub_epi16(_mm256_set1_epi16(128), y), _mm256_slli_epi16(y, 8));
  const __m256i weights_x = _mm256_slli_epi16(_mm256_shuffle_epi8(fx, order), 7);
  __m256i result[2];
  for (int k = 0; k < 2; ++k) {
    const __m256i top = load_quad(texels, taps.top, taps.top + 2, k);
    const __m256i bottom = load_quad(texels, taps.bottom, taps.bottom + 2, k);
    result[k] = bilinear_quad(top, bottom, weights_y, weights_x, k);
  }
  store_texels(result[0], result[1], _mm256_unpackhi_epi64(result[0], result[0]),
               _mm256_unpackhi_epi64(result[1], result[1]), out);
}

// Sixteen pixels of three planes, interleaved to 48 bytes.
inline void store_interleaved(__m128i r, __m128i g, __m128i b, uint8_t* rgb) {
  const __m128i r0 = _mm_setr_epi8(0, -1, -1, 1, -1, -1, 2, -1, -1, 3, -1, -1, 4, -1, -1, 5);
  const __m128i g0 = _mm_setr_epi8(-1, 0, -1, -1, 1, -1, -1, 2, -1, -1, 3, -1, -1, 4, -1, -1);
  const __m128i b0 = _mm_setr_epi8(-1, -1, 0, -1, -1, 1, -1, -1, 2, -1, -1, 3, -1, -1, 4, -1);
  const __m128i r1 = _mm_setr_epi8(-1, -1, 6, -1, -1, 7, -1, -1, 8, -1, -1, 9, -1, -1, 10, -1);
  const __m128i g1 = _mm_setr_epi8(5, -1, -1, 6, -1, -1, 7, -1, -1, 8, -1, -1, 9, -1, -1, 10);
  const __m128i b1 = _mm_setr_epi8(-1, 5, -1, -1, 6, -1, -1, 7, -1, -1, 8, -1, -1, 9, -1, -1);
  const __m128i r2 = _mm_setr_epi8(-1, 11, -1, -1, 12, -1, -1, 13, -1, -1, 14, -1, -1, 15, -1, -1);
  const __m128i g2 = _mm_setr_epi8(-1, -1, 11, -1, -1, 12, -1, -1, 13, -1, -1, 14, -1, -1, 15, -1);
  const __m128i b2 = _mm_setr_epi8(10, -1, -1, 11, -1, -1, 12, -1, -1, 13, -1, -1, 14, -1, -1, 15);
  const auto merge = [&](__m128i pr, __m128i pg, __m128i pb, int part) {
    const __m128i bytes =
        _mm_or_si128(_mm_or_si128(_mm_shuffle_epi8(r, pr), _mm_shuffle_epi8(g, pg)), _mm_shuffle_epi8(b, pb));
    _mm_storeu_si128(reinterpret_cast<__m128i*>(rgb + 16 * part), bytes);
  };
  merge(r0, g0, b0, 0);
  merge(r1, g1, b1, 1);
  merge(r2, g2, b2, 2);
}

void resolve_row(const uint16_t* sums, int shift, int width, uint8_t* rgb) {
  const __m128i count = _mm_cvtsi32_si128(shift);
  const auto bytes = [&](const uint16_t* plane) {
    const auto* p = reinterpret_cast<const __m128i*>(plane);
    return _mm_packus_epi16(_mm_srl_epi16(_mm_loadu_si128(p), count), _mm_srl_epi16(_mm_loadu_si128(p + 1), count));
  };
  constexpr int kPlane = kTileSize * kTileSize;
  for (int x = 0; x < width; x += 16) {
    const __m128i r = bytes(sums + x), g = bytes(sums + kPlane + x), b = bytes(sums + 2 * kPlane + x);
    if (width - x >= 16) {
      store_interleaved(r, g, b, rgb + 3 * x);
    } else {
      uint8_t last[48];
      store_interleaved(r, g, b, last);
      __builtin_memcpy(rgb + 3 * x, last, 3 * static_cast<size_t>(width - x));
    }
  }
}

}  // namespace

void fill_tile_avx2(TileKernels& table) {
  fill_table(table);
}

void fill_front_avx2(FrontKernels& table) {
  fill_front(table);
}

}  // namespace pac
