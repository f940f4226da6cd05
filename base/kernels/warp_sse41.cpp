#include <smmintrin.h>

#include <cstddef>
#include <cstdint>

#include "base/kernels/warp_kernels.h"

namespace pac {
namespace {

// Four pixels: lanes are columns.
struct Quad {
  __m128i x_64, y_64;
  __m128 u_before;
};

inline __m128 coordinate(const ReprojectionRow& row, int c, __m128 column, __m128 u) {
  return _mm_add_ps(_mm_add_ps(_mm_set1_ps(row.origin[c]), _mm_mul_ps(column, _mm_set1_ps(row.per_pixel[c]))),
                    _mm_mul_ps(u, _mm_set1_ps(row.per_depth[c])));
}

inline Quad reproject(const ReprojectionRow& row, __m128 column, __m128 depth) {
  const __m128 u = _mm_sub_ps(_mm_set1_ps(1.0f), depth);
  const __m128 w = coordinate(row, 3, column, u);
  // Infinite where nothing is: then no position fits 32 bits, and the conversion gives kWarpNowhere.
  const __m128 somewhere = _mm_cmpgt_ps(w, _mm_set1_ps(8.6736174e-19f));
  const __m128 r = _mm_div_ps(_mm_set1_ps(1.0f), _mm_and_ps(w, somewhere));
  const __m128 before = _mm_mul_ps(coordinate(row, 2, column, u), r);
  return {_mm_cvtps_epi32(_mm_mul_ps(coordinate(row, 0, column, u), r)),
          _mm_cvtps_epi32(_mm_mul_ps(coordinate(row, 1, column, u), r)),
          _mm_and_ps(before, _mm_and_ps(somewhere, _mm_cmpord_ps(before, before)))};
}

// Columns from `first` on.
inline void reproject_columns(const ReprojectionRow& row, size_t first, const float* depth, size_t n, int32_t* x_64,
                              int32_t* y_64, float* u_before) {
  __m128i column = _mm_add_epi32(_mm_set1_epi32(static_cast<int>(first)), _mm_setr_epi32(0, 1, 2, 3));
  size_t i = 0;
  for (; i + 4 <= n; i += 4) {
    const Quad quad = reproject(row, _mm_cvtepi32_ps(column), _mm_loadu_ps(depth + i));
    _mm_storeu_si128(reinterpret_cast<__m128i*>(x_64 + i), quad.x_64);
    _mm_storeu_si128(reinterpret_cast<__m128i*>(y_64 + i), quad.y_64);
    _mm_storeu_ps(u_before + i, quad.u_before);
    column = _mm_add_epi32(column, _mm_set1_epi32(4));
  }
  for (; i < n; ++i) {
    const auto at = static_cast<float>(static_cast<int32_t>(first + i));
    const Quad one = reproject(row, _mm_set1_ps(at), _mm_set1_ps(depth[i]));
    x_64[i] = _mm_cvtsi128_si32(one.x_64);
    y_64[i] = _mm_cvtsi128_si32(one.y_64);
    u_before[i] = _mm_cvtss_f32(one.u_before);
  }
}

void reproject_row(const ReprojectionRow& row, const float* depth, size_t n, int32_t* x_64, int32_t* y_64,
                   float* u_before) {
  reproject_columns(row, 0, depth, n, x_64, y_64, u_before);
}

inline __m128i load(const int16_t* at) {
  return _mm_loadu_si128(reinterpret_cast<const __m128i*>(at));
}

// Four partial sums over the columns of one point: lanes are columns 2i and 2i+1.
inline __m128i filter_point(const int16_t* at, ptrdiff_t stride, const int16_t* taps_x, const int16_t* taps_y) {
  const __m128i ty = load(taps_y);
  __m128i low = _mm_set1_epi32(128), high = low;
  const auto add_pair = [&](const int16_t* rows, __m128i pair) {
    const __m128i a = load(rows), b = load(rows + stride);
    low = _mm_add_epi32(low, _mm_madd_epi16(_mm_unpacklo_epi16(a, b), pair));
    high = _mm_add_epi32(high, _mm_madd_epi16(_mm_unpackhi_epi16(a, b), pair));
  };
  add_pair(at, _mm_shuffle_epi32(ty, 0x00));
  add_pair(at + 2 * stride, _mm_shuffle_epi32(ty, 0x55));
  add_pair(at + 4 * stride, _mm_shuffle_epi32(ty, 0xAA));
  const __m128i v = _mm_packs_epi32(_mm_srai_epi32(low, 8), _mm_srai_epi32(high, 8));
  return _mm_madd_epi16(v, load(taps_x));
}

inline __m128i finished(__m128i sums) {
  const __m128i done = _mm_srai_epi32(_mm_add_epi32(sums, _mm_set1_epi32(512)), 10);
  return _mm_min_epi32(_mm_max_epi32(done, _mm_set1_epi32(-kLargestCarried)), _mm_set1_epi32(kLargestCarried));
}

inline int16_t sum_of(__m128i partial) {
  const __m128i pairs = _mm_hadd_epi32(partial, partial);
  return static_cast<int16_t>(_mm_cvtsi128_si32(finished(_mm_hadd_epi32(pairs, pairs))));
}

void filter_points(const int16_t* plane, ptrdiff_t stride, const int16_t* taps, const int32_t* x_64,
                   const int32_t* y_64, const uint8_t* state, size_t n, int16_t* out) {
  const auto partial = [&](size_t i) {
    if (state[i] == kWarpAbsent) return _mm_setzero_si128();
    const int16_t* at = plane + ((y_64[i] >> 6) - kWarpTapsBefore) * stride + (x_64[i] >> 6) - kWarpTapsBefore;
    return filter_point(at, stride, taps + kWarpTapStride * (x_64[i] & (kWarpPhases - 1)),
                        taps + kWarpTapStride * (y_64[i] & (kWarpPhases - 1)));
  };
  size_t i = 0;
  for (; i + 4 <= n; i += 4) {
    const __m128i sums =
        _mm_hadd_epi32(_mm_hadd_epi32(partial(i), partial(i + 1)), _mm_hadd_epi32(partial(i + 2), partial(i + 3)));
    const __m128i four = finished(sums);
    _mm_storel_epi64(reinterpret_cast<__m128i*>(out + i), _mm_packs_epi32(four, four));
  }
  for (; i < n; ++i) out[i] = sum_of(partial(i));
}

inline __m128i load(const uint32_t* at) {
  return _mm_loadu_si128(reinterpret_cast<const __m128i*>(at));
}

// 0xFFFFFFFF where keys without their smooth bits belong to the wanted one.
inline __m128i belongs(__m128i key, __m128i wanted) {
  const __m128i apart = _mm_sub_epi32(_mm_and_si128(key, _mm_set1_epi32(static_cast<int>(kKeyBits))), wanted);
  const __m128i from_low = _mm_add_epi32(apart, _mm_set1_epi32(kKeyTolerance));
  return _mm_cmpeq_epi32(_mm_min_epu32(from_low, _mm_set1_epi32(2 * kKeyTolerance)), from_low);
}

inline int16_t filter_shown(const int16_t* plane, ptrdiff_t stride, const uint32_t* map, ptrdiff_t map_stride,
                            uint32_t wanted_key, int16_t stand_in, const int16_t* taps_x, const int16_t* taps_y) {
  const __m128i wanted = _mm_set1_epi32(static_cast<int>(wanted_key)), replaced = _mm_set1_epi16(stand_in);
  int16_t patch[kWarpTaps * kWarpTapStride];
  for (int k = 0; k < kWarpTaps; ++k) {
    const uint32_t* keys = map + k * map_stride;
    const __m128i mask = _mm_packs_epi32(belongs(load(keys), wanted), belongs(load(keys + 4), wanted));
    _mm_storeu_si128(reinterpret_cast<__m128i*>(patch + k * kWarpTapStride),
                     _mm_blendv_epi8(replaced, load(plane + k * stride), mask));
  }
  return sum_of(filter_point(patch, kWarpTapStride, taps_x, taps_y));
}

#include "base/kernels/warp_points_simd.inc"

// Of samples with bits below the point, rounded.
inline __m128i whole(__m128i carried) {
  return _mm_srai_epi16(_mm_add_epi16(carried, _mm_set1_epi16(1 << (kCarriedBits - 1))), kCarriedBits);
}

inline void add_eight(const uint8_t* base, const int16_t* carried, uint8_t* out) {
  const __m128i wide = _mm_cvtepu8_epi16(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(base)));
  const __m128i sum = _mm_add_epi16(wide, whole(load(carried)));
  _mm_storel_epi64(reinterpret_cast<__m128i*>(out), _mm_packus_epi16(sum, sum));
}

// (a x + b y + 32768) >> 16 of 16-bit lanes, a and b within 16 bits.
inline __m128i rounded_sum(__m128i x, int a, __m128i y, int b) {
  const __m128i factors =
      _mm_set1_epi32(static_cast<int>(static_cast<uint32_t>(b) << 16 | (static_cast<uint32_t>(a) & 0xFFFF)));
  const __m128i half = _mm_set1_epi32(1 << 15);
  const __m128i low = _mm_add_epi32(_mm_madd_epi16(_mm_unpacklo_epi16(x, y), factors), half);
  const __m128i high = _mm_add_epi32(_mm_madd_epi16(_mm_unpackhi_epi16(x, y), factors), half);
  return _mm_packs_epi32(_mm_srai_epi32(low, 16), _mm_srai_epi32(high, 16));
}

// Eight pixels, 24 bytes. 91881 = 65536 + 26345, 116130 = 131072 - 14942 and -46802 = -65536 + 18734: whole numbers of
// v and u stay outside of the products.
inline void composite_eight(const uint8_t* low, const int16_t* carried, const int16_t* chroma_u,
                            const int16_t* chroma_v, uint8_t* rgb) {
  const __m128i first = _mm_loadu_si128(reinterpret_cast<const __m128i*>(low));
  const __m128i last = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(low + 16));
  const auto channel = [&](__m128i from_first, __m128i from_last, __m128i added) {
    const __m128i bytes = _mm_or_si128(_mm_shuffle_epi8(first, from_first), _mm_shuffle_epi8(last, from_last));
    const __m128i sum = _mm_add_epi16(bytes, added);
    return _mm_packus_epi16(sum, sum);
  };
  const __m128i d = whole(load(carried)), u = load(chroma_u), v = load(chroma_v);
  const __m128i red = _mm_add_epi16(_mm_add_epi16(d, v), rounded_sum(v, 26345, u, 0));
  const __m128i green = _mm_add_epi16(_mm_sub_epi16(d, v), rounded_sum(u, -22554, v, 18734));
  const __m128i blue = _mm_add_epi16(_mm_add_epi16(d, _mm_add_epi16(u, u)), rounded_sum(u, -14942, v, 0));
  const __m128i r = channel(_mm_setr_epi8(0, -1, 3, -1, 6, -1, 9, -1, 12, -1, 15, -1, -1, -1, -1, -1),
                            _mm_setr_epi8(-1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, 2, -1, 5, -1), red);
  const __m128i g = channel(_mm_setr_epi8(1, -1, 4, -1, 7, -1, 10, -1, 13, -1, -1, -1, -1, -1, -1, -1),
                            _mm_setr_epi8(-1, -1, -1, -1, -1, -1, -1, -1, -1, -1, 0, -1, 3, -1, 6, -1), green);
  const __m128i b = channel(_mm_setr_epi8(2, -1, 5, -1, 8, -1, 11, -1, 14, -1, -1, -1, -1, -1, -1, -1),
                            _mm_setr_epi8(-1, -1, -1, -1, -1, -1, -1, -1, -1, -1, 1, -1, 4, -1, 7, -1), blue);
  const __m128i rg = _mm_unpacklo_epi8(r, g);
  const auto place = [&](__m128i from_rg, __m128i from_b) {
    return _mm_or_si128(_mm_shuffle_epi8(rg, from_rg), _mm_shuffle_epi8(b, from_b));
  };
  _mm_storeu_si128(reinterpret_cast<__m128i*>(rgb),
                   place(_mm_setr_epi8(0, 1, -1, 2, 3, -1, 4, 5, -1, 6, 7, -1, 8, 9, -1, 10),
                         _mm_setr_epi8(-1, -1, 0, -1, -1, 1, -1, -1, 2, -1, -1, 3, -1, -1, 4, -1)));
  _mm_storel_epi64(reinterpret_cast<__m128i*>(rgb + 16),
                   place(_mm_setr_epi8(11, -1, 12, 13, -1, 14, 15, -1, -1, -1, -1, -1, -1, -1, -1, -1),
                         _mm_setr_epi8(-1, 5, -1, -1, 6, -1, -1, 7, -1, -1, -1, -1, -1, -1, -1, -1)));
}

#include "base/kernels/warp_rows_simd.inc"

}  // namespace

void fill_warp_sse41(WarpKernels& table) {
  table.reproject_row = reproject_row;
  table.find_points = find_points;
  table.filter_points = filter_points;
  table.filter_both = filter_both;
  table.filter_edges = filter_edges;
  table.add_carried_row = add_carried_row;
  table.composite_signed_row = composite_signed_row;
}

}  // namespace pac
