// Pixel formats, strides, rows one at a time and planes: always the same picture.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
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

// The picture as `format`, with a gap behind each row.
std::vector<uint8_t> converted(const RgbImage& image, PixelFormat format, ptrdiff_t stride) {
  const int n = jpeg::bytes_per_pixel(format), red = is_blue_first(format) ? 2 : 0;
  std::vector<uint8_t> bytes(static_cast<size_t>(stride * image.height()), 0x77);
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      uint8_t* out = bytes.data() + y * stride + n * x;
      out[red] = image.pixel(x, y)[0];
      out[1] = image.pixel(x, y)[1];
      out[2 - red] = image.pixel(x, y)[2];
    }
  return bytes;
}

TEST_CASE("pixels of any format and rows from a callback encode to the bytes that the RGB image gives") {
  const RgbImage image = test_image(39, 45);
  for (const auto effort : {jpeg::Effort::fast, jpeg::Effort::normal, jpeg::Effort::best}) {
    jpeg::EncodeOptions options = jpeg::options_for(effort, jpeg::Tune::psnr, 60);
    options.restart_interval_mcus = 3;
    options.threads = 2;
    const auto expected = *jpeg::encode(image.view(), options);
    for (const PixelFormat format : kColorFormats) {
      const ptrdiff_t stride = 39 * jpeg::bytes_per_pixel(format) + 3;
      const auto bytes = converted(image, format, stride);
      REQUIRE(*jpeg::encode_pixels({bytes.data(), 39, 45, stride, format}, options) == expected);
      int next = 0;
      const auto rows = jpeg::encode_rows(
          39, 45, format,
          [&](int y, std::span<uint8_t> row) {
            REQUIRE(y == next++);
            std::memcpy(row.data(), bytes.data() + y * stride, row.size());
            return true;
          },
          options);
      REQUIRE(*rows == expected);
      REQUIRE(next == 45);
    }
  }
}

TEST_CASE("bottom-up pixels encode as the picture turned over") {
  const RgbImage image = test_image(20, 12);
  RgbImage turned(20, 12);
  for (int y = 0; y < 12; ++y) std::memcpy(turned.row(y), image.row(11 - y), 60);
  const auto bytes = converted(image, PixelFormat::bgra, 80);
  CHECK(*jpeg::encode_pixels({bytes.data() + 11 * 80, 20, 12, -80, PixelFormat::bgra}) == *jpeg::encode(turned.view()));
}

TEST_CASE("gray pixels and gray rows encode as a gray image") {
  GrayImage gray(31, 18);
  for (int y = 0; y < 18; ++y)
    for (int x = 0; x < 31; ++x) gray.row(y)[x] = static_cast<uint8_t>(5 * x + 3 * y);
  const auto expected = *jpeg::encode_gray(gray.view());
  CHECK(*jpeg::encode_pixels({gray.row(0), 31, 18, gray.stride(), PixelFormat::gray}) == expected);
  CHECK(*jpeg::encode_rows(31, 18, PixelFormat::gray, [&](int y, std::span<uint8_t> row) {
    std::memcpy(row.data(), gray.row(y), row.size());
    return true;
  }) == expected);
}

TEST_CASE("a receiver gets the file in pieces; one that refuses, or a source without rows, ends encoding") {
  const RgbImage image = test_image(200, 160);
  const auto source = [&](int y, std::span<uint8_t> row) {
    std::memcpy(row.data(), image.row(y), row.size());
    return true;
  };
  jpeg::EncodeOptions options;
  options.quality = 95;
  options.huffman = jpeg::Huffman::standard;
  std::vector<uint8_t> file;
  int pieces = 0;
  const auto size = jpeg::encode_rows(
      200, 160, PixelFormat::rgb, source,
      [&](std::span<const uint8_t> bytes) {
        file.insert(file.end(), bytes.begin(), bytes.end());
        return ++pieces > 0;
      },
      options);
  REQUIRE(size.ok());
  CHECK(*size == file.size());
  CHECK(pieces > 1);
  CHECK(file == *jpeg::encode(image.view(), options));

  const auto refused = jpeg::encode_rows(
      200, 160, PixelFormat::rgb, source, [](std::span<const uint8_t>) { return false; }, options);
  REQUIRE_FALSE(refused.ok());
  CHECK(refused.failure().error == Error::out_of_space);
  const auto starved = jpeg::encode_rows(
      200, 160, PixelFormat::rgb, [](int y, std::span<uint8_t>) { return y < 100; }, options);
  REQUIRE_FALSE(starved.ok());
  CHECK(starved.failure().error == Error::bad_argument);
}

PlaneView<const uint8_t> view_of(const jpeg::SamplePlane& plane) {
  return {plane.samples.data(), plane.width, plane.height, plane.width};
}

TEST_CASE("planes that were decoded encode again without a change of size or color, in any sampling") {
  const RgbImage image = test_image(53, 38);
  const jpeg::SamplingFactors kinds[] = {
      {}, {{2, 1, 1}, {2, 1, 1}}, {{4, 1, 1}, {1, 1, 1}}, {{1, 2, 1}, {1, 2, 1}}, {{3, 2, 1}, {1, 1, 2}}};
  for (const auto& sampling : kinds) {
    jpeg::EncodeOptions options;
    options.quality = 100;
    options.sampling = sampling;
    const auto first = jpeg::decode_planes(*jpeg::encode(image.view(), options));
    REQUIRE(first.ok());
    const jpeg::YccPlanes planes{53, 38, view_of(first->planes[0]), view_of(first->planes[1]),
                                 view_of(first->planes[2])};
    const auto file = jpeg::encode_planes(planes, options);
    REQUIRE(file.ok());
    const auto second = jpeg::decode_planes(*file);
    for (size_t c = 0; c < 3; ++c) {
      REQUIRE(second->planes[c].width == first->planes[c].width);
      int worst = 0;
      for (size_t i = 0; i < first->planes[c].samples.size(); ++i)
        worst = std::max(worst, std::abs(first->planes[c].samples[i] - second->planes[c].samples[i]));
      REQUIRE(worst <= 2);
    }
    jpeg::YccPlanes wrong = planes;
    wrong.cb.width += 1;
    CHECK(jpeg::encode_planes(wrong, options).failure().error == Error::bad_argument);
  }
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
  CHECK(report->errors == 2);  // data and EOI are missing
  CHECK(rows == 40);
  CHECK(strict_rows < 40);
}

}  // namespace
}  // namespace pac::test
