// Mip chains: exact box filter for even and odd sizes, with 8 fractional bits kept between levels.
#include <algorithm>
#include <utility>

#include "raster/scene.h"

namespace pac::raster {
namespace {

// RGBA in 8.8 fixed point.
struct FixedImage {
  int width = 0, height = 0;
  std::vector<uint16_t> samples;
};

// What destination texel i takes along one axis of `size` texels. Even size: two texels, one half each. Odd size
// 2 d + 1: the interval [i (2 d + 1) / d, (i + 1) (2 d + 1) / d) covers parts d - i, d and i + 1 of three texels.
struct BoxTaps {
  int first = 0, count = 0;
  uint64_t weight[3] = {0, 0, 0};
  uint64_t total = 0;
};

BoxTaps box_taps(int i, int size) {
  if (size == 1) return {0, 1, {1, 0, 0}, 1};
  if (size % 2 == 0) return {2 * i, 2, {1, 1, 0}, 2};
  const auto d = static_cast<uint64_t>(size / 2), at = static_cast<uint64_t>(i);
  return {2 * i, 3, {d - at, d, at + 1}, 2 * d + 1};
}

FixedImage halved(const FixedImage& source) {
  FixedImage half{std::max(source.width / 2, 1), std::max(source.height / 2, 1), {}};
  half.samples.resize(static_cast<size_t>(half.width) * static_cast<size_t>(half.height) * 4);
  uint16_t* out = half.samples.data();
  for (int y = 0; y < half.height; ++y) {
    const BoxTaps rows = box_taps(y, source.height);
    for (int x = 0; x < half.width; ++x) {
      const BoxTaps columns = box_taps(x, source.width);
      const uint64_t total = rows.total * columns.total;  // < 2^32
      for (int c = 0; c < 4; ++c) {
        uint64_t sum = total / 2;  // < 2^48 at the end
        for (int j = 0; j < rows.count; ++j)
          for (int i = 0; i < columns.count; ++i) {
            const size_t at = static_cast<size_t>(rows.first + j) * static_cast<size_t>(source.width) +
                              static_cast<size_t>(columns.first + i);
            sum += rows.weight[j] * columns.weight[i] * source.samples[4 * at + static_cast<size_t>(c)];
          }
        *out++ = static_cast<uint16_t>(sum / total);
      }
    }
  }
  return half;
}

void append_level(const FixedImage& image, Texture& texture) {
  Texture::Level level{image.width, image.height, image.width + 1, texture.texels.size() / 4};
  texture.levels.push_back(level);
  texture.texels.resize(texture.texels.size() +
                        4 * static_cast<size_t>(level.pitch) * static_cast<size_t>(level.height));
  uint8_t* out = texture.texels.data() + 4 * level.offset;
  const uint16_t* in = image.samples.data();
  for (int y = 0; y < level.height; ++y) {
    uint8_t* const row = out;
    for (int i = 0; i < 4 * level.width; ++i) *out++ = static_cast<uint8_t>((*in++ + 128) >> 8);
    out = std::copy(row, row + 4, out);
  }
}

}  // namespace

Texture make_texture(std::string name, const RgbaImage& image) {
  Texture texture;
  texture.name = std::move(name);
  if (image.empty()) return texture;
  FixedImage level{image.width(), image.height(), {}};
  level.samples.reserve(static_cast<size_t>(level.width) * static_cast<size_t>(level.height) * 4);
  for (int y = 0; y < level.height; ++y)
    for (int i = 0; i < 4 * level.width; ++i) level.samples.push_back(static_cast<uint16_t>(image.row(y)[i] << 8));
  append_level(level, texture);
  while (level.width > 1 || level.height > 1) {
    level = halved(level);
    append_level(level, texture);
  }
  return texture;
}

}  // namespace pac::raster
