#include <doctest/doctest.h>

#include <cstdint>
#include <vector>

#include "base/image.h"
#include "jpeg/jpeg.h"

namespace {

using pac::jpeg::EncodeOptions;
using pac::jpeg::Huffman;
using pac::jpeg::Subsampling;

// Smooth colors with a few edges: what a JPEG codec is made for.
pac::RgbImage smooth_image(int width, int height) {
  pac::RgbImage image(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      uint8_t* p = image.pixel(x, y);
      p[0] = static_cast<uint8_t>(100 + (x * 3 + y) % 60 / 4 + (x / 16 % 2) * 20);
      p[1] = static_cast<uint8_t>(90 + y % 64 / 2);
      p[2] = static_cast<uint8_t>(120 + (x + y) % 128 / 4);
    }
  return image;
}

double mean_square_error(const pac::RgbImage& a, const pac::RgbImage& b) {
  double sum = 0;
  for (int y = 0; y < a.height(); ++y)
    for (int x = 0; x < 3 * a.width(); ++x) sum += (a.row(y)[x] - b.row(y)[x]) * (a.row(y)[x] - b.row(y)[x]);
  return sum / (3.0 * a.width() * a.height());
}

TEST_CASE("decode(encode(image)) is close to the image for every subsampling, Huffman mode, restart and odd size") {
  for (const auto& [width, height] : {std::pair{1, 1}, {3, 5}, {16, 16}, {17, 33}, {100, 41}}) {
    const pac::RgbImage image = smooth_image(width, height);
    for (const auto subsampling : {Subsampling::yuv444, Subsampling::yuv422, Subsampling::yuv420}) {
      for (const auto huffman : {Huffman::standard, Huffman::optimal}) {
        for (const int restart : {0, 1, 3}) {
          EncodeOptions options;
          options.quality = 95;
          options.subsampling = subsampling;
          options.huffman = huffman;
          options.restart_interval_mcus = restart;
          const auto bytes = pac::jpeg::encode(image.view(), options);
          REQUIRE(bytes.ok());
          const auto decoded = pac::jpeg::decode(*bytes);
          REQUIRE(decoded.ok());
          REQUIRE(decoded->width() == width);
          REQUIRE(decoded->height() == height);
          REQUIRE(mean_square_error(image, *decoded) < 12.0);
        }
      }
    }
  }
}

TEST_CASE("the picture does not depend on how it is entropy-coded") {
  const pac::RgbImage image = smooth_image(75, 50);
  EncodeOptions options;
  options.huffman = Huffman::standard;
  const auto reference = pac::jpeg::decode(*pac::jpeg::encode(image.view(), options));
  for (const int restart : {0, 1, 2, 1000}) {
    options.huffman = Huffman::optimal;
    options.restart_interval_mcus = restart;
    const auto decoded = pac::jpeg::decode(*pac::jpeg::encode(image.view(), options));
    REQUIRE(mean_square_error(*reference, *decoded) == 0.0);
  }
}

}  // namespace
