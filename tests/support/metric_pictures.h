// Pictures for which the perceptual metrics' reference programs were asked once: the same samples on every system, from
// integer arithmetic alone.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>

#include "base/image.h"
#include "tests/support/generators.h"

namespace pac::test {

// A rendering-like picture: shaded walls with a bright disk, a striped texture, thin lines, a smooth ramp and grain.
inline RgbImage metric_scene(int width, int height) {
  RgbImage image(width, height);
  Random random(1995);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const int u = x * 256 / width, v = y * 256 / height;  // 0..255 whatever the size
      int color[3] = {60 + u / 2, 50 + (u + v) / 4, 90 + v / 3};
      if (u > 150 && v > 96) {  // striped texture, 6 pixels wide
        const int stripe = (x + 2 * y) / 6 % 2;
        color[0] = stripe ? 190 - v / 4 : 70;
        color[1] = stripe ? 150 - v / 4 : 45;
        color[2] = stripe ? 60 : 30;
      }
      const int dx = u - 90, dy = v - 110;
      if (const int distance = dx * dx + dy * dy; distance < 48 * 48) {  // shaded ball
        const int light = 250 - distance / 12;
        color[0] = light;
        color[1] = light * 5 / 8;
        color[2] = light / 3;
      }
      if (v > 220) color[0] = color[1] = color[2] = 20 + u / 6;  // smooth ramp
      if (x % 41 == 17) color[1] = 230;                          // thin lines
      if (u < 50 && v < 90)
        for (int& sample : color) sample += static_cast<int>(random.in(-14, 14));  // grain
      for (int c = 0; c < 3; ++c) image.pixel(x, y)[c] = static_cast<uint8_t>(std::clamp(color[c], 0, 255));
    }
  return image;
}

enum class Damage : uint8_t { noise, blur, blocks, bands, tint, no_shadow };
constexpr Damage kDamages[] = {Damage::noise, Damage::blur, Damage::blocks,
                               Damage::bands, Damage::tint, Damage::no_shadow};

inline std::string damage_name(Damage damage) {
  constexpr const char* kNames[] = {"noise", "blur", "blocks", "bands", "tint", "no_shadow"};
  return kNames[static_cast<size_t>(damage)];
}

// Mean of the box of (2 reach + 1)^2 pixels around (x, y), the border repeated.
inline int box_mean(const RgbImage& image, int x, int y, int c, int reach) {
  int sum = 0;
  for (int j = -reach; j <= reach; ++j)
    for (int i = -reach; i <= reach; ++i)
      sum += image.pixel(std::clamp(x + i, 0, image.width() - 1), std::clamp(y + j, 0, image.height() - 1))[c];
  const int n = (2 * reach + 1) * (2 * reach + 1);
  return (sum + n / 2) / n;
}

// amount >= 1, larger is worse: levels of noise, tint or lost shadow; reach of the blur; percent of each 8x8 block's
// mean; levels between bands.
inline RgbImage damaged(const RgbImage& image, Damage damage, int amount) {
  RgbImage out(image.width(), image.height());
  Random random(7);
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x)
      for (int c = 0; c < 3; ++c) {
        int value = image.pixel(x, y)[c];
        switch (damage) {
          case Damage::noise:
            value += static_cast<int>(random.in(-amount, amount));
            break;
          case Damage::blur:
            value = box_mean(image, x, y, c, amount);
            break;
          case Damage::blocks: {
            int sum = 0;
            for (int i = 0; i < 64; ++i)
              sum += image.pixel(std::min(x / 8 * 8 + i % 8, image.width() - 1),
                                 std::min(y / 8 * 8 + i / 8, image.height() - 1))[c];
            value = (value * (100 - amount) + sum * amount / 64) / 100;
            break;
          }
          case Damage::bands:
            value = value / amount * amount + amount / 2;
            break;
          case Damage::tint:
            value += c == 0 ? amount : c == 2 ? -amount : 0;
            break;
          case Damage::no_shadow: {
            const int dx = x * 256 / image.width() - 170, dy = y * 256 / image.height() - 60;
            value += std::max(0, amount - (dx * dx + 3 * dy * dy) * amount / 4096);
            break;
          }
        }
        out.pixel(x, y)[c] = static_cast<uint8_t>(std::clamp(value, 0, 255));
      }
  return out;
}

}  // namespace pac::test
