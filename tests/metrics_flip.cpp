#include <doctest/doctest.h>

#include <cmath>

#include "base/exact_math_float.h"
#include "base/flip.h"
#include "base/metrics.h"
#include "base/parallel.h"
#include "tests/support/metric_pictures.h"

namespace pac::test {
namespace {

TEST_CASE("FLIP: means of the authors' reference code within 2e-6") {
  struct Pin {
    int width, height;
    Damage damage;
    int amount;
    double reference;  // mean of the map of the authors' FLIP.h 1.7 at its default 67 pixels per degree
  };
  constexpr Pin kPins[] = {
      {256, 192, Damage::noise, 8, 0.04791568},      {256, 192, Damage::noise, 40, 0.16071921},
      {256, 192, Damage::blur, 1, 0.09153012},       {256, 192, Damage::blur, 3, 0.15704343},
      {256, 192, Damage::blocks, 30, 0.09896954},    {256, 192, Damage::blocks, 90, 0.18531357},
      {256, 192, Damage::bands, 12, 0.08622061},     {256, 192, Damage::bands, 40, 0.21695721},
      {256, 192, Damage::tint, 6, 0.10550733},       {256, 192, Damage::tint, 30, 0.34266400},
      {256, 192, Damage::no_shadow, 10, 0.01348523}, {256, 192, Damage::no_shadow, 60, 0.04565974},
      {61, 45, Damage::blocks, 90, 0.25431366},      {61, 45, Damage::tint, 30, 0.35284855},
      {16, 23, Damage::noise, 8, 0.05150223},        {16, 23, Damage::no_shadow, 10, 0.01826471},
  };
  for (const Pin& pin : kPins) {
    CAPTURE(damage_name(pin.damage));
    CAPTURE(pin.amount);
    CAPTURE(pin.width);
    const RgbImage scene = metric_scene(pin.width, pin.height);
    CHECK(std::abs(flip(scene.view(), damaged(scene, pin.damage, pin.amount).view()) - pin.reference) < 2e-6);
  }
}

TEST_CASE("FLIP: the map is the reference code's, pixel by pixel") {
  const RgbImage scene = metric_scene(256, 192);
  const DepthImage map = flip_map(scene.view(), damaged(scene, Damage::blur, 3).view());
  struct Place {
    int x, y;
    double error;
  };
  for (const Place& place : {Place{0, 0, 0.069109}, {100, 100, 0.407889}, {255, 191, 0.0}, {200, 130, 0.283150}})
    CHECK(std::abs(static_cast<double>(*map.pixel(place.x, place.y)) - place.error) < 5e-6);
}

TEST_CASE("FLIP: the same bits on every system and for every number of threads") {
  const RgbImage scene = metric_scene(130, 77);
  const RgbImage noisy = damaged(scene, Damage::noise, 20);
  const double error = flip(scene.view(), noisy.view());
  CHECK(error == 0.094398959299417343);
  for (const int n_threads : {1, 3}) {
    ThreadPool pool(n_threads);
    CHECK(flip(scene.view(), noisy.view(), &pool) == error);
  }
}

TEST_CASE("FLIP: equal pictures are 0 apart at every pixel, black and white 1") {
  for (const auto& [width, height] : {std::pair{1, 1}, {2, 90}, {40, 31}}) {
    const RgbImage scene = metric_scene(width, height);
    CHECK(flip(scene.view(), scene.view()) == 0);
  }
  RgbImage black(40, 30), white(40, 30);
  for (int y = 0; y < 30; ++y) std::fill_n(white.row(y), 120, uint8_t{255});
  // (Lightness 100 apart without color is 0.968: only saturated green against blue is farther.)
  CHECK(flip(black.view(), white.view()) == doctest::Approx(0.968).epsilon(1e-3));
}

TEST_CASE("FLIP: symmetric, and worse the more damage there is") {
  const RgbImage scene = metric_scene(120, 90);
  for (const Damage damage : kDamages) {
    CAPTURE(damage_name(damage));
    double last = 0;
    for (int step = 1; step <= 4; ++step) {
      const int amount = damage == Damage::blur ? step : damage == Damage::blocks ? 22 * step : 2 + 9 * step;
      const RgbImage test = damaged(scene, damage, amount);
      const double error = flip(scene.view(), test.view());
      CAPTURE(amount);
      CHECK(error > last);
      CHECK(flip(test.view(), scene.view()) == doctest::Approx(error).epsilon(1e-12));
      last = error;
    }
  }
}

TEST_CASE("magma: black for 0, light yellow for 1 and beyond, brighter in between") {
  DepthImage map(258, 1);
  for (int x = 0; x < 257; ++x) *map.pixel(x, 0) = static_cast<float>(x) / 255;
  *map.pixel(257, 0) = -1;
  const RgbImage picture = magma_picture(map);
  const auto luma = [&](int x) {
    return luma_bt601(picture.pixel(x, 0)[0], picture.pixel(x, 0)[1], picture.pixel(x, 0)[2]);
  };
  CHECK(luma(0) < 3);
  CHECK(luma(257) == luma(0));
  CHECK(luma(256) == luma(255));
  CHECK(luma(255) > 240);
  for (int x = 0; x < 255; ++x) CHECK(luma(x + 1) >= luma(x));
}

TEST_CASE("single-precision cube root and power are within their stated errors") {
  double worst_root = 0, worst_power = 0;
  for (float x = 0x1p-20f; x < 2; x *= 1.0003f)
    worst_root =
        std::max(worst_root, std::abs(static_cast<double>(exact_cube_root(x)) / std::cbrt(static_cast<double>(x)) - 1));
  for (float x = 0x1p-99f; x < 2; x *= 1.3f)
    for (float e = 0; e <= 1; e += 0.0625f)
      worst_power = std::max(worst_power, std::abs(static_cast<double>(exact_pow_unit(x, e)) /
                                                       std::pow(static_cast<double>(x), static_cast<double>(e)) -
                                                   1));
  CHECK(worst_root < 2.5e-7);
  CHECK(worst_power < 5e-6);
  CHECK(exact_pow_unit(1, 0.7f) == 1);
  CHECK(exact_pow_unit(0, 0) == 1);
}

}  // namespace
}  // namespace pac::test
