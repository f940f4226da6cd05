#include <algorithm>
#include <bit>
#include <cmath>

#include "base/kernels/warp_kernels.h"

namespace pac {
namespace {

constexpr float kSmallestW = 8.6736174e-19f;  // 2^-60

int32_t nearest(float position_64) {
  const bool fits = position_64 >= -2147483648.0f && position_64 < 2147483648.0f;
  return fits ? static_cast<int32_t>(std::nearbyint(position_64)) : kWarpNowhere;
}

struct Place {
  int32_t x_64, y_64;
  float u;
};

Place reprojected(const ReprojectionRow& row, size_t i, float depth) {
  const float u = 1.0f - depth, column = static_cast<float>(static_cast<int32_t>(i));
  float at[4];
  for (int c = 0; c < 4; ++c) at[c] = (row.origin[c] + column * row.per_pixel[c]) + u * row.per_depth[c];
  if (!(at[3] > kSmallestW)) return {kWarpNowhere, kWarpNowhere, 0.0f};
  const float r = 1.0f / at[3], before = at[2] * r;
  return {nearest(at[0] * r), nearest(at[1] * r), before == before ? before : 0.0f};
}

void reproject_row(const ReprojectionRow& row, const float* depth, size_t n, int32_t* x_64, int32_t* y_64,
                   float* u_before) {
  for (size_t i = 0; i < n; ++i) {
    const Place place = reprojected(row, i, depth[i]);
    x_64[i] = place.x_64;
    y_64[i] = place.y_64;
    u_before[i] = place.u;
  }
}

uint32_t depth_code(float u) {
  const float bounded = u > 0.0f ? (u < 1.9921875f ? u : 1.9921875f) : 0.0f;
  return std::bit_cast<uint32_t>(bounded) >> 16;
}

void surface_keys_row(const uint32_t* id, const float* depth, const uint32_t* surfaces, size_t n_surfaces, size_t n,
                      uint32_t* keys) {
  for (size_t i = 0; i < n; ++i) {
    const uint32_t surface = (surfaces == nullptr  ? uint32_t{id[i] != 0}
                              : id[i] < n_surfaces ? surfaces[id[i]]
                                                   : 0)
                             << 16;
    keys[i] = surface == 0 ? 0 : surface | depth_code(1.0f - depth[i]);
  }
}

bool apart(uint32_t a, uint32_t b) {
  // One comparison: the difference is in -kKeyTolerance..kKeyTolerance.
  return a - b + uint32_t{kKeyTolerance} > 2 * uint32_t{kKeyTolerance};
}

// floor((x + 32) / 64), of any x.
int32_t nearest_pixel(int32_t position_64) {
  return (position_64 >> 6) + (position_64 >> 5 & 1);
}

uint8_t state_of(const KeyMap& before, int32_t x_64, int32_t y_64, uint32_t wanted) {
  const int32_t near_x = nearest_pixel(x_64), near_y = nearest_pixel(y_64);
  if (wanted == 0 || near_x < 0 || near_y < 0 || near_x >= before.width || near_y >= before.height) return kWarpAbsent;
  const uint32_t key = before.keys[(y_64 >> 6) * before.stride + (x_64 >> 6)];
  return (key & kKeySmooth) != 0 && !apart(key & kKeyBits, wanted) ? kWarpPlain : kWarpEdge;
}

void count(uint8_t state, WarpCounts& counts) {
  counts.plain += state == kWarpPlain;
  counts.edges += state == kWarpEdge;
}

WarpCounts find_points(const ReprojectionRow& row, size_t first, const float* depth, const uint32_t* now,
                       const KeyMap& before, size_t n, const WarpPlaces& out) {
  WarpCounts counts = {};
  for (size_t i = 0; i < n; ++i) {
    const uint32_t surface = now[i] & kKeySurfaceBits;
    const Place place = surface == 0 ? Place{kWarpNowhere, kWarpNowhere, 0.0f} : reprojected(row, first + i, depth[i]);
    out.x_64[i] = place.x_64;
    out.y_64[i] = place.y_64;
    out.wanted[i] = surface == 0 ? 0 : surface | depth_code(place.u);
    out.state[i] = state_of(before, place.x_64, place.y_64, out.wanted[i]);
    count(out.state[i], counts);
  }
  return counts;
}

WarpCounts find_half_points(const WarpPlaces& full, const KeyMap& before, size_t n, const WarpPlaces& out) {
  WarpCounts counts = {};
  for (size_t i = 0; i < n; ++i) {
    out.x_64[i] = full.x_64[2 * i] >> 1;
    out.y_64[i] = full.y_64[2 * i] >> 1;
    out.wanted[i] = full.wanted[2 * i];
    out.state[i] = state_of(before, out.x_64[i], out.y_64[i], out.wanted[i]);
    count(out.state[i], counts);
  }
  return counts;
}

void compare_keys(const uint32_t* above, const uint32_t* here, size_t n, uint64_t* right, uint64_t* down) {
  for (size_t word = 0; 64 * word < n; ++word) {
    right[word] = down[word] = 0;
    for (size_t i = 64 * word; i < n && i < 64 * word + 64; ++i) {
      right[word] |= uint64_t{i + 1 < n && apart(here[i], here[i + 1])} << i % 64;
      down[word] |= uint64_t{apart(above[i], here[i])} << i % 64;
    }
  }
}

void mark_smooth(const uint64_t* mixed, size_t n, uint32_t* keys) {
  for (size_t i = 0; i < n; ++i)
    if ((mixed[i / 64] >> i % 64 & 1) == 0) keys[i] |= kKeySmooth;
}

int16_t filter_point(const int16_t* at, ptrdiff_t stride, const int16_t* taps_x, const int16_t* taps_y) {
  int32_t sum = 512;
  for (int j = 0; j < kWarpTaps; ++j) {
    int32_t v = 128;
    for (int k = 0; k < kWarpTaps; ++k) v += taps_y[k] * at[k * stride + j];
    sum += taps_x[j] * (v >> 8);
  }
  return static_cast<int16_t>(std::clamp<int32_t>(sum >> 10, -kLargestCarried, kLargestCarried));
}

void filter_points(const int16_t* plane, ptrdiff_t stride, const int16_t* taps, const int32_t* x_64,
                   const int32_t* y_64, const uint8_t* state, size_t n, int16_t* out) {
  for (size_t i = 0; i < n; ++i) {
    out[i] = 0;
    if (state[i] == kWarpAbsent) continue;
    const int16_t* at = plane + ((y_64[i] >> 6) - kWarpTapsBefore) * stride + (x_64[i] >> 6) - kWarpTapsBefore;
    out[i] = filter_point(at, stride, taps + kWarpTapStride * (x_64[i] & (kWarpPhases - 1)),
                          taps + kWarpTapStride * (y_64[i] & (kWarpPhases - 1)));
  }
}

void filter_both(const int16_t* const planes[2], ptrdiff_t stride, const int16_t* taps, const int32_t* x_64,
                 const int32_t* y_64, const uint8_t* state, size_t n, int16_t* const out[2]) {
  for (int k = 0; k < 2; ++k) filter_points(planes[k], stride, taps, x_64, y_64, state, n, out[k]);
}

// A point between surfaces: which of the four samples around it show its own, with their bilinear weights.
struct Edge {
  ptrdiff_t offset;  // of the first of them in a plane
  const uint32_t* keys;
  uint32_t wanted;
  int32_t right, below;
  int32_t weight[4], sum;
};

bool is_shown(const Edge& edge, uint32_t key) {
  return !apart(key & kKeyBits, edge.wanted);
}

Edge edge_at(ptrdiff_t stride, const KeyMap& map, const WarpPlaces& places, size_t i) {
  const int32_t x = places.x_64[i] >> 6, y = places.y_64[i] >> 6;
  Edge edge = {y * stride + x,
               map.keys + y * map.stride + x,
               places.wanted[i],
               places.x_64[i] & (kWarpPhases - 1),
               places.y_64[i] & (kWarpPhases - 1),
               {},
               0};
  for (int k = 0; k < 4; ++k) {
    const int32_t across = k % 2 == 0 ? kWarpPhases - edge.right : edge.right;
    const int32_t down = k / 2 == 0 ? kWarpPhases - edge.below : edge.below;
    edge.weight[k] = is_shown(edge, edge.keys[k / 2 * map.stride + k % 2]) ? across * down : 0;
    edge.sum += edge.weight[k];
  }
  return edge;
}

int16_t mean(const int16_t* plane, ptrdiff_t stride, const Edge& edge) {
  int32_t sum = 0;
  for (int k = 0; k < 4; ++k) sum += edge.weight[k] * plane[edge.offset + k / 2 * stride + k % 2];
  const int32_t half = edge.sum / 2;
  return static_cast<int16_t>(sum >= 0 ? (sum + half) / edge.sum : -((half - sum) / edge.sum));
}

size_t filter_edges(const int16_t* plane, ptrdiff_t stride, const KeyMap& map, const int16_t* taps,
                    const WarpPlaces& places, size_t n, int16_t* out) {
  size_t lost = 0;
  for (size_t i = 0; i < n; ++i) {
    if (places.state[i] != kWarpEdge) continue;
    const Edge edge = edge_at(stride, map, places, i);
    out[i] = 0;
    if (edge.sum == 0) {
      ++lost;
      continue;
    }
    const int16_t stand_in = mean(plane, stride, edge);
    int16_t patch[kWarpTaps * kWarpTapStride];
    for (int k = 0; k < kWarpTaps; ++k)
      for (int j = 0; j < kWarpTaps; ++j) {
        const ptrdiff_t across = j - kWarpTapsBefore, down = k - kWarpTapsBefore;
        patch[k * kWarpTapStride + j] = is_shown(edge, edge.keys[down * map.stride + across])
                                            ? plane[edge.offset + down * stride + across]
                                            : stand_in;
      }
    out[i] =
        filter_point(patch, kWarpTapStride, taps + kWarpTapStride * edge.right, taps + kWarpTapStride * edge.below);
  }
  return lost;
}

size_t mean_edges(const int16_t* const planes[2], ptrdiff_t stride, const KeyMap& map, const WarpPlaces& places,
                  size_t n, int16_t* const out[2]) {
  size_t lost = 0;
  for (size_t i = 0; i < n; ++i) {
    if (places.state[i] != kWarpEdge) continue;
    const Edge edge = edge_at(stride, map, places, i);
    for (int k = 0; k < 2; ++k) out[k][i] = edge.sum == 0 ? 0 : mean(planes[k], stride, edge);
    lost += edge.sum == 0;
  }
  return lost;
}

uint8_t to_byte(int value) {
  return static_cast<uint8_t>(value < 0 ? 0 : value > 255 ? 255 : value);
}

void add_carried_row(const uint8_t* base, const int16_t* carried, size_t n, uint8_t* out) {
  for (size_t i = 0; i < n; ++i) out[i] = to_byte(base[i] + ((carried[i] + (1 << (kCarriedBits - 1))) >> kCarriedBits));
}

// 16 bits hold every sum.
template <int kBits>
int16_t rounded(int value) {
  return static_cast<int16_t>(static_cast<int16_t>(value + (1 << (kBits - 1))) >> kBits);
}

void upsample_carried_row(const int16_t* near, const int16_t* far, size_t n, int16_t* out) {
  constexpr size_t kBlock = 256;
  constexpr int kKept = 2;  // bits below the point
  for (size_t first = 0; first < n; first += kBlock) {
    const size_t block = n - first < kBlock ? n - first : kBlock;
    int16_t column[kBlock + 2];
    const int16_t *a = near + first - 1, *b = far + first - 1;
    for (size_t x = 0; x < block + 2; ++x)
      column[x] = static_cast<int16_t>(3 * rounded<kCarriedBits - kKept>(a[x]) + rounded<kCarriedBits - kKept>(b[x]));
    int16_t* to = out + 2 * first;
    for (size_t x = 0; x < block; ++x) {
      const int here = 3 * column[x + 1];
      to[2 * x] = rounded<4 + kKept>(here + column[x]);
      to[2 * x + 1] = rounded<4 + kKept>(here + column[x + 2]);
    }
  }
}

void composite_signed_row(const uint8_t* low, const int16_t* carried, const int16_t* u, const int16_t* v, size_t n,
                          uint8_t* rgb) {
  constexpr int kHalf = 1 << 15;
  for (size_t i = 0; i < n; ++i) {
    const int d = rounded<kCarriedBits>(carried[i]);
    rgb[3 * i] = to_byte(low[3 * i] + d + ((91881 * v[i] + kHalf) >> 16));
    rgb[3 * i + 1] = to_byte(low[3 * i + 1] + d + ((-22554 * u[i] - 46802 * v[i] + kHalf) >> 16));
    rgb[3 * i + 2] = to_byte(low[3 * i + 2] + d + ((116130 * u[i] + kHalf) >> 16));
  }
}

}  // namespace

void fill_warp_scalar(WarpKernels& table) {
  table.reproject_row = reproject_row;
  table.surface_keys_row = surface_keys_row;
  table.find_points = find_points;
  table.find_half_points = find_half_points;
  table.compare_keys = compare_keys;
  table.mark_smooth = mark_smooth;
  table.filter_points = filter_points;
  table.filter_both = filter_both;
  table.filter_edges = filter_edges;
  table.mean_edges = mean_edges;
  table.add_carried_row = add_carried_row;
  table.upsample_carried_row = upsample_carried_row;
  table.composite_signed_row = composite_signed_row;
}

}  // namespace pac
