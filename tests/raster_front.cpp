// The kernels of the front end, from vertices to what a tile shows: every instruction set gives the scalar bits, and
// shortcuts change nothing that can be seen.
#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "tests/support/kernel_check.h"
#include "tests/support/raster_triangles.h"

namespace {

using namespace pac;
using namespace pac::raster;
using namespace pac::test_scenes;
using test::for_each_isa;

constexpr int kTilePixels = kTileSize * kTileSize;

TEST_CASE(
    "transform_vertices: every instruction set gives the scalar bits, for any number of vertices and any numbers") {
  const float special[] = {0.0f,
                           -0.0f,
                           1e-42f,
                           1e30f,
                           -1e38f,
                           std::numeric_limits<float>::infinity(),
                           std::numeric_limits<float>::quiet_NaN()};
  for_each_isa([&](const Kernels& scalar, const Kernels& table) {
    Random random(41);
    uint64_t n_projected = 0, n_other = 0;
    for (int round = 0; round < 300; ++round) {
      const auto n = static_cast<size_t>(random.bits() % 40);
      const size_t stride = 4 + random.bits() % 6;
      std::vector<float> positions(stride * n + 4);
      for (float& p : positions) p = random.bits() % 30 == 0 ? special[random.bits() % 7] : random.between(-6, 6);
      const Camera camera = room_camera(1, random.unit());
      glm::mat4 matrix = camera.clip_from_world;
      if (round % 8 == 0) matrix[3][static_cast<int>(random.bits() % 4)] = special[random.bits() % 4];
      const auto width = 1 + static_cast<int>(random.bits() % 32768),
                 height = 1 + static_cast<int>(random.bits() % 2000);
      const ScreenTransform transform = screen_transform(matrix, make_viewport(width, height));
      std::vector<ScreenVertex> expected(n + 1, {7, 7, 7, 7}), actual = expected;
      std::vector<uint32_t> expected_codes(n + 1, 77), actual_codes = expected_codes;
      scalar.front.transform_vertices(transform, positions.data(), stride, static_cast<int>(n), expected.data(),
                                      expected_codes.data());
      table.front.transform_vertices(transform, positions.data(), stride, static_cast<int>(n), actual.data(),
                                     actual_codes.data());
      REQUIRE(expected_codes == actual_codes);
      REQUIRE(std::memcmp(expected.data(), actual.data(), expected.size() * sizeof(ScreenVertex)) == 0);
      for (size_t i = 0; i < n; ++i) ++((expected_codes[i] & (kOutClip | kNotFinite)) == 0 ? n_projected : n_other);
    }
    CHECK(n_projected > 1000);
    CHECK(n_other > 1000);
  });
}

struct Group {
  ScreenVertex vertices[kSetupLanes][3];
  MeshTriangle triangles[kSetupLanes];

  explicit Group(Random& random) {
    const bool small = random.bits() % 4 != 0;  // one large triangle and the group goes another way
    for (int k = 0; k < kSetupLanes; ++k)
      for (int first = 1; first == 1 || (small && is_wide(k)); first = 0) random_corners(random, vertices[k]);
    if (random.bits() % 3 == 0) vertices[2][1] = vertices[2][random.bits() % 2 == 0 ? 0 : 2];  // no area
    for (uint32_t k = 0; k < kSetupLanes; ++k) triangles[k] = {{3 * k, 3 * k + 1, 3 * k + 2}, 0, 0};
  }
  bool is_wide(int k) const {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < i; ++j)
        if (std::abs(vertices[k][i].x - vertices[k][j].x) >= 1 << 15 ||
            std::abs(vertices[k][i].y - vertices[k][j].y) >= 1 << 15)
          return true;
    return false;
  }
};

bool are_equal(const RasterTriangle& a, const RasterTriangle& b) {
  const float depth_a[] = {a.z0, a.dzdx, a.dzdy, a.z_min, a.z_max},
              depth_b[] = {b.z0, b.dzdx, b.dzdy, b.z_min, b.z_max};
  return a.x0 == b.x0 && a.y0 == b.y0 && std::memcmp(a.a, b.a, sizeof a.a) == 0 &&
         std::memcmp(a.b, b.b, sizeof a.b) == 0 && a.min_x == b.min_x && a.min_y == b.min_y && a.max_x == b.max_x &&
         a.max_y == b.max_y && a.area2 == b.area2 && std::memcmp(depth_a, depth_b, sizeof depth_a) == 0 &&
         std::memcmp(a.w, b.w, sizeof a.w) == 0 && a.shift == b.shift && a.covered == b.covered &&
         a.planar == b.planar && std::memcmp(a.exclude, b.exclude, sizeof a.exclude) == 0;
}

SetupRules random_rules(Random& random) {
  const auto side = 1 + static_cast<int32_t>(random.bits() % 512);
  if (random.bits() % 2 == 0) return {side, 512, 0, 8, 240, 248};
  const auto x = static_cast<int32_t>(random.bits() % 256), y = static_cast<int32_t>(random.bits() % 256);
  return {side, 512, x, y, x, y};
}

TEST_CASE(
    "setup_triangles: every instruction set gives the scalar bits, groups of any size, from slivers to the guard "
    "band") {
  for_each_isa([&](const Kernels& scalar, const Kernels& table) {
    Random random(43);
    uint64_t n_drawn = 0, n_degenerate = 0;
    for (int round = 0; round < 6000; ++round) {
      const Group group(random);
      const SetupRules rules = random_rules(random);
      const int n = 1 + static_cast<int>(random.bits() % kSetupLanes);
      const uint32_t drop_back = random.bits() & 0xFF & ((1u << n) - 1);
      RasterTriangle expected[kSetupLanes] = {}, actual[kSetupLanes] = {};
      SetupMasks a, b;
      scalar.front.setup_triangles(rules, n, group.triangles, group.vertices[0], drop_back, expected, a);
      table.front.setup_triangles(rules, n, group.triangles, group.vertices[0], drop_back, actual, b);
      REQUIRE(a.drawn == b.drawn);
      REQUIRE(a.front == b.front);
      REQUIRE(a.degenerate == b.degenerate);
      for (int k = 0; k < std::popcount(a.drawn); ++k) REQUIRE(are_equal(expected[k], actual[k]));
      n_drawn += static_cast<uint64_t>(std::popcount(a.drawn));
      n_degenerate += static_cast<uint64_t>(std::popcount(a.degenerate));
    }
    CHECK(n_drawn > 5000);
    CHECK(n_degenerate > 500);
  });
}

// Twice the areas of the triangles between p and the edges all have the sign of the triangle's, none is 0.
bool is_strictly_inside(const ScreenVertex (&v)[3], int64_t x, int64_t y) {
  int positive = 0, negative = 0;
  for (int i = 0; i < 3; ++i) {
    const ScreenVertex &p = v[i], &q = v[(i + 1) % 3];
    const int64_t side = (int64_t{q.x} - p.x) * (y - p.y) - (x - p.x) * (int64_t{q.y} - p.y);
    positive += side > 0 ? 1 : 0;
    negative += side < 0 ? 1 : 0;
  }
  return positive == 3 || negative == 3;
}

// Triangles with normals around theirs, some almost in their planes, some too large, too small or not numbers.
struct NormalTriangles {
  float vertices[kSetupLanes][3][8];
  MeshTriangle triangles[kSetupLanes];

  explicit NormalTriangles(Random& random) {
    for (int k = 0; k < kSetupLanes; ++k) {
      const float scale = random.bits() % 8 == 0 ? 1e-20f : random.bits() % 8 == 0 ? 1e18f : 10.0f;
      for (int i = 0; i < 3; ++i) {
        triangles[k].vertices[i] = static_cast<uint32_t>(3 * k + i);
        for (int c = 0; c < 8; ++c) vertices[k][i][c] = random.between(-1, 1) * (c < 3 ? scale : 1.0f);
      }
      if (random.bits() % 4 != 0) flatten(random, k);
      const float odd[] = {0.0f, 1e13f, 1e-38f, std::numeric_limits<float>::quiet_NaN(), 1e38f};
      if (random.bits() % 4 == 0) vertices[k][random.bits() % 3][random.bits() % 6] = odd[random.bits() % 5];
    }
  }
  // Into the plane z = 0, with normals that lean from its normal.
  void flatten(Random& random, int k) {
    const bool up = random.bits() % 2 == 0;
    for (auto& vertex : vertices[k]) {
      vertex[2] = 0;
      vertex[5] = (up ? 1.0f : -1.0f) * (random.bits() % 4 == 0 ? 1e-5f : 1.0f) * random.unit();
    }
  }
};

TEST_CASE("keeps_normals: every instruction set says what the scalar one says, and that is true of the normals") {
  int kept_count = 0, set_count = 0;
  for_each_isa([&](const Kernels& scalar, const Kernels& table) {
    ++set_count;
    Random random(77);
    for (int round = 0; round < 400; ++round) {
      const NormalTriangles input(random);
      const uint32_t asked = random.bits() & 0xFF, front = random.bits() & 0xFF;
      const float* const vertices = input.vertices[0][0];
      const uint32_t kept = scalar.front.keeps_normals(asked, input.triangles, vertices, 8, front);
      REQUIRE(kept == table.front.keeps_normals(asked, input.triangles, vertices, 8, front));
      REQUIRE((kept & ~asked) == 0);
      for (int k = 0; k < kSetupLanes; ++k) {
        if ((kept >> k & 1) == 0) continue;
        ++kept_count;
        const auto at = [&](int i, int c) { return static_cast<long double>(input.vertices[k][i][c]); };
        for (int i = 0; i < 3; ++i) {
          long double along = 0;
          for (int c = 0; c < 3; ++c) {
            const int next = (c + 1) % 3, last = (c + 2) % 3;
            along += at(i, 3 + c) * ((at(1, next) - at(0, next)) * (at(2, last) - at(0, last)) -
                                     (at(1, last) - at(0, last)) * (at(2, next) - at(0, next)));
          }
          REQUIRE((along > 0) == ((front >> k & 1) != 0));
        }
      }
    }
  });
  CHECK(kept_count >= 100 * set_count);
}

TEST_CASE("faces_eye and gather_vertices: every instruction set gives the scalar answers, vertices of any kind") {
  constexpr int kStride = 9;
  int facing_count = 0, set_count = 0;
  for_each_isa([&](const Kernels& scalar, const Kernels& table) {
    ++set_count;
    Random random(78);
    for (int round = 0; round < 200; ++round) {
      const NormalTriangles input(random);
      const int n = 1 + static_cast<int>(random.bits() % 24);
      std::vector<float> vertices(static_cast<size_t>(kStride * n));
      const float* at[24];
      for (int i = 0; i < n; ++i) {
        float* const to = &vertices[static_cast<size_t>(kStride * i)];
        std::copy_n(input.vertices[i / 3][i % 3], 8, to);
        const uint32_t color = random.bits();
        std::memcpy(to + 8, &color, 4);
        at[i] = to;
      }
      const float eye[3] = {random.between(-9, 9), random.between(-9, 9), random.between(-9, 9)};
      const int few = std::min(n, 8);
      const uint32_t facing = scalar.front.faces_eye(eye, vertices.data(), kStride, few);
      REQUIRE(facing == table.front.faces_eye(eye, vertices.data(), kStride, few));
      facing_count += std::popcount(facing);
      static float expected[9 * kBatchLanes], actual[9 * kBatchLanes];
      const auto gather = [&](const Kernels& kernels, float* rows) {
        std::fill_n(rows, 9 * kBatchLanes, 7.0f);
        kernels.front.gather_vertices(n, at, rows, rows + 3 * kBatchLanes, rows + 6 * kBatchLanes);
      };
      gather(scalar, expected);
      gather(table, actual);
      REQUIRE(std::memcmp(expected, actual, sizeof expected) == 0);
    }
  });
  CHECK(facing_count >= 100 * set_count);
}

TEST_CASE("color_records and lit_records: nine floats a triangle, the same on every instruction set, nothing beyond") {
  constexpr int kVertices = 40, kStride = 9;
  for_each_isa([&](const Kernels& scalar, const Kernels& table) {
    Random random(79);
    for (int round = 0; round < 300; ++round) {
      std::vector<float> vertices(kStride * kVertices);
      for (int i = 0; i < kVertices; ++i) {
        float* const vertex = &vertices[static_cast<size_t>(kStride * i)];
        for (int c = 0; c < 8; ++c) vertex[c] = random.between(-300, 300);
        const uint32_t color = random.bits();
        std::memcpy(vertex + 8, &color, 4);
      }
      CornerNumbers corners;
      for (auto& corner : corners)
        for (uint32_t& number : corner) number = random.bits() % kVertices;
      const float mean[3] = {random.between(0, 1), random.between(0, 1), 1};
      const int n = 1 + static_cast<int>(random.bits() % kSetupLanes);
      const auto records_of = [&](const Kernels& kernels, bool lit) {
        std::vector<float> records(9 * kSetupLanes + 8, 7.0f);
        if (lit)
          kernels.front.lit_records(n, corners, vertices.data(), kStride, records.data());
        else
          kernels.front.color_records(n, corners, vertices.data(), kStride, mean, records.data());
        return records;
      };
      for (const bool lit : {false, true}) {
        const std::vector<float> records = records_of(table, lit);
        REQUIRE(records == records_of(scalar, lit));
        REQUIRE(std::all_of(records.begin() + 9 * n, records.end(), [](float f) { return f == 7.0f; }));
        const auto color = [&](int corner, int k, int c) {
          const float* const vertex = &vertices[kStride * corners[corner][k]];
          if (lit) return vertex[c];
          return static_cast<float>(reinterpret_cast<const uint8_t*>(vertex + 8)[c]) * mean[c];
        };
        const int last = n - 1;
        for (int c = 0; c < 3; ++c) {
          const float* const record = &records[static_cast<size_t>(9 * last + 3 * c)];
          REQUIRE(record[0] == color(0, last, c));
          REQUIRE(record[1] == color(1, last, c) - record[0]);
          REQUIRE(record[2] == color(2, last, c) - record[0]);
        }
      }
    }
  });
}

TEST_CASE("triangles that setup leaves out have no sample inside; tiny ones that it keeps cover one") {
  for (const Isa isa : {Isa::scalar, best_isa()}) {
    Random random(47);
    uint64_t n_left_out = 0, n_tiny = 0;
    for (int round = 0; round < 3000; ++round) {
      Group group(random);
      for (auto& triangle : group.vertices)  // two pixels or so
        for (ScreenVertex& v : triangle) {
          v.x = 30 * 256 + static_cast<int32_t>(random.bits() % 640);
          v.y = 30 * 256 + static_cast<int32_t>(random.bits() % 640);
        }
      const SetupRules rules{64, 64, 128, 128, 128, 128};
      RasterTriangle out[kSetupLanes] = {};
      SetupMasks masks;
      kernels_for(isa)->front.setup_triangles(rules, kSetupLanes, group.triangles, group.vertices[0], 0, out, masks);
      const RasterTriangle* drawn = out;
      for (int k = 0; k < kSetupLanes; ++k) {
        const bool is_drawn = (masks.drawn >> k & 1) != 0;
        bool inside = false;
        for (int64_t y = 28; y < 36; ++y)
          for (int64_t x = 28; x < 36; ++x)
            inside = inside || is_strictly_inside(group.vertices[k], 256 * x + 128, 256 * y + 128);
        if (inside) REQUIRE(is_drawn);
        n_left_out += is_drawn ? 0 : 1;
        if (!is_drawn) continue;
        const RasterTriangle& t = *drawn++;
        if (t.max_x - t.min_x > 1 || t.max_y - t.min_y > 1) continue;
        std::vector<float> depth(kTilePixels, 9.0f);
        std::vector<uint32_t> ids(kTilePixels, 0u);
        for (int tile = 0; tile < 4; ++tile)
          kernels_for(Isa::scalar)
              ->tile.rasterize(t, 1, {256 * kTileSize * (tile % 2) + 128, 256 * kTileSize * (tile / 2) + 128},
                               depth.data(), ids.data());
        uint32_t covered = 0;
        for (const uint32_t id : ids) covered += id;
        REQUIRE(covered > 0);
        ++n_tiny;
      }
    }
    CHECK(n_left_out > 1000);
    CHECK(n_tiny > 1000);
  }
}

TEST_CASE("rasterize_all: a tile's triangles together, many behind others, give what one after another gives") {
  for (int i = 0; i < kIsaCount; ++i) {
    const Kernels* const table = kernels_for(static_cast<Isa>(i));
    if (table == nullptr) continue;
    Random random(53);
    const auto pattern = sample_pattern(16);
    for (int round = 0; round < 200; ++round) {
      std::vector<RasterTriangle> triangles;
      while (triangles.size() < 60) {
        RasterTriangle t{};
        if (!random_triangle(random, pattern, t)) continue;
        if (round % 2 == 0) {  // parallel to the screen, mostly in front of what follows
          t.z0 = t.z_min = t.z_max = static_cast<float>(triangles.size() + random.bits() % 8) / 70.0f;
          t.dzdx = t.dzdy = 0;
        }
        if (round % 4 == 1 && triangles.size() < 8) {  // partly no nearer than the background
          t.z0 += 0.25f;
          t.z_max = 1;
        }
        triangles.push_back(t);
      }
      std::vector<const RasterTriangle*> list;
      for (const RasterTriangle& t : triangles) list.push_back(&t);
      const auto tile = static_cast<int32_t>(random.bits() % 4) * kTileSize * 256;
      const SamplePosition origin{tile + pattern[random.bits() % 16].x, pattern[random.bits() % 16].y};
      alignas(32) float expected_depth[kTilePixels], depth[kTilePixels];
      alignas(32) uint32_t expected_ids[kTilePixels], ids[kTilePixels];
      std::fill_n(expected_depth, kTilePixels, 1.0f);
      std::fill_n(depth, kTilePixels, 0.25f);  // of the tile before
      std::fill_n(expected_ids, kTilePixels, 0u);
      std::fill_n(ids, kTilePixels, 7u);
      for (uint32_t k = 0; k < list.size(); ++k)
        kernels_for(Isa::scalar)->tile.rasterize(*list[k], k + 1, origin, expected_depth, expected_ids);
      table->tile.rasterize_all(list.data(), static_cast<uint32_t>(list.size()), origin, depth, ids);
      REQUIRE(std::memcmp(expected_ids, ids, sizeof ids) == 0);
      REQUIRE(std::memcmp(expected_depth, depth, sizeof depth) == 0);
      table->tile.rasterize_all(list.data(), static_cast<uint32_t>(list.size()), origin, depth, nullptr);
      REQUIRE(std::memcmp(expected_depth, depth, sizeof depth) == 0);
    }
  }
}

}  // namespace
