#include <doctest/doctest.h>

#include <cmath>

#include "base/parallel.h"
#include "base/ssimulacra2.h"
#include "tests/support/metric_pictures.h"

namespace pac::test {
namespace {

struct Pin {
  int width, height;
  Damage damage;
  int amount;
  double reference;  // printed by the reference program, version 2.1
};

// The reference's recursive filter gathers rounding errors along rows and columns, which count as damage in smooth
// pictures: its scores lie below those of exact arithmetic, by up to 0.4 near 100. A copy of ours in doubles gives our
// scores within 0.04 in the same places and 0.002 elsewhere.
TEST_CASE("SSIMULACRA2: scores of the reference program, within its own rounding errors") {
  constexpr Pin kPins[] = {
      {256, 192, Damage::noise, 8, 75.47286599},      {256, 192, Damage::noise, 40, 2.94695452},
      {256, 192, Damage::blur, 1, -6.32730969},       {256, 192, Damage::blur, 3, -60.09772850},
      {256, 192, Damage::blocks, 30, 33.43983360},    {256, 192, Damage::blocks, 90, -56.90657411},
      {256, 192, Damage::bands, 12, 55.00910383},     {256, 192, Damage::bands, 40, -28.91899678},
      {256, 192, Damage::tint, 6, 90.56255380},       {256, 192, Damage::tint, 30, 47.52890480},
      {256, 192, Damage::no_shadow, 10, 69.84371473}, {256, 192, Damage::no_shadow, 60, -33.86199877},
      {61, 45, Damage::noise, 8, 26.72926973},        {61, 45, Damage::blur, 1, -34.36945279},
      {61, 45, Damage::bands, 12, 48.91447994},       {61, 45, Damage::no_shadow, 10, 95.34180435},
      {16, 23, Damage::noise, 40, 58.91222456},       {16, 23, Damage::blocks, 90, 45.56532002},
      {16, 23, Damage::tint, 6, 94.35557496},         {16, 23, Damage::blur, 3, 55.72704979},
  };
  for (const Pin& pin : kPins) {
    CAPTURE(damage_name(pin.damage));
    CAPTURE(pin.amount);
    CAPTURE(pin.width);
    const RgbImage scene = metric_scene(pin.width, pin.height);
    const double score = ssimulacra2(scene.view(), damaged(scene, pin.damage, pin.amount).view());
    const double tolerance = pin.reference > 90 ? 0.5 : 0.04;
    CHECK(std::abs(score - pin.reference) < tolerance);
  }
}

TEST_CASE("SSIMULACRA2: the same bits on every system and for every number of threads") {
  const RgbImage scene = metric_scene(200, 301);
  const RgbImage noisy = damaged(scene, Damage::noise, 20);
  const double score = ssimulacra2(scene.view(), noisy.view());
  CHECK(score == 40.511610383772819);
  for (const int n_threads : {1, 2, 5}) {
    ThreadPool pool(n_threads);
    CHECK(ssimulacra2(scene.view(), noisy.view(), &pool) == score);
  }
}

TEST_CASE("SSIMULACRA2: equal pictures score exactly 100, also below 8 pixels a side") {
  for (const auto& [width, height] : {std::pair{1, 1}, {3, 200}, {7, 7}, {8, 8}, {9, 16}, {130, 131}}) {
    const RgbImage scene = metric_scene(width, height);
    CHECK(ssimulacra2(scene.view(), scene.view()) == 100);
  }
  RgbImage black(5, 4), white(5, 4);
  for (int y = 0; y < 4; ++y) std::fill_n(white.row(y), 15, uint8_t{255});
  CHECK(ssimulacra2(black.view(), white.view()) < 50);
}

TEST_CASE("SSIMULACRA2: every kind of damage scores worse the more there is of it") {
  const RgbImage scene = metric_scene(150, 110);
  const Ssimulacra2 metric(scene.view());
  for (const Damage damage : kDamages) {
    CAPTURE(damage_name(damage));
    double last = 100;
    for (int step = 1; step <= 4; ++step) {
      const int amount = damage == Damage::blur ? step : damage == Damage::blocks ? 22 * step : 2 + 9 * step;
      const double score = metric.score(damaged(scene, damage, amount).view());
      CAPTURE(amount);
      CHECK(score < last);
      last = score;
    }
  }
}

TEST_CASE("SSIMULACRA2: a reference prepared once gives the scores of single pairs, for views with any stride") {
  const RgbImage scene = metric_scene(90, 61), blurred = damaged(scene, Damage::blur, 2);
  const Ssimulacra2 metric(scene.view());
  CHECK(metric.score(blurred.view()) == ssimulacra2(scene.view(), blurred.view()));
  ConstRgbView left = scene.view(), left_blurred = blurred.view();
  left.width = left_blurred.width = 40;
  RgbImage copy(40, 61), blurred_copy(40, 61);
  for (int y = 0; y < 61; ++y) {
    std::copy_n(left.row(y), 120, copy.row(y));
    std::copy_n(left_blurred.row(y), 120, blurred_copy.row(y));
  }
  CHECK(ssimulacra2(left, left_blurred) == ssimulacra2(copy.view(), blurred_copy.view()));
}

}  // namespace
}  // namespace pac::test
