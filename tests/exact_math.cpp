#include "base/exact_math.h"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

namespace {

TEST_CASE("sine and cosine agree with the C library to 1e-13 over many turns") {
  for (int i = -20000; i <= 20000; ++i) {
    const double x = i * 0.00371;
    REQUIRE(std::abs(pac::exact_sin(x) - std::sin(x)) < 1e-13);
    REQUIRE(std::abs(pac::exact_cos(x) - std::cos(x)) < 1e-13);
  }
  CHECK(pac::exact_sin(0.0) == 0.0);
  CHECK(pac::exact_cos(0.0) == 1.0);
}

TEST_CASE("logarithm, exponential and power agree with the C library to 1e-13 relative") {
  for (double x = 1e-12; x < 1e12; x *= 1.37) {
    REQUIRE(std::abs(pac::exact_log(x) - std::log(x)) <= 1e-13 * std::abs(std::log(x)) + 1e-15);
    REQUIRE(std::abs(pac::exact_pow(x, 1.0 / 2.4) / std::pow(x, 1.0 / 2.4) - 1) < 1e-13);
  }
  for (double x = -600; x < 600; x += 0.731) REQUIRE(std::abs(pac::exact_exp(x) / std::exp(x) - 1) < 1e-13);
}

TEST_CASE("what is outside a function's domain has a defined value") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(pac::exact_sin(nan) == 0.0);
  CHECK(pac::exact_sin(1e300) == 0.0);
  CHECK(pac::exact_log(-1.0) == 0.0);
  CHECK(pac::exact_log(nan) == 0.0);
  CHECK(pac::exact_pow(0.0, 2.0) == 0.0);
  CHECK(pac::exact_exp(1e6) == 1e300 * (pac::exact_exp(1e6) / 1e300));
}

TEST_CASE("sRGB encoding and decoding are inverse and monotonic on the 8-bit codes") {
  double previous = -1;
  for (int code = 0; code < 256; ++code) {
    const double linear = pac::linear_from_srgb(code / 255.0);
    CHECK(linear > previous);
    previous = linear;
    CHECK(static_cast<int>(std::floor(pac::srgb_from_linear(linear) * 255 + 0.5)) == code);
  }
}

TEST_CASE("the bits are the same on every compiler and processor") {
  uint64_t hash = 14695981039346656037u;
  for (int i = 1; i < 2000; ++i) {
    const double values[] = {pac::exact_sin(i * 0.37), pac::exact_cos(i * 0.91), pac::exact_log(i * 0.013),
                             pac::exact_exp(i * 0.1 - 100), pac::exact_pow(i * 0.5, 0.4167)};
    for (const double value : values) {
      uint64_t bits;
      std::memcpy(&bits, &value, sizeof bits);
      hash = (hash ^ bits) * 1099511628211u;
    }
  }
  CHECK(hash == 2901962769915244246u);
}

}  // namespace
