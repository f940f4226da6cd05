#include <doctest/doctest.h>

#include <cstdint>
#include <vector>

#include "base/deflate.h"
#include "base/image_io.h"
#include "base/inflate.h"

namespace {

pac::RgbImage make_picture(int width, int height) {
  pac::RgbImage image(width, height);
  uint32_t state = 1;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      state = state * 1664525 + 1013904223;
      image.pixel(x, y)[0] = static_cast<uint8_t>(x);
      image.pixel(x, y)[1] = static_cast<uint8_t>(y * 3);
      image.pixel(x, y)[2] = static_cast<uint8_t>(x + y + static_cast<int>(state >> 30));
    }
  }
  return image;
}

TEST_CASE("a written PNG decodes to the same pixels") {
  for (int width : {1, 2, 3, 7, 64, 257}) {
    const pac::RgbImage image = make_picture(width, 33);
    const auto file = pac::encode_png(image.view());
    const auto decoded = pac::decode_rgb(file);
    REQUIRE_MESSAGE(decoded.ok(), decoded.failure().text);
    REQUIRE(decoded->width() == width);
    for (int y = 0; y < 33; ++y)
      REQUIRE(std::memcmp(image.row(y), decoded->row(y), static_cast<size_t>(width) * 3) == 0);
  }
}

TEST_CASE("a PNG of a smooth picture is smaller than its pixels") {
  const pac::RgbImage image = make_picture(256, 256);
  const auto file = pac::encode_png(image.view());
  CHECK(file.size() < 256 * 256 * 3 / 4);
}

}  // namespace
