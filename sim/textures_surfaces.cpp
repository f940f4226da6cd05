// Wood, brick, stone, plaster, cloth.
#include "sim/textures.h"
#include "sim/textures_canvas.h"

namespace pac::sim {

namespace {

constexpr int kNoPeriod = 1 << 16;  // lattice cells; octaves double it

// Triangle wave in [0, 1], period 1.
float triangle_wave(float x) {
  const float f = fraction(x);
  return f < 0.5f ? 2.0f * f : 2.0f - 2.0f * f;
}

// How dark the grain is, 0 light .. 1 dark. `across` and `along` in board widths; `board` picks the board.
float grain(float across, float along, uint32_t board) {
  const float offset = static_cast<float>(board & 255u) * 3.1f;
  // Growth rings cut at a flat angle: nearly straight lines that wander, wider apart in the middle (cathedral grain).
  const float wander = fractal_noise(across * 1.3f + offset, along * 0.45f, kNoPeriod, kNoPeriod, 3, board);
  const float center = hash_unit(board, 1, 2) * 1.4f - 0.2f;
  const float d = across - center + 0.35f * wander;
  const float rings = triangle_wave(3.0f * d * d + 2.2f * std::fabs(d) + 0.12f * along);
  const float early = rings * rings;
  const float fiber = gradient_noise(across * 46.0f, along * 2.6f + offset, kNoPeriod, kNoPeriod, board + 7u);
  const float pores = gradient_noise(across * 70.0f, along * 9.0f + offset, kNoPeriod, kNoPeriod, board + 9u);
  return clamp01(0.25f + 0.5f * early + 0.16f * fiber + 0.35f * smooth_step(0.35f, 0.8f, pores) + 0.2f * wander);
}

}  // namespace

RgbaImage oak_planks(int width, int height, uint32_t seed) {
  constexpr int kBoards = 6;
  const glm::vec3 light = rgb8(232, 190, 136), dark = rgb8(158, 106, 62), gap = rgb8(52, 32, 20);
  return paint(width, height, [&](float u, float v) {
    const float column = std::floor(u * kBoards);
    const auto c = static_cast<uint32_t>(column);
    const float across = u * kBoards - column;
    const float shifted = fraction(v + hash_unit(c, 3, seed)) * 2.0f;  // two boards end to end
    const auto board = hash_u32(c, static_cast<uint32_t>(shifted), seed);
    const float along = fraction(shifted);
    const float tone = hash_unit(board, 5, seed) - 0.5f;
    const float warmth = hash_unit(board, 6, seed) - 0.5f;
    glm::vec3 color = blend(light, dark, grain(across, along * 6.0f, board) * 0.85f + 0.25f * tone + 0.05f);
    color *= 1.0f + 0.22f * tone;
    color += glm::vec3(0.03f, 0.0f, -0.03f) * warmth;
    const float side = std::fmin(across, 1.0f - across), end = std::fmin(along, 1.0f - along) * 6.0f;
    const float edge = std::fmin(side, end);
    color *= 0.86f + 0.14f * smooth_step(0.02f, 0.10f, edge);
    return blend(gap, color, smooth_step(0.008f, 0.035f, edge));
  });
}

RgbaImage wood_grain(int width, int height, glm::vec3 light, glm::vec3 dark, uint32_t seed) {
  return paint(width, height, [&](float u, float v) {
    // Cross-fading two cuts of the same timber near the far edges makes both seams vanish.
    const float du = smooth_step(0.75f, 1.0f, u), dv = smooth_step(0.85f, 1.0f, v);
    float g = grain(u, v * 4.0f, seed);
    if (du > 0.0f) g += (grain(u - 1.0f, v * 4.0f, seed) - g) * du;
    if (dv > 0.0f) {
      float next = grain(u, (v - 1.0f) * 4.0f, seed);
      if (du > 0.0f) next += (grain(u - 1.0f, (v - 1.0f) * 4.0f, seed) - next) * du;
      g += (next - g) * dv;
    }
    const float mottle = fractal_noise(u * 2.0f, v * 3.0f, 2, 3, 3, seed + 77u);
    return blend(light, dark, g) * (1.0f + 0.12f * mottle);
  });
}

RgbaImage brick_wall(int width, int height, uint32_t seed) {
  constexpr int kAcross = 4, kCourses = 12;
  const glm::vec3 palette[5] = {rgb8(164, 84, 60), rgb8(146, 70, 50), rgb8(178, 102, 72), rgb8(126, 66, 52),
                                rgb8(188, 122, 88)};
  HeightField bumps(width, height);
  RgbaImage image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(width);
      const float v = (static_cast<float>(y) + 0.5f) / static_cast<float>(height);
      const float chip_x = 0.10f * fractal_noise(u * 24, v * 24, 24, 24, 2, seed);
      const float chip_y = 0.10f * fractal_noise(u * 24, v * 24, 24, 24, 2, seed + 5u);
      const float row = std::floor(v * kCourses);
      const auto course = static_cast<uint32_t>(row);
      const float shifted = u * kAcross + ((course & 1u) != 0 ? 0.5f : 0.0f);
      const auto brick = hash_u32(static_cast<uint32_t>(shifted) % kAcross, course, seed);
      const float bx = fraction(shifted), by = v * kCourses - row;
      // Distance to the brick's edge, in course heights; a brick is about 3 times as long as high.
      const float edge_x = (0.5f - std::fabs(bx - 0.5f)) * 3.0f + chip_x * 0.6f;
      const float edge_y = 0.5f - std::fabs(by - 0.5f) + chip_y * 0.6f;
      const float edge = std::fmin(edge_x, edge_y);
      const float face = smooth_step(0.06f, 0.13f, edge);
      const float coarse = fractal_noise(u * 16, v * 16, 16, 16, 4, seed + 11u);
      const float fine = gradient_noise(u * 128, v * 128, 128, 128, seed + 13u);
      const glm::vec3 base =
          blend(palette[brick % 5u], palette[(brick >> 8) % 5u], 0.5f) * (0.88f + 0.24f * hash_unit(brick, 1, seed));
      glm::vec3 clay = base * (1.0f + 0.32f * coarse + 0.10f * fine);
      const float burn = smooth_step(0.72f, 0.95f, hash_unit(brick, 2, seed));
      clay = blend(clay, clay * 0.62f, burn * smooth_step(-0.3f, 0.4f, coarse + bx - 0.5f));
      const glm::vec3 mortar = rgb8(176, 166, 150) * (0.92f + 0.18f * fine + 0.25f * coarse);
      put_texel(image, x, y, blend(mortar * (0.72f + 0.28f * smooth_step(0.07f, -0.02f, edge)), clay, face));
      bumps.at(x, y) = face * 0.9f + 0.22f * coarse * face + 0.10f * fine;
    }
  }
  relief(image, bumps, 0.26f);
  return image;
}

RgbaImage plaster(int width, int height, glm::vec3 color, uint32_t seed) {
  HeightField bumps(width, height);
  RgbaImage image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(width);
      const float v = (static_cast<float>(y) + 0.5f) / static_cast<float>(height);
      const float cloud = fractal_noise(u * 3, v * 3, 3, 3, 4, seed);
      // Trowel strokes: noise stretched along a direction that itself wanders.
      const float bend = 1.5f * fractal_noise(u * 2, v * 2, 2, 2, 2, seed + 3u);
      const float stroke = fractal_noise(u * 6 + bend, v * 22 + bend, 6, 22, 3, seed + 5u);
      bumps.at(x, y) = 0.8f * stroke + 0.3f * gradient_noise(u * 80, v * 80, 80, 80, seed + 9u);
      put_texel(image, x, y, color * (1.0f + 0.055f * cloud + 0.03f * stroke));
    }
  }
  relief(image, bumps, 0.10f);
  return image;
}

RgbaImage marble(int width, int height, glm::vec3 ground, glm::vec3 vein, uint32_t seed) {
  return paint(width, height, [&](float u, float v) {
    const float warp_x = fractal_noise(u * 2, v * 2, 2, 2, 4, seed),
                warp_y = fractal_noise(u * 2, v * 2, 2, 2, 4, seed + 2u);
    const float x = u + 0.35f * warp_x, y = v + 0.35f * warp_y;
    const float crease = std::fabs(gradient_noise(x * 3, y * 3, 3, 3, seed + 4u));
    const float thin = std::fabs(gradient_noise(x * 7, y * 7, 7, 7, seed + 6u));
    const float cloud = fractal_noise(x * 4, y * 4, 4, 4, 4, seed + 8u);
    const float ink =
        0.75f * (1.0f - smooth_step(0.0f, 0.11f, crease)) + 0.35f * (1.0f - smooth_step(0.0f, 0.06f, thin));
    return blend(ground * (1.0f + 0.16f * cloud), vein, ink * (0.6f + 0.6f * clamp01(0.5f + cloud)));
  });
}

RgbaImage flagstones(int width, int height, uint32_t seed) {
  constexpr int kCells = 5;
  HeightField bumps(width, height);
  RgbaImage image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(width);
      const float v = (static_cast<float>(y) + 0.5f) / static_cast<float>(height);
      const float px = u * kCells + 0.12f * fractal_noise(u * 12, v * 12, 12, 12, 3, seed);
      const float py = v * kCells + 0.12f * fractal_noise(u * 12, v * 12, 12, 12, 3, seed + 1u);
      float nearest = 9.0f, second = 9.0f;
      uint32_t stone = 0;
      const int cx = static_cast<int>(std::floor(px)), cy = static_cast<int>(std::floor(py));
      for (int j = cy - 1; j <= cy + 1; ++j) {
        for (int i = cx - 1; i <= cx + 1; ++i) {
          const auto id = hash_u32(static_cast<uint32_t>((i + kCells) % kCells),
                                   static_cast<uint32_t>((j + kCells) % kCells), seed);
          const float dx = static_cast<float>(i) + 0.15f + 0.7f * hash_unit(id, 1, seed) - px;
          const float dy = static_cast<float>(j) + 0.15f + 0.7f * hash_unit(id, 2, seed) - py;
          const float d = std::sqrt(dx * dx + dy * dy);
          if (d < nearest) {
            second = nearest;
            nearest = d;
            stone = id;
          } else if (d < second) {
            second = d;
          }
        }
      }
      const float face = smooth_step(0.03f, 0.12f, second - nearest);
      const float coarse = fractal_noise(u * 14, v * 14, 14, 14, 5, seed + 3u);
      const float fine = gradient_noise(u * 90, v * 90, 90, 90, seed + 4u);
      glm::vec3 color = blend(rgb8(150, 142, 128), rgb8(112, 118, 124), hash_unit(stone, 3, seed));
      color =
          blend(color, rgb8(158, 132, 104), 0.5f * hash_unit(stone, 4, seed)) * (1.0f + 0.3f * coarse + 0.07f * fine);
      put_texel(image, x, y, blend(rgb8(84, 78, 70) * (1.0f + 0.2f * fine), color, face));
      bumps.at(x, y) = 0.9f * face + 0.5f * coarse + 0.08f * fine;
    }
  }
  relief(image, bumps, 0.22f);
  return image;
}

RgbaImage woven_fabric(int width, int height, glm::vec3 warp, glm::vec3 weft, uint32_t seed) {
  constexpr int kThreads = 64;
  return paint(width, height, [&](float u, float v) {
    const float tx = u * kThreads, ty = v * kThreads;
    const auto ix = static_cast<uint32_t>(tx), iy = static_cast<uint32_t>(ty);
    // A 2/2 twill: the over-under pattern steps by one thread a row.
    const bool warp_above = ((ix + iy) & 3u) < 2u;
    const float across = std::fabs(fraction(warp_above ? tx : ty) - 0.5f);
    const float round = 1.0f - 1.6f * across * across;
    const float slub = warp_above ? hash_unit(ix, 1, seed) + 0.6f * gradient_noise(tx, v * 8, kThreads, 8, seed)
                                  : hash_unit(iy, 2, seed) + 0.6f * gradient_noise(u * 8, ty, 8, kThreads, seed + 1u);
    const float wear = fractal_noise(u * 3, v * 3, 3, 3, 4, seed + 2u);
    return (warp_above ? warp : weft) * round * (0.86f + 0.22f * slub + 0.16f * wear);
  });
}

RgbaImage tartan(int width, int height, uint32_t seed) {
  const auto sett = [](float t) -> glm::vec3 {
    const float s = std::fabs(fraction(t) - 0.5f) * 2.0f;
    if (s < 0.05f) return rgb8(226, 196, 96);
    if (s < 0.34f) return rgb8(142, 30, 34);
    if (s < 0.42f) return rgb8(24, 34, 60);
    if (s < 0.48f) return rgb8(142, 30, 34);
    if (s < 0.80f) return rgb8(30, 74, 58);
    if (s < 0.84f) return rgb8(214, 206, 190);
    return rgb8(28, 40, 74);
  };
  const RgbaImage weave = woven_fabric(width, height, glm::vec3(1.0f), glm::vec3(0.0f), seed);
  RgbaImage image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(width);
      const float v = (static_cast<float>(y) + 0.5f) / static_cast<float>(height);
      const float t = static_cast<float>(weave.pixel(x, y)[0]) / 255.0f;
      const bool warp_above = t > 0.01f;
      const float bumps = 0.88f + 0.24f * gradient_noise(u * 64, v * 64, 64, 64, seed + 5u);
      put_texel(image, x, y, blend(sett(u * 2), sett(v * 2), warp_above ? 0.25f : 0.75f) * bumps);
    }
  }
  return image;
}

RgbaImage striped_curtain(int width, int height, uint32_t seed) {
  return paint(width, height, [&](float u, float v) {
    const float s = fraction(u * 4.0f);
    glm::vec3 color = s < 0.42f ? rgb8(196, 172, 128) : rgb8(140, 62, 52);
    if (std::fabs(s - 0.46f) < 0.02f || std::fabs(s - 0.96f) < 0.02f) color = rgb8(90, 36, 36);
    if (std::fabs(s - 0.71f) < 0.05f) {
      const float bead = fraction(v * 16.0f) - 0.5f, across = (s - 0.71f) * 8.0f;
      if (bead * bead + across * across < 0.14f) color = rgb8(214, 184, 120);
    }
    const float thread = 0.10f * gradient_noise(u * 160, v * 24, 160, 24, seed) +
                         0.08f * gradient_noise(u * 24, v * 160, 24, 160, seed + 1u);
    return color * (0.97f + thread + 0.10f * fractal_noise(u * 4, v * 4, 4, 4, 3, seed + 2u));
  });
}

RgbaImage parchment(int width, int height, uint32_t seed) {
  return paint(width, height, [&](float u, float v) {
    const float fiber =
        fractal_noise(u * 8, v * 24, 8, 24, 4, seed) + 0.5f * fractal_noise(u * 4, v * 4, 4, 4, 3, seed + 1u);
    return blend(rgb8(250, 236, 204), rgb8(226, 192, 138), 0.4f + 0.8f * fiber);
  });
}

}  // namespace pac::sim
