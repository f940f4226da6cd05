// Every instruction set's reprojection equals the scalar one, bit for bit.
#include <doctest/doctest.h>

#include <algorithm>
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
      // The same of two planes: another one is this one with some samples of 0.
      std::vector<int16_t> other = plane, both[2] = {out[0], out[0]};
      for (int16_t& sample : other) sample = (next_random(state) & 1) != 0 || round % 5 == 0 ? int16_t{0} : sample;
      scalar.filter_points(other.data(), kStride, sim::kWarpFilter.data(), x.data(), y.data(), present.data(), n,
                           out[1].data());
      const int16_t* const planes[2] = {plane.data(), other.data()};
      int16_t* const results[2] = {both[0].data(), both[1].data()};
      both[0].assign(n + 1, 99);
      both[1].assign(n + 1, 99);
      kernels_for(isa)->warp.filter_both(planes, kStride, sim::kWarpFilter.data(), x.data(), y.data(), present.data(),
                                         n, results);
      REQUIRE(both[0] == out[0]);
      REQUIRE(both[1] == out[1]);
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

// A map of some keys with the border that maps have.
struct SomeMap {
  std::vector<uint32_t> keys = std::vector<uint32_t>(kMapStride * kMapRows);

  explicit SomeMap(uint32_t& state) {
    for (int y = 0; y < kMapRows - 2 * kMapBorder; ++y)
      for (int x = 0; x < kMapStride - 2 * kMapBorder; ++x)
        keys[static_cast<size_t>((y + kMapBorder) * kMapStride + x + kMapBorder)] = some_key(state, true);
  }
  KeyMap view() const {
    return {keys.data() + kMapBorder * kMapStride + kMapBorder, kMapStride,
            static_cast<int>(kMapStride) - 2 * kMapBorder, kMapRows - 2 * kMapBorder};
  }
};

// Arrays of exactly n places, one more that nobody may write.
struct SomePlaces {
  std::vector<int32_t> x, y;
  std::vector<uint8_t> states;
  std::vector<uint32_t> wanted;

  explicit SomePlaces(size_t n) : x(n + 1, 77), y(n + 1, 77), states(n + 1, 77), wanted(n + 1, 77) {}
  WarpPlaces view() { return {x.data(), y.data(), states.data(), wanted.data()}; }
  bool operator==(const SomePlaces&) const = default;
};

TEST_CASE("points in the frame before are equal on every instruction set, inside, outside and nowhere") {
  const WarpKernels& scalar = kernels_for(Isa::scalar)->warp;
  uint32_t state = 13;
  size_t plain = 0, edges = 0;
  for (const Isa isa : {Isa::sse41, Isa::avx2, Isa::neon}) {
    if (kernels_for(isa) == nullptr) continue;
    for (int round = 0; round < 400; ++round) {
      const SomeMap map(state);
      const size_t n = static_cast<size_t>(round % 101), first = static_cast<size_t>(round % 3) * 9;
      // Around the identity: near the row, and beyond the sides of the map.
      ReprojectionRow row = {{between(state, -576, 576), between(state, -192, 1600), between(state, -0.1f, 0.1f), 1.0f},
                             {between(state, 13, 77), between(state, -13, 13), 0.0f, 0.0f},
                             {between(state, -256, 256), between(state, -256, 256), between(state, 0.9f, 1.1f), 0.0f}};
      if (round % 16 == 7) row.origin[3] = -1.0f;
      std::vector<float> depth(n);
      std::vector<uint32_t> now(n);
      for (size_t i = 0; i < n; ++i) {
        const float depths[] = {0.5f, 0.47f, 1.0f, 0.0f, between(state, 0, 1)};
        depth[i] = depths[next_random(state) % 5];
        now[i] = round % 5 == 0 && i % 64 < 40 ? 0 : some_key(state, true);
      }
      const WarpKernels* tables[] = {&scalar, &kernels_for(isa)->warp};
      SomePlaces full[2] = {SomePlaces(n), SomePlaces(n)}, half[2] = {SomePlaces(n / 2), SomePlaces(n / 2)};
      for (int side = 0; side < 2; ++side) {
        const WarpCounts found =
            tables[side]->find_points(row, first, depth.data(), now.data(), map.view(), n, full[side].view());
        const WarpCounts halves =
            tables[side]->find_half_points(full[side].view(), map.view(), n / 2, half[side].view());
        REQUIRE(found.plain == static_cast<size_t>(std::ranges::count(full[side].states, kWarpPlain)));
        REQUIRE(found.edges == static_cast<size_t>(std::ranges::count(full[side].states, kWarpEdge)));
        REQUIRE(halves.plain == static_cast<size_t>(std::ranges::count(half[side].states, kWarpPlain)));
        REQUIRE(halves.edges == static_cast<size_t>(std::ranges::count(half[side].states, kWarpEdge)));
        plain += found.plain;
        edges += found.edges;
      }
      REQUIRE(full[0] == full[1]);
      REQUIRE(half[0] == half[1]);
    }
  }
  if (kernels_for(Isa::avx2) == nullptr) return;
  CHECK(plain > 500);
  CHECK(edges > 500);
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
  constexpr ptrdiff_t kStride = 56;
  const WarpKernels& scalar = kernels_for(Isa::scalar)->warp;
  uint32_t state = 19;
  for (const Isa isa : {Isa::sse41, Isa::avx2, Isa::neon}) {
    if (kernels_for(isa) == nullptr) continue;
    for (int round = 0; round < 200; ++round) {
      std::vector<int16_t> planes[2];
      for (std::vector<int16_t>& plane : planes) {
        plane.resize(kStride * (kMapRows + 8));
        for (int16_t& sample : plane) {
          const int value = static_cast<int>(next_random(state) % 16384) - 8192;
          sample = static_cast<int16_t>(round % 3 == 0 ? (value < 0 ? -8192 : 8191) : value);
        }
      }
      const SomeMap map(state);
      const KeyMap view = map.view();
      const auto n = static_cast<size_t>(round % 23 + (round % 20 == 19 ? 500 : 0));
      SomePlaces places(n);
      for (size_t i = 0; i < n; ++i) {
        places.x[i] = static_cast<int32_t>(next_random(state) % static_cast<uint32_t>(view.width * 64)) - 32;
        places.y[i] = static_cast<int32_t>(next_random(state) % static_cast<uint32_t>(view.height * 64)) - 32;
        if (i % 5 == 0) places.x[i] &= ~63;
        places.states[i] = static_cast<uint8_t>(next_random(state) % 3);
        places.wanted[i] = some_key(state, false) | 1;
        if (places.states[i] == kWarpAbsent) places.x[i] = places.y[i] = kWarpNowhere;
      }
      std::vector<int16_t> out[2], means[2][2];
      size_t lost[2][2];
      const WarpKernels* tables[] = {&scalar, &kernels_for(isa)->warp};
      for (int side = 0; side < 2; ++side) {
        out[side].assign(n + 1, 999);
        for (std::vector<int16_t>& mean : means[side]) mean.assign(n + 1, 999);
        const int16_t* const samples[2] = {planes[0].data() + 8 * kStride + 8, planes[1].data() + 8 * kStride + 8};
        int16_t* const to[2] = {means[side][0].data(), means[side][1].data()};
        lost[side][0] = tables[side]->filter_edges(samples[0], kStride, view, sim::kWarpFilter.data(), places.view(), n,
                                                   out[side].data());
        lost[side][1] = tables[side]->mean_edges(samples, kStride, view, places.view(), n, to);
      }
      REQUIRE(out[0] == out[1]);
      REQUIRE(lost[0][0] == lost[1][0]);
      REQUIRE(lost[0][1] == lost[1][1]);
      for (int k = 0; k < 2; ++k) REQUIRE(means[0][k] == means[1][k]);
    }
  }
}

TEST_CASE("where the filter meets one surface only is marked alike on every instruction set") {
  const WarpKernels& scalar = kernels_for(Isa::scalar)->warp;
  uint32_t state = 31;
  for (const Isa isa : {Isa::sse41, Isa::avx2, Isa::neon}) {
    if (kernels_for(isa) == nullptr) continue;
    const WarpKernels* tables[] = {&scalar, &kernels_for(isa)->warp};
    for (size_t n = 1; n < 200; ++n) {
      std::vector<uint32_t> above(n), here(n + 1);
      for (size_t i = 0; i <= n; ++i)
        here[i] = i % 9 == 0 ? some_key(state, false) : 7u << 16 | (0x3F00u + next_random(state) % 6);
      for (size_t i = 0; i < n; ++i)
        above[i] = i % 23 == 0 ? some_key(state, false) : 7u << 16 | (0x3F04u + next_random(state) % 6);
      const size_t words = (n + 63) / 64;
      std::vector<uint64_t> right[2], down[2], mixed(words);
      for (uint64_t& word : mixed) word = n % 7 == 0 ? ~uint64_t{0} : uint64_t{next_random(state)} << (n % 40);
      std::vector<uint32_t> keys[2];
      for (int side = 0; side < 2; ++side) {
        right[side].assign(words + 1, 77);
        down[side].assign(words + 1, 77);
        tables[side]->compare_keys(above.data(), here.data(), n, right[side].data(), down[side].data());
        keys[side].assign(n + 1, 77);
        tables[side]->mark_smooth(mixed.data(), n, keys[side].data());
      }
      REQUIRE(right[0] == right[1]);
      REQUIRE(down[0] == down[1]);
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
      const bool is_sparse = round % 6 == 5;  // most patches are 0
      for (int16_t& sample : plane) {
        const int value = static_cast<int>(next_random(state) % 16384) - 8192;
        sample = is_sparse && next_random(state) % 100 != 0 ? int16_t{0} : static_cast<int16_t>(value);
      }
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
  constexpr int kLargest = 255 << kCarriedBits;
  uint32_t state = 29;
  for (const Isa isa : {Isa::sse41, Isa::avx2, Isa::neon}) {
    if (kernels_for(isa) == nullptr) continue;
    for (size_t n = 0; n < 600; ++n) {
      std::vector<uint8_t> low(3 * n);
      std::vector<int16_t> d(n), u(n), v(n), carried(n), near(n + 33), far(n + 33);
      for (uint8_t& sample : low) sample = static_cast<uint8_t>(next_random(state));
      for (size_t i = 0; i < n; ++i) {
        d[i] = static_cast<int16_t>(static_cast<int>(next_random(state) % (2 * kLargest + 1)) - kLargest);
        carried[i] = static_cast<int16_t>(4 * d[i] - static_cast<int>(i % 64));
        u[i] = static_cast<int16_t>(static_cast<int>(n == 511 ? i % 511 : next_random(state) % 511) - 255);
        v[i] = static_cast<int16_t>(static_cast<int>(n == 511 ? 510 - i : next_random(state) % 511) - 255);
      }
      for (std::vector<int16_t>* row : {&near, &far})
        for (int16_t& sample : *row) {
          const auto any = static_cast<int>(next_random(state) % (2 * kLargest + 1)) - kLargest;
          sample = static_cast<int16_t>(n % 8 == 7 ? (any < 0 ? -kLargest : kLargest) : any);
        }
      std::vector<int16_t> twice[2] = {std::vector<int16_t>(2 * n + 1, 9), std::vector<int16_t>(2 * n + 1, 9)};
      std::vector<uint8_t> rgb[2] = {std::vector<uint8_t>(3 * n + 1, 9), std::vector<uint8_t>(3 * n + 1, 9)};
      std::vector<uint8_t> sum[2] = {std::vector<uint8_t>(n + 1, 9), std::vector<uint8_t>(n + 1, 9)};
      const WarpKernels* tables[] = {&scalar, &kernels_for(isa)->warp};
      for (int side = 0; side < 2; ++side) {
        if (n > 0) tables[side]->upsample_carried_row(near.data() + 1, far.data() + 1, n, twice[side].data());
        tables[side]->composite_signed_row(low.data(), d.data(), u.data(), v.data(), n, rgb[side].data());
        tables[side]->add_carried_row(low.data(), carried.data(), n, sum[side].data());
      }
      REQUIRE(twice[0] == twice[1]);
      REQUIRE(rgb[0] == rgb[1]);
      REQUIRE(sum[0] == sum[1]);
    }
  }
}

}  // namespace
