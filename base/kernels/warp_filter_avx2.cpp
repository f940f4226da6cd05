// The filter takes two points in a register, or eight whose samples of one row are filtered down the columns together.
#include <immintrin.h>

#include <cstddef>
#include <cstdint>

#include "base/kernels/warp_kernels.h"

namespace pac {
namespace {

#include "base/kernels/warp_avx2_memory_simd.inc"
#include "base/kernels/warp_avx2_taps_simd.inc"

// Partial sums of points 2 i and 2 i + 1 in the halves of sums[i], finished and in order.
inline __m128i finish_eight(const __m256i sums[4]) {
  const __m256i all = _mm256_hadd_epi32(_mm256_hadd_epi32(sums[0], sums[1]), _mm256_hadd_epi32(sums[2], sums[3]));
  const __m256i done = _mm256_srai_epi32(_mm256_add_epi32(all, _mm256_set1_epi32(512)), 10);
  const __m128i even = _mm256_castsi256_si128(done), odd = _mm256_extracti128_si256(done, 1);
  return _mm_blend_epi16(even, _mm_slli_epi32(odd, 16), 0xAA);
}

// Two points anywhere.
inline __m256i filter_two(const int16_t* plane, ptrdiff_t stride, Taps taps, const int32_t* x, const int32_t* y) {
  const auto first = [&](int i) {
    return plane + ((y[i] >> 6) - kWarpTapsBefore) * stride + (x[i] >> 6) - kWarpTapsBefore;
  };
  const int16_t *a = first(0), *b = first(1);
  const __m256i ty = load_two(taps[y[0]], taps[y[1]]);
  const __m256i v = filter_down([&](int k) { return load_two(a + k * stride, b + k * stride); }, ty);
  return _mm256_madd_epi16(v, load_two(taps[x[0]], taps[x[1]]));
}

// Eight points anywhere. What is rare stays out of the loop and its registers.
[[gnu::noinline]] __m128i filter_apart(const int16_t* plane, ptrdiff_t stride, Taps taps, const int32_t* x,
                                       const int32_t* y) {
  __m256i sums[4];
  for (int i = 0; i < 4; ++i) sums[i] = filter_two(plane, stride, taps, x + 2 * i, y + 2 * i);
  return finish_eight(sums);
}

// Six rows of sixteen columns, pairs of them interleaved: columns 0..3 and 8..11, 4..7 and 12..15.
struct Patch {
  __m256i low[3], high[3];
};

// False where all of it is 0.
inline bool load_patch(const int16_t* first, ptrdiff_t stride, Patch& patch) {
  const __m256i rows[kWarpTaps] = {load_16(first),
                                   load_16(first + stride),
                                   load_16(first + 2 * stride),
                                   load_16(first + 3 * stride),
                                   load_16(first + 4 * stride),
                                   load_16(first + 5 * stride)};
  const __m256i any =
      _mm256_or_si256(_mm256_or_si256(_mm256_or_si256(rows[0], rows[1]), _mm256_or_si256(rows[2], rows[3])),
                      _mm256_or_si256(rows[4], rows[5]));
  if (_mm256_testz_si256(any, any) != 0) return false;
  for (int k = 0; k < 3; ++k) {
    patch.low[k] = _mm256_unpacklo_epi16(rows[2 * k], rows[2 * k + 1]);
    patch.high[k] = _mm256_unpackhi_epi16(rows[2 * k], rows[2 * k + 1]);
  }
  return true;
}

// Two coefficients in all lanes.
inline __m256i pair_of(const int16_t* taps, int k) {
  int32_t pair;
  __builtin_memcpy(&pair, taps + 2 * k, sizeof pair);
  return _mm256_set1_epi32(pair);
}

// v of sixteen columns.
inline __m256i filter_down(const Patch& patch, const int16_t* taps) {
  const __m256i t0 = pair_of(taps, 0), t1 = pair_of(taps, 1), t2 = pair_of(taps, 2), half = _mm256_set1_epi32(128);
  const auto sum = [&](const __m256i pairs[3]) {
    const __m256i a = _mm256_add_epi32(_mm256_madd_epi16(pairs[0], t0), _mm256_madd_epi16(pairs[1], t1));
    return _mm256_srai_epi32(_mm256_add_epi32(a, _mm256_add_epi32(_mm256_madd_epi16(pairs[2], t2), half)), 8);
  };
  return _mm256_packs_epi32(sum(patch.low), sum(patch.high));
}

// Three pairs of values a lane: columns or coefficients 0 and 1, 2 and 3, 4 and 5 of eight points.
struct Pairs {
  __m256i of[3];
};

// Of eight points one column apart, from sixteen columns on.
inline Pairs pairs_of_columns(__m256i v) {
  const __m256i from_0 = _mm256_permute4x64_epi64(v, 0x94), from_4 = _mm256_permute4x64_epi64(v, 0xE9);
  const __m256i first = _mm256_broadcastsi128_si256(_mm_setr_epi8(0, 1, 2, 3, 2, 3, 4, 5, 4, 5, 6, 7, 6, 7, 8, 9));
  const __m256i third =
      _mm256_broadcastsi128_si256(_mm_setr_epi8(4, 5, 6, 7, 6, 7, 8, 9, 8, 9, 10, 11, 10, 11, 12, 13));
  return {{_mm256_shuffle_epi8(from_0, first), _mm256_shuffle_epi8(from_0, third), _mm256_shuffle_epi8(from_4, first)}};
}

inline Pairs pairs_of_taps(Taps taps, const int32_t* x) {
  const __m256i a = load_two(taps[x[0]], taps[x[4]]), b = load_two(taps[x[1]], taps[x[5]]);
  const __m256i c = load_two(taps[x[2]], taps[x[6]]), d = load_two(taps[x[3]], taps[x[7]]);
  const __m256i ab = _mm256_unpacklo_epi32(a, b), cd = _mm256_unpacklo_epi32(c, d);
  return {{_mm256_unpacklo_epi64(ab, cd), _mm256_unpackhi_epi64(ab, cd),
           _mm256_unpacklo_epi64(_mm256_unpackhi_epi32(a, b), _mm256_unpackhi_epi32(c, d))}};
}

// Eight points one column apart, of two heights at most: the first one's, and the last one's where `is_last`.
inline __m128i filter_in_order(const Patch& patch, const Pairs& tx, Taps taps, const int32_t* y, __m256i is_last) {
  const Pairs first = pairs_of_columns(filter_down(patch, taps[y[0]]));
  const Pairs last = pairs_of_columns(filter_down(patch, taps[y[7]]));
  __m256i sum = _mm256_set1_epi32(512);
  for (int k = 0; k < 3; ++k)
    sum = _mm256_add_epi32(sum, _mm256_madd_epi16(_mm256_blendv_epi8(first.of[k], last.of[k], is_last), tx.of[k]));
  const __m256i done = _mm256_srai_epi32(sum, 10);
  return _mm_packs_epi32(_mm256_castsi256_si128(done), _mm256_extracti128_si256(done, 1));
}

// Eight points of any heights: each is filtered down by itself.
[[gnu::noinline]] __m128i filter_each(const int16_t* corner, ptrdiff_t stride, Taps taps, __m256i from_first,
                                      const int32_t* x, const int32_t* y) {
  Patch patch;
  if (!load_patch(corner, stride, patch)) return _mm_setzero_si128();
  alignas(32) int32_t pairs[3][16];
  alignas(32) int32_t at[8];
  store(at, from_first);
  for (int k = 0; k < 3; ++k) {
    store(pairs[k], _mm256_permute2x128_si256(patch.low[k], patch.high[k], 0x20));
    store(pairs[k] + 8, _mm256_permute2x128_si256(patch.low[k], patch.high[k], 0x31));
  }
  const auto down = [&](int i) {
    const int16_t* ty = taps[y[i]];
    __m256i sum = _mm256_set1_epi32(128);
    for (int k = 0; k < 3; ++k) sum = _mm256_add_epi32(sum, _mm256_madd_epi16(load(pairs[k] + at[i]), pair_of(ty, k)));
    return _mm256_srai_epi32(sum, 8);
  };
  // Two points: the lower halves of their sums' registers, then the upper ones.
  const auto two = [&](int i) {
    const __m128i a = load(taps[x[i]]), b = load(taps[x[i + 1]]);
    const __m256i tx = _mm256_set_m128i(_mm_unpackhi_epi64(a, b), _mm_unpacklo_epi64(a, b));
    const __m256i sums = _mm256_madd_epi16(_mm256_packs_epi32(down(i), down(i + 1)), tx);
    return _mm_add_epi32(_mm256_castsi256_si128(sums), _mm256_extracti128_si256(sums, 1));
  };
  const __m128i half = _mm_set1_epi32(512);
  const __m128i low = _mm_add_epi32(_mm_hadd_epi32(two(0), two(2)), half);
  const __m128i high = _mm_add_epi32(_mm_hadd_epi32(two(4), two(6)), half);
  return _mm_packs_epi32(_mm_srai_epi32(low, 10), _mm_srai_epi32(high, 10));
}

inline bool all(__m256i mask) {
  return _mm256_movemask_epi8(mask) == -1;
}

// Planes of one stride that are filtered at the same points, and what comes of eight of these.
template <int kPlanes>
struct Planes {
  const int16_t* of[kPlanes];
  ptrdiff_t stride;
};
template <int kPlanes>
struct Results {
  __m128i of[kPlanes];
};

template <int kPlanes>
[[gnu::always_inline]] inline Results<kPlanes> filter_eight(const Planes<kPlanes>& planes, Taps taps, const int32_t* x,
                                                            const int32_t* y) {
  Results<kPlanes> results;
  const ptrdiff_t stride = planes.stride;
  const __m256i heights = load(y), columns = _mm256_srai_epi32(load(x), 6), lines = _mm256_srai_epi32(heights, 6);
  const __m128i column = _mm256_castsi256_si128(columns), line = _mm256_castsi256_si128(lines);
  const __m256i from_first = _mm256_sub_epi32(columns, _mm256_broadcastd_epi32(column));
  const __m256i is_near = _mm256_cmpeq_epi32(_mm256_min_epu32(from_first, _mm256_set1_epi32(8)), from_first);
  const __m256i in_line = _mm256_cmpeq_epi32(lines, _mm256_broadcastd_epi32(line));
  if (!all(_mm256_and_si256(is_near, in_line))) {
    for (int k = 0; k < kPlanes; ++k) results.of[k] = filter_apart(planes.of[k], stride, taps, x, y);
    return results;
  }
  const ptrdiff_t row = _mm_cvtsi128_si32(line) - kWarpTapsBefore;
  const ptrdiff_t corner = row * stride + _mm_cvtsi128_si32(column) - kWarpTapsBefore;
  for (const int16_t* plane : planes.of)
    prefetch(plane, corner + (kWarpTaps + 1) * stride);  // of the next row's points
  const __m256i in_order = _mm256_cmpeq_epi32(from_first, _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7));
  const __m256i is_first = _mm256_cmpeq_epi32(heights, _mm256_set1_epi32(y[0]));
  const __m256i is_last = _mm256_cmpeq_epi32(heights, _mm256_set1_epi32(y[7]));
  if (!all(_mm256_and_si256(in_order, _mm256_or_si256(is_first, is_last)))) {
    for (int k = 0; k < kPlanes; ++k)
      results.of[k] = filter_each(planes.of[k] + corner, stride, taps, from_first, x, y);
    return results;
  }
  Pairs tx;
  if (kPlanes > 1) tx = pairs_of_taps(taps, x);
  for (int k = 0; k < kPlanes; ++k) {
    Patch patch;
    results.of[k] = _mm_setzero_si128();
    if (!load_patch(planes.of[k] + corner, stride, patch)) continue;
    if (kPlanes == 1) tx = pairs_of_taps(taps, x);
    results.of[k] = filter_in_order(patch, tx, taps, y, is_last);
  }
  return results;
}

// Eight points of which some are absent: they go where the first of the others is.
template <int kPlanes>
[[gnu::noinline]] Results<kPlanes> filter_present(const Planes<kPlanes>& planes, Taps taps, const int32_t* x,
                                                  const int32_t* y, uint64_t states) {
  const __m128i bytes = _mm_cvtsi64_si128(static_cast<long long>(states));
  const __m128i absent = _mm_cmpeq_epi8(bytes, _mm_setzero_si128());
  const __m256i absent_32 = _mm256_cvtepi8_epi32(absent);
  const int first = __builtin_ctzll(states) / 8;
  alignas(32) int32_t present_x[8], present_y[8];
  store(present_x, _mm256_blendv_epi8(load(x), _mm256_set1_epi32(x[first]), absent_32));
  store(present_y, _mm256_blendv_epi8(load(y), _mm256_set1_epi32(y[first]), absent_32));
  Results<kPlanes> results = filter_eight(planes, taps, present_x, present_y);
  for (__m128i& result : results.of) result = _mm_andnot_si128(_mm_cvtepi8_epi16(absent), result);
  return results;
}

template <int kPlanes>
inline Results<kPlanes> filter_group(const Planes<kPlanes>& planes, Taps taps, const int32_t* x, const int32_t* y,
                                     const uint8_t* state) {
  uint64_t states;
  __builtin_memcpy(&states, state, 8);
  if (states == 0) return {};
  // States are below 128: adding 127 sets the upper bits of those that are not 0.
  constexpr uint64_t kUpper = 0x8080808080808080u;
  if (((states + ~kUpper) & kUpper) != kUpper) return filter_present(planes, taps, x, y, states);
  return filter_eight(planes, taps, x, y);
}

inline __m128i limited(__m128i carried) {
  return _mm_min_epi16(_mm_max_epi16(carried, _mm_set1_epi16(-kLargestCarried)), _mm_set1_epi16(kLargestCarried));
}

template <int kPlanes>
inline void filter_planes(const Planes<kPlanes>& planes, Taps taps, const int32_t* x_64, const int32_t* y_64,
                          const uint8_t* state, size_t n, int16_t* const out[kPlanes]) {
  size_t i = 0;
  for (; i + 8 <= n; i += 8) {
    const Results<kPlanes> results = filter_group(planes, taps, x_64 + i, y_64 + i, state + i);
    for (int k = 0; k < kPlanes; ++k) _mm_storeu_si128(reinterpret_cast<__m128i*>(out[k] + i), limited(results.of[k]));
  }
  if (i == n) return;
  int32_t last_x[8] = {}, last_y[8] = {};
  uint8_t last_state[8] = {};
  __builtin_memcpy(last_x, x_64 + i, (n - i) * 4);
  __builtin_memcpy(last_y, y_64 + i, (n - i) * 4);
  __builtin_memcpy(last_state, state + i, n - i);
  const Results<kPlanes> results = filter_group(planes, taps, last_x, last_y, last_state);
  for (int k = 0; k < kPlanes; ++k) {
    const __m128i last = limited(results.of[k]);
    __builtin_memcpy(out[k] + i, &last, (n - i) * sizeof(int16_t));
  }
}

void filter_points(const int16_t* plane, ptrdiff_t stride, const int16_t* table, const int32_t* x_64,
                   const int32_t* y_64, const uint8_t* state, size_t n, int16_t* out) {
  filter_planes<1>({{plane}, stride}, {table}, x_64, y_64, state, n, &out);
}

void filter_both(const int16_t* const planes[2], ptrdiff_t stride, const int16_t* table, const int32_t* x_64,
                 const int32_t* y_64, const uint8_t* state, size_t n, int16_t* const out[2]) {
  filter_planes<2>({{planes[0], planes[1]}, stride}, {table}, x_64, y_64, state, n, out);
}

}  // namespace

void fill_warp_filters_avx2(WarpKernels& table) {
  table.filter_points = filter_points;
  table.filter_both = filter_both;
}

}  // namespace pac
