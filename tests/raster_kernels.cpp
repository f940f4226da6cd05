// The tile kernels of every instruction set equal the scalar ones.
#include <doctest/doctest.h>

#include <cstring>
#include <vector>

#include "raster/clip.h"
#include "raster/sample_pattern.h"
#include "raster/setup.h"
#include "raster/surface.h"
#include "tests/support/kernel_check.h"
#include "tests/support/raster_triangles.h"

namespace {

using namespace pac;
using namespace pac::raster;
using test::for_each_isa;
using namespace test_scenes;

constexpr int kTilePixels = kTileSize * kTileSize;

struct Tile {
  alignas(32) float depth[kTilePixels];
  alignas(32) uint32_t ids[kTilePixels];
};

TEST_CASE("rasterize: every instruction set gives the scalar bits, from slivers to the guard band") {
  for_each_isa([&](const Kernels& scalar, const Kernels& table) {
    Random random(5);
    const auto pattern = sample_pattern(16);
    Tile expected, actual;
    uint64_t covered = 0;
    for (int round = 0; round < 400; ++round) {
      std::fill(std::begin(expected.depth), std::end(expected.depth), 1.0f);
      std::fill(std::begin(expected.ids), std::end(expected.ids), 0u);
      actual = expected;
      const auto tile = static_cast<int32_t>(random.bits() % 4) * kTileSize * 256;
      const SampleOffset offset = pattern[random.bits() % 16];
      for (uint32_t id = 1; id <= 12; ++id) {
        RasterTriangle t{};
        if (!random_triangle(random, pattern, t)) continue;
        scalar.tile.rasterize(t, id, {tile + offset.x, offset.y}, expected.depth, expected.ids);
        table.tile.rasterize(t, id, {tile + offset.x, offset.y}, actual.depth, actual.ids);
      }
      REQUIRE(std::memcmp(&expected, &actual, sizeof expected) == 0);
      for (const uint32_t id : expected.ids) covered += id != 0 ? 1 : 0;
    }
    CHECK(covered > 10000);
  });
}

bool same_pack(const LanePack& a, const LanePack& b) {
  return a.triangle == b.triangle && a.x == b.x && a.y == b.y && a.mask == b.mask;
}

// What the samples of a tile see, by the grid kernels of one instruction set.
struct GridTile {
  alignas(32) uint32_t whole[kTilePixels];
  alignas(32) float near_z[kTilePixels], far_z[kTilePixels];
  alignas(32) uint32_t ids[kTilePixels * kGridSamples];
  alignas(32) float depth[kTilePixels * kGridSamples];
  SampleGrid grid;

  explicit GridTile(std::span<const SampleOffset> pattern) {
    grid = {static_cast<int>(pattern.size()), {}, {}, whole, near_z, far_z, ids, depth};
    for (size_t s = 0; s < kGridSamples; ++s) {
      grid.x[s] = pattern[s % pattern.size()].x;
      grid.y[s] = pattern[s % pattern.size()].y;
    }
  }
  uint32_t id_at(int pixel, int sample) const {
    return whole[pixel] == kSplitPixel ? ids[pixel * kGridSamples + sample] : whole[pixel];
  }
};

TEST_CASE("rasterize_grid: all samples at once see what each sees alone, on every instruction set") {
  for (const Isa isa : {Isa::scalar, Isa::sse41, Isa::avx2, Isa::neon}) {
    const Kernels* const table = kernels_for(isa);
    if (table == nullptr) continue;
    Random random(31);
    uint64_t n_whole = 0, n_split = 0;
    for (int round = 0; round < 300; ++round) {
      const auto pattern = sample_pattern(round % 3 == 0 ? 4 : 16);
      const auto corner = static_cast<int32_t>(random.bits() % 4) * kTileSize * 256;
      GridTile tile(pattern);
      std::vector<RasterTriangle> triangles;
      while (triangles.size() < 10) {
        RasterTriangle t{};
        if (random_triangle(random, pattern, t)) triangles.push_back(t);
        if (triangles.size() == 4) triangles.push_back(triangles[1]);  // equal depth: the earlier one stays
      }
      std::vector<const RasterTriangle*> list;
      for (const RasterTriangle& t : triangles) list.push_back(&t);
      table->tile.rasterize_grid(list.data(), static_cast<uint32_t>(list.size()), {corner, corner}, tile.grid);
      for (size_t i = 0; i < triangles.size(); ++i) triangles[i].id = static_cast<uint32_t>(1000 + i);
      Tile first;
      std::fill(std::begin(first.depth), std::end(first.depth), 7.0f);  // beyond width and height it stays
      std::fill(std::begin(first.ids), std::end(first.ids), 7u);
      const int width = kTileSize - round % 9, height = kTileSize - round % 4;
      table->tile.first_sample(tile.grid, width, height, list.data(), {corner, corner},
                               {first.depth, kTileSize, first.ids, kTileSize});
      for (int s = 0; s < tile.grid.n; ++s) {
        Tile expected;
        std::fill(std::begin(expected.depth), std::end(expected.depth), 1.0f);
        std::fill(std::begin(expected.ids), std::end(expected.ids), 0u);
        for (uint32_t i = 0; i < list.size(); ++i)
          kernels_for(Isa::scalar)
              ->tile.rasterize(*list[i], i + 1, {corner + tile.grid.x[s], corner + tile.grid.y[s]}, expected.depth,
                               expected.ids);
        bool same = true;
        for (int pixel = 0; pixel < kTilePixels; ++pixel) same = same && tile.id_at(pixel, s) == expected.ids[pixel];
        for (int pixel = 0; s == 0 && pixel < kTilePixels; ++pixel) {
          const bool in = pixel % kTileSize < width && pixel / kTileSize < height;
          same = same && first.depth[pixel] == (in ? expected.depth[pixel] : 7.0f);
          const uint32_t id = expected.ids[pixel] == 0 ? 0 : 999 + expected.ids[pixel];
          same = same && first.ids[pixel] == (in ? id : 7u);
        }
        REQUIRE(same);
      }
      for (const uint32_t id : tile.whole) (id == kSplitPixel ? n_split : n_whole) += id != 0 ? 1 : 0;
    }
    CHECK(n_split > 5000);
    if (isa != Isa::scalar) CHECK(n_whole > 5000);
  }
}

TEST_CASE("collect_grid: every instruction set gives the scalar packs, whichever form the pixels have") {
  for_each_isa([&](const Kernels& scalar, const Kernels& table) {
    Random random(37);
    std::vector<RasterTriangle> triangles(20);
    std::vector<const RasterTriangle*> list;
    for (const RasterTriangle& t : triangles) list.push_back(&t);
    std::vector<LanePack> expected(kTilePixels * kGridSamples), actual(kTilePixels * kGridSamples);
    for (int round = 0; round < 100; ++round) {
      GridTile tile(sample_pattern(16));
      const uint32_t kinds = 1 + random.bits() % 20;
      for (int pixel = 0; pixel < kTilePixels; ++pixel) {
        tile.whole[pixel] = random.bits() % 3 == 0 ? kSplitPixel : round % 2 == 0 ? 7 % kinds : random.bits() % kinds;
        for (int s = 0; s < kGridSamples; ++s) tile.ids[pixel * kGridSamples + s] = random.bits() % kinds;
      }
      const uint32_t samples = round % 4 == 0 ? 0xFFFF : 1 + random.bits() % 0xFFFF;
      const int first = static_cast<int>(random.bits() % 16), width = 1 + static_cast<int>(random.bits() % kTileSize);
      const int n = scalar.tile.collect_grid(tile.grid, samples, first, first + 8, width, list.data(), expected.data());
      REQUIRE(table.tile.collect_grid(tile.grid, samples, first, first + 8, width, list.data(), actual.data()) == n);
      for (size_t i = 0; i < static_cast<size_t>(n); ++i) {
        REQUIRE(same_pack(expected[i], actual[i]));
        REQUIRE(std::memcmp(expected[i].weight, actual[i].weight, 8) == 0);
      }
    }
  });
}

TEST_CASE("interpolate: every instruction set gives the scalar bits, inside and outside the triangles") {
  for_each_isa([&](const Kernels& scalar, const Kernels& table) {
    for (uint32_t seed = 1; seed <= 40; ++seed) {
      const int n = 1 + static_cast<int>(seed * 7 % kBatchPacks);
      const PackedTriangles input = random_packs(seed, n);
      std::vector<float> expected(kBatchLanes * (kMaxAttributes + 1), -1.0f), actual = expected;
      InterpolateTarget target{static_cast<int>(seed % 2),
                               static_cast<int>(3 + seed % 9),
                               expected.data(),
                               nullptr,
                               1,
                               256,
                               64,
                               -1,
                               seed % 3 != 0};
      for (int with_lod = 0; with_lod < 2; ++with_lod) {
        target.rows = expected.data();
        target.lod = with_lod != 0 ? expected.data() + kBatchLanes * kMaxAttributes : nullptr;
        scalar.tile.interpolate(input.packs.data(), n, {128, 128}, target);
        target.rows = actual.data();
        target.lod = with_lod != 0 ? actual.data() + kBatchLanes * kMaxAttributes : nullptr;
        table.tile.interpolate(input.packs.data(), n, {128, 128}, target);
        REQUIRE(std::memcmp(expected.data(), actual.data(), expected.size() * sizeof(float)) == 0);
      }
    }
  });
}

TEST_CASE("collect_packs: every instruction set gives the scalar packs") {
  for_each_isa([&](const Kernels& scalar, const Kernels& table) {
    Random random(3);
    std::vector<RasterTriangle> triangles(300);
    std::vector<const RasterTriangle*> list;
    for (const RasterTriangle& t : triangles) list.push_back(&t);
    std::vector<LanePack> expected(kTilePixels), actual(kTilePixels);
    for (int round = 0; round < 60; ++round) {
      const uint32_t kinds = 1 + random.bits() % (round % 3 == 0 ? 300 : 3);
      alignas(32) uint32_t ids[kTilePixels];
      for (uint32_t& id : ids) id = random.bits() % (kinds + 1);
      const int width = 1 + static_cast<int>(random.bits() % kTileSize),
                height = 1 + static_cast<int>(random.bits() % kTileSize);
      const int n = scalar.tile.collect_packs(ids, width, height, list.data(), expected.data());
      REQUIRE(table.tile.collect_packs(ids, width, height, list.data(), actual.data()) == n);
      for (size_t i = 0; i < static_cast<size_t>(n); ++i) {
        REQUIRE(same_pack(expected[i], actual[i]));
      }
    }
  });
}

TEST_CASE("light: every instruction set gives the scalar bits, degenerate normals and lights included") {
  for_each_isa([&](const Kernels& scalar, const Kernels& table) {
    Random random(11);
    for (int round = 0; round < 60; ++round) {
      LightingParameters m{};
      m.shininess = round % 5 == 0 ? 0 : static_cast<int32_t>(random.bits() % 1001);
      m.has_specular = round % 4 != 0 ? 1 : 0;
      m.light_count = round % 4;
      for (int c = 0; c < 3; ++c) {
        m.eye[c] = random.between(-5, 5);
        m.emission[c] = random.between(0, 50);
        m.ambient[c] = random.between(0, 100);
      }
      for (int i = 0; i < m.light_count; ++i) {
        KernelLight& light = m.lights[i];
        light.is_point = random.bits() % 2 == 0 ? 1 : 0;
        light.inverse_range = random.bits() % 2 == 0 ? 0.0f : random.unit();
        light.cone_scale = random.bits() % 2 == 0 ? 0.0f : random.between(1, 50);
        light.cone_offset = light.cone_scale == 0 ? 1.0f : random.between(-30, 1);
        for (float& component : light.axis) component = random.between(-1, 1);
        for (int c = 0; c < 3; ++c) {
          light.vector[c] = random.between(-1, 1);
          light.diffuse[c] = random.between(0, 255);
          light.specular[c] = random.between(0, 255);
        }
      }
      std::vector<float> normal(3 * kBatchLanes), position(3 * kBatchLanes), color(3 * kBatchLanes),
          specular(3 * kBatchLanes);
      for (float& f : normal) f = random.between(-2, 2);
      for (float& f : position) f = random.between(-3, 3);
      for (float& f : color) f = random.between(0, 255);
      for (size_t c = 0; c < 3; ++c) {
        normal[c * kBatchLanes] = 0;                                                   // no normal
        normal[c * kBatchLanes + 1] = c == 0 ? NAN : 1.0f;                             // not a number
        position[c * kBatchLanes + 2] = m.eye[c];                                      // at the eye
        if (m.light_count > 0) position[c * kBatchLanes + 3] = m.lights[0].vector[c];  // at the light
        normal[c * kBatchLanes + 4] = 1e30f;                                           // too long
      }
      std::vector<float> color2 = color, specular2 = specular;
      const int n = 1 + static_cast<int>(random.bits() % kBatchLanes);
      std::vector<float> factors((kMaxKernelLights + 1) * kBatchLanes);
      for (float& f : factors) f = random.unit();
      const float* visibility = random.bits() % 2 == 0 ? nullptr : factors.data();
      scalar.tile.light(m, n, normal.data(), position.data(), visibility, color.data(), specular.data());
      table.tile.light(m, n, normal.data(), position.data(), visibility, color2.data(), specular2.data());
      REQUIRE(std::memcmp(color.data(), color2.data(), color.size() * sizeof(float)) == 0);
      REQUIRE(std::memcmp(specular.data(), specular2.data(), specular.size() * sizeof(float)) == 0);
      for (int k = 0; k < n; ++k) REQUIRE(std::isfinite(color[static_cast<size_t>(k)]));
    }
  });
}

TEST_CASE("sample_texture: every instruction set gives the scalar bits for every size, wrap and filter") {
  for_each_isa([&](const Kernels& scalar, const Kernels& table) {
    Random random(17);
    constexpr int kSizes[][2] = {{1, 1}, {1, 7}, {9, 1}, {2, 2}, {64, 64}, {37, 53}, {256, 16}, {211, 211}};
    for (const auto& size : kSizes) {
      const Texture texture = test_scenes::pattern_texture(size[0], size[1], 3);
      for (int mode = 0; mode < 6; ++mode) {
        CAPTURE(size[0]);
        CAPTURE(size[1]);
        CAPTURE(mode);
        Scene scene;
        scene.textures.push_back(texture);
        scene.materials.emplace_back();
        scene.materials[0].texture = 0;
        scene.materials[0].wrap = mode % 2 == 0 ? Wrap::repeat : Wrap::clamp;
        scene.materials[0].filter = mode / 2 == 0   ? Filter::nearest
                                    : mode / 2 == 1 ? Filter::bilinear
                                                    : Filter::trilinear;
        std::vector<Surface> surfaces;
        REQUIRE(prepare_surfaces(scene, test_scenes::room_camera(), {}, nullptr, surfaces).ok());
        std::vector<float> u(kBatchLanes), v(kBatchLanes), lod(kBatchLanes), expected(3 * kBatchLanes),
            actual(3 * kBatchLanes);
        for (int round = 0; round < 6; ++round) {
          const float span = round == 0 ? 1.0f : round == 1 ? 1e-3f : round == 2 ? 1e9f : 4.0f;
          for (float& f : u) f = random.between(-span, span);
          for (float& f : v) f = random.between(-span, span);
          for (float& f : lod) f = round % 2 == 0 ? random.between(-3, 12) : random.between(1.2f, 1.4f);
          for (size_t k = 0; k < 16; ++k) {  // exact edges and centers of texels
            u[k] = static_cast<float>(k) * 0.5f / static_cast<float>(size[0]);
            v[k] = -static_cast<float>(k) * 0.5f / static_cast<float>(size[1]);
          }
          u[16] = -1e-9f;
          v[16] = 1.0f;
          scalar.tile.sample_texture(surfaces[0].sampler, kBatchLanes, u.data(), v.data(), lod.data(), expected.data());
          table.tile.sample_texture(surfaces[0].sampler, kBatchLanes, u.data(), v.data(), lod.data(), actual.data());
          REQUIRE(std::memcmp(expected.data(), actual.data(), expected.size() * sizeof(float)) == 0);
        }
      }
    }
  });
}

TEST_CASE("accumulate and resolve_row: every instruction set gives the scalar bits") {
  for_each_isa([&](const Kernels& scalar, const Kernels& table) {
    Random random(23);
    const uint8_t background[3] = {10, 200, 255};
    for (int round = 0; round < 40; ++round) {
      const int n = 1 + static_cast<int>(random.bits() % kBatchPacks);
      const PackedTriangles input = random_packs(static_cast<uint32_t>(round), n);
      std::vector<float> color(3 * kBatchLanes), texels(3 * kBatchLanes), specular(3 * kBatchLanes);
      for (float& f : color) f = random.between(-100, 500);
      for (float& f : texels) f = random.between(0, 255);
      for (float& f : specular) f = random.between(0, 300);
      std::vector<uint16_t> expected(3 * kTilePixels), actual;
      for (uint16_t& s : expected) s = static_cast<uint16_t>(random.bits());
      actual = expected;
      const float* t = round % 2 != 0 ? texels.data() : nullptr;
      const float* s = round % 4 >= 2 ? specular.data() : nullptr;
      const bool weighted = round % 8 >= 4;
      scalar.tile.accumulate(input.packs.data(), n, weighted, color.data(), t, s, background, expected.data());
      table.tile.accumulate(input.packs.data(), n, weighted, color.data(), t, s, background, actual.data());
      REQUIRE(expected == actual);
    }
    test::KernelCheck check(4096);
    std::vector<uint16_t> sums(3 * kTilePixels);
    for (uint16_t& s : sums) s = static_cast<uint16_t>(random.bits() % 16384);
    for (int width = 1; width <= kTileSize; ++width)
      for (const int shift : {0, 2, 4, 6}) {
        for (uint16_t& s : sums) s = static_cast<uint16_t>(random.bits() % (256u << shift));
        check.compare<uint8_t>(
            3 * static_cast<size_t>(width), test::Guard::after, 0,
            [&](const Kernels& k, uint8_t* rgb) { k.tile.resolve_row(sums.data(), shift, width, rgb); });
      }
    static_cast<void>(table);
  });
}

}  // namespace
