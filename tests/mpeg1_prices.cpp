// The encoder whose caller pays for syntax elements otherwise than Annex B does.
#include <doctest/doctest.h>

#include <vector>

#include "base/kernels/kernels.h"
#include "tests/support/mpeg1_clip.h"

namespace pac::test {
namespace {

using mpeg1::BlockPrices;
using mpeg1::MacroblockPrices;

constexpr int kWidth = 96, kHeight = 80, kMacroblocks = 30;

// The first frame with noise that its blocks must code.
Frame420 noisy_frame() {
  Frame420 frame = clip_frame(kWidth, kHeight, 0, 1);
  uint32_t state = 9;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      state = state * 1664525u + 1013904223u;
      const int noisy = frame.y.row(y)[x] + static_cast<int>(state >> 24) * 22 / 256 - 11;
      frame.y.row(y)[x] = static_cast<uint8_t>(noisy < 0 ? 0 : noisy > 255 ? 255 : noisy);
    }
  return frame;
}

struct Coded {
  std::vector<uint8_t> bytes;  // an I picture, then the P picture that was priced
  mpeg1::PictureReport report;
  Frame420 shown;  // the encoder's reconstruction
};

Coded code(std::span<const MacroblockPrices> prices, mpeg1::Effort effort = mpeg1::Effort::best, Isa isa = best_isa(),
           int threads = 1) {
  mpeg1::SequenceOptions options;
  options.width = kWidth;
  options.height = kHeight;
  options.quantizer_scale = 6;
  options.effort = effort;
  options.threads = threads;
  auto encoder = mpeg1::Encoder::create(options, isa);
  REQUIRE(encoder.ok());
  Coded result;
  REQUIRE(encoder->add(clip_frame(kWidth, kHeight, 0, 1), result.bytes).ok());
  mpeg1::PictureOptions picture;
  picture.prices = prices;
  const auto report = encoder->add(noisy_frame(), result.bytes, picture);
  REQUIRE(report.ok());
  result.report = *report;
  result.shown = mpeg1::copy_of(encoder->reconstruction());
  encoder->finish(result.bytes);
  return result;
}

// Bits: of a position without a level, of one with it, of each step of its size.
std::vector<MacroblockPrices> flat_prices(int zero, int level, int step, int intra) {
  MacroblockPrices prices;
  prices.skipped = prices.inter = 256;
  prices.intra = static_cast<uint16_t>(256 * intra);
  prices.moving = 512;
  for (BlockPrices& block : prices.blocks) {
    block.left_out = block.coded = 256;
    for (size_t k = 0; k < 64; ++k) {
      block.zero[k] = static_cast<uint16_t>(zero * 256);
      block.level[k] = static_cast<uint16_t>(level * 256);
      for (int size = 0; size < BlockPrices::kSizes; ++size)
        block.size[k][size] = static_cast<uint16_t>(step * 256 * (size + 1));
      block.step[k] = static_cast<uint16_t>(step * 256);
    }
  }
  return std::vector<MacroblockPrices>(kMacroblocks, prices);
}

TEST_CASE("the dearer levels are, the fewer are sent; where all are too dear, macroblocks are left as predicted") {
  const uint64_t cheap = code(flat_prices(0, 1, 1, 30)).report.size_bytes;
  const uint64_t dear = code(flat_prices(0, 9, 4, 250)).report.size_bytes;
  const Coded none = code(flat_prices(0, 250, 1, 250));
  MESSAGE("bytes at low prices " << cheap << ", at high ones " << dear << ", at the highest "
                                 << none.report.size_bytes);
  CHECK(cheap > dear + 20);
  CHECK(dear > none.report.size_bytes);
  CHECK(none.report.coded_macroblocks == 0);
  const uint64_t late = code(flat_prices(6, 3, 1, 250)).report.size_bytes;  // each zero on the way costs
  CHECK(late < cheap);
}

TEST_CASE("whatever was paid, the decoder shows the reconstruction, on every instruction set and number of threads") {
  for (const auto& prices : {flat_prices(0, 1, 1, 30), flat_prices(1, 5, 2, 0), flat_prices(0, 250, 1, 250),
                             std::vector<MacroblockPrices>(kMacroblocks)}) {
    const Coded coded = code(prices);
    CHECK(equal(mpeg1::view_of(decode_all(coded.bytes)[1]), mpeg1::view_of(coded.shown)));
    CHECK(code(prices, mpeg1::Effort::best, Isa::scalar).bytes == coded.bytes);
    CHECK(code(prices, mpeg1::Effort::best, best_isa(), 2).bytes == coded.bytes);
  }
}

TEST_CASE("effort fast looks at no prices") {
  CHECK(code(flat_prices(0, 250, 1, 250), mpeg1::Effort::fast).bytes == code({}, mpeg1::Effort::fast).bytes);
  CHECK(code(flat_prices(0, 250, 1, 250), mpeg1::Effort::normal).bytes != code({}, mpeg1::Effort::normal).bytes);
}

TEST_CASE("prices that are not one a macroblock are refused, and nothing is written") {
  mpeg1::SequenceOptions options;
  options.width = kWidth;
  options.height = kHeight;
  auto encoder = mpeg1::Encoder::create(options);
  REQUIRE(encoder.ok());
  const std::vector<MacroblockPrices> prices(kMacroblocks - 1);
  mpeg1::PictureOptions picture;
  picture.prices = prices;
  std::vector<uint8_t> bytes;
  const auto report = encoder->add(clip_frame(kWidth, kHeight, 0, 1), bytes, picture);
  REQUIRE(!report.ok());
  CHECK(report.failure().error == Error::bad_argument);
  CHECK(bytes.empty());
}

}  // namespace
}  // namespace pac::test
