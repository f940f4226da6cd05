// Points between surfaces: the filter of two of them in the halves of a register, or the mean of one.
#include <immintrin.h>

#include <cstddef>
#include <cstdint>

#include "base/kernels/warp_kernels.h"

namespace pac {
namespace {

#include "base/kernels/warp_avx2_memory_simd.inc"
#include "base/kernels/warp_avx2_taps_simd.inc"

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
      const __m256i unbounded = _mm256_srai_epi32(_mm256_add_epi32(all, _mm256_set1_epi32(512)), 10);
      const __m256i done = _mm256_min_epi32(_mm256_max_epi32(unbounded, _mm256_set1_epi32(-kLargestCarried)),
                                            _mm256_set1_epi32(kLargestCarried));
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

void fill_warp_edges_avx2(WarpKernels& table) {
  table.filter_edges = filter_edges;
  table.mean_edges = mean_edges;
}

}  // namespace pac
