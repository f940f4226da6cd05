// Paintings, the garden behind the window, book spines.
#include "base/exact_math.h"
#include "sim/textures.h"
#include "sim/textures_canvas.h"

namespace pac::sim {

namespace {

constexpr int kNoPeriod = 1 << 16;  // lattice cells; octaves double it

float fbm(float x, float y, int octaves, uint32_t seed) {
  return fractal_noise(x, y, kNoPeriod, kNoPeriod, octaves, seed);
}

// Brush strokes and canvas: paint laid on in short strokes with relief over a woven ground.
void brush(RgbaImage& image, float strength, uint32_t seed) {
  HeightField bumps(image.width(), image.height());
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      const float u = static_cast<float>(x), v = static_cast<float>(y);
      const float turn = fbm(u * 0.02f, v * 0.02f, 2, seed);
      bumps.at(x, y) =
          fbm(u * 0.06f + 4.0f * turn, v * 0.35f + 4.0f * turn, 3, seed + 2u) + 0.12f * static_cast<float>((x ^ y) & 1);
    }
  }
  relief(image, bumps, strength);
}

glm::vec3 sky(float u, float v, uint32_t seed, const glm::vec3& zenith, const glm::vec3& horizon) {
  const float cloud = fbm(u * 3.5f, v * 7.0f, 5, seed);
  const glm::vec3 clear = blend(zenith, horizon, v * 1.1f);
  const float cover = smooth_step(-0.02f, 0.32f, cloud + 0.12f * (0.5f - v));
  const glm::vec3 lit =
      blend(rgb8(206, 198, 196), rgb8(255, 248, 232), 0.5f + 1.6f * fbm(u * 3.5f + 0.1f, v * 7.0f + 0.2f, 4, seed));
  return blend(clear, lit, 0.85f * cover);
}

}  // namespace

namespace {

// Where the landscape's layers begin in one column of the picture, from far to near.
struct Skyline {
  float far_ridge, near_ridge, shore, bank;
};

std::vector<Skyline> landscape_skyline(int width, uint32_t seed) {
  std::vector<Skyline> columns;
  for (int x = 0; x < width; ++x) {
    const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(width);
    Skyline column;
    column.far_ridge = 0.40f - 0.17f * std::fabs(fbm(u * 2.6f, 0.5f, 5, seed + 1u)) -
                       0.10f * smooth_step(0.35f, 0.0f, std::fabs(u - 0.66f));
    column.near_ridge = 0.50f - 0.16f * fbm(u * 3.0f, 3.5f, 5, seed + 2u);
    column.shore = 0.66f + 0.05f * fbm(u * 3.0f, 9.5f, 4, seed + 3u);
    column.bank = 0.86f - 0.14f * smooth_step(0.75f, 0.0f, u) + 0.06f * fbm(u * 5.0f, 14.5f, 4, seed + 4u);
    columns.push_back(column);
  }
  return columns;
}

}  // namespace

RgbaImage painted_landscape(int width, int height, uint32_t seed) {
  const std::vector<Skyline> skyline = landscape_skyline(width, seed);
  RgbaImage image = paint(width, height, [&](float u, float v) {
    const auto& [far_ridge, near_ridge, shore, bank] = skyline[static_cast<size_t>(u * static_cast<float>(width))];
    const float ragged = fbm(u * 22.0f, v * 22.0f, 3, seed + 20u);
    glm::vec3 color = sky(u, v * 1.6f, seed, rgb8(84, 128, 176), rgb8(244, 214, 170));
    if (v > far_ridge) {
      const float snow =
          smooth_step(0.02f, -0.06f, v - far_ridge - 0.05f + 0.12f * fbm(u * 14.0f, v * 9.0f, 4, seed + 5u));
      const float face = fbm(u * 12.0f + v * 6.0f, v * 4.0f, 4, seed + 6u);
      color =
          blend(blend(rgb8(112, 116, 150), rgb8(164, 148, 160), 0.5f + 1.2f * face), rgb8(238, 230, 228), 0.8f * snow);
    }
    if (v > near_ridge + 0.012f * ragged) {
      color = blend(rgb8(58, 88, 76), rgb8(126, 132, 78), 0.45f + 1.3f * fbm(u * 10.0f, v * 16.0f, 4, seed + 7u));
    }
    if (v > shore) {  // the lake mirrors a little of everything above
      const float ripple = fbm(u * 6.0f, v * 60.0f, 3, seed + 8u);
      const float mirror = 2.0f * shore - v + 0.03f * ripple;
      const glm::vec3 image_above = mirror > near_ridge ? rgb8(74, 98, 84) : rgb8(196, 186, 178);
      color = blend(image_above, rgb8(96, 138, 164), 0.45f + 0.8f * ripple);
    }
    if (v > bank + 0.02f * ragged)
      color = blend(rgb8(66, 72, 34), rgb8(168, 150, 62), 0.4f + 1.4f * fbm(u * 30.0f, v * 18.0f, 4, seed + 9u));
    // Three trees on the left bank.
    const float leaf = u < 0.6f ? fbm(u * 26.0f, v * 20.0f, 4, seed + 12u) : 0.0f;
    for (int k = 0; k < 3 && u < 0.6f; ++k) {
      const float tx = 0.12f + 0.13f * static_cast<float>(k), top = 0.20f + 0.12f * static_cast<float>(k % 2);
      const float trunk = std::fabs(u - tx - 0.015f * fbm(v * 5.0f, tx * 9.0f, 2, seed + 11u));
      if (trunk < 0.010f && v > top + 0.2f && v < 0.92f) color = rgb8(62, 44, 34);
      const float dx = (u - tx) / 0.10f, dy = (v - top - 0.18f) / 0.19f;
      if (dx * dx + dy * dy + 1.4f * leaf < 0.75f)
        color = blend(rgb8(34, 56, 30), rgb8(148, 140, 52), 0.35f + 1.1f * leaf - 0.35f * dx - 0.25f * dy);
    }
    return color;
  });
  brush(image, 0.20f, seed + 40u);
  return image;
}

RgbaImage painted_seascape(int width, int height, uint32_t seed) {
  RgbaImage image = paint(width, height, [&](float u, float v) {
    constexpr float kHorizon = 0.52f;
    const float sun_x = u - 0.68f, sun_y = (v - 0.36f) * 0.8f;
    const float sun = std::sqrt(sun_x * sun_x + sun_y * sun_y);
    glm::vec3 color = sky(u, v * 1.3f, seed, rgb8(70, 84, 132), rgb8(246, 166, 92));
    color = blend(color, rgb8(255, 222, 150), 0.8f * smooth_step(0.34f, 0.02f, sun));
    if (sun < 0.055f) color = rgb8(255, 244, 206);
    if (v > kHorizon) {
      const float depth = (v - kHorizon) / (1.0f - kHorizon);
      const float swell = fbm(u * 5.0f / (0.25f + depth), 9.0f / (0.10f + depth), 4, seed + 3u);
      color = blend(rgb8(58, 84, 108), rgb8(20, 52, 66), depth + 0.9f * swell);
      const float path = smooth_step(0.05f + 0.25f * depth, 0.0f, std::fabs(u - 0.68f));
      color = blend(color, rgb8(252, 196, 124), path * smooth_step(-0.12f, 0.25f, swell));
      color = blend(color, rgb8(226, 232, 228), smooth_step(0.26f, 0.42f, swell) * smooth_step(0.15f, 0.6f, depth));
    }
    // A cutter with two sails.
    const float bx = (u - 0.34f) / 0.2f, by = (v - 0.60f) / 0.2f;
    const float heel = bx - 0.10f * by;
    if (by > -0.06f && by < 0.16f && std::fabs(heel) < 0.62f - 1.2f * by) color = rgb8(62, 36, 28);
    if (by < -0.08f && by > -1.7f) {
      const float h = (-0.08f - by) / 1.62f;
      if (heel > 0.05f && heel < 0.05f + 0.62f * (1.0f - h))
        color = blend(rgb8(236, 214, 176), rgb8(176, 132, 98), (heel - 0.05f) * 1.2f);
      if (heel < 0.0f && heel > -0.55f * (1.0f - h * 1.15f))
        color = blend(rgb8(244, 228, 196), rgb8(206, 168, 126), -heel * 1.3f);
      if (std::fabs(heel - 0.025f) < 0.022f) color = rgb8(52, 34, 26);
    }
    return color;
  });
  brush(image, 0.22f, seed + 40u);
  return image;
}

RgbaImage painted_still_life(int width, int height, uint32_t seed) {
  struct Fruit {
    float x, y, r, squash;
    glm::vec3 color;
  };
  const Fruit fruits[] = {
      {0.36f, 0.62f, 0.115f, 1.0f, rgb8(196, 44, 34)},   {0.55f, 0.60f, 0.12f, 1.0f, rgb8(226, 140, 38)},
      {0.455f, 0.52f, 0.105f, 1.0f, rgb8(206, 176, 52)}, {0.66f, 0.66f, 0.10f, 0.92f, rgb8(156, 172, 58)},
      {0.80f, 0.80f, 0.085f, 0.95f, rgb8(206, 60, 40)},  {0.20f, 0.80f, 0.075f, 1.0f, rgb8(120, 40, 88)},
      {0.13f, 0.83f, 0.055f, 1.0f, rgb8(92, 34, 92)},    {0.255f, 0.85f, 0.06f, 1.0f, rgb8(104, 36, 96)}};
  const float aspect = static_cast<float>(width) / static_cast<float>(height);
  RgbaImage image = paint(width, height, [&](float u, float v) {
    const float x = u * aspect, table = 0.74f;
    glm::vec3 color = blend(rgb8(92, 74, 52), rgb8(36, 30, 28),
                            std::fabs(u - 0.3f) * 1.3f + v * 0.3f + 0.6f * fbm(u * 4.0f, v * 4.0f, 4, seed));
    if (v > table) {
      const float fold = fbm(u * 6.0f + 2.0f * v, v * 3.0f, 4, seed + 1u);
      color = blend(rgb8(232, 222, 200), rgb8(146, 132, 124), 0.3f + 1.5f * fold + 0.8f * (v - table));
    }
    // Wine bottle and bowl, each a profile of half widths.
    const float bottle_x = (x - 0.80f * aspect) / 0.09f;
    const float neck = v < 0.34f ? 0.36f : 0.36f + 0.64f * smooth_step(0.34f, 0.44f, v);
    if (v > 0.12f && v < 0.80f && std::fabs(bottle_x) < neck) {
      const float s = bottle_x / neck;
      color = blend(rgb8(30, 46, 34), rgb8(10, 16, 14), std::fabs(s));
      if (std::fabs(s + 0.5f) < 0.10f) color = rgb8(170, 190, 160);
      if (v > 0.52f && v < 0.68f && std::fabs(s) < 0.95f) color = rgb8(222, 204, 158) * (1.0f - 0.4f * s * s);
      if (v < 0.17f) color = rgb8(120, 36, 34);
    }
    for (const Fruit& fruit : fruits) {
      const float dx = (x - fruit.x * aspect) / fruit.r, dy = (v - fruit.y) / (fruit.r * fruit.squash);
      const float d = dx * dx + dy * dy;
      if (d > 1.0f) continue;
      const float nz = std::sqrt(1.0f - d), light = clamp01(-0.55f * dx - 0.55f * dy + 0.63f * nz);
      const float skin = fbm(u * 20.0f + fruit.x * 90.0f, v * 20.0f, 3, seed + 3u);
      color = fruit.color * (0.28f + 0.85f * light) * (1.0f + 0.3f * skin);
      color = blend(color, glm::vec3(1.0f, 0.97f, 0.9f), smooth_step(0.955f, 0.995f, light) * 0.85f);
    }
    const float bowl_x = (x - 0.50f * aspect) / 0.30f, bowl_y = (v - 0.64f) / 0.19f;
    if (bowl_y > 0.0f && bowl_y < 1.0f && std::fabs(bowl_x) < 1.0f - 0.75f * bowl_y * bowl_y) {
      const float s = bowl_x / (1.0f - 0.75f * bowl_y * bowl_y);
      color = blend(rgb8(186, 206, 222), rgb8(52, 66, 104), 0.55f + 0.55f * s);
      const float band = fraction(bowl_x * 4.0f) - 0.5f, by = bowl_y - 0.4f;
      if (band * band + by * by * 6.0f < 0.10f) color = rgb8(30, 52, 128) * (1.1f - 0.5f * s);
      if (bowl_y < 0.08f) color = rgb8(226, 232, 236) * (1.0f - 0.3f * s);
    }
    return color;
  });
  brush(image, 0.18f, seed + 40u);
  return image;
}

RgbaImage painted_abstract(int width, int height, uint32_t seed) {
  // A "composition": overlapping discs, bars and wedges in a few pigments over a washed ground.
  const glm::vec3 pigments[] = {rgb8(190, 52, 42),  rgb8(232, 176, 56), rgb8(36, 66, 122),  rgb8(32, 30, 34),
                                rgb8(62, 128, 120), rgb8(216, 120, 68), rgb8(236, 226, 206)};
  struct Shape {
    float x, y, size, cosine, sine, kind;
    glm::vec3 color;
  };
  Shape shapes[16];
  Random random(seed);
  for (Shape& shape : shapes) {
    shape.x = random.range(0.1f, 0.9f);
    shape.y = random.range(0.1f, 0.9f);
    shape.size = random.range(0.06f, 0.24f);
    const double angle = static_cast<double>(random.unit()) * 2.0 * kPi;
    shape.cosine = static_cast<float>(exact_cos(angle));
    shape.sine = static_cast<float>(exact_sin(angle));
    shape.kind = random.unit();
    shape.color = pigments[random.below(7)];
  }
  const float aspect = static_cast<float>(width) / static_cast<float>(height);
  RgbaImage image = paint(width, height, [&](float u, float v) {
    glm::vec3 color = blend(rgb8(226, 208, 170), rgb8(196, 160, 118), 0.5f + fbm(u * 3.0f, v * 3.0f, 5, seed + 1u));
    const float wash = 0.9f + 0.5f * fbm(u * 12.0f, v * 12.0f, 3, seed + 2u);
    for (const Shape& shape : shapes) {
      const float dx = (u - shape.x) * aspect, dy = v - shape.y;
      const float px = (dx * shape.cosine + dy * shape.sine) / shape.size,
                  py = (dy * shape.cosine - dx * shape.sine) / shape.size;
      const float r = std::sqrt(px * px + py * py);
      float inside = 0.0f;
      if (shape.kind < 0.45f) {
        inside = smooth_step(1.02f, 0.98f, r);
        if (r > 0.62f && r < 0.70f) inside *= 0.25f;
      } else if (shape.kind < 0.75f) {
        inside = std::fabs(px) < 1.7f && std::fabs(py) < 0.16f ? 1.0f : 0.0f;
      } else {
        inside = px > -0.8f && px < 1.2f && std::fabs(py) < 0.4f * (1.2f - px) ? 1.0f : 0.0f;
      }
      color = blend(color, shape.color * wash, 0.88f * inside);
    }
    return color;
  });
  brush(image, 0.20f, seed + 40u);
  return image;
}

RgbaImage garden_view(int width, int height, uint32_t seed) {
  return paint(width, height, [&](float u, float v) {
    glm::vec3 color = sky(u, v * 1.2f, seed, rgb8(126, 176, 232), rgb8(226, 238, 250));
    const float hills = 0.62f - 0.10f * fbm(u * 2.5f, 2.5f, 5, seed + 1u);
    if (v > hills)
      color = blend(rgb8(150, 176, 176), rgb8(190, 204, 176), 0.5f + fbm(u * 9.0f, v * 14.0f, 4, seed + 2u));
    const float leaf = fbm(u * 18.0f, v * 18.0f, 5, seed + 3u);
    const float hedge = 0.76f - 0.10f * fbm(u * 5.0f, 7.5f, 4, seed + 4u);
    if (v > hedge + 0.05f * leaf) color = blend(rgb8(72, 112, 54), rgb8(186, 204, 106), 0.4f + 1.3f * leaf);
    const float dx = (u - 0.22f) / 0.26f, dy = (v - 0.36f) / 0.34f;
    if (dx * dx + dy * dy + 1.6f * leaf < 0.7f)
      color = blend(rgb8(60, 100, 44), rgb8(190, 206, 96), 0.4f + 1.3f * leaf + 0.3f * dx - 0.3f * dy);
    if (std::fabs(u - 0.22f - 0.02f * fbm(v * 6.0f, 1.5f, 2, seed)) < 0.018f && v > 0.55f && v < 0.86f)
      color = rgb8(96, 78, 60);
    return color;
  });
}

RgbaImage book_spines(int width, int height, int n_books, uint32_t seed) {
  const glm::vec3 leathers[] = {rgb8(122, 34, 30), rgb8(34, 62, 48),   rgb8(36, 44, 84), rgb8(120, 82, 46),
                                rgb8(62, 36, 26),  rgb8(172, 146, 98), rgb8(84, 28, 50), rgb8(206, 192, 160),
                                rgb8(48, 84, 104), rgb8(156, 92, 40)};
  const glm::vec3 gold = rgb8(222, 184, 96), ink = rgb8(40, 28, 22);
  return paint(width, height, [&](float u, float v) {
    const float slot = std::floor(u * static_cast<float>(n_books));
    const auto book = hash_u32(static_cast<uint32_t>(slot), 17u, seed);
    const float x = u * static_cast<float>(n_books) - slot;
    const glm::vec3 base = leathers[book % 10u];
    const float luma = 0.3f * base.x + 0.6f * base.y + 0.1f * base.z;
    const glm::vec3 letter = luma > 0.5f ? ink : gold;
    const float cx = std::fabs(x - 0.5f) * 2.0f;
    const float leather = fbm(u * 60.0f, v * 24.0f, 4, seed + 1u);
    glm::vec3 color = base * (1.0f + 0.28f * leather);
    const int style = static_cast<int>((book >> 8) % 4u);
    const int n_bands = 3 + static_cast<int>((book >> 12) % 3u);
    const float position = v * static_cast<float>(n_bands);
    const float band = std::fabs(fraction(position) - 0.5f);
    if (style != 1 && band < 0.045f) color = base * 1.25f;  // raised cords
    if (style != 1 && std::fabs(band - 0.075f) < 0.016f) color = letter;
    if (style == 1 && (std::fabs(v - 0.08f) < 0.012f || std::fabs(v - 0.92f) < 0.012f)) color = letter;
    // Title: a label with rows of uneven marks across the spine.
    const float top = 0.16f + 0.08f * hash_unit(book, 3, seed), depth = style == 1 ? 0.5f : 0.18f;
    if (v > top && v < top + depth && cx < 0.78f) {
      if (style == 2) color = blend(rgb8(150, 30, 28), color, 0.2f);
      if (style == 3) color = blend(rgb8(24, 24, 26), color, 0.2f);
      const float line = (v - top) / depth * (style == 1 ? 1.0f : 4.0f);
      const float mark = style == 1 ? hash_unit(book, static_cast<uint32_t>((v - top) * 70.0f), 5)
                                    : hash_unit(book, static_cast<uint32_t>(x * 16.0f), static_cast<uint32_t>(line));
      const bool inked =
          style == 1 ? (cx < 0.45f && mark > 0.35f) : (std::fabs(fraction(line) - 0.5f) < 0.24f && mark > 0.4f);
      if (inked) color = style == 2 || style == 3 ? gold : letter;
    }
    if (style == 0) {  // a small ornament in the lowest field
      const float oy = (v - 0.80f) * 6.0f, d = cx * cx * 1.4f + oy * oy;
      if (d < 0.32f && d > 0.12f) color = letter;
    }
    const float round = 1.08f - 0.55f * cx * cx * cx * cx;
    return color * (x < 0.04f || x > 0.96f ? 0.25f : round);
  });
}

}  // namespace pac::sim
