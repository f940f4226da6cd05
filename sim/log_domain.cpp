#include "sim/log_domain.h"

#include <algorithm>

#include "base/fixed_log2.h"

namespace pac::sim {

namespace {

constexpr int64_t log2_of(uint32_t n) {
  return fixed_log2(n, 20);
}

constexpr int64_t kZero = log2_of(kLogOffset), kWhole = log2_of(kLogOffset + 255) - kZero;

// Of the code of v, in 2^-8.
constexpr int64_t fine_code(uint32_t v) {
  return (log2_of(kLogOffset + v) - kZero) * 255 * 256 / kWhole;
}

constexpr auto kCodes = [] {
  std::array<uint8_t, 256> codes{};
  for (uint32_t v = 0; v < 256; ++v) codes[v] = static_cast<uint8_t>((fine_code(v) + 128) / 256);
  return codes;
}();

constexpr auto kValues = [] {
  std::array<uint8_t, 256> values{};
  uint32_t v = 0;
  for (int64_t code = 0; code < 256; ++code) {
    const auto distance = [&](uint32_t of) {
      const int64_t d = fine_code(of) - code * 256;
      return d < 0 ? -d : d;
    };
    while (v < 255 && distance(v + 1) <= distance(v)) ++v;
    values[static_cast<size_t>(code)] = static_cast<uint8_t>(v);
  }
  return values;
}();

}  // namespace

const std::array<uint8_t, 256>& log_codes() {
  return kCodes;
}

const std::array<uint8_t, 256>& values_of_log_codes() {
  return kValues;
}

void log_from_rgb(ConstRgbView picture, RgbView codes) {
  PAC_ASSERT(picture.width == codes.width && picture.height == codes.height);
  for (int y = 0; y < picture.height; ++y) {
    const uint8_t* from = picture.row(y);
    std::transform(from, from + 3 * picture.width, codes.row(y), [](uint8_t v) { return kCodes[v]; });
  }
}

void rgb_from_log(ConstRgbView low, ConstRgbView codes, RgbView shown) {
  PAC_ASSERT(low.width == codes.width && low.height == codes.height);
  PAC_ASSERT(low.width == shown.width && low.height == shown.height);
  for (int y = 0; y < low.height; ++y) {
    const uint8_t* from = codes.row(y);
    std::transform(from, from + 3 * low.width, low.row(y), shown.row(y), [](uint8_t code, uint8_t v) {
      return static_cast<uint8_t>(std::clamp(v + kValues[code] - kValues[kCodes[v]], 0, 255));
    });
  }
}

}  // namespace pac::sim
