// Other programs read our files, and we read theirs.
#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "base/file_io.h"
#include "base/image_io.h"
#include "base/metrics.h"
#include "jpeg/coefficient_io.h"
#include "jpeg/jpeg.h"
#include "tests/support/jpeg_file.h"
#include "tests/support/peer.h"
#include "tests/support/stb_jpeg.h"

namespace pac::test {
namespace {

// What a program that writes PPM or PGM made; empty where it failed.
RgbImage read_picture(const std::string& path) {
  const auto bytes = read_file(path);
  if (!bytes.ok()) return {};
  auto image = decode_rgb(*bytes);
  return image.ok() ? std::move(*image) : RgbImage();
}

RgbImage djpeg(const TempDir& dir, const std::string& jpeg_file) {
  REQUIRE(run("djpeg -pnm -outfile " + dir.file("djpeg.pnm") + " " + jpeg_file) == 0);
  return read_picture(dir.file("djpeg.pnm"));
}

std::string write_ppm(const TempDir& dir, const RgbImage& image) {
  const std::string path = dir.file("in.ppm");
  write_bytes(path, *encode_image(image.view(), path));
  return path;
}

TEST_CASE("djpeg sees in our files what we see, for every kind of file that we write") {
  if (!have_peer("djpeg")) return;
  TempDir dir;
  for (const auto& [width, height] : {std::pair{1, 1}, {2, 3}, {17, 9}, {64, 48}, {99, 75}}) {
    const RgbImage image = test_image(width, height);
    for (const auto subsampling :
         {jpeg::Subsampling::yuv444, jpeg::Subsampling::yuv422, jpeg::Subsampling::yuv420, jpeg::Subsampling::gray}) {
      for (const auto effort : {jpeg::Effort::fast, jpeg::Effort::normal, jpeg::Effort::best}) {
        jpeg::EncodeOptions options = jpeg::options_for(effort, jpeg::Tune::psnr, 80);
        options.subsampling = subsampling;
        options.restart_interval_mcus = effort == jpeg::Effort::normal ? 3 : 0;
        const auto bytes = *jpeg::encode(image.view(), options);
        write_bytes(dir.file("ours.jpg"), bytes);
        const RgbImage theirs = djpeg(dir, dir.file("ours.jpg"));
        REQUIRE(max_difference(jpeg::decode(bytes)->view(), theirs.view()) <= 1);
      }
    }
  }
}

TEST_CASE("ffmpeg decodes our files to pictures close to ours") {
  if (!have_peer("ffmpeg")) return;
  TempDir dir;
  const RgbImage image = test_image(160, 120);
  for (const auto subsampling : {jpeg::Subsampling::yuv444, jpeg::Subsampling::yuv422, jpeg::Subsampling::yuv420}) {
    jpeg::EncodeOptions options = jpeg::options_for(jpeg::Effort::best, jpeg::Tune::visual, 85);
    options.subsampling = subsampling;
    options.restart_interval_mcus = 7;
    const auto bytes = *jpeg::encode(image.view(), options);
    write_bytes(dir.file("ours.jpg"), bytes);
    REQUIRE(run("ffmpeg -v error -xerror -y -i " + dir.file("ours.jpg") + " -pix_fmt rgb24 " + dir.file("f.ppm")) == 0);
    // Its chroma upsampling repeats samples, so edges differ; luma does not.
    REQUIRE(psnr_luma(jpeg::decode(bytes)->view(), read_picture(dir.file("f.ppm")).view()) > 35.0);
  }
}

// Its chroma filter is another one, its luma is as exact as ours.
TEST_CASE("stb_image decodes our files, of any sampling, and those that transcoding made") {
  if (!have_stb()) return;
  const RgbImage image = test_image(97, 71);
  const jpeg::SamplingFactors kinds[] = {{},
                                         {{2, 1, 1}, {2, 1, 1}},
                                         {{2, 1, 1}, {1, 1, 1}},
                                         {{1, 1, 1}, {2, 1, 1}},
                                         {{4, 1, 1}, {1, 1, 1}},
                                         {{4, 1, 1}, {2, 1, 1}},
                                         {{2, 1, 1}, {2, 2, 2}}};
  for (const auto effort : {jpeg::Effort::fast, jpeg::Effort::normal, jpeg::Effort::best}) {
    for (const auto& sampling : kinds) {
      jpeg::EncodeOptions options = jpeg::options_for(effort, jpeg::Tune::visual, 85);
      options.sampling = sampling;
      options.restart_interval_mcus = effort == jpeg::Effort::normal ? 5 : 0;
      const auto bytes = *jpeg::encode(image.view(), options);
      const RgbImage theirs = stb_decode(bytes), ours = *jpeg::decode(bytes);
      REQUIRE(theirs.width() == 97);
      REQUIRE(psnr_luma(ours.view(), theirs.view()) > 35.0);
      if (sampling.h[0] == 1 && sampling.v[0] == 1) REQUIRE(max_difference(ours.view(), theirs.view()) <= 3);
      const auto again = *jpeg::write_coefficients(jpeg::read_coefficients(bytes)->image, {jpeg::Huffman::optimal, 3});
      REQUIRE(max_difference(stb_decode(again).view(), theirs.view()) == 0);
    }
  }
  jpeg::EncodeOptions gray;
  gray.subsampling = jpeg::Subsampling::gray;
  const auto bytes = *jpeg::encode(image.view(), gray);
  CHECK(max_difference(jpeg::decode(bytes)->view(), stb_decode(bytes).view()) <= 2);
}

TEST_CASE("with the same choices our files are cjpeg's byte for byte") {
  if (!have_peer("cjpeg")) return;
  TempDir dir;
  for (const auto& [width, height] : {std::pair{1, 1}, {8, 8}, {17, 33}, {18, 18}, {50, 34}}) {
    const RgbImage image = test_image(width, height);
    const std::string ppm = write_ppm(dir, image);
    for (const int quality : {5, 50, 75, 96}) {
      const std::pair<jpeg::Subsampling, const char*> kinds[] = {
          {jpeg::Subsampling::yuv444, "1x1"}, {jpeg::Subsampling::yuv422, "2x1"}, {jpeg::Subsampling::yuv420, "2x2"}};
      for (const auto& [subsampling, sample] : kinds) {
        jpeg::EncodeOptions options;
        options.quality = quality;
        options.subsampling = subsampling;
        options.huffman = jpeg::Huffman::standard;
        REQUIRE(run("cjpeg -quality " + std::to_string(quality) + " -baseline -sample " + sample + " -outfile " +
                    dir.file("c.jpg") + " " + ppm) == 0);
        REQUIRE(*jpeg::encode(image.view(), options) == read_bytes(dir.file("c.jpg")));
      }
    }
  }
}

TEST_CASE("files of unusual sampling factors are cjpeg's byte for byte, or djpeg's picture where cjpeg refuses") {
  if (!have_peer("cjpeg") || !have_peer("djpeg")) return;
  TempDir dir;
  const struct {
    jpeg::SamplingFactors factors;
    const char* sample;
  } kinds[] = {{{{1, 1, 1}, {2, 1, 1}}, "1x2,1x1,1x1"}, {{{4, 1, 1}, {1, 1, 1}}, "4x1,1x1,1x1"},
               {{{4, 1, 1}, {2, 1, 1}}, "4x2,1x1,1x1"}, {{{2, 1, 1}, {2, 2, 2}}, "2x2,1x2,1x2"},
               {{{2, 2, 1}, {2, 1, 1}}, "2x2,2x1,1x1"}, {{{1, 2, 1}, {1, 2, 1}}, "1x1,2x2,1x1"},
               {{{3, 1, 1}, {1, 1, 1}}, "3x1,1x1,1x1"}, {{{1, 1, 1}, {4, 1, 2}}, "1x4,1x1,1x2"},
               {{{2, 2, 2}, {1, 1, 1}}, "2x1,2x1,2x1"}, {{{3, 1, 3}, {1, 1, 1}}, "3x1,1x1,3x1"}};
  for (const auto& [width, height] : {std::pair{1, 1}, {17, 33}, {50, 34}}) {
    const RgbImage image = test_image(width, height);
    const std::string ppm = write_ppm(dir, image);
    std::string script = "cd " + dir.path();
    for (size_t i = 0; i < std::size(kinds); ++i)
      script += "; cjpeg -quality 85 -baseline -sample " + std::string(kinds[i].sample) + " -outfile " +
                std::to_string(i) + ".jpg in.ppm";
    run(script);
    for (size_t i = 0; i < std::size(kinds); ++i) {
      const char* const sample = kinds[i].sample;
      CAPTURE(sample);
      jpeg::EncodeOptions options;
      options.quality = 85;
      options.huffman = jpeg::Huffman::standard;
      options.sampling = kinds[i].factors;
      REQUIRE(*jpeg::encode(image.view(), options) == read_bytes(dir.file(std::to_string(i) + ".jpg")));
    }
  }
  // Ratios that libjpeg averages nowhere: a picture that we read, near the original.
  const RgbImage image = test_image(64, 48);
  jpeg::EncodeOptions options;
  options.quality = 95;
  options.sampling = jpeg::SamplingFactors{{3, 2, 1}, {2, 1, 2}};
  const auto decoded = jpeg::decode(*jpeg::encode(image.view(), options));
  REQUIRE(decoded.ok());
  CHECK(psnr_luma(image.view(), decoded->view()) > 30.0);
  for (const auto& factors : {jpeg::SamplingFactors{{4, 4, 1}, {2, 2, 1}}, jpeg::SamplingFactors{{5, 1, 1}, {1, 1, 1}},
                              jpeg::SamplingFactors{{1, 0, 1}, {1, 1, 1}}}) {
    options.sampling = factors;
    CHECK(jpeg::encode(image.view(), options).failure().error == Error::bad_argument);
  }
}

// Options for cjpeg that reach every path of the decoder.
constexpr const char* kVariants[] = {
    "-sample 1x1",
    "-sample 2x1 -restart 1B",
    "-sample 1x2 -optimize",
    "-sample 2x2 -restart 2B",
    "-sample 2x2 -optimize -restart 1",
    "-sample 4x1 -restart 3B",
    "-sample 4x2",
    "-sample 2x4",
    "-sample 1x4",
    "-sample 2x2,1x2,1x2",
    "-sample 2x2,2x1,1x1",
    "-sample 1x1,2x2,1x1",
    "-sample 3x1",
    "-sample 3x2,1x1,3x1",
    "-grayscale -restart 2B",
    "-grayscale -sample 2x2",
    "-rgb",
    "-quality 1",
    "-quality 100 -optimize",
    "-progressive",
    "-progressive -sample 1x1 -restart 2B",
    "-progressive -sample 2x1 -quality 95",
    "-progressive -grayscale -sample 2x2",
};

TEST_CASE("we decode cjpeg's files as djpeg does, for all sampling factors, odd sizes, restarts, gray and RGB") {
  if (!have_peer("cjpeg") || !have_peer("djpeg")) return;
  TempDir dir;
  // One shell command makes all files of a size: starting programs is what takes the time.
  for (const auto& [width, height] :
       {std::pair{1, 1}, {2, 2}, {3, 5}, {7, 16}, {15, 9}, {17, 33}, {33, 17}, {31, 32}}) {
    const std::string ppm = write_ppm(dir, test_image(width, height));
    std::string script = "cd " + dir.path() + "; rm -f *.jpg *.pnm";
    for (size_t i = 0; i < std::size(kVariants); ++i) {
      const std::string n = std::to_string(i);
      script += "; cjpeg " + std::string(kVariants[i]) + " -outfile " + n + ".jpg in.ppm && djpeg -pnm -outfile " + n +
                ".pnm " + n + ".jpg";
    }
    run(script);
    for (size_t i = 0; i < std::size(kVariants); ++i) {
      const char* const variant = kVariants[i];
      const int w = width, h = height;  // CAPTURE's lambda may not name a structured binding
      CAPTURE(variant);
      CAPTURE(w);
      CAPTURE(h);
      const auto decoded = jpeg::decode(read_bytes(dir.file(std::to_string(i) + ".jpg")));
      REQUIRE(decoded.ok());
      REQUIRE(max_difference(decoded->view(), read_picture(dir.file(std::to_string(i) + ".pnm")).view()) <= 1);
    }
  }
}

TEST_CASE("all sizes from 1 to 33 squared decode as djpeg decodes them") {
  if (!have_peer("cjpeg") || !have_peer("djpeg")) return;
  TempDir dir;
  std::string script = "cd " + dir.path();
  for (int side = 1; side <= 33; ++side) {
    const std::string n = std::to_string(side);
    write_bytes(dir.file(n + ".ppm"), *encode_image(test_image(side, 34 - side).view(), "x.ppm"));
    script += "; cjpeg -sample 2x2 -restart " + std::to_string(side % 4) + "B -outfile " + n + ".jpg " + n +
              ".ppm && djpeg -pnm -outfile " + n + ".pnm " + n + ".jpg";
  }
  run(script);
  for (int side = 1; side <= 33; ++side) {
    CAPTURE(side);
    const auto decoded = jpeg::decode(read_bytes(dir.file(std::to_string(side) + ".jpg")));
    REQUIRE(decoded.ok());
    REQUIRE(max_difference(decoded->view(), read_picture(dir.file(std::to_string(side) + ".pnm")).view()) <= 1);
  }
}

TEST_CASE("one scan for each component, as jpegtran -scans writes them, decodes as djpeg decodes it") {
  if (!have_peer("jpegtran") || !have_peer("djpeg")) return;
  TempDir dir;
  const auto write_text = [&](const char* name, const std::string& text) {
    write_bytes(dir.file(name), {reinterpret_cast<const uint8_t*>(text.data()), text.size()});
  };
  write_text("separate.txt", "0;\n1;\n2;\n");
  write_text("mixed.txt", "0;\n1 2;\n");
  for (const auto subsampling : {jpeg::Subsampling::yuv444, jpeg::Subsampling::yuv422, jpeg::Subsampling::yuv420}) {
    jpeg::EncodeOptions options;
    options.subsampling = subsampling;
    write_bytes(dir.file("a.jpg"), *jpeg::encode(test_image(45, 37).view(), options));
    for (const char* scans : {"separate.txt", "mixed.txt"}) {
      for (const char* extra : {"", "-restart 2B ", "-optimize "}) {
        CAPTURE(scans);
        REQUIRE(run("jpegtran " + std::string(extra) + "-scans " + dir.file(scans) + " -outfile " + dir.file("b.jpg") +
                    " " + dir.file("a.jpg")) == 0);
        const auto decoded = jpeg::decode(read_bytes(dir.file("b.jpg")));
        REQUIRE(decoded.ok());
        REQUIRE(max_difference(decoded->view(), djpeg(dir, dir.file("b.jpg")).view()) <= 1);
      }
    }
  }
}

TEST_CASE("a truncated file decodes leniently to djpeg's picture") {
  if (!have_peer("djpeg")) return;
  TempDir dir;
  jpeg::EncodeOptions options;
  const auto bytes = *jpeg::encode(test_image(64, 64).view(), options);
  for (const size_t n : {bytes.size() / 2, bytes.size() * 3 / 4, bytes.size() - 2}) {
    const std::vector<uint8_t> prefix(bytes.begin(), bytes.begin() + static_cast<ptrdiff_t>(n));
    write_bytes(dir.file("cut.jpg"), prefix);
    run("djpeg -pnm -outfile " + dir.file("cut.pnm") + " " + dir.file("cut.jpg"));  // exit code 2: warnings
    const auto lenient = jpeg::decode_lenient(prefix);
    REQUIRE(lenient.ok());
    REQUIRE(lenient->failure.has_value());
    REQUIRE(max_difference(lenient->image.view(), read_picture(dir.file("cut.pnm")).view()) <= 1);
  }
}

}  // namespace
}  // namespace pac::test
