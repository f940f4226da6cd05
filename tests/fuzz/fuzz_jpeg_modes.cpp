// Any bytes as a JPEG file: every way to decode it tells the same picture, on every instruction set and thread count.
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>

#include "base/hash.h"
#include "jpeg/pixel_io.h"

namespace {

using pac::jpeg::Damaged;
using pac::jpeg::DecodeOptions;
using pac::jpeg::PixelFormat;

void require(bool condition) {
  if (!condition) std::abort();
}

// Choices that depend on all bytes, so that a change anywhere may try another mode.
struct Choices {
  uint64_t state;
  int below(int n) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return static_cast<int>((state >> 33) % static_cast<uint64_t>(n));
  }
};

uint64_t digest(std::span<const uint8_t> bytes) {
  uint64_t sum = 0xCBF29CE484222325u;
  for (const uint8_t byte : bytes) sum = (sum ^ byte) * 0x100000001B3u;
  return sum;
}

struct Outcome {
  bool ok = false;
  uint64_t pixels = 0;
  int errors = 0, warnings = 0;
  bool is_damaged = false;
  bool operator==(const Outcome&) const = default;
};

Outcome lenient(std::span<const uint8_t> bytes, const DecodeOptions& options) {
  const auto image = pac::jpeg::decode_lenient(bytes, options);
  if (!image.ok()) return {};
  return {true, pac::hash_pixels(image->image.view()), image->errors, image->warnings, image->failure.has_value()};
}

// Rows as they come, put together.
Outcome by_rows(std::span<const uint8_t> bytes, const DecodeOptions& options, int width, int height) {
  pac::RgbImage image(width, height);
  const auto report = pac::jpeg::decode_rows(
      bytes, PixelFormat::rgb,
      [&](int y, std::span<const uint8_t> row) {
        require(y < height && row.size() == 3 * static_cast<size_t>(width));
        std::memcpy(image.row(y), row.data(), row.size());
        return true;
      },
      options, Damaged::keep);
  if (!report.ok()) return {};
  return {true, pac::hash_pixels(image.view()), report->errors, report->warnings, report->failure.has_value()};
}

void check_crop(std::span<const uint8_t> bytes, DecodeOptions options, const pac::RgbImage& whole, Choices& choices) {
  const int w = whole.width(), h = whole.height();
  pac::jpeg::Crop crop{choices.below(w), choices.below(h), 0, 0};
  crop.width = 1 + choices.below(w - crop.x);
  crop.height = 1 + choices.below(h - crop.y);
  options.crop = crop;
  const auto part = pac::jpeg::decode(bytes, options);
  require(part.ok() && part->width() == crop.width && part->height() == crop.height);
  for (int y = 0; y < crop.height; ++y)
    require(std::memcmp(part->row(y), whole.pixel(crop.x, crop.y + y), 3 * static_cast<size_t>(crop.width)) == 0);
  const auto damaged = pac::jpeg::decode_lenient(bytes.first(bytes.size() / 2), options);
  if (damaged.ok()) pac::hash_pixels(damaged->image.view());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::span<const uint8_t> bytes(data, size);
  Choices choices{digest(bytes)};
  DecodeOptions options;
  options.limits.max_pixels = 1 << 16;
  options.limits.max_bytes = 1 << 22;
  options.scale_denominator = 1 << choices.below(4);
  const auto info = pac::jpeg::read_info(bytes, options.limits);
  const Outcome expected = lenient(bytes, options);
  DecodeOptions other = options;
  other.isa = pac::Isa::scalar;
  other.threads = 2;
  require(lenient(bytes, other) == expected);
  if (expected.ok) {
    const auto sides = pac::jpeg::scaled_size(*info, options.scale_denominator);
    require(by_rows(bytes, options, sides.width, sides.height) == expected);
  }
  const auto whole = pac::jpeg::decode(bytes, options);
  require(whole.ok() == (expected.ok && !expected.is_damaged));
  const auto planes = pac::jpeg::decode_planes(bytes, options, Damaged::keep);
  if (planes.ok())
    for (const auto& plane : planes->planes) digest(plane.samples);
  if (!whole.ok()) return 0;
  require(pac::hash_pixels(whole->view()) == expected.pixels && planes.ok());
  check_crop(bytes, options, *whole, choices);
  check_crop(bytes, other, *whole, choices);
  return 0;
}
