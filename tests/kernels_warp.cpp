// Every instruction set's reprojection equals the scalar one, bit for bit.
#include <doctest/doctest.h>

#include <cstring>
#include <limits>
#include <vector>

#include "base/kernels/kernels.h"
#include "sim/warp_filter.h"

namespace {

using namespace pac;

uint32_t next_random(uint32_t& state) {
  state = state * 1664525u + 1013904223u;
  return state >> 8;
}

float between(uint32_t& state, float low, float high) {
  return low + (high - low) * static_cast<float>(next_random(state)) / 16777216.0f;
}

TEST_CASE("positions are equal on every instruction set, for cameras in front, behind and degenerate") {
  const WarpKernels& scalar = kernels_for(Isa::scalar)->warp;
  uint32_t state = 7;
  for (const Isa isa : {Isa::sse41, Isa::avx2, Isa::neon}) {
    if (kernels_for(isa) == nullptr) continue;
    for (int round = 0; round < 400; ++round) {
      ReprojectionRow row;
      const float spread = round % 4 == 0 ? 0.0f : round % 4 == 1 ? 1.0f : round % 4 == 2 ? 600.0f : 1e30f;
      for (int c = 0; c < 4; ++c) {
        row.origin[c] = between(state, -spread, spread);
        row.per_pixel[c] = between(state, -spread, spread) / 64;
        row.per_depth[c] = between(state, -spread, spread);
      }
      if (round % 16 == 5) row.origin[3] = std::numeric_limits<float>::quiet_NaN();
      const size_t n = static_cast<size_t>(round % 37);
      std::vector<float> depth(n), u[2];
      for (float& z : depth) z = between(state, 0, 1);
      std::vector<int32_t> x[2], y[2];
      const WarpKernels* tables[] = {&scalar, &kernels_for(isa)->warp};
      for (int side = 0; side < 2; ++side) {
        x[side].assign(n + 1, 77);
        y[side].assign(n + 1, 77);
        u[side].assign(n + 1, 77.0f);
        tables[side]->reproject_row(row, depth.data(), n, x[side].data(), y[side].data(), u[side].data());
      }
      REQUIRE(x[0] == x[1]);
      REQUIRE(y[0] == y[1]);
      REQUIRE(std::memcmp(u[0].data(), u[1].data(), u[0].size() * sizeof(float)) == 0);
    }
  }
}

TEST_CASE("the filter is equal on every instruction set, at the extremes of its samples") {
  constexpr ptrdiff_t kStride = 64;
  const WarpKernels& scalar = kernels_for(Isa::scalar)->warp;
  uint32_t state = 11;
  for (const Isa isa : {Isa::sse41, Isa::avx2, Isa::neon}) {
    if (kernels_for(isa) == nullptr) continue;
    for (int round = 0; round < 200; ++round) {
      std::vector<int16_t> plane(kStride * 16);
      for (int16_t& sample : plane) {
        const int value = static_cast<int>(next_random(state) % 511) - 255;
        sample = static_cast<int16_t>(round % 3 == 0 ? (value < 0 ? -255 : 255) : value);
      }
      const auto n = static_cast<size_t>(round % 23);
      std::vector<int32_t> offset(n);
      std::vector<uint8_t> phase_x(n), phase_y(n);
      for (size_t i = 0; i < n; ++i) {
        offset[i] = static_cast<int32_t>(next_random(state) % (kStride * 10));
        phase_x[i] = static_cast<uint8_t>(next_random(state) % kWarpPhases);
        phase_y[i] = static_cast<uint8_t>(next_random(state) % kWarpPhases);
      }
      std::vector<int16_t> out[2] = {std::vector<int16_t>(n + 1, 99), std::vector<int16_t>(n + 1, 99)};
      scalar.filter_points(plane.data(), kStride, sim::kWarpFilter.data(), offset.data(), phase_x.data(),
                           phase_y.data(), n, out[0].data());
      kernels_for(isa)->warp.filter_points(plane.data(), kStride, sim::kWarpFilter.data(), offset.data(),
                                           phase_x.data(), phase_y.data(), n, out[1].data());
      REQUIRE(out[0] == out[1]);
    }
  }
}

TEST_CASE("patches near edges are equal on every instruction set, at depths within and just beyond the tolerance") {
  constexpr ptrdiff_t kStride = 40, kMapStride = 48;
  constexpr int kRows = 12;
  const WarpKernels& scalar = kernels_for(Isa::scalar)->warp;
  uint32_t state = 13;
  for (const Isa isa : {Isa::sse41, Isa::avx2, Isa::neon}) {
    if (kernels_for(isa) == nullptr) continue;
    for (int round = 0; round < 200; ++round) {
      std::vector<int16_t> plane(kStride * kRows);
      for (int16_t& sample : plane) sample = static_cast<int16_t>(static_cast<int>(next_random(state) % 511) - 255);
      std::vector<uint32_t> surface(kMapStride * kRows);
      for (uint32_t& number : surface) number = next_random(state) % 4 == 0 ? 0x80000001u : 7u;
      std::vector<float> u(kMapStride * kRows);
      for (float& value : u) {
        const float around[] = {0.5f, 0.5f * 16 / 17, 0.5f * 16 / 15, 0.5f * 17 / 16, 0.0f, between(state, 0.4f, 0.6f)};
        value = around[next_random(state) % 6];
      }
      if (round % 8 == 3) u[kMapStride * 6 + 9] = std::numeric_limits<float>::quiet_NaN();
      std::vector<EdgePoint> points(static_cast<size_t>(round % 9));
      for (EdgePoint& point : points) {
        const int x = static_cast<int>(next_random(state) % 20), y = static_cast<int>(next_random(state) % 6);
        point = {static_cast<int32_t>(y * kStride + x), static_cast<int32_t>(y * kMapStride + x),
                 next_random(state) % 5 == 0 ? 0x80000001u : 7u, round % 16 == 4 ? 0.0f : 0.5f,
                 static_cast<int16_t>(static_cast<int>(next_random(state) % 511) - 255)};
      }
      std::vector<int16_t> patches[2];
      const WarpKernels* tables[] = {&scalar, &kernels_for(isa)->warp};
      for (int side = 0; side < 2; ++side) {
        patches[side].assign(points.size() * kEdgePatch + 1, 99);
        tables[side]->cut_patches(plane.data(), kStride, surface.data(), u.data(), kMapStride, points.data(),
                                  points.size(), patches[side].data());
        for (size_t i = 0; i < points.size() * kEdgePatch; ++i)
          if (i % kWarpTapStride >= kWarpTaps) patches[side][i] = 0;  // may hold anything
      }
      REQUIRE(patches[0] == patches[1]);
    }
  }
}

}  // namespace
