// Scaled and cropped decoding: djpeg's pictures, and exactly the whole picture's pixels.
#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "base/file_io.h"
#include "base/image_io.h"
#include "jpeg/jpeg.h"
#include "tests/support/jpeg_file.h"
#include "tests/support/peer.h"

namespace pac::test {
namespace {

using jpeg::Crop;
using jpeg::DecodeOptions;

DecodeOptions scaled(int denominator) {
  DecodeOptions options;
  options.scale_denominator = denominator;
  return options;
}

RgbImage read_pnm(const std::string& path) {
  const auto bytes = read_file(path);
  if (!bytes.ok()) return {};
  auto image = decode_rgb(*bytes);
  return image.ok() ? std::move(*image) : RgbImage();
}

// Files that reach every path: sampling factors, scans, restarts, gray, RGB, progressive ones.
std::vector<std::vector<uint8_t>> corpus() {
  std::vector<std::vector<uint8_t>> files;
  const std::string folder = PAC_SOURCE_DIR "/tests/fuzz/corpus/jpeg_decode/";
  for (const char* name :
       {"gray22.jpg", "one.jpg", "progressive.jpg", "rgb.jpg", "s111.jpg", "s112.jpg", "s211_rst.jpg", "s220_opt.jpg",
        "s221212.jpg", "s31.jpg", "s411.jpg", "scans_mix.jpg", "scans_sep.jpg"})
    files.push_back(read_bytes(folder + name));
  jpeg::EncodeOptions options;
  for (const auto subsampling :
       {jpeg::Subsampling::yuv444, jpeg::Subsampling::yuv422, jpeg::Subsampling::yuv420, jpeg::Subsampling::gray}) {
    options.subsampling = subsampling;
    files.push_back(*jpeg::encode(test_image(83, 61).view(), options));
    options.restart_interval_mcus = 3;
    files.push_back(*jpeg::encode(test_image(300, 21).view(), options));
  }
  return files;
}

TEST_CASE("pictures at 1/2, 1/4 and 1/8 are djpeg's") {
  if (!have_peer("djpeg")) return;
  TempDir dir;
  const auto files = corpus();
  std::string script = "cd " + dir.path();
  for (size_t i = 0; i < files.size(); ++i) {
    write_bytes(dir.file(std::to_string(i) + ".jpg"), files[i]);
    for (const int n : {2, 4, 8}) {
      const std::string name = std::to_string(i), scale = std::to_string(n);
      script += "; djpeg -pnm -scale 1/" + scale + " -outfile " + name + "_" + scale + ".pnm " + name + ".jpg";
    }
  }
  run(script);
  int compared = 0;
  for (size_t i = 0; i < files.size(); ++i) {
    for (const int n : {2, 4, 8}) {
      const RgbImage theirs = read_pnm(dir.file(std::to_string(i) + "_" + std::to_string(n) + ".pnm"));
      if (theirs.empty()) continue;  // djpeg refuses some factors
      CAPTURE(i);
      CAPTURE(n);
      const auto ours = jpeg::decode(files[i], scaled(n));
      REQUIRE(ours.ok());
      REQUIRE(max_difference(ours->view(), theirs.view()) == 0);
      ++compared;
    }
  }
  CHECK(compared > 50);
}

TEST_CASE("a scaled picture has its sides divided and rounded up, whatever the size") {
  for (const auto& [width, height] : {std::pair{1, 1}, {2, 3}, {7, 9}, {16, 17}, {33, 8}, {65, 31}}) {
    const auto file = *jpeg::encode(test_image(width, height).view());
    const auto info = *jpeg::read_info(file);
    for (const int n : {1, 2, 4, 8}) {
      const auto image = jpeg::decode(file, scaled(n));
      REQUIRE(image.ok());
      REQUIRE(image->width() == (width + n - 1) / n);
      REQUIRE(image->height() == (height + n - 1) / n);
      REQUIRE(jpeg::scaled_size(info, n).width == image->width());
      REQUIRE(jpeg::scaled_size(info, n).height == image->height());
    }
  }
  for (const int n : {0, -1, 3, 16}) {
    const auto refused = jpeg::decode(sound_gray().bytes, scaled(n));
    REQUIRE_FALSE(refused.ok());
    CHECK(refused.failure().error == Error::bad_argument);
  }
}

void require_crop(const std::vector<uint8_t>& file, const RgbImage& whole, const Crop& crop, int scale) {
  CAPTURE(crop.x);
  CAPTURE(crop.y);
  CAPTURE(crop.width);
  CAPTURE(crop.height);
  DecodeOptions options = scaled(scale);
  options.crop = crop;
  const auto part = jpeg::decode(file, options);
  REQUIRE(part.ok());
  const ConstRgbView expected{whole.pixel(crop.x, crop.y), crop.width, crop.height, whole.stride()};
  REQUIRE(max_difference(part->view(), expected) == 0);
}

TEST_CASE("a crop has exactly the pixels of the whole picture, at every scale and for every kind of file") {
  for (const auto& file : corpus()) {
    for (const int scale : {1, 2, 8}) {
      const auto whole = jpeg::decode(file, scaled(scale));
      REQUIRE(whole.ok());
      const int w = whole->width(), h = whole->height();
      require_crop(file, *whole, {0, 0, w, h}, scale);
      require_crop(file, *whole, {w - 1, h - 1, 1, 1}, scale);
      require_crop(file, *whole, {0, h / 2, w, 1}, scale);
      require_crop(file, *whole, {w / 2, 0, 1, h}, scale);
      require_crop(file, *whole, {w / 3, h / 3, (w + 2) / 3, (h + 2) / 3}, scale);
    }
  }
}

TEST_CASE("every single pixel, row and column can be had alone") {
  jpeg::EncodeOptions encode;
  encode.restart_interval_mcus = 2;
  const auto file = *jpeg::encode(test_image(70, 37).view(), encode);
  const auto whole = jpeg::decode(file);
  for (int x = 0; x < 70; ++x) require_crop(file, *whole, {x, (x * 7) % 37, 1, 1}, 1);
  for (int x = 0; x < 70; x += 3) require_crop(file, *whole, {x, 0, std::min(5, 70 - x), 37}, 1);
  for (int y = 0; y < 37; ++y) require_crop(file, *whole, {0, y, 70, 1}, 1);
}

TEST_CASE("a crop outside the picture is a bad argument") {
  const auto file = *jpeg::encode(test_image(20, 10).view());
  for (const Crop& crop : {Crop{0, 0, 21, 10},
                           {0, 0, 20, 11},
                           {1, 0, 20, 10},
                           {-1, 0, 5, 5},
                           {0, 0, 0, 5},
                           {5, 5, 2147483647, 1},
                           {20, 0, 1, 1}}) {
    DecodeOptions options;
    options.crop = crop;
    const auto refused = jpeg::decode(file, options);
    REQUIRE_FALSE(refused.ok());
    CHECK(refused.failure().error == Error::bad_argument);
  }
}

TEST_CASE("damage below a crop goes unnoticed, damage above it does not") {
  const auto file = *jpeg::encode(test_image(64, 64).view());
  const auto info = *jpeg::read_info(file);
  std::vector<uint8_t> cut(file.begin(), file.end() - static_cast<ptrdiff_t>((file.size() - info.header_bytes) / 4));
  DecodeOptions options;
  options.crop = Crop{0, 0, 64, 16};
  CHECK(jpeg::decode(cut, options).ok());
  options.crop = Crop{0, 56, 8, 8};
  CHECK_FALSE(jpeg::decode(cut, options).ok());
}

// Where the data of restart interval 1, 2, ... begin.
std::vector<size_t> restart_offsets(const std::vector<uint8_t>& file) {
  std::vector<size_t> offsets;
  for (size_t i = jpeg::read_info(file)->header_bytes; i + 1 < file.size(); ++i)
    if (file[i] == 0xFF && file[i + 1] >= 0xD0 && file[i + 1] <= 0xD7) offsets.push_back(i + 2);
  return offsets;
}

TEST_CASE("restart intervals that a crop does not need are not decoded, wherever they begin in a row") {
  for (const int interval : {1, 3, 4, 7, 11}) {
    CAPTURE(interval);
    jpeg::EncodeOptions encode;
    encode.restart_interval_mcus = interval;  // of 8 MCUs in a row, 6 rows
    const auto file = *jpeg::encode(test_image(128, 96).view(), encode);
    const auto whole = *jpeg::decode(file);
    for (const int scale : {1, 2}) {
      const auto shown = *jpeg::decode(file, scaled(scale));
      require_crop(file, shown, {100 / scale, 70 / scale, 20 / scale, 20 / scale}, scale);
      require_crop(file, shown, {0, 50 / scale, 128 / scale, 2}, scale);
    }
    // Undefined codes in the first interval: the whole picture is lost, the crop is not.
    auto damaged = file;
    const size_t begin = jpeg::read_info(file)->header_bytes, end = restart_offsets(file).front() - 2;
    for (size_t i = begin; i < end; ++i) damaged[i] = i % 2 == begin % 2 ? 0xFF : 0x00;
    CHECK_FALSE(jpeg::decode(damaged).ok());
    require_crop(damaged, whole, {100, 70, 20, 20}, 1);
  }
}

TEST_CASE("where a restart marker before a crop is missing, the crop is as damaged as the whole picture") {
  jpeg::EncodeOptions encode;
  encode.restart_interval_mcus = 4;
  auto file = *jpeg::encode(test_image(128, 96).view(), encode);
  file[restart_offsets(file)[1] - 1] = 0xD5;
  DecodeOptions options;
  options.crop = Crop{100, 70, 20, 20};
  CHECK_FALSE(jpeg::decode(file, options).ok());
  const auto whole = jpeg::decode_lenient(file);
  const auto part = jpeg::decode_lenient(file, options);
  REQUIRE(whole.ok());
  REQUIRE(part.ok());
  const ConstRgbView expected{whole->image.pixel(100, 70), 20, 20, whole->image.stride()};
  CHECK(max_difference(part->image.view(), expected) == 0);
}

TEST_CASE("a reused decoder crops and scales as the functions do") {
  const auto file = *jpeg::encode(test_image(50, 40).view());
  DecodeOptions options = scaled(2);
  options.crop = Crop{3, 4, 11, 9};
  const auto expected = jpeg::decode(file, options);
  jpeg::Decoder decoder(options);
  RgbImage out(11, 9);
  for (int i = 0; i < 2; ++i) {
    REQUIRE(decoder.decode_into(file, out.view()).ok());
    REQUIRE(max_difference(out.view(), expected->view()) == 0);
  }
}

TEST_CASE("scaled and cropped pictures do not depend on threads or instruction set") {
  jpeg::EncodeOptions encode;
  encode.restart_interval_mcus = jpeg::row_restart_interval(90, encode.subsampling);
  const auto file = *jpeg::encode(test_image(90, 80).view(), encode);
  for (const int n : {1, 2, 4, 8}) {
    DecodeOptions options = scaled(n);
    options.crop = Crop{1, 1, 7, 5};
    const auto expected = jpeg::decode(file, options);
    options.threads = 2;
    options.isa = Isa::scalar;
    REQUIRE(max_difference(jpeg::decode(file, options)->view(), expected->view()) == 0);
  }
}

}  // namespace
}  // namespace pac::test
