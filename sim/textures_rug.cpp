// A knotted carpet: borders, corner pieces and a medallion, drawn in one quadrant and mirrored, then knotted.
#include "sim/textures.h"
#include "sim/textures_canvas.h"

namespace pac::sim {

namespace {

struct Palette {
  glm::vec3 red = rgb8(164, 44, 42), navy = rgb8(44, 54, 100), cream = rgb8(238, 222, 186), gold = rgb8(210, 162, 88),
            teal = rgb8(84, 132, 130), rust = rgb8(198, 102, 68), dark = rgb8(34, 22, 26);
};

// |p| in a rosette of `n` petals: < 1 inside.
float rosette(float x, float y, float radius, float n, float depth) {
  const float r = std::sqrt(x * x + y * y) / radius;
  const float lobe = std::fabs(fraction(angle_turns(x, y) * n) - 0.5f) * 2.0f;
  return r / (1.0f - depth * lobe * lobe);
}

// One flower of the repeat: colored rings with petals, else `ground`.
glm::vec3 flower(float x, float y, float radius, const glm::vec3& petal, const glm::vec3& heart,
                 const glm::vec3& ground, const Palette& palette) {
  const float d = rosette(x, y, radius, 8.0f, 0.35f);
  if (d > 1.0f) return ground;
  if (d > 0.82f) return palette.dark;
  if (d > 0.45f) return petal;
  return d > 0.25f ? palette.cream : heart;
}

// Border band of width 1 at coordinates along / across (0..1), a repeat a unit along: flowers joined by a wavy vine.
glm::vec3 border(float along, float across, const Palette& palette) {
  const float cell = std::floor(along);
  const float x = along - cell - 0.5f, y = across - 0.5f;
  const bool odd = (static_cast<int>(cell) & 1) != 0;
  const float wave = 0.22f * (4.0f * std::fabs(x) - 1.0f) * (odd ? 1.0f : -1.0f);
  glm::vec3 color = palette.navy;
  if (std::fabs(y - wave) < 0.05f) color = palette.gold;
  const float lx = std::fabs(x) - 0.36f, ly = y + wave * 0.9f;
  if (lx * lx * 40.0f + ly * ly * 60.0f < 1.0f) color = palette.teal;
  return flower(x, y, 0.36f, odd ? palette.rust : palette.red, palette.navy, color, palette);
}

// The field inside the borders; x, y from the center in units of the field's half height.
glm::vec3 field(float x, float y, float half_width, const Palette& palette) {
  const float ax = std::fabs(x), ay = std::fabs(y);
  glm::vec3 color = palette.red;
  // Scattered small flowers on a half-drop lattice, with hooked stems.
  const float column = std::floor(ax * 3.2f);
  const float shift = (static_cast<int>(column) & 1) != 0 ? 0.5f : 0.0f;
  const float gx = fraction(ax * 3.2f) - 0.5f, gy = fraction(ay * 3.2f + shift) - 0.5f;
  if (std::fabs(std::fabs(gx) + std::fabs(gy) - 0.44f) < 0.035f) color = palette.rust;
  color = flower(gx, gy, 0.25f, palette.gold, palette.navy, color, palette);
  // Corner pieces: a quarter of the medallion.
  const float cx = (half_width - ax), cy = 1.0f - ay;
  const float corner = rosette(cx, cy, 0.80f, 16.0f, 0.14f);
  if (corner < 1.0f) {
    color = corner > 0.94f ? palette.cream : palette.teal;
    if (corner < 0.80f && corner > 0.74f) color = palette.gold;
    color = flower(cx - 0.25f, cy - 0.25f, 0.19f, palette.cream, palette.red, color, palette);
    if (corner < 0.94f) color = flower(cx - 0.52f, cy - 0.14f, 0.11f, palette.rust, palette.cream, color, palette);
    if (corner < 0.94f) color = flower(cx - 0.14f, cy - 0.52f, 0.11f, palette.rust, palette.cream, color, palette);
  }
  // Medallion: lobed, ringed, wider than high.
  const float m = rosette(x * 0.72f, y, 0.72f, 16.0f, 0.16f);
  const float pendant = ax > 0.8f ? std::fabs(ay) * 2.6f + std::fabs(ax - 1.12f) * 3.2f : 2.0f;
  if (pendant < 1.0f) color = pendant > 0.8f ? palette.cream : (pendant > 0.4f ? palette.navy : palette.gold);
  if (m < 1.0f) {
    if (m > 0.94f) return palette.cream;
    if (m > 0.89f) return palette.dark;
    const float spoke = fraction(angle_turns(x * 0.72f, y) * 16.0f) - 0.5f;
    if (m > 0.60f) {
      const float q = (m - 0.745f) * 7.5f;
      return flower(spoke * 1.5f, q * 0.6f, 0.44f, palette.gold, palette.red, palette.navy, palette);
    }
    if (m > 0.56f) return palette.cream;
    if (m > 0.30f) return std::fabs(spoke) * 1.4f + (m - 0.30f) * 1.6f < 0.5f ? palette.rust : palette.teal;
    return flower(x * 0.72f, y, 0.21f, palette.cream, palette.red, palette.navy, palette);
  }
  return color;
}

}  // namespace

RgbaImage persian_rug(int width, int height, uint32_t seed) {
  const Palette palette;
  const float aspect = static_cast<float>(width) / static_cast<float>(height);
  return paint(width, height, [&](float u, float v) {
    const float x = (u - 0.5f) * 2.0f * aspect, y = (v - 0.5f) * 2.0f;  // half height = 1
    const float from_side = aspect - std::fabs(x), from_end = 1.0f - std::fabs(y);
    const bool side = from_side < from_end;
    const float edge = side ? from_side : from_end, along = side ? std::fabs(y) : std::fabs(x);
    const float from_center = along;  // repeats are centered, so that both halves mirror
    glm::vec3 color;
    if (edge < 0.035f) {
      color = palette.dark;
    } else if (edge < 0.085f) {
      color = fraction(from_center * 14.0f) < 0.5f ? palette.cream : palette.rust;
    } else if (edge < 0.10f) {
      color = palette.dark;
    } else if (edge < 0.30f) {
      color = border(from_center / 0.2f + 0.5f, (edge - 0.10f) / 0.20f, palette);
    } else if (edge < 0.315f) {
      color = palette.dark;
    } else if (edge < 0.365f) {
      color = fraction(from_center * 14.0f + 0.25f) < 0.5f ? palette.gold : palette.teal;
    } else if (edge < 0.38f) {
      color = palette.cream;
    } else {
      constexpr float kInner = 1.0f - 0.38f;
      color = field(x / kInner, y / kInner, (aspect - 0.38f) / kInner, palette);
    }
    // Abrash (dye lots change along the length), wear, and the knots' own light and dark.
    const float abrash = fractal_noise(u * 9, v * 2, 9, 2, 2, seed);
    const float wear = fractal_noise(u * 5, v * 5, 5, 5, 4, seed + 1u);
    const float knots = gradient_noise(u * 170, v * 110, 170, 110, seed + 2u);
    color *= 1.0f + 0.20f * abrash + 0.10f * knots;
    return blend(color, palette.cream * 0.6f, 0.10f + 0.16f * wear);
  });
}

}  // namespace pac::sim
