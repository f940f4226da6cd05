// Which samples a triangle covers: every one inside, none twice, whatever the mesh.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <set>
#include <string>
#include <vector>

#include "raster/draw_list.h"
#include "raster/sample_pattern.h"
#include "raster/setup.h"
#include "tests/support/kernel_check.h"
#include "tests/support/raster_scenes.h"

namespace {

using namespace pac;
using namespace pac::raster;
using test_scenes::Random;

struct Point {
  int32_t x, y;  // 24.8
};
struct Triangle {
  Point corner[3];
};

int64_t area2(Point a, Point b, Point c) {
  return int64_t{b.x - a.x} * (c.y - a.y) - int64_t{c.x - a.x} * (b.y - a.y);
}

// Two triangles over a rectangle larger than the image, cut `cuts` times at random inner points: ever thinner slivers.
std::vector<Triangle> random_mesh(int32_t side, int cuts, uint32_t seed) {
  const Point p00{-700, -900}, p10{side + 800, -650}, p11{side + 555, side + 777}, p01{-300, side + 1000};
  std::vector<Triangle> mesh{{{p00, p10, p11}}, {{p00, p11, p01}}};
  Random random(seed);
  for (int i = 0; i < cuts; ++i) {
    const size_t which = random.bits() % mesh.size();
    const Triangle t = mesh[which];
    const float r = random.unit(), s = random.unit() * (1 - r);
    const auto mix = [&](int32_t a, int32_t b, int32_t c) {
      return a + static_cast<int32_t>(r * static_cast<float>(b - a)) +
             static_cast<int32_t>(s * static_cast<float>(c - a));
    };
    const Point p{mix(t.corner[0].x, t.corner[1].x, t.corner[2].x), mix(t.corner[0].y, t.corner[1].y, t.corner[2].y)};
    if (area2(t.corner[0], t.corner[1], p) <= 0 || area2(t.corner[1], t.corner[2], p) <= 0 ||
        area2(t.corner[2], t.corner[0], p) <= 0)
      continue;  // rounded out of the triangle
    mesh[which] = {{t.corner[0], t.corner[1], p}};
    mesh.push_back({{t.corner[1], t.corner[2], p}});
    mesh.push_back({{t.corner[2], t.corner[0], p}});
  }
  return mesh;
}

// How often each sample of a side x side image is covered; side is a multiple of the tile's.
class HitCounter {
 public:
  HitCounter(int side, std::span<const SampleOffset> pattern) : side_(side), pattern_(pattern) {
    counts_.resize(static_cast<size_t>(side * side) * pattern.size());
  }
  void add(const TileKernels& kernels, const RasterTriangle& triangle, int tile_x, int tile_y) {
    for (size_t s = 0; s < pattern_.size(); ++s) {
      alignas(32) float depth[kTileSize * kTileSize];
      alignas(32) uint32_t ids[kTileSize * kTileSize] = {};
      std::fill(std::begin(depth), std::end(depth), 1.0f);
      kernels.rasterize(triangle, 1,
                        {tile_x * kTileSize * 256 + pattern_[s].x, tile_y * kTileSize * 256 + pattern_[s].y}, depth,
                        ids);
      for (int y = 0; y < kTileSize; ++y)
        for (int x = 0; x < kTileSize; ++x) {
          const auto pixel = static_cast<size_t>((tile_y * kTileSize + y) * side_ + tile_x * kTileSize + x);
          counts_[pixel * pattern_.size() + s] += ids[y * kTileSize + x];
        }
    }
  }
  void add(const TileKernels& kernels, const RasterTriangle& triangle) {
    for (int y = 0; y < side_ / kTileSize; ++y)
      for (int x = 0; x < side_ / kTileSize; ++x) add(kernels, triangle, x, y);
  }
  size_t samples_hit(uint32_t times) const {
    return static_cast<size_t>(std::count(counts_.begin(), counts_.end(), times));
  }
  size_t samples() const { return counts_.size(); }

 private:
  int side_;
  std::span<const SampleOffset> pattern_;
  std::vector<uint32_t> counts_;
};

TEST_CASE("triangles of a mesh cover each sample exactly once, slivers and all") {
  constexpr int kSide = 64;
  const Viewport viewport = make_viewport(kSide, kSide);
  for (const int n : {1, 4, 16}) {
    const auto pattern = sample_pattern(n);
    for (uint32_t seed = 1; seed <= 8; ++seed) {
      CAPTURE(n);
      CAPTURE(seed);
      HitCounter hits(kSide, pattern);
      for (Triangle t : random_mesh(kSide * 256, 300, seed)) {
        if (seed % 2 == 0) std::swap(t.corner[1], t.corner[2]);  // the other facing
        ScreenVertex corners[3];
        for (int i = 0; i < 3; ++i) corners[i] = {t.corner[i].x, t.corner[i].y, 0.5f, 1.0f};
        RasterTriangle triangle{};
        const SetupResult result = setup_triangle(corners, viewport, sample_hull(pattern), triangle);
        if (result == SetupResult::front || result == SetupResult::back)
          hits.add(kernels_for(Isa::scalar)->tile, triangle);
      }
      REQUIRE(hits.samples_hit(1) == hits.samples());
    }
  }
}

// The walls of a box around the camera, each cut at random inner points: from inside, every direction meets one wall.
Scene random_box(int cuts, uint32_t seed) {
  Scene scene;
  scene.materials.emplace_back();
  scene.materials[0].lit = false;
  Random random(seed);
  for (int i = 0; i < 8; ++i) {
    Vertex v;
    for (int c = 0; c < 3; ++c) v.position[c] = (i >> c & 1) != 0 ? 10.0f + random.unit() : -10.0f - random.unit();
    scene.mesh.vertices.push_back(v);
  }
  constexpr uint32_t kWalls[6][4] = {{0, 1, 3, 2}, {5, 4, 6, 7}, {4, 0, 2, 6},
                                     {1, 5, 7, 3}, {2, 3, 7, 6}, {4, 5, 1, 0}};
  std::vector<std::array<uint32_t, 3>> triangles;
  for (const auto& w : kWalls) {
    triangles.push_back({w[0], w[1], w[2]});
    triangles.push_back({w[0], w[2], w[3]});
  }
  for (int i = 0; i < cuts; ++i) {
    const size_t which = random.bits() % triangles.size();
    const auto t = triangles[which];
    const float r = random.unit() * 0.9f + 0.05f, s = (1 - r) * (random.unit() * 0.9f + 0.05f);
    Vertex v;
    for (int c = 0; c < 3; ++c) {
      const float a = scene.mesh.vertices[t[0]].position[c];
      v.position[c] =
          a + r * (scene.mesh.vertices[t[1]].position[c] - a) + s * (scene.mesh.vertices[t[2]].position[c] - a);
    }
    const auto p = static_cast<uint32_t>(scene.mesh.vertices.size());
    scene.mesh.vertices.push_back(v);
    triangles[which] = {t[0], t[1], p};
    triangles.push_back({t[1], t[2], p});
    triangles.push_back({t[2], t[0], p});
  }
  for (const auto& t : triangles) {
    scene.mesh.faces.push_back({static_cast<uint32_t>(scene.mesh.indices.size()), 3, 0});
    scene.mesh.indices.insert(scene.mesh.indices.end(), t.begin(), t.end());
  }
  return scene;
}

TEST_CASE("clipping at the near plane and the guard band opens no cracks and covers nothing twice") {
  constexpr int kSide = 64;
  ThreadPool pool(1);
  DrawList list;
  const auto pattern = sample_pattern(4);
  for (uint32_t seed = 1; seed <= 6; ++seed) {
    CAPTURE(seed);
    const Scene scene = random_box(250, seed);
    // Close to one wall, looking along it; a near plane that sends clipped corners far outside the guard band.
    const float near_plane = seed % 2 == 0 ? 0.0005f : 0.05f;
    const Camera camera = make_camera({9.9f, 0.3f, 1.0f}, {9.0f, 0.2f, -3.0f}, {0.1f, 1, 0}, 1.9f, 1, near_plane, 100);
    std::vector<Surface> surfaces;
    REQUIRE(prepare_surfaces(scene, camera, {}, nullptr, surfaces).ok());
    const FrameInput input{&scene,
                           &scene.mesh,
                           &camera,
                           kernels_for(Isa::scalar),
                           make_viewport(kSide, kSide),
                           sample_hull(pattern),
                           {&surfaces, nullptr},
                           nullptr};
    REQUIRE(list.build(input, pool).ok());
    HitCounter hits(kSide, pattern);
    for (int tile = 0; tile < list.tiles_x() * list.tiles_y(); ++tile) {
      std::vector<const RasterTriangle*> listed;
      list.triangles_of(tile, listed);
      for (const RasterTriangle* t : listed)
        hits.add(input.kernels->tile, *t, tile % list.tiles_x(), tile / list.tiles_x());
    }
    REQUIRE(hits.samples_hit(1) == hits.samples());
  }
}

// Draws polygons given in pixels; each pixel shows the number of the first that covers its center.
std::string picture(const std::vector<std::array<float, 6>>& triangles, int side) {
  std::string text(static_cast<size_t>(side * side), '.');
  for (size_t n = 0; n < triangles.size(); ++n) {
    ScreenVertex corners[3];
    for (size_t i = 0; i < 3; ++i)
      corners[i] = {static_cast<int32_t>(triangles[n][2 * i] * 256),
                    static_cast<int32_t>(triangles[n][2 * i + 1] * 256), 0.5f, 1.0f};
    RasterTriangle t{};
    const SampleHull center{128, 128, 128, 128};
    const SetupResult result = setup_triangle(corners, make_viewport(side, side), center, t);
    if (result != SetupResult::front && result != SetupResult::back) continue;
    alignas(32) float depth[kTileSize * kTileSize];
    alignas(32) uint32_t ids[kTileSize * kTileSize] = {};
    std::fill(std::begin(depth), std::end(depth), 1.0f);
    kernels_for(Isa::scalar)->tile.rasterize(t, 1, {128, 128}, depth, ids);
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x)
        if (ids[y * kTileSize + x] != 0) {
          char& at = text[static_cast<size_t>(y * side + x)];
          at = at == '.' ? static_cast<char>('1' + n) : '*';
        }
  }
  return text;
}

TEST_CASE("top-left rule: a sample on a shared edge goes to the triangle on its right or below") {
  // A square from pixel center to pixel center: its top and left sides are in, its bottom and right sides out.
  CHECK(picture({{1.5f, 1.5f, 4.5f, 1.5f, 4.5f, 4.5f}, {1.5f, 1.5f, 4.5f, 4.5f, 1.5f, 4.5f}}, 6) ==
        "......"
        ".111.."
        ".211.."
        ".221.."
        "......"
        "......");
  // The other diagonal, through pixel centers.
  CHECK(picture({{1.5f, 1.5f, 4.5f, 1.5f, 1.5f, 4.5f}, {4.5f, 1.5f, 4.5f, 4.5f, 1.5f, 4.5f}}, 6) ==
        "......"
        ".111.."
        ".112.."
        ".122.."
        "......"
        "......");
  // Two triangles over a vertical and over a horizontal edge.
  CHECK(picture({{3.5f, 0.5f, 3.5f, 5.5f, 0.5f, 3.5f}, {3.5f, 0.5f, 5.5f, 3.5f, 3.5f, 5.5f}}, 6) ==
        "......"
        "..12.."
        ".1122."
        "11122."
        "..12.."
        "......");
  // A triangle whose corners lie between samples covers nothing.
  CHECK(picture({{1.6f, 1.6f, 2.4f, 1.6f, 2.0f, 2.4f}}, 4) == "................");
  // Four triangles around a pixel center: it belongs to exactly one.
  CHECK(picture(
            {{1.5f, 1.5f, 0, 0, 3, 0}, {1.5f, 1.5f, 3, 0, 3, 3}, {1.5f, 1.5f, 3, 3, 0, 3}, {1.5f, 1.5f, 0, 3, 0, 0}}, 3)
            .find('*') == std::string::npos);
}

TEST_CASE("sample patterns are distinct, centered, sparse, and start near the center") {
  CHECK(sample_pattern(2).empty());
  CHECK(sample_pattern(0).empty());
  CHECK(sample_pattern(1)[0].x == 128);
  CHECK(sample_pattern(1)[0].y == 128);
  for (const int n : {4, 16, 64}) {
    const auto pattern = sample_pattern(n);
    REQUIRE(pattern.size() == static_cast<size_t>(n));
    int sum_x = 0, sum_y = 0;
    std::set<int> columns, rows;
    const auto from_center = [](SampleOffset s) { return (s.x - 128) * (s.x - 128) + (s.y - 128) * (s.y - 128); };
    for (const SampleOffset s : pattern) {
      sum_x += s.x;
      sum_y += s.y;
      columns.insert(s.x * n / 256);
      rows.insert(s.y * n / 256);
      CHECK(from_center(s) >= from_center(pattern[0]));
    }
    CHECK(sum_x == 128 * n);
    CHECK(sum_y == 128 * n);
    CHECK(columns.size() == pattern.size());
    CHECK(rows.size() == pattern.size());
    for (int across = 1; across <= n; across *= 2) {  // one in each cell of across x n/across
      std::set<int> cells;
      for (const SampleOffset s : pattern) cells.insert(s.x * across / 256 * n + s.y * (n / across) / 256);
      CHECK(cells.size() == pattern.size());
    }
  }
}

TEST_CASE("concave, star-shaped and holed polygons cover what their outline encloses, once") {
  struct Outline {
    const char* name;
    std::vector<std::array<float, 2>> corners;
    float area;
  };
  const std::vector<Outline> outlines = {
      {"arrow", {{0, 0}, {4, 2}, {0, 4}, {1, 2}}, 6},
      {"comb",
       {{0, 0},
        {7, 0},
        {7, 4},
        {6, 4},
        {6, 1},
        {5, 1},
        {5, 4},
        {4, 4},
        {4, 1},
        {3, 1},
        {3, 4},
        {2, 4},
        {2, 1},
        {1, 1},
        {1, 4},
        {0, 4}},
       19},
      {"ring with a bridge", {{0, 0}, {6, 0}, {6, 6}, {0, 6}, {0, 0}, {2, 2}, {2, 4}, {4, 4}, {4, 2}, {2, 2}}, 32},
      {"convex with straight corners", {{0, 0}, {2, 0}, {4, 0}, {4, 3}, {2, 3}, {0, 3}}, 12},
  };
  for (const Outline& outline : outlines) {
    CAPTURE(outline.name);
    for (int flip = 0; flip < 2; ++flip) {
      Mesh mesh;
      mesh.faces.push_back({0, static_cast<uint32_t>(outline.corners.size()), 0});
      for (size_t i = 0; i < outline.corners.size(); ++i) {
        const auto& c = outline.corners[flip != 0 ? outline.corners.size() - 1 - i : i];
        Vertex v;
        v.position[0] = c[0];
        v.position[1] = c[1] * 0.6f;  // tilted in space
        v.position[2] = c[1] * 0.8f;
        mesh.indices.push_back(static_cast<uint32_t>(mesh.vertices.size()));
        mesh.vertices.push_back(v);
      }
      PolygonCutter cutter;
      const auto triangles = cutter.cut(mesh, mesh.faces[0]);
      REQUIRE(triangles.size() == outline.corners.size() - 2);
      const FaceNormal n = face_normal(mesh, mesh.faces[0]);
      float total = 0;
      for (const CornerTriple& t : triangles) {
        const Mesh one{{mesh.vertices[t.corner[0]], mesh.vertices[t.corner[1]], mesh.vertices[t.corner[2]]},
                       {0, 1, 2},
                       {{0, 3, 0}}};
        const FaceNormal m = face_normal(one, one.faces[0]);
        const float along = m.x * n.x + m.y * n.y + m.z * n.z;
        CHECK(along >= 0);  // none is turned over, so areas that add up mean no overlap
        total += 0.5f * std::sqrt(m.x * m.x + m.y * m.y + m.z * m.z);
      }
      CHECK(total == doctest::Approx(outline.area));
    }
  }
}

}  // namespace
