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

inline __m128i in_64ths(__m128 position, __m128 somewhere) {
  const __m128 largest = _mm_set1_ps(262144.0f);
  const __m128 clamped = _mm_max_ps(_mm_min_ps(position, largest), _mm_sub_ps(_mm_setzero_ps(), largest));
  const __m128 rounded = _mm_floor_ps(_mm_add_ps(_mm_mul_ps(clamped, _mm_set1_ps(64.0f)), _mm_set1_ps(0.5f)));
  return _mm_blendv_epi8(_mm_set1_epi32(kWarpNowhere), _mm_cvtps_epi32(rounded), _mm_castps_si128(somewhere));
}

inline Quad reproject(const ReprojectionRow& row, __m128 column, __m128 depth) {
  const __m128 u = _mm_sub_ps(_mm_set1_ps(1.0f), depth);
  const __m128 w = coordinate(row, 3, column, u);
  const __m128 x = _mm_div_ps(coordinate(row, 0, column, u), w);
  const __m128 y = _mm_div_ps(coordinate(row, 1, column, u), w);
  const __m128 before = _mm_div_ps(coordinate(row, 2, column, u), w);
  const __m128 numbers = _mm_and_ps(_mm_cmpord_ps(x, y), _mm_cmpord_ps(before, before));
  const __m128 somewhere = _mm_and_ps(_mm_cmpgt_ps(w, _mm_set1_ps(8.6736174e-19f)), numbers);
  return {in_64ths(x, somewhere), in_64ths(y, somewhere), _mm_and_ps(before, somewhere)};
}

void reproject_row(const ReprojectionRow& row, const float* depth, size_t n, int32_t* x_64, int32_t* y_64,
                   float* u_before) {
  __m128i column = _mm_setr_epi32(0, 1, 2, 3);
  size_t i = 0;
  for (; i + 4 <= n; i += 4) {
    const Quad quad = reproject(row, _mm_cvtepi32_ps(column), _mm_loadu_ps(depth + i));
    _mm_storeu_si128(reinterpret_cast<__m128i*>(x_64 + i), quad.x_64);
    _mm_storeu_si128(reinterpret_cast<__m128i*>(y_64 + i), quad.y_64);
    _mm_storeu_ps(u_before + i, quad.u_before);
    column = _mm_add_epi32(column, _mm_set1_epi32(4));
  }
  for (; i < n; ++i) {
    const Quad one = reproject(row, _mm_set1_ps(static_cast<float>(static_cast<int32_t>(i))), _mm_set1_ps(depth[i]));
    x_64[i] = _mm_cvtsi128_si32(one.x_64);
    y_64[i] = _mm_cvtsi128_si32(one.y_64);
    u_before[i] = _mm_cvtss_f32(one.u_before);
  }
}

inline __m128i load(const int16_t* at) {
  return _mm_loadu_si128(reinterpret_cast<const __m128i*>(at));
}

// Four partial sums over the columns of one point: lanes are columns 2i and 2i+1.
inline __m128i filter_point(const int16_t* at, ptrdiff_t stride, const int16_t* taps_x, const int16_t* taps_y) {
  const __m128i ty = load(taps_y);
  __m128i low = _mm_set1_epi32(1), high = low;
  const auto add_pair = [&](const int16_t* rows, __m128i pair) {
    const __m128i a = load(rows), b = load(rows + stride);
    low = _mm_add_epi32(low, _mm_madd_epi16(_mm_unpacklo_epi16(a, b), pair));
    high = _mm_add_epi32(high, _mm_madd_epi16(_mm_unpackhi_epi16(a, b), pair));
  };
  add_pair(at, _mm_shuffle_epi32(ty, 0x00));
  add_pair(at + 2 * stride, _mm_shuffle_epi32(ty, 0x55));
  add_pair(at + 4 * stride, _mm_shuffle_epi32(ty, 0xAA));
  const __m128i v = _mm_packs_epi32(_mm_srai_epi32(low, 1), _mm_srai_epi32(high, 1));
  return _mm_madd_epi16(v, load(taps_x));
}

void filter_points(const int16_t* plane, ptrdiff_t stride, const int16_t* taps, const int32_t* offset,
                   const uint8_t* phase_x, const uint8_t* phase_y, size_t n, int16_t* out) {
  const auto partial = [&](size_t i) {
    return filter_point(plane + offset[i], stride, taps + kWarpTapStride * phase_x[i],
                        taps + kWarpTapStride * phase_y[i]);
  };
  const auto finished = [](__m128i sums) { return _mm_srai_epi32(_mm_add_epi32(sums, _mm_set1_epi32(4096)), 13); };
  size_t i = 0;
  for (; i + 4 <= n; i += 4) {
    const __m128i sums =
        _mm_hadd_epi32(_mm_hadd_epi32(partial(i), partial(i + 1)), _mm_hadd_epi32(partial(i + 2), partial(i + 3)));
    const __m128i four = finished(sums);
    _mm_storel_epi64(reinterpret_cast<__m128i*>(out + i), _mm_packs_epi32(four, four));
  }
  for (; i < n; ++i) {
    const __m128i one = partial(i), pairs = _mm_hadd_epi32(one, one);
    out[i] = static_cast<int16_t>(_mm_cvtsi128_si32(finished(_mm_hadd_epi32(pairs, pairs))));
  }
}

// 0xFFFFFFFF where four taps show the point's surface at its depth.
inline __m128i shown(const uint32_t* surface, const float* u, const EdgePoint& point) {
  const __m128 wanted = _mm_set1_ps(point.u), at = _mm_loadu_ps(u);
  const __m128 larger = _mm_mul_ps(_mm_set1_ps(kWarpDepthTolerance), _mm_max_ps(at, wanted));
  const __m128 distance = _mm_andnot_ps(_mm_set1_ps(-0.0f), _mm_sub_ps(at, wanted));
  const __m128i same = _mm_cmpeq_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(surface)),
                                       _mm_set1_epi32(static_cast<int>(point.surface)));
  return _mm_and_si128(same, _mm_castps_si128(_mm_cmple_ps(distance, larger)));
}

void cut_patches(const int16_t* plane, ptrdiff_t stride, const uint32_t* surface, const float* u, ptrdiff_t map_stride,
                 const EdgePoint* points, size_t n, int16_t* patches) {
  for (size_t i = 0; i < n; ++i) {
    const EdgePoint& point = points[i];
    const int16_t* samples = plane + point.plane_offset;
    const uint32_t* surfaces = surface + point.map_offset;
    const float* depths = u + point.map_offset;
    const __m128i stand_in = _mm_set1_epi16(point.stand_in);
    for (int k = 0; k < kWarpTaps; ++k) {
      const __m128i mask = _mm_packs_epi32(shown(surfaces, depths, point), shown(surfaces + 4, depths + 4, point));
      _mm_storeu_si128(reinterpret_cast<__m128i*>(patches), _mm_blendv_epi8(stand_in, load(samples), mask));
      samples += stride;
      surfaces += map_stride;
      depths += map_stride;
      patches += kWarpTapStride;
    }
  }
}

}  // namespace

void fill_warp_sse41(WarpKernels& table) {
  table.reproject_row = reproject_row;
  table.filter_points = filter_points;
  table.cut_patches = cut_patches;
}

}  // namespace pac
