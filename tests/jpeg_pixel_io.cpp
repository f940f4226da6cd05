// Pixel formats, strides, rows one at a time and planes: always the same picture.
#include <doctest/doctest.h>

#include <cstring>
#include <vector>

#include "jpeg/pixel_io.h"
#include "tests/support/jpeg_file.h"
#include "tests/support/peer.h"

namespace pac::test {
namespace {

using jpeg::PixelFormat;
using jpeg::PixelView;

constexpr PixelFormat kColorFormats[] = {PixelFormat::rgb,  PixelFormat::bgr,  PixelFormat::rgbx,
                                         PixelFormat::bgrx, PixelFormat::rgba, PixelFormat::bgra};

bool is_blue_first(PixelFormat format) {
  return format == PixelFormat::bgr || format == PixelFormat::bgrx || format == PixelFormat::bgra;
}

// Whether `pixel` of that format is `rgb`, opaque.
bool is_pixel(const uint8_t* pixel, PixelFormat format, const uint8_t* rgb) {
  const int red = is_blue_first(format) ? 2 : 0;
  const bool opaque = jpeg::bytes_per_pixel(format) < 4 || pixel[3] == 255;
  return pixel[red] == rgb[0] && pixel[1] == rgb[1] && pixel[2 - red] == rgb[2] && opaque;
}

void require_same(const RgbImage& expected, const uint8_t* row, int y, PixelFormat format) {
  const int n = jpeg::bytes_per_pixel(format);
  for (int x = 0; x < expected.width(); ++x) REQUIRE(is_pixel(row + n * x, format, expected.pixel(x, y)));
}

TEST_CASE("every pixel format, top-down and bottom-up, holds the picture that decode gives") {
  const auto file = *jpeg::encode(test_image(37, 29).view());
  const auto expected = jpeg::decode(file);
  for (const PixelFormat format : kColorFormats) {
    const ptrdiff_t stride = 37 * jpeg::bytes_per_pixel(format) + 5;
    std::vector<uint8_t> buffer(static_cast<size_t>(stride) * 29, 0xA5);
    for (const bool bottom_up : {false, true}) {
      PixelView view{buffer.data(), 37, 29, stride, format};
      if (bottom_up) view = {buffer.data() + 28 * stride, 37, 29, -stride, format};
      REQUIRE(jpeg::decode_pixels(file, view).ok());
      for (int y = 0; y < 29; ++y) require_same(*expected, view.row(y), y, format);
    }
    for (int y = 0; y < 29; ++y) REQUIRE(buffer[static_cast<size_t>(stride * (y + 1) - 1)] == 0xA5);  // between rows
  }
}

TEST_CASE("gray pixels are luma: the Y samples of a YCbCr file, computed of an RGB file") {
  const RgbImage image = test_image(33, 18);
  const auto file = *jpeg::encode(image.view());
  const auto planes = jpeg::decode_planes(file);
  REQUIRE(planes.ok());
  std::vector<uint8_t> gray(33 * 18);
  REQUIRE(jpeg::decode_pixels(file, {gray.data(), 33, 18, 33, PixelFormat::gray}).ok());
  CHECK(gray == planes->planes[0].samples);
}

TEST_CASE("rows arrive in order, once each, and make the same picture, also cropped and scaled") {
  jpeg::EncodeOptions encode;
  for (const auto subsampling : {jpeg::Subsampling::yuv444, jpeg::Subsampling::yuv422, jpeg::Subsampling::yuv420}) {
    encode.subsampling = subsampling;
    const auto file = *jpeg::encode(test_image(45, 50).view(), encode);
    for (const int scale : {1, 4}) {
      for (const bool crop : {false, true}) {
        jpeg::DecodeOptions options;
        options.scale_denominator = scale;
        if (crop) options.crop = jpeg::Crop{2, 3, 7, 9};
        const auto expected = jpeg::decode(file, options);
        int next = 0;
        const auto report = jpeg::decode_rows(
            file, PixelFormat::bgrx,
            [&](int y, std::span<const uint8_t> row) {
              REQUIRE(y == next++);
              REQUIRE(row.size() == static_cast<size_t>(4 * expected->width()));
              require_same(*expected, row.data(), y, PixelFormat::bgrx);
              return true;
            },
            options);
        REQUIRE(report.ok());
        REQUIRE(next == expected->height());
        REQUIRE(report->height == next);
      }
    }
  }
}

TEST_CASE("rows of progressive files and of files with several scans arrive too") {
  const std::string folder = PAC_SOURCE_DIR "/tests/fuzz/corpus/jpeg_decode/";
  for (const char* name : {"progressive.jpg", "scans_sep.jpg", "gray22.jpg", "rgb.jpg"}) {
    const auto file = read_bytes(folder + name);
    const auto expected = jpeg::decode(file);
    int rows = 0;
    REQUIRE(jpeg::decode_rows(file, PixelFormat::rgb, [&](int y, std::span<const uint8_t> row) {
              require_same(*expected, row.data(), y, PixelFormat::rgb);
              return ++rows > 0;
            }).ok());
    REQUIRE(rows == expected->height());
  }
}

TEST_CASE("a sink that wants no more rows gets none") {
  const auto file = *jpeg::encode(test_image(16, 200).view());
  int rows = 0;
  const auto report =
      jpeg::decode_rows(file, PixelFormat::rgb, [&](int, std::span<const uint8_t>) { return ++rows < 5; });
  CHECK(report.ok());
  CHECK(rows == 5);
}

TEST_CASE("rows need no memory for the picture: a limit below its size does not matter") {
  const auto file = *jpeg::encode(test_image(64, 2000).view());
  jpeg::DecodeOptions options;
  options.limits.max_bytes = 16 * 1024;
  CHECK(jpeg::decode(file, options).failure().error == Error::limit_exceeded);
  int rows = 0;
  REQUIRE(jpeg::decode_rows(
              file, PixelFormat::rgb, [&](int, std::span<const uint8_t>) { return ++rows > 0; }, options)
              .ok());
  CHECK(rows == 2000);
}

TEST_CASE("planes are the samples that the picture is made of") {
  const RgbImage image = test_image(21, 13);
  jpeg::EncodeOptions options;
  options.subsampling = jpeg::Subsampling::yuv420;
  const auto planes = jpeg::decode_planes(*jpeg::encode(image.view(), options));
  REQUIRE(planes.ok());
  REQUIRE(planes->planes.size() == 3);
  CHECK(planes->color == jpeg::ColorModel::ycc);
  CHECK(planes->planes[0].width == 21);
  CHECK(planes->planes[1].width == 11);
  CHECK(planes->planes[2].height == 7);
  CHECK(planes->planes[0].h == 2);
}

TEST_CASE("damaged files: a failure strictly, rows and a report leniently") {
  auto file = *jpeg::encode(test_image(40, 40).view());
  file.resize(file.size() - 100);
  const auto count = [](int& rows) { return [&rows](int, std::span<const uint8_t>) { return ++rows > 0; }; };
  int strict_rows = 0, rows = 0;
  CHECK_FALSE(jpeg::decode_rows(file, PixelFormat::rgb, count(strict_rows)).ok());
  const auto report = jpeg::decode_rows(file, PixelFormat::rgb, count(rows), {}, jpeg::Damaged::keep);
  REQUIRE(report.ok());
  CHECK(report->failure.has_value());
  CHECK(report->warnings > 0);
  CHECK(rows == 40);
  CHECK(strict_rows < 40);
}

}  // namespace
}  // namespace pac::test
