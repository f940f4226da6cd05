// What the encoder promises: options, bounds, presets, searches, the same bytes everywhere.
#include <doctest/doctest.h>

#include <cmath>

#include "base/hash.h"
#include "base/metrics.h"
#include "jpeg/jpeg.h"
#include "tests/support/generators.h"
#include "tests/support/jpeg_file.h"

namespace pac::test {
namespace {

using jpeg::EncodeOptions;

constexpr jpeg::Subsampling kSubsamplings[] = {jpeg::Subsampling::yuv444, jpeg::Subsampling::yuv422,
                                               jpeg::Subsampling::yuv420, jpeg::Subsampling::gray};
constexpr jpeg::Tune kTunes[] = {jpeg::Tune::psnr, jpeg::Tune::ssim, jpeg::Tune::visual, jpeg::Tune::hvs};
constexpr jpeg::Effort kEfforts[] = {jpeg::Effort::fast, jpeg::Effort::normal, jpeg::Effort::best};

TEST_CASE("options outside their ranges are bad arguments; their limits are not") {
  const RgbImage image = test_image(16, 16);
  const auto error = [&](const EncodeOptions& options) {
    const auto result = jpeg::encode(image.view(), options);
    return result.ok() ? Error::io : result.failure().error;
  };
  EncodeOptions options;
  for (const double quality : {0.0, -1.0, 100.001, std::nan("")}) {
    options.quality = quality;
    CHECK(error(options) == Error::bad_argument);
  }
  for (const double quality : {1e-9, 100.0}) {
    options.quality = quality;
    CHECK(error(options) == Error::io);
  }
  for (const double dead_zone : {-0.01, 0.491, std::nan("")}) {
    options.dead_zone = dead_zone;
    CHECK(error(options) == Error::bad_argument);
  }
  options.dead_zone = 0.49;
  CHECK(error(options) == Error::io);
  for (const int interval : {-1, 65536}) {
    options.restart_interval_mcus = interval;
    CHECK(error(options) == Error::bad_argument);
  }
  options.restart_interval_mcus = 65535;
  CHECK(error(options) == Error::io);
  options.tables = jpeg::annex_k_tables(50);
  CHECK(error(options) == Error::io);
  for (const uint16_t step : {uint16_t{0}, uint16_t{256}}) {
    options.tables->chroma[63] = step;
    CHECK(error(options) == Error::bad_argument);
  }
}

TEST_CASE("sides of 1 and 65535 are encoded, 0 and 65536 refused") {
  for (const auto& [width, height] : {std::pair{65535, 1}, {1, 65535}}) {
    const RgbImage image(width, height);
    const auto bytes = jpeg::encode(image.view(), {});
    REQUIRE(bytes.ok());
    const auto decoded = jpeg::decode(*bytes);
    REQUIRE(decoded.ok());
    CHECK(max_difference(image.view(), decoded->view()) == 0);
  }
  CHECK_FALSE(jpeg::encode(RgbImage(65536, 1).view(), {}).ok());
  CHECK_FALSE(jpeg::encode(RgbImage(1, 65536).view(), {}).ok());
  CHECK_FALSE(jpeg::encode(RgbImage().view(), {}).ok());
}

TEST_CASE("no file is longer than encode_bound, not even of noise with steps of 1") {
  RgbImage noise(33, 18);
  Random random(3);
  for (int y = 0; y < noise.height(); ++y)
    for (int x = 0; x < 3 * noise.width(); ++x) noise.row(y)[x] = (random.next() & 1) != 0 ? 255 : 0;
  for (const auto subsampling : kSubsamplings) {
    for (const auto huffman : {jpeg::Huffman::standard, jpeg::Huffman::optimal}) {
      for (const int restart : {0, 1}) {
        EncodeOptions options;
        options.quality = 100;
        options.subsampling = subsampling;
        options.huffman = huffman;
        options.restart_interval_mcus = restart;
        const uint64_t bound = jpeg::encode_bound(noise.width(), noise.height(), subsampling, restart);
        REQUIRE(jpeg::encode(noise.view(), options)->size() <= bound);
        REQUIRE(bound < 40000);
      }
    }
  }
}

TEST_CASE("encode_into writes the same bytes, or says that they do not fit") {
  const RgbImage image = test_image(50, 30);
  jpeg::Encoder encoder;
  for (const auto effort : kEfforts) {
    const EncodeOptions options = jpeg::options_for(effort, jpeg::Tune::psnr, 60);
    const auto expected = *jpeg::encode(image.view(), options);
    std::vector<uint8_t> buffer(expected.size());
    const auto size = encoder.encode_into(image.view(), options, buffer);
    REQUIRE(size.ok());
    CHECK(*size == expected.size());
    CHECK(buffer == expected);
    for (const size_t shorter : {expected.size() - 1, expected.size() / 2, size_t{1}, size_t{0}}) {
      std::vector<uint8_t> small(shorter);
      const auto result = encoder.encode_into(image.view(), options, small);
      REQUIRE_FALSE(result.ok());
      CHECK(result.failure().error == Error::out_of_space);
    }
    std::vector<uint8_t> appended{7};
    REQUIRE(encoder.encode_append(image.view(), options, appended).ok());
    CHECK(appended.size() == expected.size() + 1);
  }
}

TEST_CASE("an encoder's and a decoder's second image does not depend on the first") {
  const RgbImage large = test_image(90, 70), small = test_image(23, 9, 2);
  jpeg::Encoder encoder;
  jpeg::Decoder decoder;
  std::vector<uint8_t> buffer(100000);
  for (const RgbImage* image : {&large, &small, &large, &small}) {
    const auto expected = *jpeg::encode(image->view(), {});
    const auto size = encoder.encode_into(image->view(), {}, buffer);
    REQUIRE(size.ok());
    buffer.resize(*size);
    REQUIRE(buffer == expected);
    RgbImage decoded(image->width(), image->height());
    REQUIRE(decoder.decode_into(buffer, decoded.view()).ok());
    REQUIRE(max_difference(decoded.view(), jpeg::decode(expected)->view()) == 0);
    RgbImage other(image->width() + 1, image->height());
    REQUIRE(decoder.decode_into(buffer, other.view()).failure().error == Error::bad_argument);
    buffer.resize(100000);
  }
}

TEST_CASE("gray pictures: one component, the samples themselves") {
  GrayImage gray(19, 21);
  for (int y = 0; y < 21; ++y)
    for (int x = 0; x < 19; ++x) gray.row(y)[x] = static_cast<uint8_t>(10 * x + 2 * y);
  EncodeOptions options;
  options.quality = 100;
  const auto bytes = jpeg::encode_gray(gray.view(), options);
  REQUIRE(bytes.ok());
  CHECK(jpeg::read_info(*bytes)->components.size() == 1);
  const auto decoded = jpeg::decode(*bytes);
  for (int y = 0; y < 21; ++y)
    for (int x = 0; x < 19; ++x) REQUIRE(std::abs(decoded->pixel(x, y)[1] - gray.row(y)[x]) <= 1);
}

TEST_CASE("steps given by the caller are the steps in the file") {
  EncodeOptions options;
  jpeg::QuantTables tables;
  for (size_t i = 0; i < 64; ++i) {
    tables.luma[i] = static_cast<uint16_t>(1 + 4 * i);
    tables.chroma[i] = static_cast<uint16_t>(255 - i);
  }
  options.tables = tables;
  const auto info = jpeg::read_info(*jpeg::encode(test_image(20, 20).view(), options));
  REQUIRE(info.ok());
  CHECK(info->quant_tables[0] == tables.luma);
  CHECK(info->quant_tables[1] == tables.chroma);
}

TEST_CASE("optimal Huffman tables never lose to the standard ones, and effort pays") {
  const RgbImage image = test_image(160, 120);
  for (const double quality : {10.0, 50.0, 90.0}) {
    EncodeOptions options;
    options.quality = quality;
    options.huffman = jpeg::Huffman::standard;
    const size_t standard = jpeg::encode(image.view(), options)->size();
    options.huffman = jpeg::Huffman::optimal;
    REQUIRE(jpeg::encode(image.view(), options)->size() < standard);
  }
}

// Bytes that an encoder needs for a PSNR, from its curve over qualities (linear in log bytes).
double bytes_for_psnr(const RgbImage& image, EncodeOptions options, double target) {
  double previous_psnr = 0, previous_log = 0;
  for (double quality = 5; quality <= 100; quality += 5) {
    options.quality = quality;
    const auto bytes = *jpeg::encode(image.view(), options);
    const double psnr = psnr_rgb(image.view(), jpeg::decode(bytes)->view());
    const double log_size = std::log(static_cast<double>(bytes.size()));
    if (psnr >= target && quality > 5)
      return std::exp(previous_log + (log_size - previous_log) * (target - previous_psnr) / (psnr - previous_psnr));
    previous_psnr = psnr;
    previous_log = log_size;
  }
  return 1e9;
}

TEST_CASE("at equal PSNR tuned and adapted tables beat Annex K by a twentieth, and the trellis saves more") {
  const RgbImage image = test_image(128, 96);
  constexpr double kTarget = 28.0;
  const auto preset = [](jpeg::Effort effort) {
    EncodeOptions options = jpeg::options_for(effort, jpeg::Tune::psnr, 50);
    options.subsampling = jpeg::Subsampling::yuv444;
    return options;
  };
  EncodeOptions plain;
  plain.subsampling = jpeg::Subsampling::yuv444;
  EncodeOptions adapted = preset(jpeg::Effort::normal);
  adapted.table_source = jpeg::TableSource::adapted;
  const double annex_k = bytes_for_psnr(image, plain, kTarget);
  const double normal = bytes_for_psnr(image, preset(jpeg::Effort::normal), kTarget);
  const double best = bytes_for_psnr(image, preset(jpeg::Effort::best), kTarget);
  const double with_adapted = bytes_for_psnr(image, adapted, kTarget);
  CAPTURE(annex_k);
  CAPTURE(normal);
  CAPTURE(best);
  CAPTURE(with_adapted);
  CHECK(normal < 0.95 * annex_k);
  CHECK(with_adapted < 0.95 * annex_k);
  CHECK(best < normal);
}

// A difference image: 127 but for a box of detail.
RgbImage flat_with_box() {
  RgbImage image(128, 96);
  Random random(9);
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x)
      for (int c = 0; c < 3; ++c) {
        const bool inside = x >= 16 && x < 40 && y >= 16 && y < 40;
        image.pixel(x, y)[c] = static_cast<uint8_t>(inside ? 100 + random.next() % 60 : 127);
      }
  return image;
}

TEST_CASE("fitted and adapted tables keep a flat background exact where tuned ones shift all of it") {
  const RgbImage image = flat_with_box();
  for (const double quality : {40.0, 60.0, 70.0}) {
    EncodeOptions options = jpeg::options_for(jpeg::Effort::normal, jpeg::Tune::psnr, quality);
    for (const auto source : {jpeg::TableSource::fitted, jpeg::TableSource::adapted}) {
      options.table_source = source;
      CHECK(jpeg::decode(*jpeg::encode(image.view(), options))->pixel(120, 90)[1] == 127);
    }
    options.table_source = jpeg::TableSource::tuned;
    CHECK(jpeg::decode(*jpeg::encode(image.view(), options))->pixel(120, 90)[1] == 128);
  }
}

// Mean squared error of the columns [begin, end).
double error_of_columns(ConstRgbView a, ConstRgbView b, int begin, int end) {
  double sum = 0;
  for (int y = 0; y < a.height; ++y)
    for (int x = begin; x < end; ++x) sum += std::pow(a.pixel(x, y)[1] - b.pixel(x, y)[1], 2.0);
  return sum / (a.height * (end - begin));
}

TEST_CASE("errors of a difference image hide where the picture to be seen is busy") {
  RgbImage difference(128, 64), seen(128, 64);
  Random random(4);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 128; ++x) {
      const auto detail = static_cast<uint8_t>(80 + random.next() % 96), busy = static_cast<uint8_t>(random.next());
      for (int c = 0; c < 3; ++c) {
        difference.pixel(x, y)[c] = detail;
        seen.pixel(x, y)[c] = x < 64 ? busy : uint8_t{90};
      }
    }
  EncodeOptions options = jpeg::options_for(jpeg::Effort::best, jpeg::Tune::ssim, 60);
  const auto ratio = [&] {
    const RgbImage decoded = *jpeg::decode(*jpeg::encode(difference.view(), options));
    return error_of_columns(difference.view(), decoded.view(), 0, 64) /
           error_of_columns(difference.view(), decoded.view(), 64, 128);
  };
  const double own = ratio();
  options.seen = seen.view();
  const double with_seen = ratio();
  CAPTURE(own);
  CAPTURE(with_seen);
  CHECK(own < 1.2);
  CHECK(with_seen > 1.5);
  const RgbImage other(64, 64);
  options.seen = other.view();
  CHECK(jpeg::encode(difference.view(), options).failure().error == Error::bad_argument);
}

TEST_CASE("where blocks are more important the trellis errs less, in luma and chroma, at any sampling") {
  RgbImage image(120, 63);
  Random random(5);
  for (int y = 0; y < 63; ++y)
    for (int x = 0; x < 120; ++x)
      for (int c = 0; c < 3; ++c) image.pixel(x, y)[c] = static_cast<uint8_t>(60 + random.next() % 96);
  std::vector<float> importance(size_t{15} * 8);
  for (size_t i = 0; i < importance.size(); ++i) importance[i] = i % 15 < 8 ? 0.25f : 4.0f;
  for (const auto subsampling : {jpeg::Subsampling::yuv444, jpeg::Subsampling::yuv422, jpeg::Subsampling::yuv420}) {
    CAPTURE(static_cast<int>(subsampling));
    EncodeOptions options = jpeg::options_for(jpeg::Effort::best, jpeg::Tune::psnr, 60);
    options.subsampling = subsampling;
    // Luma and the blue difference, of the less and the more important half.
    const auto ratios = [&] {
      const RgbImage decoded = *jpeg::decode(*jpeg::encode(image.view(), options));
      double errors[2][2] = {};
      for (int y = 0; y < 63; ++y)
        for (int x = 0; x < 120; ++x) {
          if (x >= 56 && x < 72) continue;  // the filter of upsampling looks across
          int error[3];
          for (int c = 0; c < 3; ++c) error[c] = image.pixel(x, y)[c] - decoded.pixel(x, y)[c];
          const double luma = 0.299 * error[0] + 0.587 * error[1] + 0.114 * error[2];
          errors[0][x < 64 ? 0 : 1] += luma * luma;
          errors[1][x < 64 ? 0 : 1] += (error[2] - luma) * (error[2] - luma);
        }
      return std::pair(errors[0][0] / errors[0][1], errors[1][0] / errors[1][1]);
    };
    const auto alike = ratios();
    options.importance = importance;
    const auto weighted = ratios();
    CHECK(weighted.first > 1.5 * alike.first);
    CHECK(weighted.second > 1.05 * alike.second);
    options.trellis = false;
    const auto bytes = jpeg::encode(image.view(), options);
    options.importance = {};
    CHECK(*bytes == *jpeg::encode(image.view(), options));
  }
}

TEST_CASE(
    "importance of another number of blocks, or not above 0, is refused; of all blocks alike it changes nothing") {
  const RgbImage image = test_image(40, 24);
  EncodeOptions options = jpeg::options_for(jpeg::Effort::best, jpeg::Tune::ssim, 60);
  const auto plain = jpeg::encode(image.view(), options);
  std::vector<float> importance(15, 1.0f);
  options.importance = importance;
  CHECK(*jpeg::encode(image.view(), options) == *plain);
  importance[7] = 0.0f;
  CHECK(jpeg::encode(image.view(), options).failure().error == Error::bad_argument);
  importance.assign(14, 1.0f);
  options.importance = importance;
  CHECK(jpeg::encode(image.view(), options).failure().error == Error::bad_argument);
}

TEST_CASE("encode_to_size fits the target, and no quality a little higher does") {
  const RgbImage image = test_image(96, 64);
  for (const auto effort : {jpeg::Effort::fast, jpeg::Effort::best}) {
    for (const uint64_t target : {uint64_t{1500}, uint64_t{4000}, uint64_t{1000000}}) {
      EncodeOptions options = jpeg::options_for(effort, jpeg::Tune::ssim, 50);
      if (target == 4000 && effort == jpeg::Effort::best) options.table_source = jpeg::TableSource::adapted;
      const auto file = jpeg::encode_to_size(image.view(), options, target);
      REQUIRE(file.ok());
      CHECK(file->bytes.size() <= target);
      const auto info = jpeg::read_info(file->bytes);
      CHECK(info->quant_tables[0] == file->tables.luma);
      if (target > 100000) CHECK(file->quality == 100.0);
      EncodeOptions again = options;
      again.quality = file->quality;
      if (!file->is_between_qualities) CHECK(*jpeg::encode(image.view(), again) == file->bytes);
      for (const double more : {1.0, 2.0, 4.0}) {
        again.quality = file->quality + more;
        if (again.quality <= 100) CHECK(jpeg::encode(image.view(), again)->size() > target);
      }
    }
  }
}

TEST_CASE("encode_to_size uses 99 % of its target, whatever the picture, the tables and the effort") {
  const RgbImage pictures[] = {test_image(96, 64), flat_with_box()};
  for (const RgbImage& image : pictures) {
    for (const auto source : {jpeg::TableSource::annex_k, jpeg::TableSource::fitted, jpeg::TableSource::adapted}) {
      const auto effort = source == jpeg::TableSource::adapted ? jpeg::Effort::best : jpeg::Effort::normal;
      EncodeOptions options = jpeg::options_for(effort, jpeg::Tune::psnr, 50);
      options.table_source = source;
      options.quality = 100;
      const size_t largest = jpeg::encode(image.view(), options)->size();
      for (const double share : {0.55, 0.7, 0.9}) {
        const auto target = static_cast<uint64_t>(share * static_cast<double>(largest));
        const auto file = jpeg::encode_to_size(image.view(), options, target);
        REQUIRE(file.ok());
        CHECK(file->bytes.size() <= target);
        // To the byte: these files are short.
        CHECK(100 * file->bytes.size() + 100 >= 99 * target);
        CHECK(jpeg::decode(file->bytes).ok());
      }
    }
  }
}

TEST_CASE("encode_to_size scales the caller's tables, and says how short it could get where the target is too small") {
  const RgbImage image = test_image(64, 64);
  EncodeOptions options;
  options.tables = jpeg::annex_k_tables(50);
  const auto scaled = jpeg::encode_to_size(image.view(), options, 3000);
  REQUIRE(scaled.ok());
  CHECK(scaled->tables.luma == jpeg::annex_k_tables(scaled->quality).luma);
  const auto impossible = jpeg::encode_to_size(image.view(), options, 300);
  REQUIRE_FALSE(impossible.ok());
  CHECK(impossible.failure().error == Error::out_of_space);
  CHECK(impossible.failure().byte_offset > 300);
}

TEST_CASE("the same bytes and pixels on every instruction set, and the ones recorded here") {
  const RgbImage image = test_image(61, 47);
  uint64_t files = kHashStart, pixels = kHashStart;
  for (const auto subsampling : kSubsamplings) {
    for (const auto effort : kEfforts) {
      for (const auto tune : kTunes) {
        EncodeOptions options = jpeg::options_for(effort, tune, 63.5);
        options.subsampling = subsampling;
        options.restart_interval_mcus = tune == jpeg::Tune::ssim ? 5 : 0;
        if (tune == jpeg::Tune::visual) options.table_source = jpeg::TableSource::adapted;
        options.isa = Isa::scalar;
        const auto expected = *jpeg::encode(image.view(), options);
        const auto decoded = jpeg::decode(expected, {}, Isa::scalar);
        files = hash_bytes(expected.data(), expected.size(), files);
        pixels = hash_pixels(decoded->view(), pixels);
        for (int i = 0; i < kIsaCount; ++i) {
          options.isa = static_cast<Isa>(i);
          if (!isa_is_built(options.isa) || !isa_is_supported(options.isa)) continue;
          REQUIRE(*jpeg::encode(image.view(), options) == expected);
          REQUIRE(max_difference(jpeg::decode(expected, {}, options.isa)->view(), decoded->view()) == 0);
        }
      }
    }
  }
  CHECK(files == 0x4ffc4c494fc93bc7u);
  CHECK(pixels == 0xf95c389d40a7611cu);
}

}  // namespace
}  // namespace pac::test
