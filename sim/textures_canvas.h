// Helpers for writing a texture: a function of the texel's place becomes an image, a height field becomes relief.
#pragma once

#include <cstdint>
#include <vector>

#include "base/image.h"
#include "sim/textures_noise.h"

namespace pac::sim {

inline void put_texel(RgbaImage& image, int x, int y, const glm::vec3& color) {
  uint8_t* texel = image.pixel(x, y);
  for (int c = 0; c < 3; ++c) texel[c] = static_cast<uint8_t>(clamp01(color[c]) * 255.0f + 0.5f);
  texel[3] = 255;
}

// Calls color(u, v) with the texel centers' coordinates in (0, 1).
template <class Fn>
RgbaImage paint(int width, int height, Fn&& color) {
  RgbaImage image(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      put_texel(image, x, y,
                color((static_cast<float>(x) + 0.5f) / static_cast<float>(width),
                      (static_cast<float>(y) + 0.5f) / static_cast<float>(height)));
  return image;
}

// A height a texel, for relief().
struct HeightField {
  int width = 0, height = 0;
  std::vector<float> values;

  HeightField(int w, int h) : width(w), height(h), values(static_cast<size_t>(w) * static_cast<size_t>(h)) {}
  float& at(int x, int y) {
    return values[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)];
  }
  float wrapped(int x, int y) const {
    const int xx = (x + width) % width, yy = (y + height) % height;
    return values[static_cast<size_t>(yy) * static_cast<size_t>(width) + static_cast<size_t>(xx)];
  }
};

// Lights the relief from the upper left: each texel times 1 + strength * slope, slope clamped to [-1, 1].
inline void relief(RgbaImage& image, const HeightField& field, float strength) {
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      const float slope = field.wrapped(x + 1, y + 1) - field.wrapped(x - 1, y - 1);
      const float gain = 1.0f + strength * (slope > 1.0f ? 1.0f : (slope < -1.0f ? -1.0f : slope));
      uint8_t* texel = image.pixel(x, y);
      for (int c = 0; c < 3; ++c)
        texel[c] = static_cast<uint8_t>(clamp01(static_cast<float>(texel[c]) * gain / 255.0f) * 255.0f + 0.5f);
    }
  }
}

}  // namespace pac::sim
