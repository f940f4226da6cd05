// Kernels of shading; anisotropic and alpha filters.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <vector>

#include "raster/surface.h"
#include "tests/support/kernel_check.h"
#include "tests/support/raster_pictures.h"
#include "tests/support/raster_scenes.h"

namespace {

using namespace pac;
using namespace pac::raster;
using namespace test_pictures;
using test::for_each_isa;
using test_scenes::Random;

TEST_CASE("shading kernels: every instruction set gives the scalar bits") {
  for_each_isa([&](const Kernels& scalar, const Kernels& table) {
    Random random(71);
    std::vector<float> depths(64 * 64);
    for (float& d : depths) d = random.unit();
    for (int round = 0; round < 60; ++round) {
      const int n = 1 + static_cast<int>(random.bits() % kBatchLanes);
      std::vector<float> normal(3 * kBatchLanes), position(3 * kBatchLanes), texels(3 * kBatchLanes),
          tangents(6 * kBatchLanes), color(3 * kBatchLanes);
      for (float& f : normal) f = random.between(-2, 2);
      for (float& f : position) f = random.between(-3, 3);
      for (float& f : tangents) f = random.between(-1, 1);
      for (float& f : texels) f = random.between(0, 255);
      for (float& f : color) f = random.between(-50, 400);
      for (size_t c = 0; c < 3; ++c) {
        normal[c * kBatchLanes] = 0;
        normal[c * kBatchLanes + 1] = c == 0 ? NAN : 1.0f;
        tangents[c * kBatchLanes + 2] = 0;
        for (size_t k = 0; k < 2; ++k) tangents[(3 * k + c) * kBatchLanes + 3] = normal[c * kBatchLanes + 3];
        position[c * kBatchLanes + 4] = 1e18f;
        normal[c * kBatchLanes + 5] = c == 2 ? -1.0f : 0.0f;
        position[c * kBatchLanes + 5] = 0;
      }
      const auto expect_equal = [&](auto&& run, size_t rows) {
        std::vector<float> expected(rows * kBatchLanes, 3.0f), actual = expected;
        run(scalar.tile, expected.data());
        run(table.tile, actual.data());
        REQUIRE(std::memcmp(expected.data(), actual.data(), expected.size() * sizeof(float)) == 0);
      };
      expect_equal(
          [&](const TileKernels& k, float* out) {
            std::copy(normal.begin(), normal.end(), out);
            k.bend_normals(n, round % 3 == 0 ? 1.0f : 0.7f, texels.data(), tangents.data(), out);
          },
          3);
      const float eye[3] = {0, round % 2 == 0 ? 0.0f : 1.0f, 5};
      expect_equal([&](const TileKernels& k,
                       float* out) { k.reflect(eye, n, normal.data(), position.data(), out, out + kBatchLanes); },
                   2);
      FogParameters fog{{0, 1, 5}, {200, 100, 50}, 6, 0.2f, round % 3};
      expect_equal(
          [&](const TileKernels& k, float* out) {
            std::copy(color.begin(), color.end(), out);
            k.fog(fog, n, position.data(), round % 2 != 0 ? texels.data() : nullptr,
                  round % 4 >= 2 ? tangents.data() : nullptr, out);
          },
          3);
      ShadowMap map{depths.data(), 64, {}, 0.1f, 0.01f};
      for (auto& row : map.m)
        for (float& f : row) f = random.between(-8, 8);
      for (int c = 0; c < 4; ++c) map.m[3][c] = round % 2 == 0 ? (c == 3 ? 1.0f : 0.0f) : random.between(-0.3f, 0.5f);
      for (int c = 0; c < 3; ++c) map.m[2][c] *= 0.05f;
      map.m[0][3] = map.m[1][3] = 32;
      map.m[2][3] = 0.5f;
      expect_equal([&](const TileKernels& k, float* out) { k.shadow_map(map, n, normal.data(), position.data(), out); },
                   1);
    }
  });
}

TEST_CASE("anisotropic and alpha filters: every instruction set gives the scalar bits for every size and wrap") {
  for_each_isa([&](const Kernels& scalar, const Kernels& table) {
    Random random(73);
    constexpr int kSizes[][2] = {{1, 1}, {1, 7}, {64, 64}, {37, 53}, {256, 16}};
    for (const auto& size : kSizes)
      for (int mode = 0; mode < 6; ++mode) {
        Scene scene;
        scene.textures.push_back(texture_of(size[0], size[1], [&](int, int) {
          return std::array<uint8_t, 4>{static_cast<uint8_t>(random.bits()), static_cast<uint8_t>(random.bits()),
                                        static_cast<uint8_t>(random.bits()), static_cast<uint8_t>(random.bits())};
        }));
        add_material(scene);
        scene.materials[0].texture = 0;
        scene.materials[0].wrap = mode % 2 == 0 ? Wrap::repeat : Wrap::clamp;
        scene.materials[0].filter = static_cast<Filter>(mode / 2);
        std::vector<Surface> surfaces;
        REQUIRE(prepare_surfaces(scene, {}, {}, nullptr, surfaces).ok());
        std::vector<float> rows[6], expected(3 * kBatchLanes), actual(3 * kBatchLanes);
        for (auto& row : rows) row.resize(kBatchLanes);
        for (size_t k = 0; k < kBatchLanes; ++k) {
          rows[0][k] = random.between(-3, 3);
          rows[1][k] = random.between(-3, 3);
          rows[2][k] = random.between(-2, 9);
          rows[3][k] = random.between(-1, 1);
          rows[4][k] = k % 7 == 0 ? 0x1p20f : random.between(-1, 1);
          rows[5][k] = static_cast<float>(1 + random.bits() % 8);
        }
        const auto run = [&](const TileKernels& k, float* out) {
          k.sample_anisotropic(surfaces[0].sampler, kBatchLanes, rows[0].data(), rows[1].data(), rows[2].data(),
                               rows[3].data(), rows[4].data(), rows[5].data(), out);
        };
        run(scalar.tile, expected.data());
        run(table.tile, actual.data());
        REQUIRE(std::memcmp(expected.data(), actual.data(), expected.size() * sizeof(float)) == 0);
        const auto run_alpha = [&](const TileKernels& k, float* out) {
          k.sample_alpha(surfaces[0].sampler, kBatchLanes, rows[0].data(), rows[1].data(), rows[2].data(), out);
        };
        run_alpha(scalar.tile, expected.data());
        run_alpha(table.tile, actual.data());
        REQUIRE(std::memcmp(expected.data(), actual.data(), expected.size() * sizeof(float)) == 0);
      }
  });
}

// A checkered floor that runs away from the viewer.
Scene checkered_floor(int anisotropy) {
  Scene scene;
  scene.textures.push_back(texture_of(256, 256, [](int x, int y) {
    const auto c = static_cast<uint8_t>((x / 16 + y / 16) % 2 == 0 ? 230 : 20);
    return std::array<uint8_t, 4>{c, c, static_cast<uint8_t>(255 - c), 255};
  }));
  add_material(scene);
  scene.materials[0].texture = 0;
  scene.materials[0].anisotropy = anisotropy;
  test_scenes::add_quad(scene, {{-40, 0, 2}, {40, 0, 2}, {40, 0, -78}, {-40, 0, -78}},
                        {{0, 0}, {20, 0}, {20, 20}, {0, 20}}, 0, {255, 255, 255, 255});
  return scene;
}

TEST_CASE("anisotropic filter: a floor at a grazing angle comes nearer to its supersampled picture with more probes") {
  const Camera camera = make_camera({0, 0.6f, 2}, {0, 0, -6}, {0, 1, 0}, 0.9f, 1, 0.05f, 200);
  RenderQuality many;
  many.samples = 64;
  const RgbImage truth = draw(checkered_floor(1), camera, many);
  std::vector<double> errors;
  for (const int anisotropy : {1, 2, 4, 8})
    errors.push_back(squared_error(draw_everywhere(checkered_floor(anisotropy), camera), truth, 40, kSide));
  CHECK(errors[1] < 0.9 * errors[0]);
  CHECK(errors[2] < 0.9 * errors[1]);
  CHECK(errors[3] < errors[2]);
  CHECK(errors[3] < 0.5 * errors[0]);
  CHECK(hash(draw(checkered_floor(8), camera)) == hash(draw(checkered_floor(1000), camera)));
  CHECK(hash(draw(checkered_floor(1), camera)) == hash(draw(checkered_floor(-3), camera)));
}

TEST_CASE("anisotropic filter: a surface seen straight on is filtered as before") {
  const auto flat = [](int anisotropy) {
    Scene scene = checkered_floor(anisotropy);
    scene.mesh = {};
    add_square(scene, 0, 0, {255, 255, 255, 255});
    return draw(scene, Camera{});
  };
  CHECK(squared_error(flat(8), flat(1), 0, kSide) <= 3.0 * kSide * kSide);  // a level at most
}

}  // namespace
