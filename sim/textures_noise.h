// Noise and small shaping functions that the procedural textures are made of. Deterministic: integer hashes, and only
// + - * / floor sqrt on floats.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>

namespace pac::sim {

// A well mixed 32-bit hash of three words (Murmur3's finalizer between them).
inline uint32_t hash_u32(uint32_t a, uint32_t b, uint32_t c) {
  uint32_t h = a * 0x9E3779B1u ^ (b + 0x7F4A7C15u) * 0x85EBCA6Bu ^ (c + 0x165667B1u) * 0xC2B2AE35u;
  h ^= h >> 16;
  h *= 0x85EBCA6Bu;
  h ^= h >> 13;
  h *= 0xC2B2AE35u;
  h ^= h >> 16;
  return h;
}

// Uniform in [0, 1), exact multiples of 2^-24.
inline float hash_unit(uint32_t a, uint32_t b, uint32_t c) {
  return static_cast<float>(hash_u32(a, b, c) >> 8) * (1.0f / 16777216.0f);
}

// A sequence of hashes. Draw each number in a statement of its own: argument order is not defined.
class Random {
 public:
  explicit Random(uint32_t seed) : seed_(seed) {}
  uint32_t next() { return hash_u32(seed_, count_++, 0x51ED27u); }
  float unit() { return static_cast<float>(next() >> 8) * (1.0f / 16777216.0f); }
  float range(float low, float high) { return low + (high - low) * unit(); }
  int below(int n) { return static_cast<int>(next() % static_cast<uint32_t>(n)); }

 private:
  uint32_t seed_, count_ = 0;
};

inline float clamp01(float x) {
  return x < 0.0f ? 0.0f : (x > 1.0f ? 1.0f : x);
}
inline float fraction(float x) {
  return x - std::floor(x);
}
// 0 below `low`, 1 above `high`, a cubic between; low != high (low > high falls instead of rising).
inline float smooth_step(float low, float high, float x) {
  const float t = clamp01((x - low) / (high - low));
  return t * t * (3.0f - 2.0f * t);
}
inline glm::vec3 blend(const glm::vec3& a, const glm::vec3& b, float t) {
  return a + (b - a) * clamp01(t);
}
inline glm::vec3 rgb8(int r, int g, int b) {
  return glm::vec3(static_cast<float>(r), static_cast<float>(g), static_cast<float>(b)) * (1.0f / 255.0f);
}

// The angle of (x, y) from the x axis, in turns in [0, 1); within 1e-4 (a drawing aid, not exact_math's accuracy).
inline float angle_turns(float x, float y) {
  const float ax = std::fabs(x), ay = std::fabs(y);
  const float high = ax > ay ? ax : ay, low = ax > ay ? ay : ax;
  if (high == 0.0f) return 0.0f;
  const float t = low / high, s = t * t;
  float turns = t * (0.1591322f + s * (-0.0525630f + s * (0.0286540f - s * 0.0102850f)));
  if (ay > ax) turns = 0.25f - turns;
  if (x < 0.0f) turns = 0.5f - turns;
  if (y < 0.0f) turns = 1.0f - turns;
  return turns >= 1.0f ? 0.0f : turns;
}

// Gradient noise in about [-1, 1], 0 on the lattice. Repeats after `period` lattice cells on each axis.
inline float gradient_noise(float x, float y, int period_x, int period_y, uint32_t seed) {
  static constexpr float kGradients[8][2] = {{1, 0},  {0.7071068f, 0.7071068f},   {0, 1},  {-0.7071068f, 0.7071068f},
                                             {-1, 0}, {-0.7071068f, -0.7071068f}, {0, -1}, {0.7071068f, -0.7071068f}};
  const float floor_x = std::floor(x), floor_y = std::floor(y);
  const float fx = x - floor_x, fy = y - floor_y;
  const auto wrap = [](float cell, int period) {  // the lattice is small: an int holds every cell
    const int i = static_cast<int>(cell) % period;
    return static_cast<uint32_t>(i < 0 ? i + period : i);
  };
  const uint32_t x0 = wrap(floor_x, period_x), x1 = x0 + 1 == static_cast<uint32_t>(period_x) ? 0 : x0 + 1;
  const uint32_t y0 = wrap(floor_y, period_y), y1 = y0 + 1 == static_cast<uint32_t>(period_y) ? 0 : y0 + 1;
  const auto corner = [&](uint32_t cx, uint32_t cy, float dx, float dy) {
    const float* g = kGradients[hash_u32(cx, cy, seed) >> 29];
    return g[0] * dx + g[1] * dy;
  };
  const float sx = fx * fx * fx * (fx * (fx * 6.0f - 15.0f) + 10.0f);
  const float sy = fy * fy * fy * (fy * (fy * 6.0f - 15.0f) + 10.0f);
  const float n00 = corner(x0, y0, fx, fy), n10 = corner(x1, y0, fx - 1.0f, fy);
  const float n01 = corner(x0, y1, fx, fy - 1.0f), n11 = corner(x1, y1, fx - 1.0f, fy - 1.0f);
  const float a = n00 + (n10 - n00) * sx, b = n01 + (n11 - n01) * sx;
  return (a + (b - a) * sy) * 1.5f;
}

// `octaves` of gradient noise, each twice as fine and half as strong; about [-1, 1]. Periods are those of the first.
inline float fractal_noise(float x, float y, int period_x, int period_y, int octaves, uint32_t seed) {
  float sum = 0.0f, amplitude = 0.5f;
  for (int k = 0; k < octaves; ++k) {
    sum += amplitude * gradient_noise(x, y, period_x, period_y, seed + static_cast<uint32_t>(k) * 101u);
    x *= 2.0f;
    y *= 2.0f;
    period_x *= 2;
    period_y *= 2;
    amplitude *= 0.5f;
  }
  return sum;
}

// Sum of |noise|: creases, as in marble. In [0, 1].
inline float turbulence(float x, float y, int period_x, int period_y, int octaves, uint32_t seed) {
  float sum = 0.0f, amplitude = 0.5f;
  for (int k = 0; k < octaves; ++k) {
    sum += amplitude * std::fabs(gradient_noise(x, y, period_x, period_y, seed + static_cast<uint32_t>(k) * 101u));
    x *= 2.0f;
    y *= 2.0f;
    period_x *= 2;
    period_y *= 2;
    amplitude *= 0.5f;
  }
  return sum;
}

}  // namespace pac::sim
