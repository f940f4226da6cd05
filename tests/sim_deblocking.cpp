// What the deblocking filter smooths, and what it leaves as it is.
#include <doctest/doctest.h>

#include <cstdint>
#include <cstdlib>

#include "sim/deblocking.h"
#include "sim/model_prediction.h"

namespace {

using namespace pac;

constexpr int kWidth = 45, kHeight = 37;  // no multiples of 8
constexpr int kOne = 1 << kCarriedBits;

// A difference of blocks, each `step` (in 1/32) more than the one before it and the one above.
struct Blocks {
  sim::BorderedPlane difference{kWidth, kHeight}, shown{kWidth, kHeight};
  GrayImage coded{kWidth, kHeight}, reference{kWidth, kHeight};
  IdImage id{kWidth, kHeight};

  explicit Blocks(int step) {
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        difference.row(y)[x] = static_cast<int16_t>(step * (x / 8 + y / 8));
        coded.row(y)[x] = 1;
        id.row(y)[x] = 7;
      }
  }
  void filter() {
    sim::Deblocker deblocker(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y) deblocker.see_row(y, id.row(y));
    deblocker.filter(difference, coded.view(), reference.view(), shown);
  }
  // Samples that are not what they were.
  int changed() const {
    int n = 0;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) n += shown.row(y)[x] != difference.row(y)[x];
    return n;
  }
  int step_at(int x, int y) const { return shown.row(y)[x] - shown.row(y)[x - 1]; }
};

TEST_CASE("steps between coded blocks of one polygon are smoothed, along both directions") {
  Blocks blocks(2 * kOne);
  blocks.filter();
  for (int x = 8; x < kWidth - 1; x += 8) CHECK(blocks.step_at(x, 3) < kOne);
  for (int y = 8; y < kHeight - 1; y += 8) CHECK(blocks.shown.row(y)[3] - blocks.shown.row(y - 1)[3] < kOne);
  CHECK(blocks.step_at(4, 3) == 0);  // inside a block
}

TEST_CASE("steps at a polygon's edge stay, however small, and so do great ones") {
  Blocks blocks(2 * kOne);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) blocks.id.row(y)[x] = static_cast<uint32_t>(x / 8 + 100 * (y / 8));
  blocks.filter();
  CHECK(blocks.changed() == 0);
  Blocks content(40 * kOne);
  content.filter();
  CHECK(content.changed() == 0);
}

TEST_CASE("borders between macroblocks that were not coded stay") {
  Blocks blocks(2 * kOne);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) blocks.reference.row(y)[x] = blocks.coded.row(y)[x];
  blocks.filter();
  CHECK(blocks.changed() == 0);
  blocks.reference.row(20)[20] = 9;  // the second macroblock of the second row
  blocks.filter();
  CHECK(blocks.step_at(24, 20) < kOne);
  CHECK(blocks.step_at(16, 20) < kOne);
  CHECK(blocks.step_at(32, 20) < kOne);
  CHECK(blocks.step_at(40, 20) == 2 * kOne);
  CHECK(blocks.step_at(24, 4) == 2 * kOne);
}

TEST_CASE("pictures smaller than a block go through") {
  sim::Deblocker deblocker(1, 1);
  const uint32_t id = 3;
  deblocker.see_row(0, &id);
  sim::BorderedPlane difference(1, 1), shown(1, 1);
  difference.row(0)[0] = 77;
  const GrayImage picture(1, 1);
  deblocker.filter(difference, picture.view(), picture.view(), shown);
  CHECK(shown.row(0)[0] == 77);
}

TEST_CASE("what is kept for the next frame is not filtered") {
  sim::ModelPredictor model(kWidth, kHeight, {0, 1}, 0.5, 0.5);
  model.deblock(true);
  Blocks blocks(0);
  const DepthImage depth(kWidth, kHeight);
  Frame420 gray(kWidth, kHeight), picture(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      blocks.id.row(y)[x] = 1;
      gray.y.row(y)[x] = 100;
      picture.y.row(y)[x] = static_cast<uint8_t>(100 + 2 * (x / 8));
    }
  model.reference(gray, depth.view(), blocks.id.view(), {});
  model.keep(picture.y.view(), picture.cb.view(), picture.cr.view());
  const auto step = [](const sim::BorderedPlane& plane) { return plane.row(5)[8] - plane.row(5)[7]; };
  CHECK(step(model.difference(0)) == 2 * kOne);
  CHECK(step(model.shown(0)) < kOne);
  model.deblock(false);
  CHECK(step(model.shown(0)) == 2 * kOne);
}

}  // namespace
