#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "base/edge_band.h"
#include "base/metrics.h"
#include "tests/support/metric_pictures.h"

namespace pac::test {
namespace {

int count(const GrayImage& mask) {
  int n = 0;
  for (int y = 0; y < mask.height(); ++y)
    for (int x = 0; x < mask.width(); ++x) n += *mask.pixel(x, y) != 0;
  return n;
}

TEST_CASE("edge band: reach pixels on either side of where ids change, square around corners, nothing elsewhere") {
  IdImage id(20, 12);
  for (int y = 0; y < 12; ++y)
    for (int x = 8; x < 20; ++x) *id.pixel(x, y) = 5;
  for (const int reach : {1, 2, 3}) {
    const GrayImage band = edge_band(id.view(), reach);
    for (int x = 0; x < 20; ++x) CHECK((*band.pixel(x, 6) != 0) == (x >= 8 - reach && x < 8 + reach));
    CHECK(count(band) == 2 * reach * 12);
  }
  IdImage dot(9, 9);
  *dot.pixel(4, 4) = 1;
  CHECK(count(edge_band(dot.view(), 1)) == 5);   // the dot and its four neighbors
  CHECK(count(edge_band(dot.view(), 2)) == 21);  // each of them with the square around it: 5x5 without its corners
  CHECK(count(edge_band(IdImage(7, 5).view())) == 0);
}

TEST_CASE("edge band of depth: silhouettes and the background's border, but no slopes") {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  DepthImage depth(30, 4);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 30; ++x)
      *depth.pixel(x, y) = x < 10 ? 5 + 0.05f * static_cast<float>(x) : x < 20 ? 9.0f : kInfinity;
  const GrayImage band = edge_band(depth.view(), 0.1f, 1);
  for (int x = 0; x < 30; ++x) {
    const bool is_edge = x == 9 || x == 10 || x == 19 || x == 20;
    CHECK((*band.pixel(x, 2) != 0) == is_edge);
  }
}

TEST_CASE("rms under a mask: over all pixels it is the rms, over none 0, and both parts add up") {
  const RgbImage scene = metric_scene(64, 48), test = damaged(scene, Damage::blur, 2);
  GrayImage all(64, 48), half(64, 48), other(64, 48);
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x) {
      *all.pixel(x, y) = 1;
      *(x < 20 ? half : other).pixel(x, y) = 255;
    }
  const MaskedError whole = masked_rms(scene.view(), test.view(), all.view());
  CHECK(whole.rms == doctest::Approx(rms_error(scene.view(), test.view())).epsilon(1e-12));
  CHECK(whole.n_pixels == 64 * 48);
  CHECK(masked_rms(scene.view(), test.view(), GrayImage(64, 48).view()).rms == 0);
  const MaskedError a = masked_rms(scene.view(), test.view(), half.view());
  const MaskedError b = masked_rms(scene.view(), test.view(), other.view());
  const double n_a = static_cast<double>(a.n_pixels), n_b = static_cast<double>(b.n_pixels);
  CHECK(a.n_pixels + b.n_pixels == whole.n_pixels);
  CHECK((a.rms * a.rms * n_a + b.rms * b.rms * n_b) / (n_a + n_b) == doctest::Approx(whole.rms * whole.rms));
}

TEST_CASE("flicker: a constant error does not flicker, one that alternates does") {
  const RgbImage scene = metric_scene(40, 30);
  const GrayImage before = luma_of(scene.view()), after = luma_of(damaged(scene, Damage::tint, 20).view());
  const auto brighter = [](const GrayImage& image, int by) {
    GrayImage out = image.clone();
    for (int y = 0; y < out.height(); ++y)
      for (int x = 0; x < out.width(); ++x) *out.pixel(x, y) = static_cast<uint8_t>(*out.pixel(x, y) / 2 + by);
    return out;
  };
  const GrayImage a = brighter(before, 0), b = brighter(after, 0);
  CHECK(flicker_rms(a.view(), b.view(), a.view(), b.view()) == 0);
  const GrayImage a9 = brighter(before, 9), b9 = brighter(after, 9), b4 = brighter(after, 4);
  CHECK(flicker_rms(a.view(), b.view(), a9.view(), b9.view()) == 0);
  CHECK(flicker_rms(a.view(), b.view(), a9.view(), b4.view()) == 5);
}

}  // namespace
}  // namespace pac::test
