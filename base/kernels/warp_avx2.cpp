// Eight pixels at a time: where they were and what is smooth. The filters: warp_filter_avx2.cpp.
#include <immintrin.h>

#include <cstddef>
#include <cstdint>

#include "base/kernels/warp_kernels.h"

namespace pac {
namespace {

#include "base/kernels/warp_avx2_memory_simd.inc"

// ---- Places ----

inline __m256 coordinate(const ReprojectionRow& row, int c, __m256 column, __m256 u) {
  return _mm256_add_ps(
      _mm256_add_ps(_mm256_set1_ps(row.origin[c]), _mm256_mul_ps(column, _mm256_set1_ps(row.per_pixel[c]))),
      _mm256_mul_ps(u, _mm256_set1_ps(row.per_depth[c])));
}

inline __m256i in_64ths(__m256 position, __m256 somewhere) {
  const __m256 largest = _mm256_set1_ps(262144.0f);
  const __m256 clamped = _mm256_max_ps(_mm256_min_ps(position, largest), _mm256_sub_ps(_mm256_setzero_ps(), largest));
  const __m256 rounded =
      _mm256_floor_ps(_mm256_add_ps(_mm256_mul_ps(clamped, _mm256_set1_ps(64.0f)), _mm256_set1_ps(0.5f)));
  return _mm256_blendv_epi8(_mm256_set1_epi32(kWarpNowhere), _mm256_cvtps_epi32(rounded),
                            _mm256_castps_si256(somewhere));
}

struct Eight {
  __m256i x_64, y_64;
  __m256 u;
};

inline Eight reproject(const ReprojectionRow& row, __m256 column, __m256 depth) {
  const __m256 u = _mm256_sub_ps(_mm256_set1_ps(1.0f), depth);
  const __m256 w = coordinate(row, 3, column, u);
  const __m256 x = _mm256_div_ps(coordinate(row, 0, column, u), w);
  const __m256 y = _mm256_div_ps(coordinate(row, 1, column, u), w);
  const __m256 before = _mm256_div_ps(coordinate(row, 2, column, u), w);
  const __m256 numbers = _mm256_and_ps(_mm256_cmp_ps(x, y, _CMP_ORD_Q), _mm256_cmp_ps(before, before, _CMP_ORD_Q));
  const __m256 somewhere = _mm256_and_ps(_mm256_cmp_ps(w, _mm256_set1_ps(8.6736174e-19f), _CMP_GT_OQ), numbers);
  return {in_64ths(x, somewhere), in_64ths(y, somewhere), _mm256_and_ps(before, somewhere)};
}

inline __m256 first_columns() {
  return _mm256_setr_ps(0, 1, 2, 3, 4, 5, 6, 7);
}

void reproject_row(const ReprojectionRow& row, const float* depth, size_t n, int32_t* x_64, int32_t* y_64,
                   float* u_before) {
  __m256 column = first_columns();
  const auto eight = [&](const float* z, int32_t* x, int32_t* y, float* u) {
    const Eight at = reproject(row, column, _mm256_loadu_ps(z));
    store(x, at.x_64);
    store(y, at.y_64);
    _mm256_storeu_ps(u, at.u);
  };
  size_t i = 0;
  for (; i + 8 <= n; i += 8) {
    eight(depth + i, x_64 + i, y_64 + i, u_before + i);
    column = _mm256_add_ps(column, _mm256_set1_ps(8.0f));  // exact below 2^24
  }
  if (i == n) return;
  float last_depth[8] = {}, last_u[8];
  int32_t last_x[8], last_y[8];
  __builtin_memcpy(last_depth, depth + i, (n - i) * sizeof(float));
  eight(last_depth, last_x, last_y, last_u);
  __builtin_memcpy(x_64 + i, last_x, (n - i) * sizeof(int32_t));
  __builtin_memcpy(y_64 + i, last_y, (n - i) * sizeof(int32_t));
  __builtin_memcpy(u_before + i, last_u, (n - i) * sizeof(float));
}

// The maximum of equal zeros is its second operand: no -0.
inline __m256i depth_code(__m256 u) {
  const __m256 bounded = _mm256_min_ps(_mm256_max_ps(u, _mm256_setzero_ps()), _mm256_set1_ps(1.9921875f));
  return _mm256_srli_epi32(_mm256_castps_si256(bounded), 16);
}

// Ids to surfaces in the upper halves.
struct SurfaceTable {
  static constexpr bool kBackgroundIsZero = false;
  const int* surfaces;
  __m256i last;
  __m256i operator()(__m256i ids) const {
    const __m256i known = _mm256_cmpeq_epi32(_mm256_min_epu32(ids, last), ids);
    return _mm256_slli_epi32(
        _mm256_mask_i32gather_epi32(_mm256_setzero_si256(), surfaces, _mm256_and_si256(ids, known), known, 4), 16);
  }
};
struct OneSurface {
  static constexpr bool kBackgroundIsZero = true;
  __m256i operator()(__m256i ids) const {
    return _mm256_andnot_si256(_mm256_cmpeq_epi32(ids, _mm256_setzero_si256()), _mm256_set1_epi32(1 << 16));
  }
};

// Whoever maps a row piece by piece finds the next piece in the cache.
constexpr ptrdiff_t kAhead = 160;

template <class Surfaces>
inline void surface_keys_row(const uint32_t* id, const float* depth, const Surfaces& surfaces, size_t n,
                             uint32_t* keys) {
  const auto eight = [&](const uint32_t* ids, const float* z) {
    const __m256i shown = load(ids);
    if (_mm256_testz_si256(shown, shown) != 0 && Surfaces::kBackgroundIsZero) return shown;
    const __m256i surface = surfaces(shown);
    const __m256 u = _mm256_sub_ps(_mm256_set1_ps(1.0f), _mm256_loadu_ps(z));
    const __m256i background = _mm256_cmpeq_epi32(surface, _mm256_setzero_si256());
    return _mm256_or_si256(surface, _mm256_andnot_si256(background, depth_code(u)));
  };
  size_t i = 0;
  for (; i + 8 <= n; i += 8) {
    prefetch(id + i, kAhead);
    prefetch(depth + i, kAhead);
    store(keys + i, eight(id + i, depth + i));
  }
  if (i == n) return;
  uint32_t last_id[8] = {}, last_keys[8];
  float last_depth[8] = {};
  __builtin_memcpy(last_id, id + i, (n - i) * sizeof(uint32_t));
  __builtin_memcpy(last_depth, depth + i, (n - i) * sizeof(float));
  store(last_keys, eight(last_id, last_depth));
  __builtin_memcpy(keys + i, last_keys, (n - i) * sizeof(uint32_t));
}

void surface_keys_row(const uint32_t* id, const float* depth, const uint32_t* surfaces, size_t n_surfaces, size_t n,
                      uint32_t* keys) {
  if (surfaces == nullptr) return surface_keys_row(id, depth, OneSurface{}, n, keys);
  // Indices of the gather are signed.
  const size_t count = n_surfaces < 0x7FFFFFFF ? n_surfaces : 0x7FFFFFFF;
  const SurfaceTable table{reinterpret_cast<const int*>(surfaces), _mm256_set1_epi32(static_cast<int>(count - 1))};
  surface_keys_row(id, depth, table, n, keys);
}

struct Lookup {
  const int* keys;
  __m256i width_64, height_64, map_stride;
  ptrdiff_t stride;
};

// 0xFFFFFFFF where keys without their smooth bits belong to the wanted ones.
inline __m256i belongs(__m256i key, __m256i wanted) {
  const __m256i apart = _mm256_sub_epi32(_mm256_and_si256(key, _mm256_set1_epi32(static_cast<int>(kKeyBits))), wanted);
  const __m256i from_low = _mm256_add_epi32(apart, _mm256_set1_epi32(kKeyTolerance));
  return _mm256_cmpeq_epi32(_mm256_min_epu32(from_low, _mm256_set1_epi32(2 * kKeyTolerance)), from_low);
}

inline __m256i in_range(__m256i position_64, __m256i end_64) {
  const __m256i near = _mm256_add_epi32(position_64, _mm256_set1_epi32(kWarpPhases / 2));
  return _mm256_and_si256(_mm256_cmpgt_epi32(near, _mm256_set1_epi32(-1)), _mm256_cmpgt_epi32(end_64, near));
}

inline __m256i ramp() {
  return _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
}

inline size_t count_of(__m256i mask) {
  return static_cast<size_t>(__builtin_popcount(static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps(mask)))));
}

// Eight states, and how many are plain and edges.
inline void find_states(const Lookup& before, __m256i x, __m256i y, __m256i wanted, uint8_t* state,
                        WarpCounts& counts) {
  const __m256i background = _mm256_cmpeq_epi32(wanted, _mm256_setzero_si256());
  const __m256i inside =
      _mm256_andnot_si256(background, _mm256_and_si256(in_range(x, before.width_64), in_range(y, before.height_64)));
  const __m256i column = _mm256_srai_epi32(x, 6), line = _mm256_srai_epi32(y, 6);
  const __m256i index = _mm256_add_epi32(_mm256_mullo_epi32(line, before.map_stride), column);
  const int32_t start = _mm_cvtsi128_si32(_mm256_castsi256_si128(index));
  const __m256i in_order =
      _mm256_and_si256(inside, _mm256_cmpeq_epi32(index, _mm256_add_epi32(_mm256_set1_epi32(start), ramp())));
  // A gather takes long, and most often the eight lie side by side.
  const __m256i key = _mm256_movemask_epi8(in_order) == -1
                          ? _mm256_loadu_si256(reinterpret_cast<const __m256i*>(before.keys + start))
                          : _mm256_mask_i32gather_epi32(_mm256_setzero_si256(), before.keys, index, inside, 4);
  prefetch(before.keys, start + 4 * before.stride);  // of the next row's edges
  const __m256i smooth = _mm256_srai_epi32(_mm256_slli_epi32(key, 17), 31);
  const __m256i plain = _mm256_and_si256(smooth, belongs(key, wanted));
  const __m256i states = _mm256_sub_epi32(_mm256_setzero_si256(), _mm256_add_epi32(plain, inside));
  const __m128i words = _mm_packus_epi32(_mm256_castsi256_si128(states), _mm256_extracti128_si256(states, 1));
  _mm_storel_epi64(reinterpret_cast<__m128i*>(state), _mm_packus_epi16(words, words));
  const size_t n_plain = count_of(plain);
  counts.plain += n_plain;
  counts.edges += count_of(inside) - n_plain;
}

inline Lookup lookup_in(const KeyMap& map) {
  return {reinterpret_cast<const int*>(map.keys), _mm256_set1_epi32(map.width * kWarpPhases),
          _mm256_set1_epi32(map.height * kWarpPhases), _mm256_set1_epi32(static_cast<int>(map.stride)), map.stride};
}

inline void store_nothing(const WarpPlaces& out) {
  store(out.x_64, _mm256_set1_epi32(kWarpNowhere));
  store(out.y_64, _mm256_set1_epi32(kWarpNowhere));
  store(out.wanted, _mm256_setzero_si256());
  _mm_storel_epi64(reinterpret_cast<__m128i*>(out.state), _mm_setzero_si128());
}

// Eight at a time by eight(i, out); the last few of them through copies.
template <class DoEight>
inline void by_eight(size_t n, const WarpPlaces& out, const DoEight& eight) {
  size_t i = 0;
  for (; i + 8 <= n; i += 8) eight(i, {out.x_64 + i, out.y_64 + i, out.state + i, out.wanted + i});
  if (i == n) return;
  int32_t x[8], y[8];
  uint8_t state[8];
  uint32_t wanted[8];
  eight(i, {x, y, state, wanted});
  const size_t rest = n - i;
  __builtin_memcpy(out.x_64 + i, x, rest * 4);
  __builtin_memcpy(out.y_64 + i, y, rest * 4);
  __builtin_memcpy(out.state + i, state, rest);
  __builtin_memcpy(out.wanted + i, wanted, rest * 4);
}

// `n` of eight values, then zeros.
inline __m256i load_some(const void* from, size_t n) {
  if (n >= 8) return _mm256_loadu_si256(static_cast<const __m256i*>(from));
  alignas(32) int32_t some[8] = {};
  __builtin_memcpy(some, from, n * 4);
  return load(some);
}

WarpCounts find_points(const ReprojectionRow& row, size_t first, const float* depth, const uint32_t* now,
                       const KeyMap& map, size_t n, const WarpPlaces& out) {
  const Lookup before = lookup_in(map);
  WarpCounts counts = {};
  by_eight(n, out, [&](size_t i, const WarpPlaces& to) {
    const __m256i keys = load_some(now + i, n - i);
    const __m256i surface = _mm256_and_si256(keys, _mm256_set1_epi32(static_cast<int>(kKeySurfaceBits)));
    if (_mm256_testz_si256(surface, surface) != 0) return store_nothing(to);
    const __m256 column =
        _mm256_add_ps(_mm256_set1_ps(static_cast<float>(static_cast<int32_t>(first + i))), first_columns());
    const Eight at = reproject(row, column, _mm256_castsi256_ps(load_some(depth + i, n - i)));
    const __m256i background = _mm256_cmpeq_epi32(surface, _mm256_setzero_si256());
    const __m256i nowhere = _mm256_set1_epi32(kWarpNowhere);
    const __m256i x = _mm256_blendv_epi8(at.x_64, nowhere, background);
    const __m256i y = _mm256_blendv_epi8(at.y_64, nowhere, background);
    const __m256i wanted = _mm256_andnot_si256(background, _mm256_or_si256(surface, depth_code(at.u)));
    store(to.x_64, x);
    store(to.y_64, y);
    store(to.wanted, wanted);
    find_states(before, x, y, wanted, to.state, counts);
  });
  return counts;
}

// Of sixteen values, or of twice `n`, every second.
template <class T>
inline __m256i load_seconds(const T* from, size_t n) {
  const __m256i low = load_some(from, 2 * n), high = n > 4 ? load_some(from + 8, 2 * n - 8) : _mm256_setzero_si256();
  const __m256 mixed = _mm256_shuffle_ps(_mm256_castsi256_ps(low), _mm256_castsi256_ps(high), 0x88);
  return _mm256_permute4x64_epi64(_mm256_castps_si256(mixed), 0xD8);
}

WarpCounts find_half_points(const WarpPlaces& full, const KeyMap& map, size_t n, const WarpPlaces& out) {
  const Lookup before = lookup_in(map);
  WarpCounts counts = {};
  by_eight(n, out, [&](size_t i, const WarpPlaces& to) {
    const __m256i wanted = load_seconds(full.wanted + 2 * i, n - i);
    const __m256i x = _mm256_srai_epi32(load_seconds(full.x_64 + 2 * i, n - i), 1);
    const __m256i y = _mm256_srai_epi32(load_seconds(full.y_64 + 2 * i, n - i), 1);
    store(to.x_64, x);
    store(to.y_64, y);
    store(to.wanted, wanted);
    if (_mm256_testz_si256(wanted, wanted) != 0) {
      _mm_storel_epi64(reinterpret_cast<__m128i*>(to.state), _mm_setzero_si128());
      return;
    }
    find_states(before, x, y, wanted, to.state, counts);
  });
  return counts;
}

// ---- What is smooth ----

// Bits of lanes whose keys do not belong together.
inline unsigned apart(__m256i a, __m256i b) {
  const __m256i from_low = _mm256_add_epi32(_mm256_sub_epi32(a, b), _mm256_set1_epi32(kKeyTolerance));
  const __m256i together =
      _mm256_cmpeq_epi32(_mm256_min_epu32(from_low, _mm256_set1_epi32(2 * kKeyTolerance)), from_low);
  return 0xFFu ^ static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps(together)));
}

void compare_keys(const uint32_t* above, const uint32_t* here, size_t n, uint64_t* right, uint64_t* down) {
  for (size_t first = 0; first < n; first += 64) {
    uint64_t to_right = 0, to_below = 0;
    const size_t end = first + 64 < n ? first + 64 : n;
    size_t i = first;
    for (; i + 8 <= end; i += 8) {
      const __m256i keys = load(here + i);
      to_right |= uint64_t{apart(keys, load(here + i + 1))} << (i - first);
      to_below |= uint64_t{apart(keys, load(above + i))} << (i - first);
    }
    if (i < end) {
      const uint64_t inside = (uint64_t{1} << (end - i)) - 1;
      const __m256i keys = load_some(here + i, end - i);
      to_right |= (apart(keys, load_some(here + i + 1, end - i)) & inside) << (i - first);
      to_below |= (apart(keys, load_some(above + i, end - i)) & inside) << (i - first);
    }
    if (end == n) to_right &= ~(uint64_t{1} << (n - 1 - first));
    right[first / 64] = to_right;
    down[first / 64] = to_below;
  }
}

void mark_smooth(const uint64_t* mixed, size_t n, uint32_t* keys) {
  const __m256i bit = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
  size_t i = 0;
  for (; i + 8 <= n; i += 8) {
    const auto eight = static_cast<int>(mixed[i / 64] >> i % 64 & 0xFF);
    if (eight == 0xFF) continue;
    const __m256i is_mixed = _mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32(eight), bit), bit);
    const __m256i smooth = _mm256_andnot_si256(is_mixed, _mm256_set1_epi32(kKeySmooth));
    store(keys + i, _mm256_or_si256(load(keys + i), smooth));
  }
  for (; i < n; ++i)
    if ((mixed[i / 64] >> i % 64 & 1) == 0) keys[i] |= kKeySmooth;
}

}  // namespace

void fill_warp_avx2(WarpKernels& table) {
  table.reproject_row = reproject_row;
  table.surface_keys_row = surface_keys_row;
  table.find_points = find_points;
  table.find_half_points = find_half_points;
  table.compare_keys = compare_keys;
  table.mark_smooth = mark_smooth;
}

}  // namespace pac
