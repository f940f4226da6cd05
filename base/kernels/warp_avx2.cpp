// Eight pixels at a time; the filter takes two points in a register, or eight whose samples of one row are filtered
// down the columns together.
#include <immintrin.h>

#include <cstddef>
#include <cstdint>

#include "base/kernels/warp_kernels.h"

namespace pac {
namespace {

inline __m256i load(const int32_t* p) {
  return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(p));
}
inline __m256i load(const uint32_t* p) {
  return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(p));
}
inline void store(void* p, __m256i v) {
  _mm256_storeu_si256(static_cast<__m256i*>(p), v);
}
inline __m128i load(const int16_t* p) {
  return _mm_loadu_si128(reinterpret_cast<const __m128i*>(p));
}
inline __m256i load_16(const int16_t* p) {
  return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(p));
}
inline __m256i load_two(const int16_t* low, const int16_t* high) {
  return _mm256_inserti128_si256(_mm256_castsi128_si256(load(low)), load(high), 1);
}

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

inline void reproject(const ReprojectionRow& row, __m256 column, __m256 depth, int32_t* x_64, int32_t* y_64,
                      float* u_before) {
  const __m256 u = _mm256_sub_ps(_mm256_set1_ps(1.0f), depth);
  const __m256 w = coordinate(row, 3, column, u);
  const __m256 x = _mm256_div_ps(coordinate(row, 0, column, u), w);
  const __m256 y = _mm256_div_ps(coordinate(row, 1, column, u), w);
  const __m256 before = _mm256_div_ps(coordinate(row, 2, column, u), w);
  const __m256 numbers = _mm256_and_ps(_mm256_cmp_ps(x, y, _CMP_ORD_Q), _mm256_cmp_ps(before, before, _CMP_ORD_Q));
  const __m256 somewhere = _mm256_and_ps(_mm256_cmp_ps(w, _mm256_set1_ps(8.6736174e-19f), _CMP_GT_OQ), numbers);
  store(x_64, in_64ths(x, somewhere));
  store(y_64, in_64ths(y, somewhere));
  _mm256_storeu_ps(u_before, _mm256_and_ps(before, somewhere));
}

void reproject_row(const ReprojectionRow& row, const float* depth, size_t n, int32_t* x_64, int32_t* y_64,
                   float* u_before) {
  __m256 column = _mm256_setr_ps(0, 1, 2, 3, 4, 5, 6, 7);
  size_t i = 0;
  for (; i + 8 <= n; i += 8) {
    reproject(row, column, _mm256_loadu_ps(depth + i), x_64 + i, y_64 + i, u_before + i);
    column = _mm256_add_ps(column, _mm256_set1_ps(8.0f));  // exact below 2^24
  }
  if (i == n) return;
  float last_depth[8] = {}, last_u[8];
  int32_t last_x[8], last_y[8];
  __builtin_memcpy(last_depth, depth + i, (n - i) * sizeof(float));
  reproject(row, column, _mm256_loadu_ps(last_depth), last_x, last_y, last_u);
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
  const int* surfaces;
  __m256i last;
  __m256i operator()(__m256i ids) const {
    const __m256i known = _mm256_cmpeq_epi32(_mm256_min_epu32(ids, last), ids);
    return _mm256_slli_epi32(
        _mm256_mask_i32gather_epi32(_mm256_setzero_si256(), surfaces, _mm256_and_si256(ids, known), known, 4), 16);
  }
};
struct OneSurface {
  __m256i operator()(__m256i ids) const {
    return _mm256_andnot_si256(_mm256_cmpeq_epi32(ids, _mm256_setzero_si256()), _mm256_set1_epi32(1 << 16));
  }
};

template <class Surfaces>
inline void surface_keys_row(const uint32_t* id, const float* depth, const Surfaces& surfaces, size_t n,
                             uint32_t* keys) {
  const auto eight = [&](const uint32_t* ids, const float* z) {
    const __m256 u = _mm256_sub_ps(_mm256_set1_ps(1.0f), _mm256_loadu_ps(z));
    return _mm256_or_si256(surfaces(load(ids)), depth_code(u));
  };
  size_t i = 0;
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
  __m256i width_64, height_64, map_stride;
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

// Returns how many of the eight are plain.
inline int place(const Lookup& before, const int32_t* x_64, const int32_t* y_64, const float* u, const uint32_t* now,
                 uint8_t* state, uint32_t* wanted_keys) {
  const __m256i x = load(x_64), y = load(y_64);
  const __m256i surface = _mm256_and_si256(load(now), _mm256_set1_epi32(static_cast<int>(kKeySurfaceBits)));
  const __m256i wanted = _mm256_or_si256(surface, depth_code(_mm256_loadu_ps(u)));
  store(wanted_keys, wanted);
  const __m256i background = _mm256_cmpeq_epi32(surface, _mm256_setzero_si256());
  const __m256i inside =
      _mm256_andnot_si256(background, _mm256_and_si256(in_range(x, before.width_64), in_range(y, before.height_64)));
  if (_mm256_testz_si256(inside, inside) != 0) {
    _mm_storel_epi64(reinterpret_cast<__m128i*>(state), _mm_setzero_si128());
    return 0;
  }
  const __m256i column = _mm256_srai_epi32(x, 6), line = _mm256_srai_epi32(y, 6);
  const __m256i index = _mm256_add_epi32(_mm256_mullo_epi32(line, before.map_stride), column);
  const int32_t start = _mm_cvtsi128_si32(_mm256_castsi256_si128(index));
  const __m256i in_order =
      _mm256_and_si256(inside, _mm256_cmpeq_epi32(index, _mm256_add_epi32(_mm256_set1_epi32(start), ramp())));
  // A gather takes long, and most often the eight lie side by side.
  const __m256i key = _mm256_movemask_epi8(in_order) == -1
                          ? _mm256_loadu_si256(reinterpret_cast<const __m256i*>(before.keys + start))
                          : _mm256_mask_i32gather_epi32(_mm256_setzero_si256(), before.keys, index, inside, 4);
  const __m256i smooth = _mm256_srai_epi32(_mm256_slli_epi32(key, 17), 31);
  const __m256i plain = _mm256_and_si256(smooth, belongs(key, wanted));
  const __m256i states = _mm256_sub_epi32(_mm256_setzero_si256(), _mm256_add_epi32(plain, inside));
  const __m128i words = _mm_packus_epi32(_mm256_castsi256_si128(states), _mm256_extracti128_si256(states, 1));
  _mm_storel_epi64(reinterpret_cast<__m128i*>(state), _mm_packus_epi16(words, words));
  return __builtin_popcount(static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps(plain))));
}

size_t place_points(const KeyMap& map, const int32_t* x_64, const int32_t* y_64, const float* u_before,
                    const uint32_t* now, size_t n, const WarpPlaces& out) {
  const Lookup before{reinterpret_cast<const int*>(map.keys), _mm256_set1_epi32(map.width * kWarpPhases),
                      _mm256_set1_epi32(map.height * kWarpPhases), _mm256_set1_epi32(static_cast<int>(map.stride))};
  size_t i = 0, plain = 0;
  for (; i + 8 <= n; i += 8)
    plain +=
        static_cast<size_t>(place(before, x_64 + i, y_64 + i, u_before + i, now + i, out.state + i, out.wanted + i));
  if (i == n) return n - plain;
  const size_t rest = n - i;
  int32_t x[8], y[8];
  for (int k = 0; k < 8; ++k) x[k] = y[k] = kWarpNowhere;
  float u[8] = {};
  uint32_t keys[8] = {}, wanted[8];
  uint8_t state[8];
  __builtin_memcpy(x, x_64 + i, rest * 4);
  __builtin_memcpy(y, y_64 + i, rest * 4);
  __builtin_memcpy(u, u_before + i, rest * 4);
  __builtin_memcpy(keys, now + i, rest * 4);
  plain += static_cast<size_t>(place(before, x, y, u, keys, state, wanted));
  __builtin_memcpy(out.wanted + i, wanted, rest * 4);
  __builtin_memcpy(out.state + i, state, rest);
  return n - plain;
}

// ---- What is smooth ----

// Lanes of 0xFFFFFFFF where keys belong together.
inline __m256i together(__m256i a, __m256i b) {
  const __m256i from_low = _mm256_add_epi32(_mm256_sub_epi32(a, b), _mm256_set1_epi32(kKeyTolerance));
  return _mm256_cmpeq_epi32(_mm256_min_epu32(from_low, _mm256_set1_epi32(2 * kKeyTolerance)), from_low);
}

inline void mark_eight(const uint32_t* here, const uint32_t* below, uint8_t* mixed) {
  const __m256i a = load(here), b = load(here + 1), c = load(below), d = load(below + 1);
  const __m256i all = _mm256_and_si256(_mm256_and_si256(together(a, b), together(a, c)),
                                       _mm256_and_si256(together(c, d), together(b, d)));
  const __m256i ones = _mm256_add_epi32(all, _mm256_set1_epi32(1));
  const __m128i words = _mm_packus_epi32(_mm256_castsi256_si128(ones), _mm256_extracti128_si256(ones, 1));
  _mm_storel_epi64(reinterpret_cast<__m128i*>(mixed), _mm_packus_epi16(words, words));
}

void mark_mixed(const uint32_t* here, const uint32_t* below, size_t n, uint8_t* mixed) {
  size_t i = 0;
  for (; i + 8 <= n; i += 8) mark_eight(here + i, below + i, mixed + i);
  if (i == n) return;
  uint32_t last_here[9] = {}, last_below[9] = {};
  uint8_t last_mixed[8];
  __builtin_memcpy(last_here, here + i, (n - i + 1) * 4);
  __builtin_memcpy(last_below, below + i, (n - i + 1) * 4);
  mark_eight(last_here, last_below, last_mixed);
  __builtin_memcpy(mixed + i, last_mixed, n - i);
}

void mark_smooth(const uint8_t* const rows[5], size_t n, uint32_t* keys) {
  const auto any_of_five = [&](size_t at) {
    __m128i any = _mm_setzero_si128();
    for (int row = 0; row < 5; ++row)
      any = _mm_or_si128(any, _mm_loadu_si128(reinterpret_cast<const __m128i*>(rows[row] + at)));
    return any;
  };
  size_t i = 0;
  // Of 16 columns read 12 are used.
  for (; i + 12 <= n; i += 8) {
    const __m128i down = any_of_five(i);
    const __m128i two = _mm_or_si128(down, _mm_srli_si128(down, 1));
    const __m128i any = _mm_or_si128(_mm_or_si128(two, _mm_srli_si128(two, 2)), _mm_srli_si128(down, 4));
    const __m256i none = _mm256_cmpeq_epi32(_mm256_cvtepu8_epi32(any), _mm256_setzero_si256());
    store(keys + i, _mm256_or_si256(load(keys + i), _mm256_and_si256(none, _mm256_set1_epi32(kKeySmooth))));
  }
  for (; i < n; ++i) {
    int any = 0;
    for (int row = 0; row < 5; ++row)
      for (size_t k = 0; k < 5; ++k) any |= rows[row][i + k];
    if (any == 0) keys[i] |= kKeySmooth;
  }
}

// ---- Filter ----

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

// Eight points no more than eight columns from the first one: sixteen columns are filtered down once for each of the
// heights among them, of which there are a few. False where there are more.
constexpr int kHeights = 5;
inline bool filter_down_heights(const int16_t* plane, ptrdiff_t stride, Taps taps, __m256i columns, const int32_t* y,
                                int16_t* v, int32_t* at) {
  const __m256i from_first = _mm256_sub_epi32(columns, _mm256_broadcastd_epi32(_mm256_castsi256_si128(columns)));
  const __m256i near = _mm256_cmpeq_epi32(_mm256_min_epu32(from_first, _mm256_set1_epi32(8)), from_first);
  if (_mm256_movemask_epi8(near) != -1) return false;
  const int16_t* first = plane + _mm_cvtsi128_si32(_mm256_castsi256_si128(columns)) - kWarpTapsBefore;
  const __m256i heights = load(y);
  __m256i places = from_first;
  unsigned left = 0xFF;
  for (int i = 0; i < kHeights; ++i) {
    const int32_t height = y[__builtin_ctz(left)];
    const __m256i same = _mm256_cmpeq_epi32(heights, _mm256_set1_epi32(height));
    const int16_t* rows = first + ((height >> 6) - kWarpTapsBefore) * stride;
    const __m256i ty = _mm256_broadcastsi128_si256(load(taps[height]));
    store(v + 16 * i, filter_down([&](int k) { return load_16(rows + k * stride); }, ty));
    places = _mm256_add_epi32(places, _mm256_and_si256(same, _mm256_set1_epi32(16 * i)));
    left &= ~static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps(same)));
    if (left != 0) continue;
    store(at, places);
    return true;
  }
  return false;
}

inline __m128i filter_eight(const int16_t* plane, ptrdiff_t stride, Taps taps, const int32_t* x, const int32_t* y) {
  alignas(32) int16_t v[16 * kHeights];
  alignas(32) int32_t at[8];
  __m256i sums[4];
  if (filter_down_heights(plane, stride, taps, _mm256_srai_epi32(load(x), 6), y, v, at)) {
    for (int i = 0; i < 4; ++i)
      sums[i] =
          _mm256_madd_epi16(load_two(v + at[2 * i], v + at[2 * i + 1]), load_two(taps[x[2 * i]], taps[x[2 * i + 1]]));
  } else {
    for (int i = 0; i < 4; ++i) sums[i] = filter_two(plane, stride, taps, x + 2 * i, y + 2 * i);
  }
  return finish_eight(sums);
}

// Eight points of which some are absent: they go where the first of the others is.
inline __m128i filter_present(const int16_t* plane, ptrdiff_t stride, Taps taps, const int32_t* x, const int32_t* y,
                              uint64_t states) {
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

// Row k of an edge point, what shows something else replaced.
inline __m128i shown_row(const int16_t* samples, const uint32_t* keys, __m256i wanted, __m128i stand_in) {
  const __m256i mask = belongs(load(keys), wanted);
  const __m128i narrow = _mm_packs_epi32(_mm256_castsi256_si128(mask), _mm256_extracti128_si256(mask, 1));
  return _mm_blendv_epi8(stand_in, load(samples), narrow);
}

void filter_edge_points(const int16_t* plane, ptrdiff_t stride, const uint32_t* map, ptrdiff_t map_stride,
                        const int16_t* table, const WarpEdge* edges, size_t n, int16_t* out) {
  const Taps taps{table};
  const auto row = [&](const WarpEdge& edge, __m256i wanted, int k) {
    return shown_row(plane + edge.offset + k * stride, map + edge.map_offset + k * map_stride, wanted,
                     _mm_set1_epi16(edge.stand_in));
  };
  for (size_t i = 0; i < n; i += 2) {
    const WarpEdge &a = edges[i], &b = edges[i + 1 < n ? i + 1 : i];
    const __m256i wanted_a = _mm256_set1_epi32(static_cast<int>(a.wanted));
    const __m256i wanted_b = _mm256_set1_epi32(static_cast<int>(b.wanted));
    const auto rows = [&](int k) {
      return _mm256_inserti128_si256(_mm256_castsi128_si256(row(a, wanted_a, k)), row(b, wanted_b, k), 1);
    };
    const __m256i v = filter_down(rows, load_two(taps[a.phase_y], taps[b.phase_y]));
    const __m256i sums = _mm256_madd_epi16(v, load_two(taps[a.phase_x], taps[b.phase_x]));
    const __m256i pairs = _mm256_hadd_epi32(sums, sums), all = _mm256_hadd_epi32(pairs, pairs);
    const __m256i done = _mm256_srai_epi32(_mm256_add_epi32(all, _mm256_set1_epi32(512)), 10);
    out[i] = static_cast<int16_t>(_mm256_extract_epi32(done, 0));
    if (i + 1 < n) out[i + 1] = static_cast<int16_t>(_mm256_extract_epi32(done, 4));
  }
}

// Of samples with bits below the point, rounded.
inline __m256i whole(__m256i carried) {
  return _mm256_srai_epi16(_mm256_add_epi16(carried, _mm256_set1_epi16(1 << (kCarriedBits - 1))), kCarriedBits);
}

void add_carried_row(const uint8_t* base, const int16_t* carried, size_t n, uint8_t* out) {
  const auto sixteen = [](const uint8_t* from, const int16_t* added) {
    const __m256i wide = _mm256_cvtepu8_epi16(_mm_loadu_si128(reinterpret_cast<const __m128i*>(from)));
    const __m256i sum = _mm256_add_epi16(wide, whole(load_16(added)));
    return _mm_packus_epi16(_mm256_castsi256_si128(sum), _mm256_extracti128_si256(sum, 1));
  };
  size_t i = 0;
  for (; i + 16 <= n; i += 16) _mm_storeu_si128(reinterpret_cast<__m128i*>(out + i), sixteen(base + i, carried + i));
  if (i == n) return;
  uint8_t last_base[16] = {}, last_out[16];
  int16_t last_carried[16] = {};
  __builtin_memcpy(last_base, base + i, n - i);
  __builtin_memcpy(last_carried, carried + i, (n - i) * sizeof(int16_t));
  _mm_storeu_si128(reinterpret_cast<__m128i*>(last_out), sixteen(last_base, last_carried));
  __builtin_memcpy(out + i, last_out, n - i);
}

}  // namespace

void fill_warp_avx2(WarpKernels& table) {
  table.reproject_row = reproject_row;
  table.surface_keys_row = surface_keys_row;
  table.place_points = place_points;
  table.mark_mixed = mark_mixed;
  table.mark_smooth = mark_smooth;
  table.filter_points = filter_points;
  table.filter_edge_points = filter_edge_points;
  table.add_carried_row = add_carried_row;
}

}  // namespace pac
