// The kernels that color what a tile shows: lanes of many triangles, squares of 8 x 8 pixels and grids of samples give
// the bits that packs of one triangle give.
#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <set>
#include <vector>

#include "tests/support/kernel_check.h"
#include "tests/support/raster_triangles.h"

namespace {

using namespace pac;
using namespace pac::raster;
using namespace pac::test_scenes;
using test::for_each_isa;

constexpr int kTilePixels = kTileSize * kTileSize;

// The lanes in the masks of packs, and where each is in the packs' rows.
struct Lanes {
  std::vector<LaneSample> samples;
  std::vector<size_t> rows;

  explicit Lanes(const std::vector<LanePack>& packs) {
    for (size_t p = 0; p < packs.size(); ++p)
      for (unsigned k = 0; k < 8; ++k) {
        if ((packs[p].mask >> k & 1) == 0) continue;
        samples.push_back({packs[p].triangle, static_cast<uint8_t>(packs[p].x + k), packs[p].y, packs[p].weight[k]});
        rows.push_back(8 * p + k);
      }
  }
};

TEST_CASE("interpolate_lanes: a sample among those of other triangles gets the bits that its pack gives it") {
  for (int isa = 0; isa < kIsaCount; ++isa) {
    const Kernels* const table = kernels_for(static_cast<Isa>(isa));
    if (table == nullptr) continue;
    for (uint32_t seed = 1; seed <= 60; ++seed) {
      const int n = 1 + static_cast<int>(seed * 7 % kBatchPacks);
      const PackedTriangles input = random_packs(seed, n);
      const Lanes lanes(input.packs);
      if (lanes.samples.empty()) continue;
      std::vector<float> expected(kBatchLanes * (kMaxAttributes + 1), -1.0f), actual = expected;
      InterpolateTarget target{
          static_cast<int>(seed % 2), static_cast<int>(5 + seed % 9), expected.data(), nullptr, 3, 256, 64, -1};
      target.lod = seed % 3 == 0 ? nullptr : expected.data() + kBatchLanes * kMaxAttributes;
      kernels_for(Isa::scalar)->tile.interpolate(input.packs.data(), n, {128, 128}, target);
      target.rows = actual.data();
      target.lod = seed % 3 == 0 ? nullptr : actual.data() + kBatchLanes * kMaxAttributes;
      table->tile.interpolate_lanes(lanes.samples.data(), static_cast<int>(lanes.samples.size()), {128, 128}, target);
      for (size_t row = 0; row <= kMaxAttributes; ++row)
        for (size_t i = 0; i < lanes.rows.size(); ++i)
          REQUIRE(std::bit_cast<uint32_t>(expected[row * kBatchLanes + lanes.rows[i]]) ==
                  std::bit_cast<uint32_t>(actual[row * kBatchLanes + i]));
    }
  }
}

TEST_CASE("accumulate_lanes: samples by themselves add what their packs add") {
  for (int isa = 0; isa < kIsaCount; ++isa) {
    const Kernels* const table = kernels_for(static_cast<Isa>(isa));
    if (table == nullptr) continue;
    Random random(59);
    const uint8_t background[3] = {10, 200, 255};
    for (uint32_t round = 0; round < 40; ++round) {
      const int n = 1 + static_cast<int>(random.bits() % kBatchPacks);
      const PackedTriangles input = random_packs(round, n);
      const Lanes lanes(input.packs);
      if (lanes.samples.empty()) continue;
      std::vector<float> packed(9 * kBatchLanes), single(9 * kBatchLanes);  // color, texels, specular
      for (float& f : packed) f = random.between(-20, 300);
      for (size_t row = 0; row < 9; ++row)
        for (size_t i = 0; i < lanes.rows.size(); ++i)
          single[row * kBatchLanes + i] = packed[row * kBatchLanes + lanes.rows[i]];
      const bool textured = round % 2 != 0, specular = round % 4 >= 2, weighted = round % 8 >= 4;
      std::vector<uint16_t> expected(3 * kTilePixels, 1000), actual = expected;
      const auto part = [&](std::vector<float>& rows, bool wanted, size_t row) {
        return wanted ? rows.data() + row * kBatchLanes : nullptr;
      };
      kernels_for(Isa::scalar)
          ->tile.accumulate(input.packs.data(), n, weighted, packed.data(), part(packed, textured, 3),
                            part(packed, specular, 6), background, expected.data());
      table->tile.accumulate_lanes(lanes.samples.data(), static_cast<int>(lanes.samples.size()), weighted,
                                   single.data(), part(single, textured, 3), part(single, specular, 6), background,
                                   actual.data());
      REQUIRE(expected == actual);
    }
  }
}

// A tile that shows a few triangles, some larger than it, others of a pixel or two.
struct SeenTile {
  PackedTriangles input;
  std::vector<const RasterTriangle*> list;
  SamplePosition origin;
  alignas(32) uint32_t ids[kTilePixels];

  explicit SeenTile(uint32_t seed) : input(random_packs(seed, 1)), origin{128, 128} {
    for (RasterTriangle& t : input.triangles) {
      t.state[0] = static_cast<uint32_t>(list.size() % 3);
      t.state[1] = 0;
      list.push_back(&t);
    }
    std::vector<float> depth(kTilePixels, 1.0f);
    std::fill_n(ids, kTilePixels, 0u);
    const auto n = static_cast<uint32_t>(list.size());
    for (uint32_t i = 0; i < n && i <= seed; ++i)
      kernels_for(Isa::scalar)->tile.rasterize(*list[i], i + 1, origin, depth.data(), ids);
  }
};

std::vector<uint16_t> sums_of(const uint8_t background[3]) {
  std::vector<uint16_t> sums;
  for (int c = 0; c < 3; ++c) sums.insert(sums.end(), kTilePixels, background[c]);
  return sums;
}

// What painting sums of one sample a pixel gives: rows with 5 bytes between them, `before` where the picture is not.
constexpr ptrdiff_t kPaintStride = 3 * kTileSize + 5;
std::vector<uint8_t> painted(const std::vector<uint16_t>& sums, int width, int height, uint8_t before) {
  std::vector<uint8_t> rgb(static_cast<size_t>(kPaintStride) * kTileSize, before);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < 3 * width; ++x)
      rgb[static_cast<size_t>(y * kPaintStride + x)] =
          static_cast<uint8_t>(sums[static_cast<size_t>(x % 3 * kTilePixels + y * kTileSize + x / 3)]);
  return rgb;
}

// The colors that packs, interpolated and accumulated, give.
std::vector<uint16_t> colors_by_packs(const SeenTile& tile, int width, int height, int rendering,
                                      const uint8_t background[3]) {
  const TileKernels& scalar = kernels_for(Isa::scalar)->tile;
  std::vector<uint16_t> sums = sums_of(background);
  std::vector<LanePack> packs(kTilePixels);
  const int n = scalar.collect_packs(tile.ids, width, height, tile.list.data(), packs.data());
  std::vector<float> rows(3 * kBatchLanes);
  for (int first = 0; first < n; first += kBatchPacks) {
    const int count = std::min(kBatchPacks, n - first);
    scalar.interpolate(packs.data() + first, count, tile.origin,
                       {rendering, 3, rows.data(), nullptr, 0, 0, 0, 0, true});
    scalar.accumulate(packs.data() + first, count, false, rows.data(), nullptr, nullptr, background, sums.data());
  }
  return sums;
}

TEST_CASE("add_colors, paint_colors: the colors that packs give, in groups of one triangle and of many") {
  int many = 0, whole = 0;
  for (int isa = 0; isa < kIsaCount; ++isa) {
    const Kernels* const table = kernels_for(static_cast<Isa>(isa));
    if (table == nullptr) continue;
    Random random(61);
    const uint8_t background[3] = {10, 200, 255};
    for (uint32_t round = 0; round < 60; ++round) {
      const SeenTile tile(round);
      for (int i = 0; i < kTilePixels; i += 8) {
        const std::set<uint32_t> kinds(tile.ids + i, tile.ids + i + 8);
        many += kinds.size() > 4 ? 1 : 0;
        whole += kinds.size() == 1 && *kinds.begin() != 0 ? 1 : 0;
      }
      const int width = 1 + static_cast<int>(random.bits() % kTileSize), height = 32 - static_cast<int>(round % 4);
      const int rendering = static_cast<int>(round % 2);
      const std::vector<uint16_t> expected = colors_by_packs(tile, width, height, rendering, background);
      std::vector<uint16_t> sums = sums_of(background);
      const SampleIds sample{tile.ids, tile.origin};
      table->tile.add_colors(&sample, 1, width, height, tile.list.data(), rendering, background, sums.data());
      REQUIRE(expected == sums);
      std::vector<uint8_t> rgb = painted({}, 0, 0, 77);
      table->tile.paint_colors(tile.ids, width, height, tile.list.data(), rendering, tile.origin, background,
                               rgb.data(), kPaintStride);
      REQUIRE(painted(expected, width, height, 77) == rgb);
    }
  }
  CHECK(many > 5);
  CHECK(whole > 100);
}

TEST_CASE("add_colors, add_textured: several samples at once add what one after the other does") {
  const uint8_t background[3] = {10, 200, 255};
  const PaintedSurface plain[3] = {};
  for (int isa = 0; isa < kIsaCount; ++isa) {
    const Kernels* const table = kernels_for(static_cast<Isa>(isa));
    if (table == nullptr) continue;
    for (uint32_t round = 0; round < 20; ++round) {
      const SeenTile tile(round);
      std::vector<uint32_t> turned(tile.ids, tile.ids + kTilePixels);
      std::reverse(turned.begin(), turned.end());
      std::vector<uint32_t> few = turned;
      std::fill(few.begin() + 64, few.begin() + 400, 0u);
      const SampleIds samples[3] = {{tile.ids, tile.origin},
                                    {turned.data(), {tile.origin.x + 100, tile.origin.y - 30}},
                                    {few.data(), {tile.origin.x - 7, tile.origin.y + 64}}};
      const auto rendering = static_cast<int>(round % 2);
      std::vector<uint16_t> colors = sums_of(background), textured = colors, expected = colors;
      for (const SampleIds& sample : samples)
        table->tile.add_colors(&sample, 1, 29, 30, tile.list.data(), rendering, background, expected.data());
      table->tile.add_colors(samples, 3, 29, 30, tile.list.data(), rendering, background, colors.data());
      REQUIRE(expected == colors);
      table->tile.add_textured(samples, 3, 29, 30, tile.list.data(), rendering, plain, background, textured.data());
      REQUIRE(expected == textured);
    }
  }
}

// Grids of which every sample sees `first`, or those from `from[pixel]` on `second`.
struct ShownGrid {
  alignas(32) uint32_t whole[kTilePixels];
  alignas(32) uint32_t ids[kTilePixels * kGridSamples];
  SampleGrid grid{};

  ShownGrid(int n, const uint32_t* first, const uint32_t* second, const int* from) {
    grid.n = n;
    grid.whole = whole;
    grid.ids = ids;
    for (int i = 0; i < kTilePixels; ++i) {
      whole[i] = from == nullptr ? first[i] : kSplitPixel;
      for (int s = 0; from != nullptr && s < kGridSamples; ++s)
        ids[i * kGridSamples + s] = s < from[i] ? first[i] : second[i];
    }
  }
  std::vector<uint8_t> painted(const TileKernels& kernels, const SeenTile& tile, int width, int height, int rendering,
                               const uint8_t background[3]) const {
    std::vector<uint8_t> rgb(static_cast<size_t>(kPaintStride) * kTileSize, 77);
    kernels.paint_grid(grid, width, height, tile.list.data(), rendering, tile.origin, background, rgb.data(),
                       kPaintStride);
    return rgb;
  }
};

TEST_CASE("paint_grid: means of what the samples show, inside their triangles the colors of one sample a pixel") {
  for_each_isa([&](const Kernels& scalar, const Kernels& table) {
    Random random(67);
    int different = 0, compared = 0;
    const uint8_t background[3] = {10, 200, 255};
    for (uint32_t round = 0; round < 60; ++round) {
      const SeenTile tile(round);
      const int n = round % 3 == 0 ? 4 : 16, width = 1 + static_cast<int>(random.bits() % kTileSize);
      const int height = 32 - static_cast<int>(round % 4), rendering = static_cast<int>(round % 2);
      uint32_t neighbors[kTilePixels];  // seen outside of their triangles, too
      int from[kTilePixels];
      for (int i = 0; i < kTilePixels; ++i) {
        neighbors[i] = tile.ids[(i + 1) % kTilePixels];
        from[i] = static_cast<int>(random.bits() % static_cast<uint32_t>(n + 1));
      }
      const auto paint = [&](const TileKernels& kernels, const uint32_t* first, const uint32_t* second,
                             const int* place) {
        return ShownGrid(n, first, second, place).painted(kernels, tile, width, height, rendering, background);
      };
      const std::vector<uint8_t> own = paint(table.tile, tile.ids, nullptr, nullptr);
      const std::vector<uint8_t> next = paint(table.tile, neighbors, nullptr, nullptr);
      REQUIRE(own == paint(scalar.tile, tile.ids, nullptr, nullptr));
      REQUIRE(next == paint(scalar.tile, neighbors, nullptr, nullptr));
      const std::vector<uint8_t> mixed = paint(table.tile, tile.ids, neighbors, from);
      std::vector<uint8_t> once(own.size(), 77);
      table.tile.paint_colors(tile.ids, width, height, tile.list.data(), rendering, tile.origin, background,
                              once.data(), kPaintStride);
      const auto same_place = [&](uint32_t id) { return id == 0 || tile.list[id - 1]->planar == 0; };
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < 3 * width; ++x) {
          const auto at = static_cast<size_t>(y * kPaintStride + x);
          const int pixel = y * kTileSize + x / 3, first = from[pixel];
          different += own[at] != once[at] ? 1 : 0;
          if (tile.ids[pixel] != neighbors[pixel] && !(same_place(tile.ids[pixel]) && same_place(neighbors[pixel])))
            continue;  // planes and weights differ by roundings, and outside by more
          different += mixed[at] != (own[at] * first + next[at] * (n - first) + n / 2) / n ? 1 : 0;
          ++compared;
        }
      REQUIRE(different == 0);
      REQUIRE(mixed == paint(scalar.tile, tile.ids, neighbors, from));
    }
    CHECK(compared > 10000);
  });
}

TEST_CASE("collect_groups, interpolate_groups: each lane gets the bits that the pack of its own triangle gives it") {
  for (int isa = 0; isa < kIsaCount; ++isa) {
    const Kernels* const table = kernels_for(static_cast<Isa>(isa));
    if (table == nullptr) continue;
    const TileKernels& scalar = kernels_for(Isa::scalar)->tile;
    for (uint32_t round = 0; round < 60; ++round) {
      const SeenTile tile(round);
      const int rendering = static_cast<int>(round % 2), key = round % 4 == 3 ? -1 : rendering;
      std::vector<LanePack> packs(kTilePixels), same(kTilePixels);
      const int n = scalar.collect_groups(tile.ids, kTileSize, kTileSize, tile.list.data(), key, packs.data());
      REQUIRE(n == table->tile.collect_groups(tile.ids, kTileSize, kTileSize, tile.list.data(), key, same.data()));
      int lanes = 0;
      for (size_t i = 0; i < static_cast<size_t>(n); ++i) {
        const bool equal = packs[i].triangle == same[i].triangle && packs[i].x == same[i].x &&
                           packs[i].y == same[i].y && packs[i].mask == same[i].mask;
        REQUIRE(equal);
        lanes += std::popcount(packs[i].mask);
      }
      REQUIRE(lanes == std::count_if(tile.ids, tile.ids + kTilePixels, [](uint32_t id) { return id != 0; }));
      const int attributes = round % 5 == 0 ? 9 : 5 + static_cast<int>(round % 2);
      for (int first = 0; first < n; first += kBatchPacks) {
        const int count = std::min(kBatchPacks, n - first);
        const LanePack* const at = packs.data() + first;
        std::vector<float> expected(kBatchLanes * (kMaxAttributes + 1), -1.0f), actual = expected, own = expected;
        InterpolateTarget target{rendering, attributes, expected.data(), nullptr, 3, 256, 64, -1, true};
        const auto with_rows = [&](std::vector<float>& rows) {
          target.rows = rows.data();
          target.lod = round % 3 == 0 ? nullptr : rows.data() + kBatchLanes * kMaxAttributes;
          return target;
        };
        scalar.interpolate_groups(at, count, tile.ids, tile.list.data(), tile.origin, with_rows(expected));
        table->tile.interpolate_groups(at, count, tile.ids, tile.list.data(), tile.origin, with_rows(actual));
        REQUIRE(std::memcmp(expected.data(), actual.data(), expected.size() * sizeof(float)) == 0);
        for (size_t i = 0; i < static_cast<size_t>(8 * count); ++i) {
          const LanePack& pack = at[i / 8];
          if ((pack.mask >> (i % 8) & 1) == 0) continue;
          const size_t pixel = static_cast<size_t>(pack.y * kTileSize + pack.x) + i % 8;
          const LanePack alone{tile.list[tile.ids[pixel] - 1], pack.x, pack.y, 0xFF, {}};
          scalar.interpolate(&alone, 1, tile.origin, with_rows(own));
          for (size_t row = 0; row < static_cast<size_t>(attributes); ++row)
            REQUIRE(std::bit_cast<uint32_t>(own[row * kBatchLanes + i % 8]) ==
                    std::bit_cast<uint32_t>(actual[row * kBatchLanes + i]));
        }
      }
    }
  }
}

TEST_CASE("interpolate: in planar triangles planes give what weights give, within 2^-13 of the corners' differences") {
  const TileKernels& scalar = kernels_for(Isa::scalar)->tile;
  int n_planar = 0, n_loose = 0;
  for (uint32_t round = 0; round < 300; ++round) {
    const SeenTile tile(round);
    std::vector<LanePack> packs(kTilePixels);
    const int n = scalar.collect_packs(tile.ids, kTileSize, kTileSize, tile.list.data(), packs.data());
    for (size_t i = 0; i < static_cast<size_t>(n); ++i) {
      const RasterTriangle& t = *packs[i].triangle;
      (t.planar != 0 ? n_planar : n_loose) += 1;
      std::vector<float> planes(kBatchLanes * 6), weights = planes;
      for (int inside = 0; inside < 2; ++inside) {
        std::vector<float>& rows = inside != 0 ? planes : weights;
        scalar.interpolate(&packs[i], 1, tile.origin,
                           {0, 5, rows.data(), rows.data() + 5 * kBatchLanes, 3, 256, 64, 0, inside != 0});
      }
      for (size_t row = 0; row < 6; ++row)
        for (size_t k = 0; k < 8; ++k) {
          if ((packs[i].mask >> k & 1) == 0) continue;
          const float* const a = t.attributes[0] + 3 * row;
          const float difference = row < 5 ? std::max(std::fabs(a[1]), std::fabs(a[2])) : 64.0f;
          REQUIRE(std::fabs(planes[row * kBatchLanes + k] - weights[row * kBatchLanes + k]) <= difference * 0x1p-13f);
        }
    }
  }
  CHECK(n_planar > 1000);
  CHECK(n_loose > 1000);
}

// A chain of random texels; level i + 1 half as wide and high.
struct NoiseTexture {
  std::vector<uint8_t> texels;
  TextureSampler sampler{};

  NoiseTexture(Random& random, int width, int height, int filter, bool clamp) {
    sampler.filter = filter;
    sampler.clamp = clamp ? 1 : 0;
    for (int w = width, h = height;; w = std::max(w / 2, 1), h = std::max(h / 2, 1)) {
      const int level = sampler.level_count++;
      sampler.offset[level] = static_cast<int32_t>(texels.size() / 4);
      sampler.width[level] = w;
      sampler.height[level] = h;
      sampler.pitch[level] = w + 1;
      for (int i = 0; i < 4 * (w + 1) * h; ++i) texels.push_back(static_cast<uint8_t>(random.bits()));
      if (w == 1 && h == 1) break;
    }
    sampler.texels = texels.data();
  }
};

TEST_CASE(
    "add_textured, paint_textured: what interpolation, texture filter and accumulation give one after the other") {
  const TileKernels& scalar = kernels_for(Isa::scalar)->tile;
  Random random(71);
  const NoiseTexture textures[2] = {{random, 64, 32, 2, false}, {random, 24, 20, 2, true}};
  const PaintedSurface surfaces[3] = {{&textures[0].sampler, 0}, {nullptr, 0}, {&textures[1].sampler, -2}};
  const uint8_t background[3] = {10, 200, 255};
  for (uint32_t round = 0; round < 40; ++round) {
    SeenTile tile(round);
    for (std::vector<float>& record : tile.input.attributes)
      for (size_t i = 9; i < 15; ++i) record[i] *= 0.01f;
    const int width = 1 + static_cast<int>(random.bits() % kTileSize), height = 32 - static_cast<int>(round % 4);
    const int rendering = static_cast<int>(round % 2);
    std::vector<LanePack> packs(kTilePixels);
    const int n = scalar.collect_groups(tile.ids, width, height, tile.list.data(), rendering, packs.data());
    std::vector<uint16_t> expected = sums_of(background);
    std::vector<float> rows(9 * kBatchLanes);
    float *const lod = rows.data() + 5 * kBatchLanes, *const texels = lod + kBatchLanes;
    for (size_t i = 0; i < static_cast<size_t>(n); ++i) {
      const PaintedSurface& surface = surfaces[packs[i].triangle->state[rendering]];
      const TextureSampler* const texture = surface.texture;
      InterpolateTarget target{rendering, 3, rows.data(), nullptr, 3, 0, 0, surface.lod_bias};
      if (texture != nullptr)
        target = {rendering,
                  5,
                  rows.data(),
                  lod,
                  3,
                  static_cast<float>(texture->width[0]),
                  static_cast<float>(texture->height[0]),
                  surface.lod_bias};
      scalar.interpolate_groups(&packs[i], 1, tile.ids, tile.list.data(), tile.origin, target);
      if (texture != nullptr)
        scalar.sample_texture(*texture, 8, rows.data() + 3 * kBatchLanes, rows.data() + 4 * kBatchLanes, lod, texels);
      scalar.accumulate(&packs[i], 1, false, rows.data(), texture != nullptr ? texels : nullptr, nullptr, background,
                        expected.data());
    }
    for (int isa = 0; isa < kIsaCount; ++isa) {
      const Kernels* const table = kernels_for(static_cast<Isa>(isa));
      if (table == nullptr) continue;
      std::vector<uint16_t> sums = sums_of(background);
      const SampleIds sample{tile.ids, tile.origin};
      table->tile.add_textured(&sample, 1, width, height, tile.list.data(), rendering, surfaces, background,
                               sums.data());
      REQUIRE(expected == sums);
      std::vector<uint8_t> rgb = painted({}, 0, 0, 77);
      table->tile.paint_textured(tile.ids, width, height, tile.list.data(), rendering, tile.origin, surfaces,
                                 background, rgb.data(), kPaintStride);
      REQUIRE(painted(expected, width, height, 77) == rgb);
    }
  }
}

TEST_CASE("add_textured_grid: what add_textured adds for each of the samples") {
  const TileKernels& scalar = kernels_for(Isa::scalar)->tile;
  Random random(73);
  const NoiseTexture textures[2] = {{random, 64, 32, 2, false}, {random, 24, 20, 2, true}};
  const PaintedSurface surfaces[3] = {{&textures[0].sampler, 0}, {nullptr, 0}, {&textures[1].sampler, -2}};
  const uint8_t background[3] = {10, 200, 255};
  for (uint32_t round = 0; round < 24; ++round) {
    SeenTile tile(round);
    for (std::vector<float>& record : tile.input.attributes)
      for (size_t i = 9; i < 15; ++i) record[i] *= 0.01f;
    const int width = 2 * (1 + static_cast<int>(random.bits() % (kTileSize / 2)));
    const int height = 32 - static_cast<int>(round % 4) / 2 * 2, rendering = static_cast<int>(round % 2);
    uint32_t neighbors[kTilePixels];
    int from[kTilePixels];
    for (int i = 0; i < kTilePixels; ++i) {
      neighbors[i] = tile.ids[(i + 1) % kTilePixels];
      from[i] = random.bits() % 2 == 0 ? kGridSamples : static_cast<int>(random.bits() % (kGridSamples + 1));
    }
    ShownGrid shown(kGridSamples, tile.ids, neighbors, from);
    for (int i = 0; i < kTilePixels; ++i)
      if (from[i] == kGridSamples) shown.whole[i] = tile.ids[i];
    const SamplePosition origin{tile.origin.x - 128, tile.origin.y - 128};
    std::vector<uint16_t> expected = sums_of(background);
    for (int s = 0; s < kGridSamples; ++s) {
      shown.grid.x[s] = static_cast<int32_t>(random.bits() % 256);
      shown.grid.y[s] = static_cast<int32_t>(random.bits() % 256);
      alignas(32) uint32_t ids[kTilePixels] = {};
      for (int i = 0; i < kTilePixels; ++i)
        if (i % kTileSize < width) ids[i] = s < from[i] ? tile.ids[i] : neighbors[i];
      const SampleIds sample{ids, {origin.x + shown.grid.x[s], origin.y + shown.grid.y[s]}};
      scalar.add_textured(&sample, 1, width, height, tile.list.data(), rendering, surfaces, background,
                          expected.data());
    }
    for (int isa = 0; isa < kIsaCount; ++isa) {
      const Kernels* const table = kernels_for(static_cast<Isa>(isa));
      if (table == nullptr) continue;
      std::vector<uint16_t> sums = sums_of(background);
      table->tile.add_textured_grid(shown.grid, width, height, tile.list.data(), rendering, origin, surfaces,
                                    background, sums.data());
      REQUIRE(painted(expected, width, height, 77) == painted(sums, width, height, 77));
    }
  }
}

}  // namespace
