// Eight pixels at a time: where they were and what is smooth. The filters: warp_filter_avx2.cpp.
#include <immintrin.h>

#include <cstddef>
#include <cstdint>

#include "base/kernels/warp_kernels.h"

namespace pac {
namespace {

#include "base/kernels/warp_avx2_memory_simd.inc"

// ---- Places ----

// A row's numbers in all lanes.
struct Terms {
  __m256 origin[4], per_pixel[4], per_depth[4];

  explicit Terms(const ReprojectionRow& row) {
    for (int c = 0; c < 4; ++c) {
      origin[c] = _mm256_set1_ps(row.origin[c]);
      per_pixel[c] = _mm256_set1_ps(row.per_pixel[c]);
      per_depth[c] = _mm256_set1_ps(row.per_depth[c]);
    }
  }
};

inline __m256 coordinate(const Terms& terms, int c, __m256 column, __m256 u) {
  return _mm256_add_ps(_mm256_add_ps(terms.origin[c], _mm256_mul_ps(column, terms.per_pixel[c])),
                       _mm256_mul_ps(u, terms.per_depth[c]));
}

struct Eight {
  __m256i x_64, y_64;
  __m256 u;
};

// Of those lanes that are `shown`; the others are nowhere. u may not be a number.
inline Eight reproject(const Terms& terms, __m256 column, __m256 depth, __m256 shown) {
  const __m256 u = _mm256_sub_ps(_mm256_set1_ps(1.0f), depth);
  const __m256 w = coordinate(terms, 3, column, u);
  // Infinite where nothing is: then no position fits 32 bits, and the conversion gives kWarpNowhere.
  const __m256 somewhere = _mm256_and_ps(_mm256_cmp_ps(w, _mm256_set1_ps(8.6736174e-19f), _CMP_GT_OQ), shown);
  const __m256 r = _mm256_div_ps(_mm256_set1_ps(1.0f), _mm256_and_ps(w, somewhere));
  return {_mm256_cvtps_epi32(_mm256_mul_ps(coordinate(terms, 0, column, u), r)),
          _mm256_cvtps_epi32(_mm256_mul_ps(coordinate(terms, 1, column, u), r)),
          _mm256_and_ps(_mm256_mul_ps(coordinate(terms, 2, column, u), r), somewhere)};
}

inline __m256 first_columns() {
  return _mm256_setr_ps(0, 1, 2, 3, 4, 5, 6, 7);
}

void reproject_row(const ReprojectionRow& row, const float* depth, size_t n, int32_t* x_64, int32_t* y_64,
                   float* u_before) {
  const Terms terms(row);
  const __m256 all = _mm256_castsi256_ps(_mm256_set1_epi32(-1));
  __m256 column = first_columns();
  const auto eight = [&](const float* z, int32_t* x, int32_t* y, float* u) {
    const Eight at = reproject(terms, column, _mm256_loadu_ps(z), all);
    store(x, at.x_64);
    store(y, at.y_64);
    _mm256_storeu_ps(u, _mm256_and_ps(at.u, _mm256_cmp_ps(at.u, at.u, _CMP_ORD_Q)));
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

// The maximum of equal zeros, and of what is not a number, is its second operand: 0.
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
  for (; i + 16 <= n; i += 16) {  // a line of the cache
    prefetch(id + i, kAhead);
    prefetch(depth + i, kAhead);
    prefetch(keys + i, kAhead);
    store(keys + i, eight(id + i, depth + i));
    store(keys + i + 8, eight(id + i + 8, depth + i + 8));
  }
  for (; i + 8 <= n; i += 8) store(keys + i, eight(id + i, depth + i));
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
  __m256i last_x_64, last_y_64, map_stride;
  ptrdiff_t stride;
};

// 0xFFFFFFFF where keys without their smooth bits belong to the wanted ones.
inline __m256i belongs(__m256i key, __m256i wanted) {
  const __m256i apart = _mm256_sub_epi32(_mm256_and_si256(key, _mm256_set1_epi32(static_cast<int>(kKeyBits))), wanted);
  const __m256i from_low = _mm256_add_epi32(apart, _mm256_set1_epi32(kKeyTolerance));
  return _mm256_cmpeq_epi32(_mm256_min_epu32(from_low, _mm256_set1_epi32(2 * kKeyTolerance)), from_low);
}

// Positions whose nearest pixel is within the map: without a sign, negative ones are beyond any end.
inline __m256i in_range(__m256i position_64, __m256i last_64) {
  const __m256i near = _mm256_add_epi32(position_64, _mm256_set1_epi32(kWarpPhases / 2));
  return _mm256_cmpeq_epi32(_mm256_min_epu32(near, last_64), near);
}

// Minus the states of points that are found: of lanes, so far.
struct Counters {
  __m256i plain = _mm256_setzero_si256(), inside = _mm256_setzero_si256();

  static size_t sum_of(__m256i counts) {
    alignas(32) int32_t lanes[8];
    store(lanes, counts);
    int64_t sum = 0;
    for (const int32_t lane : lanes) sum -= lane;
    return static_cast<size_t>(sum);
  }
  WarpCounts counts() const { return {sum_of(plain), sum_of(inside) - sum_of(plain)}; }
};

// The keys of eight pixels of the map, `inside` it, by their columns and lines.
inline __m256i keys_at(const Lookup& before, __m256i columns, __m256i lines, __m256i inside) {
  const __m128i column = _mm256_castsi256_si128(columns), line = _mm256_castsi256_si128(lines);
  const __m256i from_first = _mm256_sub_epi32(columns, _mm256_broadcastd_epi32(column));
  const __m256i is_near = _mm256_cmpeq_epi32(_mm256_min_epu32(from_first, _mm256_set1_epi32(15)), from_first);
  const __m256i in_line = _mm256_cmpeq_epi32(lines, _mm256_broadcastd_epi32(line));
  const ptrdiff_t start = _mm_cvtsi128_si32(line) * before.stride + _mm_cvtsi128_si32(column);
  prefetch(before.keys, start + 4 * before.stride);  // of the next row's edges
  if (_mm256_movemask_epi8(_mm256_and_si256(inside, _mm256_and_si256(is_near, in_line))) != -1) {
    const __m256i index = _mm256_add_epi32(_mm256_mullo_epi32(lines, before.map_stride), columns);
    return _mm256_mask_i32gather_epi32(_mm256_setzero_si256(), before.keys, index, inside, 4);
  }
  // A gather takes longer than two permutations; where from_first has bit 3, the second one counts.
  const auto eight_at = [&](ptrdiff_t i) {
    return _mm256_permutevar8x32_epi32(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(before.keys + start + i)),
                                       from_first);
  };
  const __m256i is_late = _mm256_slli_epi32(from_first, 28);
  return _mm256_castps_si256(_mm256_blendv_ps(_mm256_castsi256_ps(eight_at(0)), _mm256_castsi256_ps(eight_at(8)),
                                              _mm256_castsi256_ps(is_late)));
}

// Eight states.
inline void find_states(const Lookup& before, __m256i x, __m256i y, __m256i wanted, uint8_t* state,
                        Counters& counters) {
  const __m256i inside = _mm256_and_si256(in_range(x, before.last_x_64), in_range(y, before.last_y_64));
  const __m256i key = keys_at(before, _mm256_srai_epi32(x, 6), _mm256_srai_epi32(y, 6), inside);
  const __m256i smooth = _mm256_srai_epi32(_mm256_slli_epi32(key, 17), 31);
  const __m256i plain = _mm256_and_si256(smooth, belongs(key, wanted));
  const __m256i states = _mm256_abs_epi32(_mm256_add_epi32(plain, inside));
  const __m128i words = _mm_packus_epi32(_mm256_castsi256_si128(states), _mm256_extracti128_si256(states, 1));
  _mm_storel_epi64(reinterpret_cast<__m128i*>(state), _mm_packus_epi16(words, words));
  counters.plain = _mm256_add_epi32(counters.plain, plain);
  counters.inside = _mm256_add_epi32(counters.inside, inside);
}

inline Lookup lookup_in(const KeyMap& map) {
  return {reinterpret_cast<const int*>(map.keys), _mm256_set1_epi32(map.width * kWarpPhases - 1),
          _mm256_set1_epi32(map.height * kWarpPhases - 1), _mm256_set1_epi32(static_cast<int>(map.stride)), map.stride};
}

inline void store_nothing(const WarpPlaces& out) {
  store(out.x_64, _mm256_set1_epi32(kWarpNowhere));
  store(out.y_64, _mm256_set1_epi32(kWarpNowhere));
  store(out.wanted, _mm256_setzero_si256());
}

// The states of eight places.
inline void look_up(const Lookup& before, const WarpPlaces& places, Counters& counters) {
  const __m256i wanted = load(places.wanted);
  if (_mm256_testz_si256(wanted, wanted) != 0) {
    _mm_storel_epi64(reinterpret_cast<__m128i*>(places.state), _mm_setzero_si128());
    return;
  }
  find_states(before, load(places.x_64), load(places.y_64), wanted, places.state, counters);
}

inline WarpPlaces from(const WarpPlaces& places, size_t i) {
  return {places.x_64 + i, places.y_64 + i, places.state + i, places.wanted + i};
}

// Eight at a time: places by place(i, out) a block ahead of their states by look_up(out), which are guessed wrong more
// often and would wait for all that leads to a place. The last few go through copies.
template <class Place, class LookUp>
inline void by_eight(size_t n, const WarpPlaces& out, const Place& place, const LookUp& look_up) {
  constexpr size_t kBlock = 64;
  const size_t whole = n & ~size_t{7};
  for (size_t first = 0; first < whole; first += kBlock) {
    const size_t end = first + kBlock < whole ? first + kBlock : whole;
    for (size_t i = first; i < end; i += 8) place(i, from(out, i));
    for (size_t i = first; i < end; i += 8) look_up(from(out, i));
  }
  if (whole == n) return;
  int32_t x[8], y[8];
  uint8_t state[8];
  uint32_t wanted[8];
  const WarpPlaces last = {x, y, state, wanted};
  const size_t rest = n - whole;
  place(whole, last);
  for (size_t i = rest; i < 8; ++i) x[i] = kWarpNowhere;
  look_up(last);
  __builtin_memcpy(out.x_64 + whole, x, rest * 4);
  __builtin_memcpy(out.y_64 + whole, y, rest * 4);
  __builtin_memcpy(out.state + whole, state, rest);
  __builtin_memcpy(out.wanted + whole, wanted, rest * 4);
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
  const Terms terms(row);
  Counters counters;
  const auto place = [&](size_t i, const WarpPlaces& to) {
    const __m256i keys = load_some(now + i, n - i);
    const __m256i surface = _mm256_and_si256(keys, _mm256_set1_epi32(static_cast<int>(kKeySurfaceBits)));
    if (_mm256_testz_si256(surface, surface) != 0) return store_nothing(to);
    const __m256 column =
        _mm256_add_ps(_mm256_set1_ps(static_cast<float>(static_cast<int32_t>(first + i))), first_columns());
    const __m256i background = _mm256_cmpeq_epi32(surface, _mm256_setzero_si256());
    const __m256 shown = _mm256_castsi256_ps(_mm256_xor_si256(background, _mm256_set1_epi32(-1)));
    const Eight at = reproject(terms, column, _mm256_castsi256_ps(load_some(depth + i, n - i)), shown);
    store(to.x_64, at.x_64);
    store(to.y_64, at.y_64);
    store(to.wanted, _mm256_or_si256(surface, depth_code(at.u)));
  };
  by_eight(n, out, place, [&](const WarpPlaces& at) { look_up(before, at, counters); });
  return counters.counts();
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
  Counters counters;
  const auto place = [&](size_t i, const WarpPlaces& to) {
    store(to.x_64, _mm256_srai_epi32(load_seconds(full.x_64 + 2 * i, n - i), 1));
    store(to.y_64, _mm256_srai_epi32(load_seconds(full.y_64 + 2 * i, n - i), 1));
    store(to.wanted, load_seconds(full.wanted + 2 * i, n - i));
  };
  by_eight(n, out, place, [&](const WarpPlaces& at) { look_up(before, at, counters); });
  return counters.counts();
}

// ---- What is smooth ----

// 0xFFFFFFFF where keys belong together.
inline __m256i together(__m256i a, __m256i b) {
  const __m256i from_low = _mm256_add_epi32(_mm256_sub_epi32(a, b), _mm256_set1_epi32(kKeyTolerance));
  return _mm256_cmpeq_epi32(_mm256_min_epu32(from_low, _mm256_set1_epi32(2 * kKeyTolerance)), from_low);
}

// Bits of eight keys that do not belong to the others.
inline uint64_t apart(__m256i a, __m256i b) {
  return 0xFFu ^ static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps(together(a, b))));
}

// The same of 32 keys. Packing goes by halves: bytes come as keys 0..3, 8..11, 16..19, 24..27, 4..7 and so on.
inline uint64_t apart(const uint32_t* a, const uint32_t* b) {
  const auto eight = [&](int i) { return together(load(a + 8 * i), load(b + 8 * i)); };
  const __m256i bytes =
      _mm256_packs_epi16(_mm256_packs_epi32(eight(0), eight(1)), _mm256_packs_epi32(eight(2), eight(3)));
  const __m256i in_order = _mm256_permutevar8x32_epi32(bytes, _mm256_setr_epi32(0, 4, 1, 5, 2, 6, 3, 7));
  return 0xFFFFFFFFu ^ static_cast<unsigned>(_mm256_movemask_epi8(in_order));
}

void compare_keys(const uint32_t* above, const uint32_t* here, size_t n, uint64_t* right, uint64_t* down) {
  for (size_t first = 0; first < n; first += 64) {
    uint64_t to_right = 0, to_below = 0;
    const size_t end = first + 64 < n ? first + 64 : n;
    size_t i = first;
    for (; i + 32 <= end; i += 32) {
      to_right |= apart(here + i, here + i + 1) << (i - first);
      to_below |= apart(here + i, above + i) << (i - first);
    }
    for (; i < end; i += 8) {
      const size_t rest = end - i < 8 ? end - i : 8;
      const uint64_t inside = (uint64_t{1} << rest) - 1;
      const __m256i keys = load_some(here + i, rest);
      to_right |= (apart(keys, load_some(here + i + 1, rest)) & inside) << (i - first);
      to_below |= (apart(keys, load_some(above + i, rest)) & inside) << (i - first);
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
