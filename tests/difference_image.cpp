#include <doctest/doctest.h>

#include <cstdint>

#include "base/kernels/kernels.h"

namespace {

TEST_CASE("zero difference maps to 127, and every difference survives the round trip within its lost bit") {
  for (int h = 0; h < 256; ++h) {
    for (int l = 0; l < 256; ++l) {
      const auto high = static_cast<uint8_t>(h), low = static_cast<uint8_t>(l);
      uint8_t d, c;
      pac::kernels().pixel.difference_row(&high, &low, &d, 1);
      pac::kernels().pixel.composite_row(&low, &d, &c, 1);
      if (h == l) REQUIRE(d == 127);
      REQUIRE(d <= 254);
      REQUIRE((h - c) * (h - c) <= 1);
      if ((h - l) % 2 == 0) REQUIRE(c == h);
    }
  }
}

}  // namespace
