#include "tests/support/stb_jpeg.h"

#include <doctest/doctest.h>

#include <cstdlib>
#include <cstring>
#include <string_view>

#if __has_include(<stb/stb_image.h>)
#define PAC_HAVE_STB 1
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_JPEG
#define STBI_NO_STDIO
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop
#endif

namespace pac::test {

#ifdef PAC_HAVE_STB

bool have_stb() {
  return true;
}

RgbImage stb_decode(std::span<const uint8_t> file) {
  int width = 0, height = 0, n_channels = 0;
  uint8_t* pixels = stbi_load_from_memory(file.data(), static_cast<int>(file.size()), &width, &height, &n_channels, 3);
  if (pixels == nullptr) return {};
  RgbImage image(width, height);
  const auto row = 3 * static_cast<size_t>(width);
  for (int y = 0; y < height; ++y) std::memcpy(image.row(y), pixels + static_cast<size_t>(y) * row, row);
  stbi_image_free(pixels);
  return image;
}

#else

bool have_stb() {
  const char* ci = std::getenv("CI");
  if (ci != nullptr && std::string_view(ci) == "true") {
    FAIL_CHECK("stb_image.h was missing when the tests were built");
  } else {
    MESSAGE("skipped: stb_image.h was missing when the tests were built");
  }
  return false;
}

RgbImage stb_decode(std::span<const uint8_t>) {
  return {};
}

#endif

}  // namespace pac::test
