// The filter takes two points in a register, or eight whose samples of one row are filtered down the columns together.
#include <immintrin.h>

#include <cstddef>
#include <cstdint>

#include "base/kernels/warp_kernels.h"

namespace pac {
namespace {

#include "base/kernels/warp_avx2_memory_simd.inc"

inline __m256i load_two(const int16_t* low, const int16_t* high) {
  return _mm256_inserti128_si256(_mm256_castsi128_si256(load(low)), load(high), 1);
}

// Six rows down the columns, 16 bits of result: v of the contract. rows(k): row k; ty: the coefficients, in each half.
template <class Rows>
inline __m256i filter_down(const Rows& rows, __m256i ty) {
  __m256i low = _mm256_set1_epi32(128), high = low;
  const auto add_pair = [&](int k, __m256i pair) {
    const __m256i a = rows(k), b = rows(k + 1);
    low = _mm256_add_epi32(low, _mm256_madd_epi16(_mm256_unpacklo_epi16(a, b), pair));
    high = _mm256_add_epi32(high, _mm256_madd_epi16(_mm256_unpackhi_epi16(a, b), pair));
  };
  add_pair(0, _mm256_shuffle_epi32(ty, 0x00));
  add_pair(2, _mm256_shuffle_epi32(ty, 0x55));
  add_pair(4, _mm256_shuffle_epi32(ty, 0xAA));
  return _mm256_packs_epi32(_mm256_srai_epi32(low, 8), _mm256_srai_epi32(high, 8));
}

// By positions in 1/64.
struct Taps {
  const int16_t* table;
  const int16_t* operator[](int32_t position) const { return table + kWarpTapStride * (position & (kWarpPhases - 1)); }
  const int16_t* of_phase(uint32_t phase) const { return table + size_t{kWarpTapStride} * phase; }
};

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
inline __m128i filter_in_order(const Patch& patch, Taps taps, const int32_t* x, const int32_t* y, __m256i is_last) {
  const Pairs first = pairs_of_columns(filter_down(patch, taps[y[0]]));
  const Pairs last = pairs_of_columns(filter_down(patch, taps[y[7]]));
  const Pairs tx = pairs_of_taps(taps, x);
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

inline __m128i filter_eight(const int16_t* plane, ptrdiff_t stride, Taps taps, const int32_t* x, const int32_t* y) {
  const __m256i heights = load(y), columns = _mm256_srai_epi32(load(x), 6), lines = _mm256_srai_epi32(heights, 6);
  const __m128i column = _mm256_castsi256_si128(columns), line = _mm256_castsi256_si128(lines);
  const __m256i from_first = _mm256_sub_epi32(columns, _mm256_broadcastd_epi32(column));
  const __m256i is_near = _mm256_cmpeq_epi32(_mm256_min_epu32(from_first, _mm256_set1_epi32(8)), from_first);
  const __m256i in_line = _mm256_cmpeq_epi32(lines, _mm256_broadcastd_epi32(line));
  if (!all(_mm256_and_si256(is_near, in_line))) return filter_apart(plane, stride, taps, x, y);
  const ptrdiff_t row = _mm_cvtsi128_si32(line) - kWarpTapsBefore;
  const int16_t* first = plane + row * stride + _mm_cvtsi128_si32(column) - kWarpTapsBefore;
  prefetch(first, (kWarpTaps + 1) * stride);  // of the next row's points
  const __m256i in_order = _mm256_cmpeq_epi32(from_first, _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7));
  const __m256i is_first = _mm256_cmpeq_epi32(heights, _mm256_set1_epi32(y[0]));
  const __m256i is_last = _mm256_cmpeq_epi32(heights, _mm256_set1_epi32(y[7]));
  if (!all(_mm256_and_si256(in_order, _mm256_or_si256(is_first, is_last))))
    return filter_each(first, stride, taps, from_first, x, y);
  Patch patch;
  if (!load_patch(first, stride, patch)) return _mm_setzero_si128();
  return filter_in_order(patch, taps, x, y, is_last);
}

// Eight points of which some are absent: they go where the first of the others is.
[[gnu::noinline]] __m128i filter_present(const int16_t* plane, ptrdiff_t stride, Taps taps, const int32_t* x,
                                         const int32_t* y, uint64_t states) {
  const __m128i bytes = _mm_cvtsi64_si128(static_cast<long long>(states));
  const __m128i absent = _mm_cmpeq_epi8(bytes, _mm_setzero_si128());
  const __m256i absent_32 = _mm256_cvtepi8_epi32(absent);
  const int first = __builtin_ctzll(states) / 8;
  alignas(32) int32_t present_x[8], present_y[8];
  store(present_x, _mm256_blendv_epi8(load(x), _mm256_set1_epi32(x[first]), absent_32));
  store(present_y, _mm256_blendv_epi8(load(y), _mm256_set1_epi32(y[first]), absent_32));
  return _mm_andnot_si128(_mm_cvtepi8_epi16(absent), filter_eight(plane, stride, taps, present_x, present_y));
}

inline __m128i filter_group(const int16_t* plane, ptrdiff_t stride, Taps taps, const int32_t* x, const int32_t* y,
                            const uint8_t* state) {
  uint64_t states;
  __builtin_memcpy(&states, state, 8);
  if (states == 0) return _mm_setzero_si128();
  // States are below 128: adding 127 sets the upper bits of those that are not 0.
  constexpr uint64_t kUpper = 0x8080808080808080u;
  if (((states + ~kUpper) & kUpper) != kUpper) return filter_present(plane, stride, taps, x, y, states);
  return filter_eight(plane, stride, taps, x, y);
}

void filter_points(const int16_t* plane, ptrdiff_t stride, const int16_t* table, const int32_t* x_64,
                   const int32_t* y_64, const uint8_t* state, size_t n, int16_t* out) {
  const Taps taps{table};
  size_t i = 0;
  for (; i + 8 <= n; i += 8)
    _mm_storeu_si128(reinterpret_cast<__m128i*>(out + i),
                     filter_group(plane, stride, taps, x_64 + i, y_64 + i, state + i));
  if (i == n) return;
  int32_t last_x[8] = {}, last_y[8] = {};
  uint8_t last_state[8] = {};
  int16_t last_out[8];
  __builtin_memcpy(last_x, x_64 + i, (n - i) * 4);
  __builtin_memcpy(last_y, y_64 + i, (n - i) * 4);
  __builtin_memcpy(last_state, state + i, n - i);
  _mm_storeu_si128(reinterpret_cast<__m128i*>(last_out), filter_group(plane, stride, taps, last_x, last_y, last_state));
  __builtin_memcpy(out + i, last_out, (n - i) * sizeof(int16_t));
}

// ---- Points between surfaces ----

// The columns of edges, kBlock at a time: do_edges(columns, how many).
template <class DoEdges>
inline void for_edges(const uint8_t* state, size_t n, const DoEdges& do_edges) {
  constexpr size_t kBlock = 256;
  uint32_t columns[kBlock];
  for (size_t first = 0; first < n; first += kBlock) {
    const size_t end = first + kBlock < n ? first + kBlock : n;
    size_t n_edges = 0;
    for (size_t i = first; i < end; i += 8) {
      uint64_t states = 0;
      if (end - i >= 8)
        __builtin_memcpy(&states, state + i, 8);
      else
        __builtin_memcpy(&states, state + i, end - i);
      static_assert(kWarpAbsent == 0 && kWarpEdge == 1 && kWarpPlain == 2);
      for (uint64_t edges = states & 0x0101010101010101u; edges != 0; edges &= edges - 1)
        columns[n_edges++] = static_cast<uint32_t>(i) + static_cast<uint32_t>(__builtin_ctzll(edges) / 8);
    }
    if (n_edges > 0) do_edges(columns, n_edges);
  }
}

// Lanes of 0xFFFFFFFF where keys belong to the wanted one; 16-bit ones, of two times eight keys.
inline __m256i belongs(__m256i keys, __m256i wanted) {
  const __m256i apart = _mm256_sub_epi32(_mm256_and_si256(keys, _mm256_set1_epi32(static_cast<int>(kKeyBits))), wanted);
  const __m256i from_low = _mm256_add_epi32(apart, _mm256_set1_epi32(kKeyTolerance));
  return _mm256_cmpeq_epi32(_mm256_min_epu32(from_low, _mm256_set1_epi32(2 * kKeyTolerance)), from_low);
}
inline __m256i belong(const uint32_t* a, __m256i wanted_a, const uint32_t* b, __m256i wanted_b) {
  const __m256i both = _mm256_packs_epi32(belongs(load(a), wanted_a), belongs(load(b), wanted_b));
  return _mm256_permute4x64_epi64(both, 0xD8);
}

// The bilinear weights of the four samples around a point, the upper two first, 16 bits each.
inline uint64_t weights_at(uint32_t phase_x, uint32_t phase_y) {
  const uint32_t across = (kWarpPhases - phase_x) | phase_x << 16;
  return across * (kWarpPhases - phase_y) | uint64_t{across * phase_y} << 32;
}

inline int32_t sum_of_two(long long pair) {
  return static_cast<int32_t>(static_cast<uint32_t>(pair) + static_cast<uint32_t>(static_cast<uint64_t>(pair) >> 32));
}

// Rounded to nearest, halves away from 0.
inline int16_t divided(int32_t sum, int32_t by) {
  constexpr int32_t kAll = kWarpPhases * kWarpPhases;
  const int32_t sign = sum >> 31, size = (sum ^ sign) - sign;
  const int32_t mean = by == kAll ? (size + kAll / 2) / kAll : (size + by / 2) / by;
  return static_cast<int16_t>((mean ^ sign) - sign);
}

struct EdgePoint {
  ptrdiff_t x, y;
  uint32_t phase_x, phase_y, wanted;
};

inline EdgePoint edge_point(const WarpPlaces& places, uint32_t i) {
  const int32_t x = places.x_64[i], y = places.y_64[i];
  return {x >> 6, y >> 6, static_cast<uint32_t>(x) % kWarpPhases, static_cast<uint32_t>(y) % kWarpPhases,
          places.wanted[i]};
}

// Two points, in the halves of registers.
struct EdgePair {
  __m256i masks[kWarpTaps], samples[kWarpTaps];
};

// Their means: false where nothing of the half's point is shown.
struct EdgeMeans {
  int16_t mean[2];
  bool is_shown[2];
};

inline EdgeMeans means_of(const EdgePair& pair, uint64_t weights_a, uint64_t weights_b) {
  // The four samples around the point: lanes 2 and 3 of rows 2 and 3, then the second quarter of the half.
  const __m256i mask = _mm256_unpacklo_epi32(pair.masks[2], pair.masks[3]);
  const __m256i samples = _mm256_unpacklo_epi32(pair.samples[2], pair.samples[3]);
  const auto a = static_cast<long long>(weights_a), b = static_cast<long long>(weights_b);
  const __m256i weights = _mm256_and_si256(mask, _mm256_setr_epi64x(0, a, 0, b));
  const __m256i sums = _mm256_madd_epi16(weights, samples), by = _mm256_madd_epi16(weights, _mm256_set1_epi16(1));
  const int32_t by_a = sum_of_two(_mm256_extract_epi64(by, 1)), by_b = sum_of_two(_mm256_extract_epi64(by, 3));
  EdgeMeans means = {{0, 0}, {by_a != 0, by_b != 0}};
  if (by_a != 0) means.mean[0] = divided(sum_of_two(_mm256_extract_epi64(sums, 1)), by_a);
  if (by_b != 0) means.mean[1] = divided(sum_of_two(_mm256_extract_epi64(sums, 3)), by_b);
  return means;
}

size_t filter_edges(const int16_t* plane, ptrdiff_t stride, const KeyMap& map, const int16_t* table,
                    const WarpPlaces& places, size_t n, int16_t* out) {
  const Taps taps{table};
  size_t lost = 0;
  for_edges(places.state, n, [&](const uint32_t* columns, size_t n_edges) {
    for (size_t i = 0; i < n_edges; i += 2) {
      const uint32_t column_a = columns[i], column_b = columns[i + 1 < n_edges ? i + 1 : i];
      const EdgePoint a = edge_point(places, column_a), b = edge_point(places, column_b);
      const auto sample_at = [&](const EdgePoint& p) {
        return plane + (p.y - kWarpTapsBefore) * stride + p.x - kWarpTapsBefore;
      };
      const auto key_at = [&](const EdgePoint& p) {
        return map.keys + (p.y - kWarpTapsBefore) * map.stride + p.x - kWarpTapsBefore;
      };
      const int16_t *samples_a = sample_at(a), *samples_b = sample_at(b);
      const uint32_t *keys_a = key_at(a), *keys_b = key_at(b);
      const __m256i wanted_a = _mm256_set1_epi32(static_cast<int>(a.wanted));
      const __m256i wanted_b = _mm256_set1_epi32(static_cast<int>(b.wanted));
      EdgePair pair;
      for (int k = 0; k < kWarpTaps; ++k) {
        pair.masks[k] = belong(keys_a + k * map.stride, wanted_a, keys_b + k * map.stride, wanted_b);
        pair.samples[k] = load_two(samples_a + k * stride, samples_b + k * stride);
      }
      const EdgeMeans means = means_of(pair, weights_at(a.phase_x, a.phase_y), weights_at(b.phase_x, b.phase_y));
      const __m256i stand_in = _mm256_inserti128_si256(_mm256_castsi128_si256(_mm_set1_epi16(means.mean[0])),
                                                       _mm_set1_epi16(means.mean[1]), 1);
      const auto rows = [&](int k) { return _mm256_blendv_epi8(stand_in, pair.samples[k], pair.masks[k]); };
      const __m256i v = filter_down(rows, load_two(taps.of_phase(a.phase_y), taps.of_phase(b.phase_y)));
      const __m256i sums = _mm256_madd_epi16(v, load_two(taps.of_phase(a.phase_x), taps.of_phase(b.phase_x)));
      const __m256i pairs = _mm256_hadd_epi32(sums, sums), all = _mm256_hadd_epi32(pairs, pairs);
      const __m256i done = _mm256_srai_epi32(_mm256_add_epi32(all, _mm256_set1_epi32(512)), 10);
      out[column_a] = means.is_shown[0] ? static_cast<int16_t>(_mm256_extract_epi32(done, 0)) : int16_t{0};
      lost += !means.is_shown[0];
      if (i + 1 == n_edges) continue;
      out[column_b] = means.is_shown[1] ? static_cast<int16_t>(_mm256_extract_epi32(done, 4)) : int16_t{0};
      lost += !means.is_shown[1];
    }
  });
  return lost;
}

// Four samples around a point: two of each row.
inline __m128i load_four(const int16_t* above, const int16_t* below) {
  int32_t two[2];
  __builtin_memcpy(&two[0], above, 4);
  __builtin_memcpy(&two[1], below, 4);
  return _mm_insert_epi32(_mm_cvtsi32_si128(two[0]), two[1], 1);
}
inline __m128i load_four(const uint32_t* above, const uint32_t* below) {
  return _mm_unpacklo_epi64(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(above)),
                            _mm_loadl_epi64(reinterpret_cast<const __m128i*>(below)));
}

size_t mean_edges(const int16_t* const planes[2], ptrdiff_t stride, const KeyMap& map, const WarpPlaces& places,
                  size_t n, int16_t* const out[2]) {
  size_t lost = 0;
  for_edges(places.state, n, [&](const uint32_t* columns, size_t n_edges) {
    for (size_t i = 0; i < n_edges; ++i) {
      const uint32_t column = columns[i];
      const EdgePoint at = edge_point(places, column);
      const uint32_t* key = map.keys + at.y * map.stride + at.x;
      const __m128i keys = _mm_and_si128(load_four(key, key + map.stride), _mm_set1_epi32(static_cast<int>(kKeyBits)));
      const __m128i from_low = _mm_add_epi32(_mm_sub_epi32(keys, _mm_set1_epi32(static_cast<int>(at.wanted))),
                                             _mm_set1_epi32(kKeyTolerance));
      const __m128i mask = _mm_cmpeq_epi32(_mm_min_epu32(from_low, _mm_set1_epi32(2 * kKeyTolerance)), from_low);
      const auto all = static_cast<long long>(weights_at(at.phase_x, at.phase_y));
      const __m128i weights = _mm_and_si128(_mm_packs_epi32(mask, mask), _mm_set1_epi64x(all));
      const ptrdiff_t offset = at.y * stride + at.x;
      const int16_t *u = planes[0] + offset, *v = planes[1] + offset;
      const __m128i samples = _mm_unpacklo_epi64(load_four(u, u + stride), load_four(v, v + stride));
      const __m128i sums = _mm_madd_epi16(weights, samples), by = _mm_madd_epi16(weights, _mm_set1_epi16(1));
      const int32_t sum_of_weights = sum_of_two(_mm_cvtsi128_si64(by));
      lost += sum_of_weights == 0;
      out[0][column] = sum_of_weights == 0 ? int16_t{0} : divided(sum_of_two(_mm_cvtsi128_si64(sums)), sum_of_weights);
      out[1][column] =
          sum_of_weights == 0 ? int16_t{0} : divided(sum_of_two(_mm_extract_epi64(sums, 1)), sum_of_weights);
    }
  });
  return lost;
}

}  // namespace

void fill_warp_filters_avx2(WarpKernels& table) {
  table.filter_points = filter_points;
  table.filter_edges = filter_edges;
  table.mean_edges = mean_edges;
}

}  // namespace pac
