// Normative definitions of the texture filters: one lane at a time.
#include <algorithm>
#include <cmath>

#include "base/kernels/tile_kernels.h"

namespace pac {
namespace {

// The two texels that one axis mixes, and the weight of the second in 1/256.
struct Taps {
  int32_t first, second;  // second: the right or lower neighbour, wrapped
  int32_t fraction;       // 0..255
};

// coordinate * size in 24.8, wrapped or clamped to the image; `half` shifts to texel centers (128) or not (0).
Taps taps(float coordinate, int32_t size, int32_t clamp, int32_t half) {
  const float scale = static_cast<float>(size * 256);
  int32_t fixed;
  if (clamp != 0) {
    const float unit = std::min(std::max(coordinate, 0.0f), 1.0f);
    const int32_t limit = size * 256 - (half != 0 ? 256 : 1);  // the last texel's center has fraction 0
    fixed = std::min(std::max(static_cast<int32_t>(unit * scale) - half, 0), limit);
  } else {
    const float unit = coordinate - std::floor(coordinate);  // [0, 1], 1 by rounding only
    fixed = static_cast<int32_t>(unit * scale) - half;
    if (fixed < 0) fixed += size * 256;
    if (fixed >= size * 256) fixed -= size * 256;
  }
  const int32_t first = fixed >> 8;
  return {first, first + 1 == size ? 0 : first + 1, fixed & 255};
}

const uint8_t* texel(const TextureSampler& texture, int level, int32_t x, int32_t y) {
  return texture.texels + 4 * (ptrdiff_t{texture.offset[level]} + ptrdiff_t{y} * texture.pitch[level] + x);
}

// a + (b - a) * fraction / 256, rounded: what pmulhrsw and sqrdmulh compute.
int32_t mix(int32_t a, int32_t b, int32_t fraction) {
  return a + (((b - a) * (fraction << 7) + 0x4000) >> 15);
}

// Channels first .. first + count - 1 minus 128 in 1/128: in [-16384, 16256]. Vertical weights have 7 bits, horizontal
// ones 8.
void bilinear(const TextureSampler& texture, int level, float u, float v, int first, int count, int32_t out[4]) {
  const Taps x = taps(u, texture.width[level], texture.clamp, 128);
  const Taps y = taps(v, texture.height[level], texture.clamp, 128);
  const uint8_t* top = texel(texture, level, x.first, y.first);
  const uint8_t* bottom = texel(texture, level, x.first, y.second);
  const int32_t lower = y.fraction >> 1;
  for (int c = first; c < first + count; ++c) {
    const int32_t left = (top[c] - 128) * (128 - lower) + (bottom[c] - 128) * lower;
    const int32_t right = (top[c + 4] - 128) * (128 - lower) + (bottom[c + 4] - 128) * lower;
    out[c] = mix(left, right, x.fraction);
  }
}

// Channels first .. first + count - 1 of one lane, in [0, 255].
void filtered(const TextureSampler& texture, float u, float v, float lod, int first, int count, float out[4]) {
  const float bounded = std::min(std::max(lod, 0.0f), static_cast<float>(texture.level_count - 1));
  int32_t color[4];
  if (texture.filter == 2) {
    const int32_t fixed = static_cast<int32_t>(bounded * 256.0f);
    const int32_t level = fixed >> 8;
    int32_t coarse[4];
    bilinear(texture, level, u, v, first, count, color);
    bilinear(texture, std::min(level + 1, texture.level_count - 1), u, v, first, count, coarse);
    for (int c = first; c < first + count; ++c) color[c] = mix(color[c], coarse[c], fixed & 255);
  } else {
    const int32_t level = static_cast<int32_t>(bounded + 0.5f);
    if (texture.filter == 1) {
      bilinear(texture, level, u, v, first, count, color);
    } else {
      const uint8_t* nearest = texel(texture, level, taps(u, texture.width[level], texture.clamp, 0).first,
                                     taps(v, texture.height[level], texture.clamp, 0).first);
      for (int c = first; c < first + count; ++c) color[c] = (nearest[c] - 128) * 128;
    }
  }
  for (int c = first; c < first + count; ++c) out[c] = static_cast<float>(color[c]) * (1.0f / 128.0f) + 128.0f;
}

void sample_texture(const TextureSampler& texture, int n, const float* u, const float* v, const float* lod,
                    float* texels) {
  for (int k = 0; k < (n + 7) / 8 * 8; ++k) {
    float color[4];
    filtered(texture, u[k], v[k], lod[k], 0, 3, color);
    for (int c = 0; c < 3; ++c) texels[c * kBatchLanes + k] = color[c];
  }
}

// Sums are exact: each texel is a multiple of 1/128 below 256.
void sample_anisotropic(const TextureSampler& texture, int n, const float* u, const float* v, const float* lod,
                        const float* axis_u, const float* axis_v, const float* probes, float* texels) {
  for (int k = 0; k < (n + 7) / 8 * 8; ++k) {
    const float inverse = 1.0f / probes[k];
    float sum[3] = {0, 0, 0};
    for (int i = 0; static_cast<float>(i) < probes[k]; ++i) {
      const float step = (static_cast<float>(i) + 0.5f) * inverse - 0.5f;
      float color[4];
      filtered(texture, u[k] + axis_u[k] * step, v[k] + axis_v[k] * step, lod[k], 0, 3, color);
      for (int c = 0; c < 3; ++c) sum[c] = sum[c] + color[c];
    }
    for (int c = 0; c < 3; ++c) texels[c * kBatchLanes + k] = sum[c] * inverse;
  }
}

void sample_alpha(const TextureSampler& texture, int n, const float* u, const float* v, const float* lod,
                  float* alpha) {
  for (int k = 0; k < (n + 7) / 8 * 8; ++k) {
    float color[4];
    filtered(texture, u[k], v[k], lod[k], 3, 1, color);
    alpha[k] = color[3];
  }
}

}  // namespace

void fill_texture_scalar(TileKernels& table) {
  table.sample_texture = sample_texture;
  table.sample_anisotropic = sample_anisotropic;
  table.sample_alpha = sample_alpha;
}

}  // namespace pac
