// Reprojection and the carried difference: identity for a camera at rest, a shift for a known pan, nothing where the
// frame before saw something else.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "base/metrics.h"
#include "raster/sample_pattern.h"
#include "sim/frame420.h"
#include "sim/frame_renderer.h"
#include "sim/model_prediction.h"
#include "sim/signed_composite.h"
#include "sim/warp_filter.h"
#include "tests/support/small_scene.h"

namespace {

using namespace pac;

constexpr int kWidth = 64, kHeight = 48;

// Pixels of a wall at u = 1 - depth of one half, seen by a camera that shows world x in -1..1.
struct Wall {
  DepthImage depth{kWidth, kHeight};
  IdImage id{kWidth, kHeight};
  Frame420 gray{kWidth, kHeight}, picture{kWidth, kHeight};

  Wall() {
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        depth.row(y)[x] = 0.5f;
        id.row(y)[x] = 1;
        gray.y.row(y)[x] = 128;
        picture.y.row(y)[x] = static_cast<uint8_t>(100 + 7 * x % 50 + 3 * y % 40);
      }
    for (int y = 0; y < kHeight / 2; ++y)
      for (int x = 0; x < kWidth / 2; ++x) {
        gray.cb.row(y)[x] = gray.cr.row(y)[x] = 128;
        picture.cb.row(y)[x] = static_cast<uint8_t>(100 + 5 * x + y);
        picture.cr.row(y)[x] = static_cast<uint8_t>(150 - 3 * x + 2 * y);
      }
  }
};

raster::Camera shifted(float pixels) {
  raster::Camera camera;
  camera.clip_from_world[3][0] = pixels * 2.0f / kWidth;
  return camera;
}

sim::ModelPredictor predictor() {
  return sim::ModelPredictor(kWidth, kHeight, {0, 1, 2}, 0.5, 0.5);
}

bool equal(const GrayImage& a, const GrayImage& b, int margin_left = 0) {
  for (int y = 0; y < a.height(); ++y)
    if (!std::equal(a.row(y) + margin_left, a.row(y) + a.width(), b.row(y) + margin_left)) return false;
  return true;
}

TEST_CASE("a camera at rest carries the difference unchanged, sample for sample") {
  const Wall wall;
  sim::ModelPredictor model = predictor();
  CHECK(equal(model.reference(wall.gray, wall.depth.view(), wall.id.view(), {}).y, wall.gray.y));
  model.keep(wall.picture.y.view(), wall.picture.cb.view(), wall.picture.cr.view());
  const Frame420& reference = model.reference(wall.gray, wall.depth.view(), wall.id.view(), {});
  CHECK(equal(reference.y, wall.picture.y));
  CHECK(equal(reference.cb, wall.picture.cb));
  CHECK(equal(reference.cr, wall.picture.cr));
  CHECK(model.stats().carried_share == 1.0);
}

TEST_CASE("a pan by whole pixels shifts luma, by two of them chroma, and shows the base where nothing came from") {
  const Wall wall;
  sim::ModelPredictor model = predictor();
  model.reference(wall.gray, wall.depth.view(), wall.id.view(), {});
  model.keep(wall.picture.y.view(), wall.picture.cb.view(), wall.picture.cr.view());
  const Frame420& reference = model.reference(wall.gray, wall.depth.view(), wall.id.view(), shifted(6));
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) REQUIRE(reference.y.row(y)[x] == (x < 6 ? 128 : wall.picture.y.row(y)[x - 6]));
  for (int y = 0; y < kHeight / 2; ++y)
    for (int x = 3; x < kWidth / 2; ++x) {
      REQUIRE(reference.cb.row(y)[x] == wall.picture.cb.row(y)[x - 3]);
      REQUIRE(reference.cr.row(y)[x] == wall.picture.cr.row(y)[x - 3]);
    }
}

TEST_CASE("nothing is carried from another object or from another depth") {
  for (const bool other_depth : {false, true}) {
    Wall wall;
    sim::ModelPredictor model(kWidth, kHeight, {0, 1, 1}, 0.5, 0.5, best_isa(), {sim::kStands, sim::kStands, 1});
    const sim::Transforms objects = {glm::mat4(1.0f)};
    model.reference(wall.gray, wall.depth.view(), wall.id.view(), {}, objects);
    model.keep(wall.picture.y.view(), wall.picture.cb.view(), wall.picture.cr.view());
    for (int y = 0; y < kHeight; ++y)
      for (int x = 20; x < 40; ++x) {
        if (other_depth)
          wall.depth.row(y)[x] = 0.25f;
        else
          wall.id.row(y)[x] = 2;
      }
    const Frame420& reference = model.reference(wall.gray, wall.depth.view(), wall.id.view(), {}, objects);
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        REQUIRE(reference.y.row(y)[x] == (x >= 20 && x < 40 ? 128 : wall.picture.y.row(y)[x]));
  }
}

TEST_CASE("the interpolation filter keeps constants and whole pixels") {
  for (int phase = 0; phase < kWarpPhases; ++phase) {
    int sum = 0, absolute = 0;
    for (int tap = 0; tap < kWarpTapStride; ++tap) {
      const int value = sim::kWarpFilter[static_cast<size_t>(phase * kWarpTapStride + tap)];
      sum += value;
      absolute += std::abs(value);
      if (phase == 0) CHECK(value == (tap == 2 ? 512 : 0));
      if (tap >= kWarpTaps) CHECK(value == 0);
    }
    CHECK(sum == 512);
    CHECK(absolute <= 1020);
  }
}

TEST_CASE("a walk past textured surfaces: the model predicts H at least 6 dB better than the picture before does") {
  const sim::SceneSet scene = test::small_scene(false);
  const auto split = sim::make_split("texture", scene, {16});
  REQUIRE(split.ok());
  constexpr int kSide = 128;
  auto renderer = sim::FrameRenderer::create(scene, *split, false, kSide, kSide, 1, best_isa());
  REQUIRE(renderer.ok());
  const raster::SampleOffset sample = raster::sample_pattern(split->low.samples)[0];
  sim::ModelPredictor model(kSide, kSide, sim::surfaces_of(renderer->low_scene()), sample.x / 256.0, sample.y / 256.0);
  Frame420 high(kSide, kSide), low(kSide, kSide);
  for (int number = 0; number < 4; ++number) {
    const raster::Camera camera = test::small_camera(number, 1.0f);
    const auto images = renderer->render(scene, camera, true);
    REQUIRE(images.ok());
    sim::frame420_from_rgb(images->low.view(), low);
    GrayImage before = high.y.clone();
    sim::frame420_from_rgb(images->high.view(), high);
    const Frame420& reference = model.reference(low, images->depth.view(), images->id.view(), camera);
    if (number > 0) {
      const double still = psnr_from_mse(mean_squared_error(before.view(), high.y.view()));
      const double modeled = psnr_from_mse(mean_squared_error(reference.y.view(), high.y.view()));
      MESSAGE("frame " << number << ": " << still << " dB, model " << modeled << " dB");
      CHECK(modeled > still + 6);
      CHECK(model.stats().carried_share > 0.7);
    }
    model.keep(high.y.view(), high.cb.view(), high.cr.view());
  }
}

TEST_CASE("L and a signed difference without error give H back, whatever their distance, where chroma is flat") {
  RgbImage low(16, 16), high(16, 16), shown(16, 16);
  for (int y = 0; y < 16; ++y)
    for (int i = 0; i < 48; ++i) {
      low.row(y)[i] = i % 3 == 0 ? 10 : 250;
      high.row(y)[i] = i % 3 == 0 ? 240 : 5;
    }
  Frame420 low420(16, 16), high420(16, 16);
  sim::frame420_from_rgb(low.view(), low420);
  sim::frame420_from_rgb(high.view(), high420);
  sim::ModelPredictor model(16, 16, {0}, 0.5, 0.5);
  const DepthImage depth(16, 16);
  const IdImage id(16, 16);
  model.reference(low420, depth.view(), id.view(), {});
  model.keep(high420.y.view(), high420.cb.view(), high420.cr.view());
  sim::composite_signed(low.view(), model.difference(0), model.difference(1), model.difference(2), shown.view());
  for (int y = 0; y < 16; ++y)
    for (int i = 0; i < 48; ++i) CHECK(std::abs(shown.row(y)[i] - high.row(y)[i]) <= 3);
}

}  // namespace
