#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "base/bd_rate.h"

namespace pac::test {
namespace {

using Points = std::vector<RatePoint>;

double percent(const Points& reference, const Points& test) {
  const auto result = bd_rate(reference, test);
  REQUIRE(result.ok());
  return result->percent;
}

const Points kReference{{4100, 21.5}, {7300, 44.25}, {12050, 58}, {20400, 71.75}, {33000, 80.5}};
const Points kTest{{2900, 12.5}, {5200, 40}, {9100, 61.5}, {16100, 74}, {30500, 85}};

TEST_CASE("BD-rate and curve: the figures of SciPy's PchipInterpolator") {
  const auto result = bd_rate(kReference, kTest);
  REQUIRE(result.ok());
  CHECK(result->percent == doctest::Approx(-25.1262260015).epsilon(1e-9));
  CHECK(result->lowest_quality == 21.5);
  CHECK(result->highest_quality == 80.5);
  const auto curve = RateCurve::create(kReference);
  REQUIRE(curve.ok());
  CHECK(curve->bytes_at(50) == doctest::Approx(8884.84694774).epsilon(1e-10));
  CHECK(curve->bytes_at(75.5) == doctest::Approx(24641.02374915).epsilon(1e-10));
  // A turn, a plateau at its sides, uneven steps.
  const auto turning = RateCurve::create(Points{{1000, 1}, {1500, 2}, {1400, 2.5}, {4000, 7}, {4100, 7.5}});
  REQUIRE(turning.ok());
  struct Place {
    double quality, bytes;
  };
  for (const Place& place :
       {Place{1, 1000.00000000}, {1.2, 1150.78276691}, {2.2, 1464.01054348}, {4, 1795.87762946}, {7.4, 4085.91919038}})
    CHECK(turning->bytes_at(place.quality) == doctest::Approx(place.bytes).epsilon(1e-10));
  CHECK(turning->integral(1.3, 7.2) == doctest::Approx(45.2139035807).epsilon(1e-10));
}

TEST_CASE("BD-rate: bytes times a factor are that factor, in either order of points and for falling metrics") {
  Points scaled = kReference, falling = kReference, falling_scaled = kReference;
  for (size_t i = 0; i < kReference.size(); ++i) {
    scaled[kReference.size() - 1 - i] = {kReference[i].size_bytes * 0.7, kReference[i].quality};
    falling[i].quality = 1 / kReference[i].quality;
    falling_scaled[i] = {kReference[i].size_bytes * 1.25, falling[i].quality};
  }
  CHECK(percent(kReference, scaled) == doctest::Approx(-30).epsilon(1e-10));
  CHECK(percent(scaled, kReference) == doctest::Approx(100 / 0.7 - 100).epsilon(1e-10));
  CHECK(percent(falling, falling_scaled) == doctest::Approx(25).epsilon(1e-10));
  CHECK(std::abs(percent(kReference, kReference)) < 1e-12);
}

TEST_CASE("BD-rate: two points a curve, only the shared range counts") {
  // ln bytes = q / 10 against ln bytes = q / 10 - 0.5, on 0..60 and 30..90.
  const Points a{{1, 0}, {std::exp(6.0), 60}}, b{{std::exp(2.5), 30}, {std::exp(8.5), 90}};
  const auto result = bd_rate(a, b);
  REQUIRE(result.ok());
  CHECK(result->percent == doctest::Approx(100 * (std::exp(-0.5) - 1)).epsilon(1e-9));
  CHECK(result->lowest_quality == 30);
  CHECK(result->highest_quality == 60);
}

TEST_CASE("a rate curve passes through its points, stays between neighbors and ends where they end") {
  const auto curve = RateCurve::create(kTest);
  REQUIRE(curve.ok());
  for (const RatePoint& point : kTest)
    CHECK(curve->bytes_at(point.quality) == doctest::Approx(point.size_bytes).epsilon(1e-12));
  double last = 0;
  for (double q = 12.5; q <= 85; q += 0.25) {
    CHECK(curve->bytes_at(q) >= last);
    last = curve->bytes_at(q);
  }
  CHECK(curve->bytes_at(-100) == curve->bytes_at(12.5));
  CHECK(curve->bytes_at(200) == curve->bytes_at(85));
}

TEST_CASE("BD-rate refuses curves that say nothing") {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  CHECK_FALSE(bd_rate(Points{{1, 2}}, kTest).ok());
  CHECK_FALSE(bd_rate(kTest, Points{}).ok());
  CHECK_FALSE(bd_rate(kTest, Points{{100, 50}, {200, 50}}).ok());
  CHECK_FALSE(bd_rate(kTest, Points{{0, 50}, {200, 60}}).ok());
  CHECK_FALSE(bd_rate(kTest, Points{{100, kNan}, {200, 60}}).ok());
  CHECK_FALSE(bd_rate(kTest, Points{{100, 90}, {200, 95}}).ok());  // no shared range
  CHECK_FALSE(bd_rate(kTest, Points{{100, 85}, {200, 95}}).ok());  // a single point shared
}

}  // namespace
}  // namespace pac::test
