// Eight lanes in two registers.
#include <smmintrin.h>

#include "base/kernels/front_kernels.h"
#include "base/kernels/tile_kernels.h"

namespace pac {
namespace {

struct F8 {
  __m128 lo, hi;
};
struct I8 {
  __m128i lo, hi;
};
struct M8 {
  __m128 lo, hi;
};

inline F8 load(const float* p) {
  return {_mm_loadu_ps(p), _mm_loadu_ps(p + 4)};
}
inline I8 load(const int32_t* p) {
  return {_mm_loadu_si128(reinterpret_cast<const __m128i*>(p)),
          _mm_loadu_si128(reinterpret_cast<const __m128i*>(p + 4))};
}
inline I8 load_bytes(const uint8_t* p) {
  const __m128i bytes = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(p));
  return {_mm_cvtepu8_epi32(bytes), _mm_cvtepu8_epi32(_mm_srli_si128(bytes, 4))};
}
inline void store(float* p, F8 a) {
  _mm_storeu_ps(p, a.lo);
  _mm_storeu_ps(p + 4, a.hi);
}
inline void store(int32_t* p, I8 a) {
  _mm_storeu_si128(reinterpret_cast<__m128i*>(p), a.lo);
  _mm_storeu_si128(reinterpret_cast<__m128i*>(p + 4), a.hi);
}
inline F8 splat(float a) {
  return {_mm_set1_ps(a), _mm_set1_ps(a)};
}
inline I8 splat(int32_t a) {
  return {_mm_set1_epi32(a), _mm_set1_epi32(a)};
}
inline I8 kRamp() {
  return {_mm_setr_epi32(0, 1, 2, 3), _mm_setr_epi32(4, 5, 6, 7)};
}
inline F8 operator+(F8 a, F8 b) {
  return {_mm_add_ps(a.lo, b.lo), _mm_add_ps(a.hi, b.hi)};
}
inline F8 operator-(F8 a, F8 b) {
  return {_mm_sub_ps(a.lo, b.lo), _mm_sub_ps(a.hi, b.hi)};
}
inline F8 operator*(F8 a, F8 b) {
  return {_mm_mul_ps(a.lo, b.lo), _mm_mul_ps(a.hi, b.hi)};
}
inline F8 operator/(F8 a, F8 b) {
  return {_mm_div_ps(a.lo, b.lo), _mm_div_ps(a.hi, b.hi)};
}
inline F8 square_root(F8 a) {
  return {_mm_sqrt_ps(a.lo), _mm_sqrt_ps(a.hi)};
}
inline F8 round_down(F8 a) {
  return {_mm_floor_ps(a.lo), _mm_floor_ps(a.hi)};
}
inline F8 smaller(F8 a, F8 b) {
  return {_mm_min_ps(b.lo, a.lo), _mm_min_ps(b.hi, a.hi)};
}
inline F8 larger(F8 a, F8 b) {
  return {_mm_max_ps(b.lo, a.lo), _mm_max_ps(b.hi, a.hi)};
}
inline F8 to_float(I8 a) {
  return {_mm_cvtepi32_ps(a.lo), _mm_cvtepi32_ps(a.hi)};
}
inline I8 truncate(F8 a) {
  return {_mm_cvttps_epi32(a.lo), _mm_cvttps_epi32(a.hi)};
}
inline F8 as_float(I8 a) {
  return {_mm_castsi128_ps(a.lo), _mm_castsi128_ps(a.hi)};
}
inline I8 as_int(F8 a) {
  return {_mm_castps_si128(a.lo), _mm_castps_si128(a.hi)};
}
inline I8 operator+(I8 a, I8 b) {
  return {_mm_add_epi32(a.lo, b.lo), _mm_add_epi32(a.hi, b.hi)};
}
inline I8 operator-(I8 a, I8 b) {
  return {_mm_sub_epi32(a.lo, b.lo), _mm_sub_epi32(a.hi, b.hi)};
}
inline I8 operator*(I8 a, I8 b) {
  return {_mm_mullo_epi32(a.lo, b.lo), _mm_mullo_epi32(a.hi, b.hi)};
}
inline I8 operator&(I8 a, I8 b) {
  return {_mm_and_si128(a.lo, b.lo), _mm_and_si128(a.hi, b.hi)};
}
inline I8 operator|(I8 a, I8 b) {
  return {_mm_or_si128(a.lo, b.lo), _mm_or_si128(a.hi, b.hi)};
}
template <int kBits>
inline I8 shift_right(I8 a) {
  return {_mm_srai_epi32(a.lo, kBits), _mm_srai_epi32(a.hi, kBits)};
}
template <int kBits>
inline I8 shift_left(I8 a) {
  return {_mm_slli_epi32(a.lo, kBits), _mm_slli_epi32(a.hi, kBits)};
}
// n in 0..15, lane by lane: multiplied by a power of two, exactly, as 0 <= a < 2^24 is.
inline __m128i shifted(__m128i a, __m128i exponent) {
  const __m128 power = _mm_castsi128_ps(_mm_slli_epi32(exponent, 23));
  return _mm_cvttps_epi32(_mm_mul_ps(_mm_cvtepi32_ps(a), power));
}
inline I8 shift_right(I8 a, I8 n) {
  const __m128i bias = _mm_set1_epi32(127);
  return {shifted(a.lo, _mm_sub_epi32(bias, n.lo)), shifted(a.hi, _mm_sub_epi32(bias, n.hi))};
}
inline I8 smaller(I8 a, I8 b) {
  return {_mm_min_epi32(a.lo, b.lo), _mm_min_epi32(a.hi, b.hi)};
}
inline I8 larger(I8 a, I8 b) {
  return {_mm_max_epi32(a.lo, b.lo), _mm_max_epi32(a.hi, b.hi)};
}
// Of all lanes.
inline int32_t least_of(I8 a) {
  __m128i m = _mm_min_epi32(a.lo, a.hi);
  m = _mm_min_epi32(m, _mm_shuffle_epi32(m, 0x4E));
  return _mm_cvtsi128_si32(_mm_min_epi32(m, _mm_shuffle_epi32(m, 0xB1)));
}
inline int32_t greatest_of(I8 a) {
  __m128i m = _mm_max_epi32(a.lo, a.hi);
  m = _mm_max_epi32(m, _mm_shuffle_epi32(m, 0x4E));
  return _mm_cvtsi128_si32(_mm_max_epi32(m, _mm_shuffle_epi32(m, 0xB1)));
}
inline M8 operator<(F8 a, F8 b) {
  return {_mm_cmplt_ps(a.lo, b.lo), _mm_cmplt_ps(a.hi, b.hi)};
}
inline M8 operator<=(F8 a, F8 b) {
  return {_mm_cmple_ps(a.lo, b.lo), _mm_cmple_ps(a.hi, b.hi)};
}
inline M8 operator>=(F8 a, F8 b) {
  return {_mm_cmpge_ps(a.lo, b.lo), _mm_cmpge_ps(a.hi, b.hi)};
}
inline M8 operator<(I8 a, I8 b) {
  return {_mm_castsi128_ps(_mm_cmplt_epi32(a.lo, b.lo)), _mm_castsi128_ps(_mm_cmplt_epi32(a.hi, b.hi))};
}
inline M8 operator&(M8 a, M8 b) {
  return {_mm_and_ps(a.lo, b.lo), _mm_and_ps(a.hi, b.hi)};
}
inline M8 not_negative(I8 a) {
  return {_mm_castsi128_ps(_mm_cmpgt_epi32(a.lo, _mm_set1_epi32(-1))),
          _mm_castsi128_ps(_mm_cmpgt_epi32(a.hi, _mm_set1_epi32(-1)))};
}
inline F8 select(M8 m, F8 a, F8 b) {
  return {_mm_blendv_ps(b.lo, a.lo, m.lo), _mm_blendv_ps(b.hi, a.hi, m.hi)};
}
inline I8 select(M8 m, I8 a, I8 b) {
  return {_mm_blendv_epi8(b.lo, a.lo, _mm_castps_si128(m.lo)), _mm_blendv_epi8(b.hi, a.hi, _mm_castps_si128(m.hi))};
}
inline F8 select_negative(I8 m, F8 a, F8 b) {
  return {_mm_blendv_ps(b.lo, a.lo, _mm_castsi128_ps(m.lo)), _mm_blendv_ps(b.hi, a.hi, _mm_castsi128_ps(m.hi))};
}
inline uint32_t bits(M8 m) {
  return static_cast<uint32_t>(_mm_movemask_ps(m.lo) | _mm_movemask_ps(m.hi) << 4);
}
inline M8 equal_to(I8 a, uint32_t value) {
  const __m128i wanted = _mm_set1_epi32(static_cast<int32_t>(value));
  return {_mm_castsi128_ps(_mm_cmpeq_epi32(a.lo, wanted)), _mm_castsi128_ps(_mm_cmpeq_epi32(a.hi, wanted))};
}
inline uint32_t matching_lanes(I8 a, uint32_t value) {
  return bits(equal_to(a, value));
}
inline I8 look_up(const int32_t table[16], I8 at) {
  alignas(16) int32_t lanes[8];
  store(lanes, at);
  for (int32_t& lane : lanes) lane = table[lane];
  return load(lanes);
}
inline void store_rgb(uint8_t* p, I8 red, I8 green, I8 blue) {
  const __m128i order = _mm_setr_epi8(0, 4, 8, 1, 5, 9, 2, 6, 10, 3, 7, 11, -1, -1, -1, -1);
  const auto interleaved = [&](__m128i r, __m128i g, __m128i b) {
    return _mm_shuffle_epi8(_mm_packus_epi16(_mm_packs_epi32(r, g), _mm_packs_epi32(b, b)), order);
  };
  const __m128i low = interleaved(red.lo, green.lo, blue.lo), high = interleaved(red.hi, green.hi, blue.hi);
  auto* at = reinterpret_cast<__m128i*>(p);
  _mm_storeu_si128(at, _mm_or_si128(low, _mm_slli_si128(high, 12)));
  _mm_storel_epi64(reinterpret_cast<__m128i*>(p + 16), _mm_srli_si128(high, 4));
}

using LaneMask16 = __m128i;
inline LaneMask16 lane_mask_16(uint8_t mask) {
  const __m128i bit = _mm_setr_epi16(1, 2, 4, 8, 16, 32, 64, 128);
  return _mm_cmpeq_epi16(_mm_and_si128(_mm_set1_epi16(mask), bit), bit);
}
// Adds eight values in [-4080, 4080] to 16-bit sums in the lanes of the mask.
inline void add_masked(uint16_t* sums, I8 values, LaneMask16 mask) {
  auto* at = reinterpret_cast<__m128i*>(sums);
  const __m128i packed = _mm_packs_epi32(values.lo, values.hi);
  _mm_storeu_si128(at, _mm_add_epi16(_mm_loadu_si128(at), _mm_and_si128(packed, mask)));
}

template <int kFrom = 0>
[[gnu::always_inline]] inline void load_columns(const float* const at[8], F8 rows[4]) {
  __m128 low[4], high[4];
  for (int k = 0; k < 4; ++k) {
    low[k] = _mm_loadu_ps(at[k] + kFrom);
    high[k] = _mm_loadu_ps(at[k + 4] + kFrom);
  }
  _MM_TRANSPOSE4_PS(low[0], low[1], low[2], low[3]);
  _MM_TRANSPOSE4_PS(high[0], high[1], high[2], high[3]);
  for (int k = 0; k < 4; ++k) rows[k] = {low[k], high[k]};
}
template <int kFrom = 0>
[[gnu::always_inline]] inline void store_columns(float* const at[8], const F8 rows[4]) {
  __m128 low[4], high[4];
  for (int k = 0; k < 4; ++k) {
    low[k] = rows[k].lo;
    high[k] = rows[k].hi;
  }
  _MM_TRANSPOSE4_PS(low[0], low[1], low[2], low[3]);
  _MM_TRANSPOSE4_PS(high[0], high[1], high[2], high[3]);
  for (int k = 0; k < 4; ++k) {
    _mm_storeu_ps(at[k] + kFrom, low[k]);
    _mm_storeu_ps(at[k + 4] + kFrom, high[k]);
  }
}

struct LevelTaps;
void filter_bilinear(const uint8_t* texels, const LevelTaps& taps, float* out);
void filter_trilinear(const uint8_t* texels, const LevelTaps& fine, const LevelTaps& coarse, I8 fraction, float* out);
void resolve_row(const uint16_t* sums, int shift, int width, uint8_t* rgb);

#include "base/kernels/tile_simd.inc"

inline __m128i load_pairs(const uint8_t* texels, int32_t first, int32_t second) {
  const auto at = [&](int32_t i) {
    return _mm_loadl_epi64(reinterpret_cast<const __m128i*>(texels + 4 * ptrdiff_t{i}));
  };
  const __m128i both = _mm_unpacklo_epi64(at(first), at(second));
  return _mm_xor_si128(both, _mm_set1_epi8(-128));  // signed bytes
}

// a + (b - a) * fraction, fraction in Q15.
inline __m128i mix(__m128i a, __m128i b, __m128i fraction) {
  return _mm_add_epi16(a, _mm_mulhrs_epi16(_mm_sub_epi16(b, a), fraction));
}

// Word i of the low half and word i of the high half, four times each.
inline __m128i broadcast_words(__m128i v, int i) {
  const auto low = static_cast<int16_t>((2 * i + 1) << 8 | 2 * i), high = static_cast<int16_t>(low + 0x0808);
  return _mm_shuffle_epi8(v, _mm_setr_epi16(low, low, low, low, high, high, high, high));
}
inline __m128i broadcast_word(__m128i v, int i) {
  return _mm_shuffle_epi8(v, _mm_set1_epi16(static_cast<int16_t>((2 * i + 1) << 8 | 2 * i)));
}

// Weights of four lanes of two filters.
struct Weights {
  __m128i x, y;
};
inline Weights weights(__m128i x1, __m128i y1, __m128i x2, __m128i y2) {
  const __m128i y = _mm_packs_epi32(y1, y2);
  return {_mm_slli_epi16(_mm_packs_epi32(x1, x2), 7),
          _mm_or_si128(_mm_sub_epi16(_mm_set1_epi16(128), y), _mm_slli_epi16(y, 8))};
}

// Two bilinear filters: [first's rgba | second's rgba] in 1/128 minus 128.
inline __m128i bilinear_two(__m128i top, __m128i bottom, const Weights& w, int k) {
  const __m128i first = _mm_maddubs_epi16(broadcast_word(w.y, k), _mm_unpacklo_epi8(top, bottom));
  const __m128i second = _mm_maddubs_epi16(broadcast_word(w.y, k + 4), _mm_unpackhi_epi8(top, bottom));
  return mix(_mm_unpacklo_epi64(first, second), _mm_unpackhi_epi64(first, second), broadcast_words(w.x, k));
}

inline void store_channel(__m128i words, float* out) {
  const __m128 value = _mm_cvtepi32_ps(_mm_srai_epi32(words, 16));
  _mm_storeu_ps(out, _mm_add_ps(_mm_mul_ps(value, _mm_set1_ps(1.0f / 128.0f)), _mm_set1_ps(128.0f)));
}

// Four lanes with rgba in the low 64 bits of each.
inline void store_texels(__m128i t0, __m128i t1, __m128i t2, __m128i t3, float* out) {
  const __m128i t01 = _mm_unpacklo_epi16(t0, t1), t23 = _mm_unpacklo_epi16(t2, t3);
  const __m128i rg = _mm_unpacklo_epi32(t01, t23), ba = _mm_unpackhi_epi32(t01, t23);
  store_channel(_mm_unpacklo_epi16(rg, rg), out);
  store_channel(_mm_unpackhi_epi16(rg, rg), out + kBatchLanes);
  store_channel(_mm_unpacklo_epi16(ba, ba), out + 2 * kBatchLanes);
}

void filter_trilinear(const uint8_t* texels, const LevelTaps& fine, const LevelTaps& coarse, I8 fraction, float* out) {
  for (int half = 0; half < 2; ++half) {
    const Weights w = half == 0
                          ? weights(fine.fraction_x.lo, fine.fraction_y.lo, coarse.fraction_x.lo, coarse.fraction_y.lo)
                          : weights(fine.fraction_x.hi, fine.fraction_y.hi, coarse.fraction_x.hi, coarse.fraction_y.hi);
    const __m128i f = half == 0 ? fraction.lo : fraction.hi;
    const __m128i level = _mm_slli_epi16(_mm_packs_epi32(f, f), 7);
    __m128i result[4];
    for (int k = 0; k < 4; ++k) {
      const int lane = 4 * half + k;
      const __m128i top = load_pairs(texels, fine.top[lane], coarse.top[lane]);
      const __m128i bottom = load_pairs(texels, fine.bottom[lane], coarse.bottom[lane]);
      const __m128i both = bilinear_two(top, bottom, w, k);
      result[k] = mix(both, _mm_unpackhi_epi64(both, both), broadcast_word(level, k));
    }
    store_texels(result[0], result[1], result[2], result[3], out + 4 * half);
  }
}

// Lane k + 4 rides where the coarse level would be.
void filter_bilinear(const uint8_t* texels, const LevelTaps& taps, float* out) {
  const Weights w = weights(taps.fraction_x.lo, taps.fraction_y.lo, taps.fraction_x.hi, taps.fraction_y.hi);
  __m128i low[4], high[4];
  for (int k = 0; k < 4; ++k) {
    const __m128i top = load_pairs(texels, taps.top[k], taps.top[k + 4]);
    const __m128i bottom = load_pairs(texels, taps.bottom[k], taps.bottom[k + 4]);
    low[k] = bilinear_two(top, bottom, w, k);
    high[k] = _mm_unpackhi_epi64(low[k], low[k]);
  }
  store_texels(low[0], low[1], low[2], low[3], out);
  store_texels(high[0], high[1], high[2], high[3], out + 4);
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

void fill_tile_sse41(TileKernels& table) {
  fill_table(table);
}

void fill_front_sse41(FrontKernels& table) {
  fill_front(table);
}

}  // namespace pac
