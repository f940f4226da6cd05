// Quantized coefficients read and written without going to pixels.
#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "base/metrics.h"
#include "jpeg/coefficient_io.h"
#include "jpeg/metadata.h"
#include "tests/support/jpeg_file.h"
#include "tests/support/peer.h"

namespace pac::test {
namespace {

using jpeg::CoefficientImage;
using jpeg::EncodeOptions;

std::vector<uint8_t> corpus_file(const char* name) {
  return read_bytes(std::string(PAC_SOURCE_DIR "/tests/fuzz/corpus/jpeg_decode/") + name);
}

constexpr const char* kSoundFiles[] = {"gray22.jpg", "one.jpg",  "progressive.jpg", "q16bit.jpg",   "rgb.jpg",
                                       "s111.jpg",   "s112.jpg", "s211_rst.jpg",    "s220_opt.jpg", "s221212.jpg",
                                       "s31.jpg",    "s411.jpg", "scans_mix.jpg",   "scans_sep.jpg"};

TEST_CASE("any file becomes a baseline file of the same pixels, progressive ones too") {
  for (const char* name : kSoundFiles) {
    CAPTURE(name);
    const auto original = corpus_file(name);
    const auto read = jpeg::read_coefficients(original);
    REQUIRE(read.ok());
    for (const auto huffman : {jpeg::Huffman::standard, jpeg::Huffman::optimal}) {
      for (const int restart : {0, 2}) {
        const auto file = jpeg::write_coefficients(read->image, {huffman, restart, nullptr});
        REQUIRE(file.ok());
        const int process = jpeg::read_info(*file)->start_of_frame;
        CHECK((process == 0xC0 || (process == 0xC1 && std::string(name) == "q16bit.jpg")));
        REQUIRE(max_difference(jpeg::decode(*file)->view(), jpeg::decode(original)->view()) == 0);
        const auto again = jpeg::read_coefficients(*file);
        for (size_t c = 0; c < read->image.components.size(); ++c)
          REQUIRE(again->image.components[c].steps == read->image.components[c].steps);
      }
    }
  }
}

TEST_CASE("a file of ours, read and written, is the same file") {
  for (const auto subsampling :
       {jpeg::Subsampling::yuv444, jpeg::Subsampling::yuv422, jpeg::Subsampling::yuv420, jpeg::Subsampling::gray}) {
    for (const int restart : {0, 5}) {
      EncodeOptions options;
      options.subsampling = subsampling;
      options.restart_interval_mcus = restart;
      const auto file = *jpeg::encode(test_image(75, 49).view(), options);
      const auto read = jpeg::read_coefficients(file);
      REQUIRE(read.ok());
      CHECK(*jpeg::write_coefficients(read->image, {jpeg::Huffman::optimal, restart, nullptr}) == file);
    }
  }
}

TEST_CASE("jpegtran makes the same coefficients, and not fewer bytes, of a progressive file") {
  if (!have_peer("jpegtran") || !have_peer("cjpeg")) return;
  TempDir dir;
  EncodeOptions options;
  options.quality = 90;
  write_bytes(dir.file("a.jpg"), *jpeg::encode(test_image(120, 90).view(), options));
  REQUIRE(run("jpegtran -progressive -outfile " + dir.file("p.jpg") + " " + dir.file("a.jpg")) == 0);
  REQUIRE(run("jpegtran -optimize -outfile " + dir.file("o.jpg") + " " + dir.file("p.jpg")) == 0);
  const auto ours = jpeg::write_coefficients(jpeg::read_coefficients(read_bytes(dir.file("p.jpg")))->image);
  REQUIRE(ours.ok());
  const auto theirs = read_bytes(dir.file("o.jpg"));
  CHECK(ours->size() <= theirs.size());
  const auto a = jpeg::read_coefficients(*ours), b = jpeg::read_coefficients(theirs);
  for (size_t c = 0; c < 3; ++c) REQUIRE(a->image.components[c].levels == b->image.components[c].levels);
  write_bytes(dir.file("ours.jpg"), *ours);
  REQUIRE(run("djpeg -outfile " + dir.file("x.ppm") + " " + dir.file("ours.jpg")) == 0);
  REQUIRE(run("djpeg -outfile " + dir.file("y.ppm") + " " + dir.file("p.jpg")) == 0);
  CHECK(read_bytes(dir.file("x.ppm")) == read_bytes(dir.file("y.ppm")));
}

TEST_CASE("requantized files are smaller and still near the picture; the same steps change nothing") {
  const RgbImage image = test_image(96, 80);
  EncodeOptions options;
  options.quality = 90;
  const auto file = *jpeg::encode(image.view(), options);
  CoefficientImage coefficients = jpeg::read_coefficients(file)->image;
  jpeg::requantize(coefficients, jpeg::annex_k_tables(90));
  CHECK(*jpeg::write_coefficients(coefficients) == file);
  jpeg::requantize(coefficients, jpeg::annex_k_tables(50));
  const auto smaller = *jpeg::write_coefficients(coefficients);
  CHECK(smaller.size() < file.size() * 2 / 3);
  options.quality = 50;
  const double direct = psnr_luma(image.view(), jpeg::decode(*jpeg::encode(image.view(), options))->view());
  CHECK(psnr_luma(image.view(), jpeg::decode(smaller)->view()) > direct - 0.5);
}

TEST_CASE("a change of a coefficient is a change of that block alone") {
  EncodeOptions options;
  options.subsampling = jpeg::Subsampling::yuv444;
  const auto file = *jpeg::encode(test_image(64, 64).view(), options);
  auto read = jpeg::read_coefficients(file);
  read->image.components[0].block(3, 2)[0] += 8;
  const auto before = jpeg::decode(file), after = jpeg::decode(*jpeg::write_coefficients(read->image));
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const bool changed = before->pixel(x, y)[1] != after->pixel(x, y)[1];
      if (x / 8 != 3 || y / 8 != 2) REQUIRE_FALSE(changed);
    }
  CHECK(before->pixel(28, 20)[1] != after->pixel(28, 20)[1]);
}

TEST_CASE("coefficients that fit no file are bad arguments") {
  const CoefficientImage sound = jpeg::read_coefficients(*jpeg::encode(test_image(20, 20).view()))->image;
  REQUIRE(jpeg::write_coefficients(sound).ok());
  const auto refused = [&](auto&& change) {
    CoefficientImage image = sound;
    change(image);
    const auto result = jpeg::write_coefficients(image);
    return !result.ok() && result.failure().error == Error::bad_argument;
  };
  CHECK(refused([](CoefficientImage& i) { i.width = 0; }));
  CHECK(refused([](CoefficientImage& i) { i.width = 33; }));
  CHECK(refused([](CoefficientImage& i) { i.components.pop_back(); }));
  CHECK(refused([](CoefficientImage& i) { i.components[1].h = 5; }));
  CHECK(refused([](CoefficientImage& i) { i.components[1].id = 1; }));
  CHECK(refused([](CoefficientImage& i) { i.components[0].steps[9] = 0; }));
  CHECK(refused([](CoefficientImage& i) { i.components[0].levels.pop_back(); }));
  CHECK(refused([](CoefficientImage& i) { i.components[0].block(0, 0)[5] = 1024; }));
  CHECK(refused([](CoefficientImage& i) { i.components[0].block(0, 0)[0] = 2048; }));
  CHECK_FALSE(refused([](CoefficientImage& i) { i.components[0].block(0, 0)[5] = -1023; }));
}

TEST_CASE("damaged files: no coefficients strictly, what is there leniently") {
  auto file = *jpeg::encode(test_image(64, 64).view());
  file.resize(file.size() / 2);
  CHECK_FALSE(jpeg::read_coefficients(file).ok());
  const auto read = jpeg::read_coefficients(file, {}, true);
  REQUIRE(read.ok());
  CHECK(read->failure.has_value());
  const auto repaired = jpeg::write_coefficients(read->image);
  REQUIRE(repaired.ok());
  CHECK(jpeg::decode(*repaired).ok());
}

TEST_CASE("levels count against the limit on memory") {
  const auto file = *jpeg::encode(test_image(64, 64).view());
  jpeg::DecodeOptions options;
  options.limits.max_bytes = 64 * 64 * 2;
  CHECK(jpeg::read_coefficients(file, options).failure().error == Error::limit_exceeded);
}

}  // namespace
}  // namespace pac::test
