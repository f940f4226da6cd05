#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "base/metrics.h"
#include "jpeg/jpeg.h"
#include "sim/experiment.h"
#include "sim/match.h"
#include "sim/table_family.h"
#include "tests/support/small_scene.h"

namespace {

using namespace pac;
using sim::Content;

sim::Renderings renderings(const char* split = "texture") {
  sim::RenderOptions options;
  options.split = split;
  options.samples = 4;
  auto result = sim::render_split(test::small_scene(false), test::small_camera(0, 1), options);
  REQUIRE(result.ok());
  return std::move(*result);
}

TEST_CASE("the paper's qualities of D, with the division by two undone") {
  CHECK(sim::equivalent_quality(41, Content::difference) == doctest::Approx(20.5));
  CHECK(sim::equivalent_quality(55, Content::difference) == doctest::Approx(27.78).epsilon(0.001));
  CHECK(sim::equivalent_quality(30, Content::difference) == doctest::Approx(15));
  CHECK(sim::coded_quality(15, Content::difference) == doctest::Approx(30));
  CHECK(sim::coded_quality(50, Content::difference) == doctest::Approx(75));
  for (double quality = 0.5; quality < 100; quality += 0.5) {
    CHECK(sim::equivalent_quality(sim::coded_quality(quality, Content::difference), Content::difference) ==
          doctest::Approx(quality));
    CHECK(sim::quality_from_scale(sim::scale_from_quality(quality)) == doctest::Approx(quality));
    CHECK(sim::equivalent_quality(quality, Content::image) == quality);
  }
}

TEST_CASE("a coded quality halves the tables of its equivalent quality, but for rounding") {
  for (const double quality : {20.0, 25.0, 41.0, 55.0, 80.0}) {
    const auto halved = jpeg::annex_k_tables(quality);
    const auto full = jpeg::annex_k_tables(sim::equivalent_quality(quality, Content::difference));
    for (size_t k = 0; k < 64; ++k)
      if (full.luma[k] < 255 && full.luma[k] > 1) REQUIRE(std::abs(2 * halved.luma[k] - full.luma[k]) <= 1);
  }
}

TEST_CASE("the search finds the nearest size that any quality gives, whatever the file size does in between") {
  const sim::Renderings pictures = renderings();
  const sim::CodingOptions options;
  // Every quality on a fine grid, as a check that no other one comes nearer.
  std::vector<uint64_t> sizes;
  for (double quality = 5; quality < 90; quality += 0.25)
    sizes.push_back(
        sim::code_at_quality(pictures.difference.view(), Content::difference, quality, options)->bytes.size());
  for (const uint64_t target : {1100u, 1500u, 1501u, 2000u, 2600u}) {
    const auto coded = sim::code_at_size(pictures.difference.view(), Content::difference, target, options);
    REQUIRE(coded.ok());
    const auto distance = [&](uint64_t size) { return std::llabs(static_cast<long long>(size - target)); };
    for (const uint64_t size : sizes) CHECK(distance(coded->bytes.size()) <= distance(size));
    CHECK(distance(coded->bytes.size()) * 100 <= static_cast<long long>(target));
  }
}

TEST_CASE("a size that only a bump of the size curve has is hit exactly") {
  const sim::Renderings pictures = renderings();
  const ConstRgbView image = pictures.high.view();
  const auto family = sim::ScaledTables::create(image, sim::TableFamily::annex_k, jpeg::Subsampling::yuv420);
  REQUIRE(family.ok());
  const std::vector<double> steps = family->step_qualities();
  std::vector<uint64_t> sizes;
  const size_t first = steps.size() / 4;
  for (size_t i = 0; i < 120; ++i)
    sizes.push_back(sim::code_at_quality(image, Content::image, steps[first + i], {})->bytes.size());
  int bumps = 0;
  for (size_t i = 20; i + 20 < sizes.size() && bumps < 6; ++i) {
    if (sizes[i] <= sizes[i - 1]) continue;  // coarser tables, larger file
    ++bumps;
    CHECK(sim::code_at_size(image, Content::image, sizes[i], {})->bytes.size() == sizes[i]);
  }
  CHECK(bumps >= 3);
}

TEST_CASE("the quality that the search reports gives the same file again") {
  const sim::Renderings pictures = renderings();
  for (const auto family : {sim::TableFamily::annex_k, sim::TableFamily::adapted}) {
    sim::CodingOptions options;
    options.tables = family;
    const auto found = sim::code_at_size(pictures.high.view(), Content::image, 2500, options);
    REQUIRE(found.ok());
    const auto again = sim::code_at_quality(pictures.high.view(), Content::image, found->quality, options);
    REQUIRE(again.ok());
    CHECK(found->bytes == again->bytes);
    CHECK(sim::same_tables(found->tables, again->tables));
  }
}

TEST_CASE("threads and instruction sets change neither the file nor the number of encodes") {
  const sim::Renderings pictures = renderings();
  const auto reference = sim::code_at_size(pictures.difference.view(), Content::difference, 1700, {});
  REQUIRE(reference.ok());
  for (const int threads : {2, 3}) {
    sim::CodingOptions options;
    options.threads = threads;
    options.isa = Isa::scalar;
    const auto other = sim::code_at_size(pictures.difference.view(), Content::difference, 1700, options);
    REQUIRE(other.ok());
    CHECK(other->bytes == reference->bytes);
    CHECK(other->encodes == reference->encodes);
  }
}

TEST_CASE("a size that no quality reaches gives the smallest or the largest file") {
  const sim::Renderings pictures = renderings();
  const auto smallest = sim::code_at_size(pictures.high.view(), Content::image, 1, {});
  const auto largest = sim::code_at_size(pictures.high.view(), Content::image, 1 << 30, {});
  REQUIRE(smallest.ok());
  REQUIRE(largest.ok());
  CHECK(largest->quality > 99);
  CHECK(smallest->bytes.size() <= sim::code_at_quality(pictures.high.view(), Content::image, 1, {})->bytes.size());
}

TEST_CASE("headers are counted: the size found is the size of the whole file") {
  const sim::Renderings pictures = renderings();
  const auto coded = sim::code_at_size(pictures.high.view(), Content::image, 3000, {});
  REQUIRE(coded.ok());
  CHECK(coded->bytes[0] == 0xFF);
  CHECK(coded->bytes[1] == 0xD8);
  CHECK(coded->bytes.back() == 0xD9);
}

TEST_CASE("tables adapted to the difference image give less error at equal size than Annex K's") {
  const sim::Renderings pictures = renderings();
  sim::CodingOptions adapted;
  adapted.tables = sim::TableFamily::adapted;
  const auto rms = [&](const sim::CodingOptions& options) {
    const auto arm = sim::code_arm_at_size(pictures, sim::ArmKind::polygon_assisted, 2000, options);
    REQUIRE(arm.ok());
    return arm->scores.rms;
  };
  CHECK(rms(adapted) < rms({}));
}

TEST_CASE("fixed Huffman tables for difference images shrink D's file, keep its pixels, and leave H's file alone") {
  const sim::Renderings pictures = renderings("tessellation");
  sim::CodingOptions standard, fixed, optimal;
  fixed.huffman = jpeg::Huffman::difference;
  optimal.huffman = jpeg::Huffman::optimal;
  const auto code = [&](const RgbImage& image, Content content, const sim::CodingOptions& options) {
    auto coded = sim::code_at_quality(image.view(), content, 41, options);
    REQUIRE(coded.ok());
    return coded->bytes;
  };
  const auto paper = code(pictures.difference, Content::difference, standard);
  const auto one_pass = code(pictures.difference, Content::difference, fixed);
  CHECK(one_pass.size() < paper.size());
  CHECK(one_pass.size() > code(pictures.difference, Content::difference, optimal).size());
  CHECK(mean_squared_error(jpeg::decode(one_pass)->view(), jpeg::decode(paper)->view()) == 0);
  CHECK(code(pictures.high, Content::image, fixed) == code(pictures.high, Content::image, standard));
}

TEST_CASE("masking looks at H for the difference, at H itself for the image, and only with adapted tables") {
  const sim::Renderings pictures = renderings();
  sim::CodingOptions plain, masked;
  masked.masking = jpeg::Tune::ssim;
  const auto code = [&](const RgbImage& image, Content content, const sim::CodingOptions& options, bool sees_high) {
    auto coded = sim::code_at_quality(image.view(), content, 41, options,
                                      sees_high ? ConstRgbView(pictures.high.view()) : ConstRgbView());
    REQUIRE(coded.ok());
    return coded->bytes;
  };
  CHECK(code(pictures.difference, Content::difference, masked, true) ==
        code(pictures.difference, Content::difference, plain, false));
  plain.tables = masked.tables = sim::TableFamily::adapted;
  const auto seen = code(pictures.difference, Content::difference, masked, true);
  CHECK(seen.size() < code(pictures.difference, Content::difference, plain, true).size());
  CHECK(seen != code(pictures.difference, Content::difference, masked, false));
  CHECK(seen == code(pictures.difference, Content::difference, masked, true));
  CHECK(code(pictures.high, Content::image, masked, true) == code(pictures.high, Content::image, masked, false));
}

TEST_CASE("quality outside (0, 100] and pictures without pixels are refused") {
  const RgbImage image(8, 8), empty;
  for (const double quality : {0.0, -1.0, 100.01, std::nan("")})
    CHECK(sim::code_at_quality(image.view(), Content::image, quality, {}).failure().error == Error::bad_argument);
  CHECK(sim::code_at_size(empty.view(), Content::image, 100, {}).failure().error == Error::bad_argument);
}

}  // namespace
