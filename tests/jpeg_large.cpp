// Pictures large enough for the look-up of pairs decode as small ones do, sound or damaged.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "jpeg/jpeg.h"

namespace pac::test {
namespace {

constexpr int kWidth = 520, kHeight = 512, kSmallHeight = 128;

// Smooth at the left, noisy at the right: blocks with no, few and many levels.
RgbImage picture() {
  RgbImage image(kWidth, kHeight);
  uint32_t state = 1;
  for (int y = 0; y < kHeight; ++y)
    for (int i = 0; i < 3 * kWidth; ++i) {
      state = state * 1664525 + 1013904223;
      const int noise = static_cast<int>(state >> 24) * (i / 3) / kWidth;
      image.row(y)[i] = static_cast<uint8_t>((i / 12 + y / 2) / 4 + noise / 2);
    }
  return image;
}

// Standard tables, so that the data of the upper rows are the same bytes in a file of them alone.
std::vector<uint8_t> file_of(const RgbImage& image, int height, int quality, jpeg::Subsampling subsampling) {
  jpeg::EncodeOptions options;
  options.quality = quality;
  options.subsampling = subsampling;
  options.huffman = jpeg::Huffman::standard;
  ConstRgbView view = image.view();
  view.height = height;
  return *jpeg::encode(view, options);
}

// Rows that lean on none below the small picture.
constexpr int kSameRows = kSmallHeight - 1;

void require_same_rows(const RgbImage& large, const RgbImage& small, int n_rows) {
  for (int y = 0; y < n_rows; ++y) REQUIRE(std::equal(large.row(y), large.row(y) + 3 * kWidth, small.row(y)));
}

TEST_CASE("a large picture's upper rows are those of a small picture, at any quality and subsampling") {
  const RgbImage image = picture();
  for (const auto subsampling : {jpeg::Subsampling::yuv420, jpeg::Subsampling::yuv422, jpeg::Subsampling::yuv444}) {
    for (const int quality : {3, 30, 60, 85, 97, 100}) {
      const auto large = jpeg::decode(file_of(image, kHeight, quality, subsampling));
      const auto small = jpeg::decode(file_of(image, kSmallHeight, quality, subsampling));
      REQUIRE(large.ok());
      REQUIRE(small.ok());
      require_same_rows(*large, *small, kSameRows);
    }
  }
}

TEST_CASE("damage does to a large picture's upper rows what it does to a small picture") {
  const RgbImage image = picture();
  for (const int quality : {30, 90}) {
    const auto large = file_of(image, kHeight, quality, jpeg::Subsampling::yuv420);
    const auto small = file_of(image, kSmallHeight, quality, jpeg::Subsampling::yuv420);
    const auto info = jpeg::read_info(small);
    REQUIRE(info.ok());
    const size_t begin = info->header_bytes, end = small.size() - 64;
    for (size_t at = begin; at < end; at += (end - begin) / 40) {
      if (small[at] == 0xFF || small[at - 1] == 0xFF) continue;
      auto damaged_large = large, damaged_small = small;
      REQUIRE(large[at] == small[at]);
      const auto value = static_cast<uint8_t>((small[at] ^ 0x5A) == 0xFF ? 0 : small[at] ^ 0x5A);
      damaged_large[at] = damaged_small[at] = value;
      const auto a = jpeg::decode_lenient(damaged_large), b = jpeg::decode_lenient(damaged_small);
      REQUIRE(a.ok());
      REQUIRE(b.ok());
      // What follows may end sooner in the small one: only where both go on is it the same data.
      const int n_rows = b->failure ? 0 : kSmallHeight / 2;
      require_same_rows(a->image, b->image, n_rows);
      if (b->failure && a->failure && b->failure->byte_offset + 64 < small.size()) {
        CHECK(a->failure->byte_offset == b->failure->byte_offset);
        require_same_rows(a->image, b->image, kSameRows);
      }
    }
  }
}

}  // namespace
}  // namespace pac::test
