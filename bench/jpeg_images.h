// A picture to measure with where no photograph may be shipped.
#pragma once

#include <cstdint>

#include "base/image.h"

namespace pac::bench {

// Octaves of smooth noise with amplitudes that fall as in photographs (about 1/f), three channels that mostly agree,
// and a grain of a few levels. The same on every machine.
inline RgbImage photograph_like(int width, int height) {
  const auto lattice = [](int x, int y, int octave, int channel) {
    uint32_t h = static_cast<uint32_t>(x) * 0x9E3779B1u ^ static_cast<uint32_t>(y) * 0x85EBCA77u ^
                 static_cast<uint32_t>(8 * octave + channel) * 0xC2B2AE3Du;
    h = (h ^ h >> 15) * 0x2C1B3C6Du;
    return static_cast<float>(h >> 16 & 1023) / 1023.0f - 0.5f;
  };
  RgbImage image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      float sum[4] = {};  // what the channels share, and each one's own
      for (int octave = 0; octave < 7; ++octave) {
        const int cell = 256 >> octave, cx = x / cell, cy = y / cell;
        const float fx = static_cast<float>(x % cell) / static_cast<float>(cell);
        const float fy = static_cast<float>(y % cell) / static_cast<float>(cell);
        const float amplitude = 110.0f / static_cast<float>(1 << octave) * (octave > 3 ? 1.3f : 1.0f);
        for (int c = 0; c < (octave < 4 ? 4 : 1); ++c) {
          const float top = lattice(cx, cy, octave, c) * (1 - fx) + lattice(cx + 1, cy, octave, c) * fx;
          const float bottom = lattice(cx, cy + 1, octave, c) * (1 - fx) + lattice(cx + 1, cy + 1, octave, c) * fx;
          sum[c] += amplitude * (top * (1 - fy) + bottom * fy);
        }
      }
      for (int c = 0; c < 3; ++c) {
        const float value = 128.0f + sum[0] + 0.4f * sum[c + 1] + 4.0f * lattice(x, y, 9, c);
        image.pixel(x, y)[c] = static_cast<uint8_t>(value < 0 ? 0 : value > 255 ? 255 : value);
      }
    }
  }
  return image;
}

}  // namespace pac::bench
