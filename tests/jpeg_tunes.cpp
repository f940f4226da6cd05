// What each tuning is for: fewer bytes at equal value of its metric than any other tuning.
#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "base/bd_rate.h"
#include "base/metrics.h"
#include "base/psnr_hvs.h"
#include "base/ssimulacra2.h"
#include "jpeg/jpeg.h"
#include "tests/support/generators.h"

namespace {

using namespace pac;
using jpeg::Tune;

// Shades, edges and some noise, in color.
RgbImage picture(uint32_t seed) {
  RgbImage image(192, 160);
  test::Random random(seed);
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      const double wave = 40 * std::sin(0.11 * x + 0.05 * y) + 30 * std::cos(0.31 * y - 0.002 * x * x);
      const bool inside = (x / 24 + y / 20) % 3 == 0;
      const int grain = static_cast<int>(random.next() % 24);
      for (int c = 0; c < 3; ++c)
        image.pixel(x, y)[c] = static_cast<uint8_t>(90 + wave * (1.0 - 0.3 * c) + (inside ? 50 - 20 * c : 0) + grain);
    }
  return image;
}

double measure(Tune metric, const RgbImage& image, const RgbImage& decoded) {
  switch (metric) {
    case Tune::psnr:
      return psnr_rgb(image.view(), decoded.view());
    case Tune::ssim:
      return -10 * std::log10(1 - ssim_luma(image.view(), decoded.view()));
    case Tune::visual:
      return ssimulacra2(image.view(), decoded.view());
    default:
      return psnr_hvs_luma(image.view(), decoded.view()).psnr_hvs_m_db;
  }
}

std::vector<RatePoint> curve(const RgbImage& image, Tune metric, Tune tune) {
  std::vector<RatePoint> points;
  for (const double quality : {20.0, 40.0, 60.0, 80.0}) {
    const auto file = jpeg::encode(image.view(), jpeg::options_for(jpeg::Effort::best, tune, quality));
    REQUIRE(file.ok());
    points.push_back({static_cast<double>(file->size()), measure(metric, image, *jpeg::decode(*file))});
  }
  return points;
}

TEST_CASE("each tuning takes the fewest bytes at equal value of the metric it is for") {
  const RgbImage image = picture(5);
  for (const Tune metric : {Tune::psnr, Tune::ssim, Tune::visual, Tune::hvs}) {
    const auto own = curve(image, metric, metric);
    for (const Tune other : {Tune::psnr, Tune::ssim, Tune::visual, Tune::hvs}) {
      if (other == metric) continue;
      const auto rate = bd_rate(curve(image, metric, other), own);
      REQUIRE(rate.ok());
      CAPTURE(static_cast<int>(metric));
      CAPTURE(static_cast<int>(other));
      CHECK(rate->percent < 0);
    }
  }
}

}  // namespace
