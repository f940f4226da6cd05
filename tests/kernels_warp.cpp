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
        const int value = static_cast<int>(next_random(state) % 16384) - 8192;
        sample = static_cast<int16_t>(round % 3 == 0 ? (value < 0 ? -8192 : 8191) : value);
      }
      const auto n = static_cast<size_t>(round % 23);
      std::vector<int32_t> x(n), y(n);
      std::vector<uint8_t> present(n);
      for (size_t i = 0; i < n; ++i) {
        x[i] = 64 * kWarpTapsBefore + static_cast<int32_t>(next_random(state) % (64 * 48));
        y[i] = 64 * kWarpTapsBefore + static_cast<int32_t>(next_random(state) % (64 * 8));
        present[i] =
            static_cast<uint8_t>(next_random(state) % (round % 2 == 0 ? 3 : 30) == 0 ? kWarpAbsent : 1 + i % 2);
        if (present[i] == kWarpAbsent) x[i] = y[i] = i % 2 == 0 ? kWarpNowhere : 1 << 24;  // not to be read
      }
      std::vector<int16_t> out[2] = {std::vector<int16_t>(n + 1, 99), std::vector<int16_t>(n + 1, 99)};
      scalar.filter_points(plane.data(), kStride, sim::kWarpFilter.data(), x.data(), y.data(), present.data(), n,
                           out[0].data());
      kernels_for(isa)->warp.filter_points(plane.data(), kStride, sim::kWarpFilter.data(), x.data(), y.data(),
                                           present.data(), n, out[1].data());
      REQUIRE(out[0] == out[1]);
    }
  }
}

constexpr ptrdiff_t kMapStride = 48;
constexpr int kMapRows = 32, kMapBorder = 5;

// Keys around one of surface 7 at half the depth: within and just beyond the tolerance, of another surface, at the
// ends.
uint32_t some_key(uint32_t& state, bool with_smooth) {
  const uint32_t middle = 7u << 16 | 0x3F00u;
  const uint32_t around[] = {middle,   middle + 12, middle - 12, middle + 13,        middle - 13,
                             6u << 16, 0xFFFF3FFEu, 0,           8u << 16 | 0x3F00u, 7u << 16};
  const uint32_t key = around[next_random(state) % 10];
  return with_smooth && next_random(state) % 3 != 0 ? key | kKeySmooth : key;
}

TEST_CASE("places in the frame before are equal on every instruction set, inside, outside and nowhere") {
  const WarpKernels& scalar = kernels_for(Isa::scalar)->warp;
  uint32_t state = 13;
  for (const Isa isa : {Isa::sse41, Isa::avx2, Isa::neon}) {
    if (kernels_for(isa) == nullptr) continue;
    for (int round = 0; round < 200; ++round) {
      std::vector<uint32_t> keys(kMapStride * kMapRows);
      const int width = kMapStride - 2 * kMapBorder, height = kMapRows - 2 * kMapBorder;
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
          keys[static_cast<size_t>((y + kMapBorder) * kMapStride + x + kMapBorder)] = some_key(state, true);
      const KeyMap map{keys.data() + kMapBorder * kMapStride + kMapBorder, kMapStride, width, height};
      const auto n = static_cast<size_t>(round % 37);
      std::vector<int32_t> x(n), y(n);
      std::vector<float> u(n);
      std::vector<uint32_t> now(n);
      for (size_t i = 0; i < n; ++i) {
        x[i] = static_cast<int32_t>(next_random(state) % (kMapStride * 64)) - 320;
        y[i] = static_cast<int32_t>(next_random(state) % (kMapRows * 64)) - 320;
        if (next_random(state) % 16 == 0) x[i] = y[i] = round % 2 == 0 ? kWarpNowhere : 1 << 24;
        const float depths[] = {0.5f, 0.53f, 0.0f, -0.0f, -3.0f, 1e30f, 2e-20f, between(state, 0, 1)};
        u[i] = depths[next_random(state) % 8];
        now[i] = some_key(state, true);
      }
      std::vector<uint8_t> states[2];
      std::vector<uint32_t> wanted[2];
      size_t special[2];
      const WarpKernels* tables[] = {&scalar, &kernels_for(isa)->warp};
      for (int side = 0; side < 2; ++side) {
        wanted[side].assign(n + 1, 77);
        states[side].assign(n + 1, 77);
        special[side] = tables[side]->place_points(map, x.data(), y.data(), u.data(), now.data(), n,
                                                   {states[side].data(), wanted[side].data()});
      }
      REQUIRE(special[0] == special[1]);
      REQUIRE(wanted[0] == wanted[1]);
      REQUIRE(states[0] == states[1]);
    }
  }
}

TEST_CASE("keys of surfaces and depths are equal on every instruction set, for ids beyond the table, too") {
  const WarpKernels& scalar = kernels_for(Isa::scalar)->warp;
  uint32_t state = 17;
  const std::vector<uint32_t> surfaces = {0, 1, 65535, 65536, 70000, 3};
  for (const Isa isa : {Isa::sse41, Isa::avx2, Isa::neon}) {
    if (kernels_for(isa) == nullptr) continue;
    for (size_t n = 0; n < 40; ++n) {
      std::vector<uint32_t> id(n);
      std::vector<float> depth(n);
      for (size_t i = 0; i < n; ++i) {
        const uint32_t ids[] = {5, 6, 0xFFFFFFFFu, 0x80000000u, next_random(state) % 6};
        id[i] = ids[next_random(state) % 5];
        depth[i] = next_random(state) % 4 == 0 ? 1.0f : between(state, -0.5f, 1.5f);
      }
      for (const uint32_t* table : {surfaces.data(), static_cast<const uint32_t*>(nullptr)}) {
        std::vector<uint32_t> keys[2] = {std::vector<uint32_t>(n + 1, 9), std::vector<uint32_t>(n + 1, 9)};
        scalar.surface_keys_row(id.data(), depth.data(), table, surfaces.size(), n, keys[0].data());
        kernels_for(isa)->warp.surface_keys_row(id.data(), depth.data(), table, surfaces.size(), n, keys[1].data());
        REQUIRE(keys[0] == keys[1]);
      }
    }
  }
}

TEST_CASE("points near edges are equal on every instruction set, at depths within and just beyond the tolerance") {
  constexpr ptrdiff_t kStride = 40;
  constexpr int kRows = 12;
  const WarpKernels& scalar = kernels_for(Isa::scalar)->warp;
  uint32_t state = 19;
  for (const Isa isa : {Isa::sse41, Isa::avx2, Isa::neon}) {
    if (kernels_for(isa) == nullptr) continue;
    for (int round = 0; round < 200; ++round) {
      std::vector<int16_t> plane(kStride * kRows);
      for (int16_t& sample : plane) sample = static_cast<int16_t>(static_cast<int>(next_random(state) % 16384) - 8192);
      std::vector<uint32_t> keys(kMapStride * kRows);
      for (uint32_t& key : keys) key = some_key(state, true);
      std::vector<WarpEdge> edges(static_cast<size_t>(round % 9));
      for (WarpEdge& edge : edges) {
        const int x = static_cast<int>(next_random(state) % 20), y = static_cast<int>(next_random(state) % 6);
        edge = {static_cast<int32_t>(y * kStride + x),
                static_cast<int32_t>(y * kMapStride + x),
                some_key(state, false),
                static_cast<int16_t>(static_cast<int>(next_random(state) % 511) - 255),
                static_cast<uint8_t>(next_random(state) % kWarpPhases),
                static_cast<uint8_t>(next_random(state) % kWarpPhases)};
      }
      std::vector<int16_t> out[2];
      const WarpKernels* tables[] = {&scalar, &kernels_for(isa)->warp};
      for (int side = 0; side < 2; ++side) {
        out[side].assign(edges.size() + 1, 999);
        tables[side]->filter_edge_points(plane.data(), kStride, keys.data(), kMapStride, sim::kWarpFilter.data(),
                                         edges.data(), edges.size(), out[side].data());
      }
      REQUIRE(out[0] == out[1]);
    }
  }
}

TEST_CASE("where the filter meets one surface only is marked alike on every instruction set") {
  const WarpKernels& scalar = kernels_for(Isa::scalar)->warp;
  uint32_t state = 31;
  for (const Isa isa : {Isa::sse41, Isa::avx2, Isa::neon}) {
    if (kernels_for(isa) == nullptr) continue;
    const WarpKernels* tables[] = {&scalar, &kernels_for(isa)->warp};
    for (size_t n = 1; n < 60; ++n) {
      std::vector<uint32_t> here(n + 1), below(n + 1);
      for (size_t i = 0; i <= n; ++i) {
        here[i] = i % 9 == 0 ? some_key(state, false) : 7u << 16 | (0x3F00u + next_random(state) % 6);
        below[i] = i % 23 == 0 ? some_key(state, false) : 7u << 16 | (0x3F04u + next_random(state) % 6);
      }
      std::vector<uint8_t> mixed[2];
      std::vector<uint32_t> keys[2];
      std::vector<uint8_t> flags(n + 8);
      for (uint8_t& flag : flags) flag = next_random(state) % 12 == 0;
      const uint8_t* const rows[5] = {flags.data() + 1, flags.data() + 3, flags.data(), flags.data() + 4,
                                      flags.data() + 2};
      for (int side = 0; side < 2; ++side) {
        mixed[side].assign(n + 1, 77);
        tables[side]->mark_mixed(here.data(), below.data(), n, mixed[side].data());
        keys[side].assign(n + 1, 77);
        tables[side]->mark_smooth(rows, n, keys[side].data());
      }
      REQUIRE(mixed[0] == mixed[1]);
      REQUIRE(keys[0] == keys[1]);
    }
  }
}

TEST_CASE("points of one height, of a few and of many are filtered alike on every instruction set") {
  constexpr ptrdiff_t kStride = 64;
  const WarpKernels& scalar = kernels_for(Isa::scalar)->warp;
  uint32_t state = 23;
  for (const Isa isa : {Isa::sse41, Isa::avx2, Isa::neon}) {
    if (kernels_for(isa) == nullptr) continue;
    for (int round = 0; round < 100; ++round) {
      std::vector<int16_t> plane(kStride * 12);
      for (int16_t& sample : plane) sample = static_cast<int16_t>(static_cast<int>(next_random(state) % 16384) - 8192);
      constexpr size_t kPoints = 29;
      std::vector<int32_t> x(kPoints), y(kPoints);
      std::vector<uint8_t> present(kPoints, kWarpPlain);
      for (size_t i = 0; i < kPoints; ++i) {
        const auto spread = static_cast<int32_t>(next_random(state) % (round % 3 == 0 ? 80 : 16));
        x[i] = 64 * (kWarpTapsBefore + static_cast<int32_t>(i)) + spread + (round % 5 == 0 && i % 7 == 6 ? -100 : 0);
        y[i] = 64 * kWarpTapsBefore + round +
               static_cast<int32_t>(next_random(state) % (1 + static_cast<uint32_t>(round) % 8));
        if (round % 4 == 3 && i % 11 == 5) present[i] = kWarpAbsent;
      }
      std::vector<int16_t> out[2] = {std::vector<int16_t>(kPoints), std::vector<int16_t>(kPoints)};
      scalar.filter_points(plane.data(), kStride, sim::kWarpFilter.data(), x.data(), y.data(), present.data(), kPoints,
                           out[0].data());
      kernels_for(isa)->warp.filter_points(plane.data(), kStride, sim::kWarpFilter.data(), x.data(), y.data(),
                                           present.data(), kPoints, out[1].data());
      REQUIRE(out[0] == out[1]);
    }
  }
}

TEST_CASE("what is shown is equal on every instruction set, for every difference") {
  const WarpKernels& scalar = kernels_for(Isa::scalar)->warp;
  uint32_t state = 29;
  for (const Isa isa : {Isa::sse41, Isa::avx2, Isa::neon}) {
    if (kernels_for(isa) == nullptr) continue;
    for (size_t n = 0; n < 600; ++n) {
      std::vector<uint8_t> low(3 * n);
      std::vector<int16_t> d(n), u(n), v(n), carried(n);
      for (uint8_t& sample : low) sample = static_cast<uint8_t>(next_random(state));
      for (size_t i = 0; i < n; ++i) {
        d[i] = static_cast<int16_t>(static_cast<int>(next_random(state) % 511) - 255);
        carried[i] = static_cast<int16_t>(128 * d[i] - static_cast<int>(i % 64));
        u[i] = static_cast<int16_t>(static_cast<int>(n == 511 ? i % 511 : next_random(state) % 511) - 255);
        v[i] = static_cast<int16_t>(static_cast<int>(n == 511 ? 510 - i : next_random(state) % 511) - 255);
      }
      std::vector<uint8_t> rgb[2] = {std::vector<uint8_t>(3 * n + 1, 9), std::vector<uint8_t>(3 * n + 1, 9)};
      std::vector<uint8_t> sum[2] = {std::vector<uint8_t>(n + 1, 9), std::vector<uint8_t>(n + 1, 9)};
      const WarpKernels* tables[] = {&scalar, &kernels_for(isa)->warp};
      for (int side = 0; side < 2; ++side) {
        tables[side]->composite_signed_row(low.data(), d.data(), u.data(), v.data(), n, rgb[side].data());
        tables[side]->add_carried_row(low.data(), carried.data(), n, sum[side].data());
      }
      REQUIRE(rgb[0] == rgb[1]);
      REQUIRE(sum[0] == sum[1]);
    }
  }
}

}  // namespace
