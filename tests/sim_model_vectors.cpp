// Block vectors from the model: what moved where, told without search.
#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

#include "sim/model_vectors.h"

namespace {

using namespace pac;

constexpr int kSide = 96;  // 6 x 6 macroblocks

raster::Camera shifted(float pixels_x, float pixels_y) {
  raster::Camera camera;
  camera.clip_from_world[3][0] = pixels_x * 2.0f / kSide;
  camera.clip_from_world[3][1] = -pixels_y * 2.0f / kSide;
  return camera;
}

bool are_all(const std::vector<mpeg1::MotionVector>& vectors, mpeg1::MotionVector wanted) {
  return std::all_of(vectors.begin(), vectors.end(), [&](const mpeg1::MotionVector& v) { return v == wanted; });
}

TEST_CASE("a pan moves every block by itself, in half samples, however far") {
  DepthImage depth(kSide, kSide - 5);  // no multiple of 16
  IdImage id(kSide, kSide - 5);
  for (int y = 0; y < depth.height(); ++y) std::fill_n(depth.row(y), kSide, 0.5f);
  sim::ModelFlow flow(kSide, kSide, 0.5, 0.5, {}, best_isa());
  flow.remember({}, {});
  struct Case {
    float x, y;
    mpeg1::MotionVector vector;
  };
  const Case cases[] = {{0, 0, {0, 0}}, {6, 0, {-12, 0}}, {-2.5f, 3, {5, -6}}, {80, -40.5f, {-160, 81}}};
  for (const Case& item : cases) {
    const auto vectors = sim::vectors_of(flow.find(depth.view(), id.view(), shifted(item.x, item.y), {}));
    CHECK(vectors.size() == 6 * 6 * sim::kModelVectors);
    CHECK(are_all(vectors, item.vector));
  }
}

TEST_CASE(
    "blocks of an object that moved have its vector, those of what stands have none, at the edge there are both") {
  DepthImage depth(kSide, kSide);
  IdImage id(kSide, kSide);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      depth.row(y)[x] = 0.5f;
      id.row(y)[x] = x < 40 ? 1 : 2;
    }
  sim::ModelFlow flow(kSide, kSide, 0.5, 0.5, {sim::kStands, sim::kStands, 1}, best_isa());
  glm::mat4 moved(1.0f);
  moved[3][0] = 4 * 2.0f / kSide;
  flow.remember({}, {{glm::mat4(1.0f)}});
  const auto vectors = sim::vectors_of(flow.find(depth.view(), id.view(), {}, {{moved}}));
  const auto of_block = [&](int column) {
    const auto first = vectors.begin() + column * sim::kModelVectors;
    return std::vector<mpeg1::MotionVector>(first, first + sim::kModelVectors);
  };
  CHECK(are_all(of_block(0), {0, 0}));
  CHECK(are_all(of_block(5), {-8, 0}));
  const auto edge = of_block(2);  // columns 32 to 47
  CHECK(std::count(edge.begin(), edge.end(), mpeg1::MotionVector{0, 0}) > 0);
  CHECK(std::count(edge.begin(), edge.end(), mpeg1::MotionVector{-8, 0}) > 0);
}

TEST_CASE("what was nowhere has no vector") {
  sim::Flow flow{Image<int32_t, 1>(kSide, kSide), Image<int32_t, 1>(kSide, kSide), DepthImage(kSide, kSide)};
  for (int y = 0; y < kSide; ++y) {
    std::fill_n(flow.x_64.row(y), kSide, kWarpNowhere);
    std::fill_n(flow.y_64.row(y), kSide, kWarpNowhere);
  }
  CHECK(are_all(sim::vectors_of(flow), {0, 0}));
}

}  // namespace
