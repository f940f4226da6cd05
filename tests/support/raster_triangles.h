// Random triangles for the tests of the rasterizer's kernels.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "raster/clip.h"
#include "raster/sample_pattern.h"
#include "raster/setup.h"
#include "tests/support/raster_scenes.h"

namespace pac::test_scenes {

constexpr int kTriangleImage = 512;  // side of the image that they are on

inline int32_t random_coordinate(Random& random, int kind) {
  switch (kind) {
    case 0:  // in and around one tile
      return static_cast<int32_t>(random.bits() % (64 * 256)) - 16 * 256;
    case 1:  // a few pixels
      return 12 * 256 + static_cast<int32_t>(random.bits() % (6 * 256));
    case 2:  // over the image
      return static_cast<int32_t>(random.bits() % (600 * 256)) - 44 * 256;
    case 3:  // whole pixel centers: samples on edges and corners
      return static_cast<int32_t>(random.bits() % 48) * 256 - 8 * 256 + 128;
    default:  // to the ends of the guard band
      return static_cast<int32_t>(random.bits() % (1u << 23)) - (1 << 22) + kTriangleImage * 128;
  }
}

// Corners of a triangle of one of several kinds, slivers among them.
inline void random_corners(Random& random, ScreenVertex corners[3]) {
  const int kind = static_cast<int>(random.bits() % 6);
  for (int i = 0; i < 3; ++i) {
    corners[i].x = random_coordinate(random, kind);
    corners[i].y = random_coordinate(random, kind);
    corners[i].z = random.unit() * 1.5f;
    corners[i].inverse_w = random.unit() * (random.bits() % 4 == 0 ? 1e-6f : 10.0f) + 1e-9f;
  }
  if (kind == 5) corners[2] = {corners[1].x + static_cast<int32_t>(random.bits() % 3) - 1, corners[1].y + 1, 0.5f, 1};
}

// False if it is degenerate or misses the image.
inline bool random_triangle(Random& random, std::span<const raster::SampleOffset> pattern, RasterTriangle& out) {
  ScreenVertex corners[3];
  random_corners(random, corners);
  const raster::SetupResult result = raster::setup_triangle(
      corners, raster::make_viewport(kTriangleImage, kTriangleImage), raster::sample_hull(pattern), out);
  return result == raster::SetupResult::front || result == raster::SetupResult::back;
}

// Triangles with attributes, and packs of them.
struct PackedTriangles {
  std::vector<RasterTriangle> triangles;
  std::vector<std::vector<float>> attributes;
  std::vector<LanePack> packs;
};

inline PackedTriangles random_packs(uint32_t seed, int n) {
  Random random(seed);
  PackedTriangles out;
  const auto pattern = raster::sample_pattern(1);
  while (out.triangles.size() < 16) {
    RasterTriangle t{};
    if (!random_triangle(random, pattern, t)) continue;
    std::vector<float> record;
    for (int i = 0; i < 3 * kMaxAttributes + 1; ++i) record.push_back(random.between(-300, 300));
    out.triangles.push_back(t);
    out.attributes.push_back(record);
  }
  for (size_t i = 0; i < out.triangles.size(); ++i)
    out.triangles[i].attributes[0] = out.triangles[i].attributes[1] = out.attributes[i].data();
  for (int i = 0; i < n; ++i) {
    LanePack pack{&out.triangles[random.bits() % 16],
                  static_cast<uint8_t>(random.bits() % 4 * 8),
                  static_cast<uint8_t>(random.bits() % kTileSize),
                  static_cast<uint8_t>(random.bits()),
                  {}};
    for (uint8_t& weight : pack.weight) weight = static_cast<uint8_t>(random.bits() % (kGridSamples + 1));
    out.packs.push_back(pack);
  }
  return out;
}

}  // namespace pac::test_scenes
