// Several threads: the same bytes, pixels and complaints as one.
#include <doctest/doctest.h>

#include <vector>

#include "jpeg/jpeg.h"
#include "tests/support/jpeg_file.h"

namespace pac::test {
namespace {

using jpeg::EncodeOptions;
using jpeg::Subsampling;

constexpr Subsampling kSubsamplings[] = {Subsampling::yuv444, Subsampling::yuv422, Subsampling::yuv420,
                                         Subsampling::gray};

Result<RgbImage> decode_with(std::span<const uint8_t> bytes, int threads) {
  jpeg::DecodeOptions options;
  options.threads = threads;
  return jpeg::decode(bytes, options);
}

std::vector<uint8_t> restarted_file(const RgbImage& image, Subsampling subsampling) {
  EncodeOptions options;
  options.subsampling = subsampling;
  options.restart_interval_mcus = jpeg::row_restart_interval(image.width(), subsampling);
  return *jpeg::encode(image.view(), options);
}

TEST_CASE("bytes do not depend on the number of threads, for any subsampling, effort and restart interval") {
  const RgbImage image = test_image(69, 203);
  for (const auto subsampling : kSubsamplings) {
    const int row = jpeg::row_restart_interval(image.width(), subsampling);
    for (const auto effort : {jpeg::Effort::fast, jpeg::Effort::normal, jpeg::Effort::best}) {
      for (const int interval : {0, 1, row, 2 * row, row + 1, 3 * row}) {
        EncodeOptions options = jpeg::options_for(effort, jpeg::Tune::visual, 70);
        options.subsampling = subsampling;
        options.restart_interval_mcus = interval;
        const auto expected = *jpeg::encode(image.view(), options);
        for (const int threads : {2, 3}) {
          options.threads = threads;
          REQUIRE(*jpeg::encode(image.view(), options) == expected);
        }
      }
    }
  }
}

TEST_CASE("adapted tables and the search for a size do not depend on the number of threads") {
  const RgbImage image = test_image(50, 90);
  EncodeOptions options = jpeg::options_for(jpeg::Effort::normal, jpeg::Tune::psnr, 50);
  options.table_source = jpeg::TableSource::adapted;
  options.restart_interval_mcus = jpeg::row_restart_interval(image.width(), options.subsampling);
  const auto expected = *jpeg::encode(image.view(), options);
  options.threads = 2;
  CHECK(*jpeg::encode(image.view(), options) == expected);
  options.table_source = jpeg::TableSource::annex_k;
  const auto two = *jpeg::encode_to_size(image.view(), options, 3000);
  options.threads = 1;
  CHECK(jpeg::encode_to_size(image.view(), options, 3000)->bytes == two.bytes);
}

TEST_CASE("an encoder may go from many threads to one and back") {
  const RgbImage image = test_image(64, 100);
  EncodeOptions options;
  options.restart_interval_mcus = jpeg::row_restart_interval(image.width(), options.subsampling);
  const auto expected = *jpeg::encode(image.view(), options);
  jpeg::Encoder encoder;
  for (const int threads : {2, 1, 3, 0}) {
    options.threads = threads;
    std::vector<uint8_t> bytes;
    REQUIRE(encoder.encode_append(image.view(), options, bytes).ok());
    REQUIRE(bytes == expected);
  }
}

TEST_CASE("thread counts outside 0..1024 are bad arguments") {
  const RgbImage image = test_image(8, 8);
  EncodeOptions options;
  for (const int threads : {-1, 1025}) {
    options.threads = threads;
    REQUIRE_FALSE(jpeg::encode(image.view(), options).ok());
    REQUIRE_FALSE(decode_with(sound_gray().bytes, threads).ok());
  }
}

TEST_CASE("pixels do not depend on the number of threads, also at the seams between them") {
  for (const auto& [width, height] : {std::pair{5, 40}, {69, 203}, {64, 256}, {33, 17}}) {
    const RgbImage image = test_image(width, height);
    for (const auto subsampling : kSubsamplings) {
      const auto bytes = restarted_file(image, subsampling);
      const auto expected = decode_with(bytes, 1);
      REQUIRE(expected.ok());
      for (const int threads : {2, 3, 16}) {
        const auto decoded = decode_with(bytes, threads);
        REQUIRE(decoded.ok());
        REQUIRE(max_difference(decoded->view(), expected->view()) == 0);
      }
    }
  }
}

// Any byte of the file changed: the same picture or the same complaint.
TEST_CASE("what is wrong with a damaged file does not depend on the number of threads") {
  const auto bytes = restarted_file(test_image(40, 70), Subsampling::yuv420);
  const auto info = jpeg::read_info(bytes);
  REQUIRE(info.ok());
  for (size_t at = info->header_bytes; at < bytes.size(); at += 3) {
    std::vector<uint8_t> damaged = bytes;
    damaged[at] = static_cast<uint8_t>(damaged[at] ^ (1 << at % 8));
    jpeg::DecodeOptions options;
    const auto one = jpeg::decode_lenient(damaged, options);
    options.threads = 2;
    const auto two = jpeg::decode_lenient(damaged, options);
    REQUIRE(one.ok() == two.ok());
    if (!one.ok()) continue;
    REQUIRE(one->errors == two->errors);
    REQUIRE(one->warnings == two->warnings);
    REQUIRE(one->failure.has_value() == two->failure.has_value());
    if (one->failure) REQUIRE(one->failure->byte_offset == two->failure->byte_offset);
    REQUIRE(max_difference(one->image.view(), two->image.view()) == 0);
  }
}

TEST_CASE("a file cut anywhere fails alike with one thread and two") {
  const auto bytes = restarted_file(test_image(40, 70), Subsampling::yuv420);
  for (size_t n = 0; n < bytes.size(); n += 7) {
    const std::span<const uint8_t> prefix(bytes.data(), n);
    const auto one = decode_with(prefix, 1), two = decode_with(prefix, 2);
    REQUIRE_FALSE(one.ok());
    REQUIRE_FALSE(two.ok());
    REQUIRE(one.failure().byte_offset == two.failure().byte_offset);
  }
}

}  // namespace
}  // namespace pac::test
