#include <bit>
#include <cmath>

#include "base/kernels/warp_kernels.h"

namespace pac {
namespace {

constexpr float kLargest = 262144.0f;         // 2^18 pixels: 2^24 in 1/64
constexpr float kSmallestW = 8.6736174e-19f;  // 2^-60

float clamped(float value) {
  return value < -kLargest ? -kLargest : value > kLargest ? kLargest : value;
}

int32_t in_64ths(float position) {
  return static_cast<int32_t>(std::floor(clamped(position) * 64.0f + 0.5f));
}

void reproject_row(const ReprojectionRow& row, const float* depth, size_t n, int32_t* x_64, int32_t* y_64,
                   float* u_before) {
  for (size_t i = 0; i < n; ++i) {
    const float u = 1.0f - depth[i], column = static_cast<float>(static_cast<int32_t>(i));
    float at[4];
    for (int c = 0; c < 4; ++c) at[c] = (row.origin[c] + column * row.per_pixel[c]) + u * row.per_depth[c];
    const float x = at[0] / at[3], y = at[1] / at[3], before = at[2] / at[3];
    const bool somewhere = at[3] > kSmallestW && x == x && y == y && before == before;
    x_64[i] = somewhere ? in_64ths(x) : kWarpNowhere;
    y_64[i] = somewhere ? in_64ths(y) : kWarpNowhere;
    u_before[i] = somewhere ? before : 0.0f;
  }
}

uint32_t depth_code(float u) {
  const float bounded = u < 0.0f ? 0.0f : u > 1.9921875f ? 1.9921875f : u;
  return std::bit_cast<uint32_t>(bounded + 0.0f) >> 16;
}

void surface_keys_row(const uint32_t* id, const float* depth, const uint32_t* surfaces, size_t n_surfaces, size_t n,
                      uint32_t* keys) {
  for (size_t i = 0; i < n; ++i)
    keys[i] = (surfaces == nullptr  ? uint32_t{id[i] != 0} << 16
               : id[i] < n_surfaces ? surfaces[id[i]] << 16
                                    : 0) |
              depth_code(1.0f - depth[i]);
}

size_t place_points(const KeyMap& before, const int32_t* x_64, const int32_t* y_64, const float* u_before,
                    const uint32_t* now, size_t n, const WarpPlaces& out) {
  size_t not_plain = 0;
  for (size_t i = 0; i < n; ++i) {
    const int32_t x = x_64[i] >> 6, y = y_64[i] >> 6;
    const uint32_t wanted = (now[i] & kKeySurfaceBits) | depth_code(u_before[i]);
    const int32_t near_x = (x_64[i] + kWarpPhases / 2) >> 6, near_y = (y_64[i] + kWarpPhases / 2) >> 6;
    const bool is_inside = (now[i] & kKeySurfaceBits) != 0 && near_x >= 0 && near_y >= 0 && near_x < before.width &&
                           near_y < before.height;
    const uint32_t key = is_inside ? before.keys[y * before.stride + x] : 0;
    const auto apart = static_cast<int32_t>((key & kKeyBits) - wanted);
    const bool is_plain = (key & kKeySmooth) != 0 && apart <= kKeyTolerance && apart >= -kKeyTolerance;
    out.wanted[i] = wanted;
    out.state[i] = is_plain ? kWarpPlain : is_inside ? kWarpEdge : kWarpAbsent;
    if (!is_plain) ++not_plain;
  }
  return not_plain;
}

bool apart(uint32_t a, uint32_t b) {
  // One comparison: the difference is in -kKeyTolerance..kKeyTolerance.
  return a - b + uint32_t{kKeyTolerance} > 2 * uint32_t{kKeyTolerance};
}

void mark_mixed(const uint32_t* here, const uint32_t* below, size_t n, uint8_t* mixed) {
  for (size_t i = 0; i < n; ++i)
    mixed[i] = apart(here[i], here[i + 1]) || apart(here[i], below[i]) || apart(below[i], below[i + 1]) ||
               apart(here[i + 1], below[i + 1]);
}

void mark_smooth(const uint8_t* const rows[5], size_t n, uint32_t* keys) {
  for (size_t i = 0; i < n; ++i) {
    uint8_t any = 0;
    for (int row = 0; row < 5; ++row)
      for (size_t k = 0; k < 5; ++k) any |= rows[row][i + k];
    if (any == 0) keys[i] |= kKeySmooth;
  }
}

int16_t filter_point(const int16_t* at, ptrdiff_t stride, const int16_t* taps_x, const int16_t* taps_y) {
  int32_t sum = 512;
  for (int j = 0; j < kWarpTaps; ++j) {
    int32_t v = 128;
    for (int k = 0; k < kWarpTaps; ++k) v += taps_y[k] * at[k * stride + j];
    sum += taps_x[j] * (v >> 8);
  }
  return static_cast<int16_t>(sum >> 10);
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

void filter_edge_points(const int16_t* plane, ptrdiff_t stride, const uint32_t* map, ptrdiff_t map_stride,
                        const int16_t* taps, const WarpEdge* edges, size_t n, int16_t* out) {
  for (size_t i = 0; i < n; ++i) {
    const WarpEdge& edge = edges[i];
    int16_t patch[kWarpTaps * kWarpTapStride];
    for (int k = 0; k < kWarpTaps; ++k)
      for (int j = 0; j < kWarpTaps; ++j) {
        const uint32_t key = map[edge.map_offset + k * map_stride + j] & kKeyBits;
        const auto apart = static_cast<int32_t>(key - edge.wanted);
        patch[k * kWarpTapStride + j] =
            apart <= kKeyTolerance && apart >= -kKeyTolerance ? plane[edge.offset + k * stride + j] : edge.stand_in;
      }
    out[i] =
        filter_point(patch, kWarpTapStride, taps + kWarpTapStride * edge.phase_x, taps + kWarpTapStride * edge.phase_y);
  }
}

uint8_t to_byte(int value) {
  return static_cast<uint8_t>(value < 0 ? 0 : value > 255 ? 255 : value);
}

void add_carried_row(const uint8_t* base, const int16_t* carried, size_t n, uint8_t* out) {
  for (size_t i = 0; i < n; ++i) out[i] = to_byte(base[i] + ((carried[i] + (1 << (kCarriedBits - 1))) >> kCarriedBits));
}

void composite_signed_row(const uint8_t* low, const int16_t* d, const int16_t* u, const int16_t* v, size_t n,
                          uint8_t* rgb) {
  constexpr int kHalf = 1 << 15;
  for (size_t i = 0; i < n; ++i) {
    rgb[3 * i] = to_byte(low[3 * i] + d[i] + ((91881 * v[i] + kHalf) >> 16));
    rgb[3 * i + 1] = to_byte(low[3 * i + 1] + d[i] + ((-22554 * u[i] - 46802 * v[i] + kHalf) >> 16));
    rgb[3 * i + 2] = to_byte(low[3 * i + 2] + d[i] + ((116130 * u[i] + kHalf) >> 16));
  }
}

}  // namespace

void fill_warp_scalar(WarpKernels& table) {
  table.reproject_row = reproject_row;
  table.filter_points = filter_points;
  table.surface_keys_row = surface_keys_row;
  table.place_points = place_points;
  table.mark_mixed = mark_mixed;
  table.mark_smooth = mark_smooth;
  table.filter_edge_points = filter_edge_points;
  table.add_carried_row = add_carried_row;
  table.composite_signed_row = composite_signed_row;
}

}  // namespace pac
