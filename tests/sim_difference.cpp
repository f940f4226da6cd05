// The difference image and its compensated tables [Levoy95 s.3].
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/metrics.h"
#include "jpeg/jpeg.h"
#include "sim/difference.h"
#include "sim/experiment.h"
#include "sim/match.h"
#include "tests/support/small_scene.h"

namespace {

using namespace pac;

// H and L of the small scene with |H - L| <= 126, so that the difference also fits 8 bits without the division by two.
struct Pair {
  RgbImage high, low, divided, undivided;
};

Pair make_pair() {
  sim::RenderOptions options;
  options.split = "texture";
  options.width = options.height = 192;
  options.samples = 4;
  auto rendered = sim::render_split(test::small_scene(false), test::small_camera(0, 1), options);
  REQUIRE(rendered.ok());
  Pair pair{std::move(rendered->high), std::move(rendered->low), RgbImage(192, 192), RgbImage(192, 192)};
  for (int y = 0; y < 192; ++y)
    for (int i = 0; i < 192 * 3; ++i) {
      uint8_t& high = pair.high.row(y)[i];
      const int low = pair.low.row(y)[i];
      high = static_cast<uint8_t>(std::clamp<int>(high, low - 126, low + 126));
      pair.undivided.row(y)[i] = static_cast<uint8_t>(127 + (high - low));
    }
  sim::difference_image(pair.high.view(), pair.low.view(), pair.divided.view());
  return pair;
}

std::vector<uint8_t> encode(const RgbImage& image, double quality, jpeg::Huffman huffman) {
  jpeg::EncodeOptions options;
  options.tables = jpeg::annex_k_tables(quality);
  options.huffman = huffman;
  auto bytes = jpeg::encode(image.view(), options);
  REQUIRE(bytes.ok());
  return std::move(*bytes);
}

// L plus the decoded difference, which was not divided.
RgbImage add_undivided(const Pair& pair, const std::vector<uint8_t>& file) {
  auto decoded = jpeg::decode(file);
  REQUIRE(decoded.ok());
  RgbImage sum(192, 192);
  for (int y = 0; y < 192; ++y)
    for (int i = 0; i < 192 * 3; ++i)
      sum.row(y)[i] = static_cast<uint8_t>(std::clamp(pair.low.row(y)[i] + decoded->row(y)[i] - 127, 0, 255));
  return sum;
}

RgbImage add_divided(const Pair& pair, const std::vector<uint8_t>& file) {
  auto decoded = jpeg::decode(file);
  REQUIRE(decoded.ok());
  RgbImage sum(192, 192);
  sim::composite_image(pair.low.view(), decoded->view(), sum.view());
  return sum;
}

// Below quality 25 some of the undivided tables' steps stop at 255, the halved ones' do not: hence not nearer.
TEST_CASE("halved tables give the divided difference the code size of the undivided one, within 3 %") {
  const Pair pair = make_pair();
  for (const double quality : {10.0, 15.0, 25.0, 40.0, 60.0}) {
    const double halved = sim::coded_quality(quality, sim::Content::difference);
    for (const auto huffman : {jpeg::Huffman::standard, jpeg::Huffman::optimal}) {
      const double undivided = static_cast<double>(encode(pair.undivided, quality, huffman).size());
      const double divided = static_cast<double>(encode(pair.divided, halved, huffman).size());
      INFO("quality " << quality << ": " << undivided << " and " << divided << " bytes");
      CHECK(std::fabs(divided - undivided) <= 0.03 * undivided);
    }
  }
}

TEST_CASE("halved tables degrade the divided difference as the full ones degrade the undivided, within 2 %") {
  const Pair pair = make_pair();
  for (const double quality : {10.0, 15.0, 25.0, 40.0, 60.0}) {
    const double halved = sim::coded_quality(quality, sim::Content::difference);
    const auto huffman = jpeg::Huffman::optimal;
    const RgbImage undivided = add_undivided(pair, encode(pair.undivided, quality, huffman));
    const RgbImage divided = add_divided(pair, encode(pair.divided, halved, huffman));
    const double rms_undivided = rms_error(pair.high.view(), undivided.view());
    const double rms_divided = rms_error(pair.high.view(), divided.view());
    INFO("quality " << quality << ": rms " << rms_undivided << " and " << rms_divided);
    CHECK(std::fabs(rms_divided - rms_undivided) <= 0.02 * rms_undivided);
    CHECK(ssim_luma(pair.high.view(), divided.view()) ==
          doctest::Approx(ssim_luma(pair.high.view(), undivided.view())).epsilon(0.01));
  }
}

TEST_CASE("without compensation the division by two would cost more than half of the code's accuracy") {
  const Pair pair = make_pair();
  const auto huffman = jpeg::Huffman::optimal;
  const RgbImage compensated = add_divided(pair, encode(pair.divided, 30, huffman));
  const RgbImage uncompensated = add_divided(pair, encode(pair.divided, 15, huffman));
  CHECK(rms_error(pair.high.view(), uncompensated.view()) > 1.2 * rms_error(pair.high.view(), compensated.view()));
}

TEST_CASE("whole images are subtracted and added alike on every instruction set, in place too") {
  const Pair pair = make_pair();
  for (int number = 0; number < kIsaCount; ++number) {
    const Isa isa = static_cast<Isa>(number);
    if (!isa_is_supported(isa) || !isa_is_built(isa)) continue;
    RgbImage difference = pair.high.clone();
    sim::difference_image(difference.view(), pair.low.view(), difference.view(), isa);
    CHECK(sim::image_hash(difference.view()) == sim::image_hash(pair.divided.view()));
    RgbImage composite = pair.low.clone();
    sim::composite_image(composite.view(), difference.view(), composite.view(), isa);
    int worst = 0;
    for (int y = 0; y < 192; ++y)
      for (int i = 0; i < 192 * 3; ++i) worst = std::max(worst, std::abs(composite.row(y)[i] - pair.high.row(y)[i]));
    CHECK(worst <= 1);
  }
}

TEST_CASE("the hash of an image depends on its size and on each pixel, not on its stride") {
  RgbImage image(7, 5);
  const uint64_t black = sim::image_hash(image.view());
  image.pixel(6, 4)[2] = 1;
  CHECK(sim::image_hash(image.view()) != black);
  CHECK(sim::image_hash(RgbImage(5, 7).view()) != black);
  uint8_t packed[7 * 5 * 3] = {};
  CHECK(sim::image_hash(ConstRgbView{packed, 7, 5, 7 * 3}) == black);
}

}  // namespace
