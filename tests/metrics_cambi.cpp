#include <doctest/doctest.h>

#include <cmath>

#include "base/cambi.h"
#include "base/metrics.h"
#include "tests/support/metric_pictures.h"

namespace pac::test {
namespace {

// A slope of `rise` levels over the width, in steps of `step` levels.
GrayImage slope(int width, int height, int rise, int step) {
  GrayImage image(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) *image.pixel(x, y) = static_cast<uint8_t>(60 + x * rise / width / step * step);
  return image;
}

TEST_CASE("CAMBI: the figures of libvmaf's code, in limited and in full range, within 1e-5") {
  struct Pin {
    Damage damage;
    int amount;
    double limited, full;
  };
  constexpr Pin kPins[] = {
      {Damage::bands, 12, 2.029031, 1.604655},
      {Damage::bands, 40, 0.044493, 0.044175},
      {Damage::blocks, 30, 2.465435, 2.183473},
      {Damage::blocks, 90, 3.655678, 3.157697},
      {Damage::blur, 3, 2.315379, 2.315055},
      {Damage::no_shadow, 10, 3.188282, 3.184382},
      {Damage::noise, 8, 0.0, 0.0},
      {Damage::tint, 30, 3.153692, 3.152559},
  };
  const RgbImage scene = metric_scene(256, 192);
  for (const Pin& pin : kPins) {
    CAPTURE(damage_name(pin.damage));
    const GrayImage luma = luma_of(damaged(scene, pin.damage, pin.amount).view());
    CHECK(std::abs(cambi(luma.view(), LumaRange::limited) - pin.limited) < 1e-5);
    CHECK(std::abs(cambi(luma.view()) - pin.full) < 1e-5);
  }
  CHECK(std::abs(cambi_luma(scene.view()) - 3.184382) < 1e-5);
}

TEST_CASE("CAMBI: a slope in steps of one level is banded, a flat or a noisy picture and steps far too high are not") {
  CHECK(cambi(slope(256, 224, 0, 1).view()) == 0);
  const double fine = cambi(slope(256, 224, 12, 1).view());
  CHECK(fine > 1);
  CHECK(cambi(slope(256, 224, 200, 50).view()) < 0.1 * fine);
  GrayImage noisy = slope(256, 224, 12, 1);
  Random random(3);
  for (int y = 0; y < 224; ++y)
    for (int x = 0; x < 256; ++x) *noisy.pixel(x, y) = static_cast<uint8_t>(*noisy.pixel(x, y) + random.in(0, 6));
  CHECK(cambi(noisy.view()) < 0.01);
}

TEST_CASE("CAMBI: any size down to one pixel has a number") {
  for (const auto& [width, height] : {std::pair{1, 1}, {2, 1}, {1, 40}, {63, 5}, {65, 64}}) {
    const double score = cambi_luma(metric_scene(width, height).view());
    CHECK(score >= 0);
    CHECK(score < 30);
  }
}

}  // namespace
}  // namespace pac::test
