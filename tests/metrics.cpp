#include "base/metrics.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <string>

#include "base/image_io.h"
#include "tests/support/generators.h"
#include "tests/support/peer.h"

namespace pac::test {
namespace {

// A picture with edges, gradients and grain, and a damaged copy of it.
struct Pair {
  RgbImage reference, damaged;
};
Pair make_pair(int width, int height, int damage) {
  Pair pair{RgbImage(width, height), RgbImage(width, height)};
  Random random(7);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 3; ++c) {
        const int edge = (x / 9 + y / 7) % 2 * 60;
        const int value = 40 + edge + (x * (c + 1) + y) % 90 + static_cast<int>(random.in(0, 12));
        pair.reference.pixel(x, y)[c] = static_cast<uint8_t>(value);
        const int64_t noisy = value + random.in(-damage, damage) + (x + y) % 3;
        pair.damaged.pixel(x, y)[c] = static_cast<uint8_t>(noisy < 0 ? 0 : noisy > 255 ? 255 : noisy);
      }
  return pair;
}

// SSIM as the paper writes it: a full 2-D window at each place, two passes, libm. with_means: else contrast and
// structure alone.
double plain_ssim(PlaneView<const uint8_t> a, PlaneView<const uint8_t> b, bool with_means = true) {
  double window[11][11], sum = 0;
  for (int i = 0; i < 11; ++i)
    for (int j = 0; j < 11; ++j) sum += window[i][j] = std::exp(-((i - 5) * (i - 5) + (j - 5) * (j - 5)) / 4.5);
  const double c1 = 6.5025, c2 = 58.5225;
  double total = 0;
  int n = 0;
  for (int y = 0; y + 11 <= a.height; ++y)
    for (int x = 0; x + 11 <= a.width; ++x, ++n) {
      double ma = 0, mb = 0, va = 0, vb = 0, cov = 0;
      for (int i = 0; i < 11; ++i)
        for (int j = 0; j < 11; ++j) {
          ma += window[i][j] / sum * *a.pixel(x + j, y + i);
          mb += window[i][j] / sum * *b.pixel(x + j, y + i);
        }
      for (int i = 0; i < 11; ++i)
        for (int j = 0; j < 11; ++j) {
          const double w = window[i][j] / sum, p = *a.pixel(x + j, y + i) - ma, q = *b.pixel(x + j, y + i) - mb;
          va += w * p * p;
          vb += w * q * q;
          cov += w * p * q;
        }
      const double means = (2 * ma * mb + c1) / (ma * ma + mb * mb + c1);
      total += (with_means ? means : 1.0) * (2 * cov + c2) / (va + vb + c2);
    }
  return total / n;
}

// Rounded means of 2x2 samples.
GrayImage plain_half(const GrayImage& image) {
  GrayImage half(image.width() / 2, image.height() / 2);
  for (int y = 0; y < half.height(); ++y)
    for (int x = 0; x < half.width(); ++x) {
      double sum = 0;
      for (int i = 0; i < 4; ++i) sum += *image.pixel(2 * x + i % 2, 2 * y + i / 2);
      *half.pixel(x, y) = static_cast<uint8_t>(std::floor(sum / 4 + 0.5));
    }
  return half;
}

RgbImage solid(int width, int height, int r, int g, int b) {
  RgbImage image(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      image.pixel(x, y)[0] = static_cast<uint8_t>(r);
      image.pixel(x, y)[1] = static_cast<uint8_t>(g);
      image.pixel(x, y)[2] = static_cast<uint8_t>(b);
    }
  return image;
}

TEST_CASE("equal pictures: rms 0, PSNR infinite, SSIM exactly 1") {
  const Pair pair = make_pair(67, 45, 9);
  const Metrics m = measure(pair.reference.view(), pair.reference.view());
  CHECK(m.rms == 0);
  CHECK(m.psnr_rgb_db == std::numeric_limits<double>::infinity());
  CHECK(m.psnr_luma_db == std::numeric_limits<double>::infinity());
  CHECK(m.ssim == 1);
  CHECK(m.ms_ssim == doctest::Approx(1).epsilon(1e-12));
  CHECK(m.max_error == 0);
}

TEST_CASE("rms and PSNR of hand-computed pictures") {
  // Two pixels: differences (3, 0, 0) and (0, 4, 0). Mean square 25 / 6.
  RgbImage a(2, 1), b(2, 1);
  a.pixel(0, 0)[0] = 3;
  b.pixel(1, 0)[1] = 4;
  CHECK(mean_squared_error(a.view(), b.view()) == 25.0 / 6);
  CHECK(rms_error(a.view(), b.view()) == std::sqrt(25.0 / 6));
  CHECK(psnr_rgb(a.view(), b.view()) == doctest::Approx(10 * std::log10(65025 * 6 / 25.0)).epsilon(1e-12));
  // Black against white is 255 everywhere: 0 dB.
  CHECK(rms_error(solid(5, 3, 0, 0, 0).view(), solid(5, 3, 255, 255, 255).view()) == 255);
  CHECK(psnr_luma(solid(5, 3, 0, 0, 0).view(), solid(5, 3, 255, 255, 255).view()) == 0);
}

TEST_CASE("luma is BT.601's, rounded: gray stays, primaries get 76, 150, 29") {
  for (int v = 0; v < 256; ++v) REQUIRE(luma_bt601(v, v, v) == v);
  CHECK(luma_bt601(255, 0, 0) == 76);
  CHECK(luma_bt601(0, 255, 0) == 150);
  CHECK(luma_bt601(0, 0, 255) == 29);
}

TEST_CASE("entropy of known histograms") {
  const RgbImage one_color = solid(16, 16, 9, 200, 77);
  CHECK(entropy_per_channel(one_color.view()) == 0);
  CHECK(entropy_luma(one_color.view()) == 0);
  CHECK(entropy_joint(one_color.view()) == 0);
  // Red takes 4 values equally often, green 2 in the ratio 3:1, blue 1; (R, G) pairs are 16 equally likely.
  RgbImage image(16, 16);
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x) {
      image.pixel(x, y)[0] = static_cast<uint8_t>(x % 4 * 50);
      image.pixel(x, y)[1] = y % 4 == 0 ? 10 : 20;
    }
  const double green = 2 - 0.75 * std::log2(3.0);
  CHECK(entropy_per_channel(image.view()) == doctest::Approx((2 + green) / 3).epsilon(1e-12));
  CHECK(entropy_joint(image.view()) == doctest::Approx(2 + green).epsilon(1e-12));
  GrayImage all(256, 1);
  for (int x = 0; x < 256; ++x) *all.pixel(x, 0) = static_cast<uint8_t>(x);
  CHECK(entropy(all.view()) == doctest::Approx(8).epsilon(1e-12));
}

TEST_CASE("SSIM equals the formula applied window by window") {
  for (const auto& [width, height] : {std::pair{11, 11}, {12, 40}, {64, 48}}) {
    const Pair pair = make_pair(width, height, 25);
    const GrayImage a = luma_of(pair.reference.view()), b = luma_of(pair.damaged.view());
    CHECK(ssim(a.view(), b.view()) == doctest::Approx(plain_ssim(a.view(), b.view())).epsilon(1e-10));
  }
}

TEST_CASE("MS-SSIM equals the product of its paper, equation 7, over five scales") {
  constexpr double kExponents[5] = {0.0448, 0.2856, 0.3001, 0.2363, 0.1333};
  const Pair pair = make_pair(192, 176, 40);
  GrayImage a = luma_of(pair.reference.view()), b = luma_of(pair.damaged.view());
  const double computed = ms_ssim(a.view(), b.view());
  double expected = 1;
  for (int scale = 0; scale < 5; ++scale) {
    expected *= std::pow(plain_ssim(a.view(), b.view(), scale == 4), kExponents[scale]);
    a = plain_half(a);
    b = plain_half(b);
  }
  CHECK(computed == doctest::Approx(expected).epsilon(1e-9));
}

TEST_CASE("SSIM of two flat pictures is the ratio of their means alone") {
  const RgbImage a = solid(20, 20, 100, 100, 100), b = solid(20, 20, 150, 150, 150);
  const double expected = (2.0 * 100 * 150 + 6.5025) / (100.0 * 100 + 150.0 * 150 + 6.5025);
  CHECK(ssim_luma(a.view(), b.view()) == doctest::Approx(expected).epsilon(1e-9));
}

TEST_CASE("SSIM's map has a value for each window, and their mean is SSIM") {
  const Pair pair = make_pair(40, 30, 25);
  const GrayImage a = luma_of(pair.reference.view()), b = luma_of(pair.damaged.view());
  const DepthImage map = ssim_map(a.view(), b.view());
  REQUIRE(map.width() == 30);
  REQUIRE(map.height() == 20);
  double sum = 0;
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 30; ++x) sum += static_cast<double>(*map.pixel(x, y));
  CHECK(sum / 600 == doctest::Approx(ssim(a.view(), b.view())).epsilon(1e-6));
}

TEST_CASE("more damage makes every metric worse, for pictures down to one pixel") {
  for (const int side : {1, 2, 5, 10, 11, 23, 64, 200}) {
    CAPTURE(side);
    const Pair mild = make_pair(side, side, 6), strong = make_pair(side, side, 60);
    const Metrics a = measure(mild.reference.view(), mild.damaged.view());
    const Metrics b = measure(strong.reference.view(), strong.damaged.view());
    if (side < 5) continue;  // too few samples for an order; must only not crash
    CHECK(a.rms < b.rms);
    CHECK(a.psnr_rgb_db > b.psnr_rgb_db);
    CHECK(a.psnr_luma_db > b.psnr_luma_db);
    CHECK(a.ssim > b.ssim);
    CHECK(a.ms_ssim > b.ms_ssim);
  }
}

TEST_CASE("the error map is the amplified difference") {
  RgbImage a = solid(3, 1, 10, 10, 10), b = solid(3, 1, 10, 10, 10);
  b.pixel(1, 0)[2] = 13;
  b.pixel(2, 0)[0] = 110;
  const RgbImage map = error_map(a.view(), b.view(), 8);
  CHECK(map.pixel(0, 0)[0] == 0);
  CHECK(map.pixel(1, 0)[2] == 24);
  CHECK(map.pixel(2, 0)[0] == 255);
}

TEST_CASE("the paper's Table I: 512x512 in 9836 bytes is 80:1, 320x800 in 6030 is 127:1") {
  CHECK(std::floor(compression_ratio(512, 512, 9836) + 0.5) == 80);
  CHECK(std::floor(compression_ratio(320, 800, 6030) + 0.5) == 127);
}

// The number after `key` in ffmpeg's summary line.
double number_after(const std::string& text, const std::string& key) {
  const size_t at = text.rfind(key);
  return at == std::string::npos ? -1.0 : std::strtod(text.c_str() + at + key.size(), nullptr);
}

TEST_CASE("peer: ffmpeg's psnr filter agrees within 0.005 dB, its ssim filter within 0.03") {
  if (!have_peer("ffmpeg")) return;
  const TempDir dir;
  const Pair pair = make_pair(128, 96, 20);
  const GrayImage a = luma_of(pair.reference.view()), b = luma_of(pair.damaged.view());
  write_bytes(dir.file("a.pgm"), encode_pgm(a.view()));
  write_bytes(dir.file("b.pgm"), encode_pgm(b.view()));
  const std::string command = "ffmpeg -hide_banner -i " + dir.file("a.pgm") + " -i " + dir.file("b.pgm");
  const std::string psnr = output_of(command + " -lavfi psnr -f null -");
  CHECK(std::abs(number_after(psnr, "average:") - psnr_from_mse(mean_squared_error(a.view(), b.view()))) < 0.005);
  // ffmpeg's windows are 8x8 boxes every 4 pixels instead of Gaussians at every pixel: close, not equal.
  const std::string text = output_of(command + " -lavfi ssim -f null -");
  CHECK(std::abs(number_after(text, "All:") - ssim(a.view(), b.view())) < 0.03);
}

}  // namespace
}  // namespace pac::test
