// Normative definitions: one lane or one sample at a time. Lights and shadows: shade_scalar.cpp; texture filters:
// texture_scalar.cpp.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/kernels/tile_kernels.h"

namespace pac {
namespace {

// E_i at a sample, without the top-left rule.
int64_t edge(const RasterTriangle& t, int i, int64_t x, int64_t y) {
  return (i == 0 ? t.area2 : 0) + t.a[i] * x + t.b[i] * y;
}

float depth_at(const RasterTriangle& t, int32_t x, int32_t y) {
  const float z = (t.z0 + static_cast<float>(y) * t.dzdy) + static_cast<float>(x) * t.dzdx;
  return std::min(std::max(z, t.z_min), t.z_max);
}

void rasterize(const RasterTriangle& t, uint32_t id, SamplePosition origin, float* depth, uint32_t* ids) {
  const int tile_x = origin.x >> 8, tile_y = origin.y >> 8;
  const int first_x = std::max(t.min_x - tile_x, 0), last_x = std::min(t.max_x - tile_x, kTileSize - 1);
  const int first_y = std::max(t.min_y - tile_y, 0), last_y = std::min(t.max_y - tile_y, kTileSize - 1);
  for (int py = first_y; py <= last_y; ++py) {
    const int32_t y = origin.y + 256 * py - t.y0;
    for (int px = first_x; px <= last_x; ++px) {
      const int32_t x = origin.x + 256 * px - t.x0;
      if (edge(t, 0, x, y) < t.exclude[0] || edge(t, 1, x, y) < t.exclude[1] || edge(t, 2, x, y) < t.exclude[2])
        continue;
      const float z = depth_at(t, x, y);
      const int at = py * kTileSize + px;
      if (!(z < depth[at])) continue;
      depth[at] = z;
      if (ids != nullptr) ids[at] = id;
    }
  }
}

void rasterize_all(const RasterTriangle* const* triangles, uint32_t n, SamplePosition origin, float* depth,
                   uint32_t* ids) {
  std::fill_n(depth, kTileSize * kTileSize, 1.0f);
  if (ids != nullptr) std::fill_n(ids, kTileSize * kTileSize, 0u);
  for (uint32_t i = 0; i < n; ++i) rasterize(*triangles[i], i + 1, origin, depth, ids);
}

int collect_packs(const uint32_t* ids, int width, int height, const RasterTriangle* const* triangles, LanePack* packs) {
  int n = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; x += 8) {
      const uint32_t* group = ids + y * kTileSize + x;
      uint32_t left = 0xFF;
      for (uint32_t k = 0; k < 8; ++k) {
        if ((left >> k & 1) == 0) continue;
        uint32_t mask = 0;
        for (uint32_t i = k; i < 8; ++i) mask |= (group[i] == group[k] ? 1u : 0u) << i;
        left &= ~mask;
        if (group[k] != 0)
          packs[n++] = {triangles[group[k] - 1],
                        static_cast<uint8_t>(x),
                        static_cast<uint8_t>(y),
                        static_cast<uint8_t>(mask),
                        {}};
      }
    }
  return n;
}

int collect_groups(const uint32_t* ids, int width, int height, const RasterTriangle* const* triangles, int rendering,
                   LanePack* packs) {
  int n = 0;
  for (int square = 0; square < (height + 7) / 8 * kTileSize; ++square) {
    const int x = square % kTileSize / 8 * 8, y = square / kTileSize * 8 + square % 8;
    if (x >= width || y >= height) continue;
    const int first = n;
    for (int k = 0; k < 8; ++k) {
      const uint32_t id = ids[y * kTileSize + x + k];
      if (id == 0) continue;
      const RasterTriangle* const triangle = triangles[id - 1];
      int i = first;
      while (i < n && rendering >= 0 && packs[i].triangle->state[rendering] != triangle->state[rendering]) ++i;
      if (i == n) packs[n++] = {triangle, static_cast<uint8_t>(x), static_cast<uint8_t>(y), 0, {}};
      packs[i].mask = static_cast<uint8_t>(packs[i].mask | 1 << k);
    }
  }
  return n;
}

// E_i / 2^shift of lane k of a pack whose lane 0 has E_i = first. Exact (rounded down) up to shift 8, which is
// area 2^22 pixels; beyond, the error is under 8 of more than 2^30. Never negative inside the triangle, up to that
// error, and modulo 2^32 outside.
int32_t lane_edge(int64_t first, int32_t gradient, int shift, int k) {
  const int32_t step =
      shift <= 8 ? static_cast<int32_t>(static_cast<uint32_t>(gradient) << (8 - shift)) : gradient >> (shift - 8);
  return static_cast<int32_t>(static_cast<uint32_t>(first >> shift) +
                              static_cast<uint32_t>(step) * static_cast<uint32_t>(k));
}

// Change of E_i / 2^shift by one pixel.
float pixel_gradient(int32_t gradient, int shift) {
  const float scale = 256.0f / static_cast<float>(int64_t{1} << shift);
  return static_cast<float>(gradient) * scale;
}

// log2 x of a positive normal number within 0.01: exponent and mantissa m give e + m + 0.3431 m (1 - m).
float log2_estimate(float x) {
  int32_t bits;
  std::memcpy(&bits, &x, sizeof bits);
  const float linear = static_cast<float>(bits) * (1.0f / 8388608.0f) - 127.0f;
  const float m = linear - std::floor(linear);
  return linear + 0.3431f * (m * (1.0f - m));
}

struct LaneWeights {
  float l1, l2;  // perspective-correct weights of corners 1 and 2
  float r;       // 1 / interpolated (1/w)
};

LaneWeights lane_weights(const RasterTriangle& t, int64_t first1, int64_t first2, int k) {
  const int32_t e1 = lane_edge(first1, t.a[1], t.shift, k), e2 = lane_edge(first2, t.a[2], t.shift, k);
  const int32_t total = static_cast<int32_t>(t.area2 >> t.shift);
  const int32_t e0 =
      static_cast<int32_t>(static_cast<uint32_t>(total) - static_cast<uint32_t>(e1) - static_cast<uint32_t>(e2));
  const float f0 = static_cast<float>(std::max(e0, 0)) * t.w[0];
  const float f1 = static_cast<float>(std::max(e1, 0)) * t.w[1];
  const float f2 = static_cast<float>(std::max(e2, 0)) * t.w[2];
  const float q = std::max((f0 + f1) + f2, 0x1p-60f);  // only outside the triangle
  const float r = 1.0f / q;
  return {f1 * r, f2 * r, r};
}

// Analytic derivatives of u and v along x (axis 0) or y, in texels, times q: with weights l_i = f_i / q,
// dl_i = (df_i - l_i dq) / q.
struct TexelStep {
  float u, v;
  float squared;  // length
};
TexelStep texel_step(const RasterTriangle& t, const LaneWeights& lane, int axis, const float* uv, float width,
                     float height) {
  const int32_t* gradient = axis == 0 ? t.a : t.b;
  const float g0 = pixel_gradient(gradient[0], t.shift) * t.w[0];
  const float g1 = pixel_gradient(gradient[1], t.shift) * t.w[1];
  const float g2 = pixel_gradient(gradient[2], t.shift) * t.w[2];
  const float gq = (g0 + g1) + g2;
  const float d1 = g1 - lane.l1 * gq, d2 = g2 - lane.l2 * gq;
  const float du = d1 * (uv[1] * width) + d2 * (uv[2] * width);
  const float dv = d1 * (uv[4] * height) + d2 * (uv[5] * height);
  return {du, dv, du * du + dv * dv};
}

float lane_lod(const RasterTriangle& t, const LaneWeights& lane, const float* uv, const InterpolateTarget& target) {
  const TexelStep across = texel_step(t, lane, 0, uv, target.width, target.height);
  const TexelStep down = texel_step(t, lane, 1, uv, target.width, target.height);
  const float rho = std::max(across.squared, down.squared) * (lane.r * lane.r);
  const float bounded = std::min(std::max(rho, 0x1p-60f), 0x1p60f);
  return 0.5f * log2_estimate(bounded) + target.lod_bias;
}

// In [low, high]; what is not a number becomes low.
float clamped(float value, float low, float high) {
  return std::min(std::max(low, value), high);
}

void lane_footprint(const RasterTriangle& t, const LaneWeights& lane, const FootprintTarget& target, int at) {
  const float* uv = t.attributes[target.rendering] + 3 * target.uv;
  const TexelStep across = texel_step(t, lane, 0, uv, target.width, target.height);
  const TexelStep down = texel_step(t, lane, 1, uv, target.width, target.height);
  const float r2 = lane.r * lane.r;
  const bool is_across = !(across.squared < down.squared);
  const float longer = clamped((is_across ? across.squared : down.squared) * r2, 0x1p-60f, 0x1p60f);
  const float shorter = clamped((is_across ? down.squared : across.squared) * r2, 0x1p-60f, 0x1p60f);
  const float length = std::sqrt(longer) * target.scale;
  const float ratio = std::min(std::min(std::sqrt(longer / shorter), length), target.max_probes);
  const float probes = std::max(-std::floor(-ratio), 1.0f);
  target.lod[at] = 0.5f * log2_estimate(clamped(longer / (probes * probes), 0x1p-60f, 0x1p60f)) + target.lod_bias;
  if (target.probes == nullptr) return;
  const float to_u = (lane.r * target.scale) / target.width, to_v = (lane.r * target.scale) / target.height;
  target.probes[at] = probes;
  target.axis_u[at] = clamped((is_across ? across.u : down.u) * to_u, -0x1p20f, 0x1p20f);
  target.axis_v[at] = clamped((is_across ? across.v : down.v) * to_v, -0x1p20f, 0x1p20f);
}

void footprint(const LanePack* packs, int n, SamplePosition origin, const FootprintTarget& target) {
  for (int p = 0; p < n; ++p) {
    const RasterTriangle& t = *packs[p].triangle;
    const int32_t x = origin.x + 256 * packs[p].x - t.x0, y = origin.y + 256 * packs[p].y - t.y0;
    const int64_t first1 = edge(t, 1, x, y), first2 = edge(t, 2, x, y);
    for (int k = 0; k < 8; ++k) lane_footprint(t, lane_weights(t, first1, first2, k), target, 8 * p + k);
  }
}

// The row element `at`: the sample (X, Y) from corner 0 of a planar triangle, inside it. With l_i = E_i w_i / (area2 Q)
// and the differences d1, d2 of an attribute from corner 0, both Q = w0 + X Q_x + Y Q_y and the sum of d_i E_i w_i /
// area2 = X N_x + Y N_y are planes.
void interpolate_plane(const RasterTriangle& t, float x, float y, const InterpolateTarget& target, int at) {
  const float inverse = 1.0f / static_cast<float>(t.area2);
  const float x1 = static_cast<float>(t.a[1]) * inverse, x2 = static_cast<float>(t.a[2]) * inverse;
  const float y1 = static_cast<float>(t.b[1]) * inverse, y2 = static_cast<float>(t.b[2]) * inverse;
  const float w1 = t.w[1] - t.w[0], w2 = t.w[2] - t.w[0];
  const float q_x = w1 * x1 + w2 * x2, q_y = w1 * y1 + w2 * y2;
  const float r = 1.0f / std::max((t.w[0] + y * q_y) + x * q_x, kLeastPlanarW);
  const float wx1 = t.w[1] * x1, wx2 = t.w[2] * x2, wy1 = t.w[1] * y1, wy2 = t.w[2] * y2;
  const float* record = t.attributes[target.rendering];
  struct Plane {
    float x, y, value;
  };
  const auto plane = [&](int j) {  // value: beyond corner 0's
    const float* a = record + 3 * j;
    const float n_x = a[1] * wx1 + a[2] * wx2, n_y = a[1] * wy1 + a[2] * wy2;
    return Plane{n_x, n_y, (y * n_y + x * n_x) * r};
  };
  for (int j = 0; j < target.n_attributes; ++j) target.rows[j * kBatchLanes + at] = record[3 * j] + plane(j).value;
  if (target.lod == nullptr) return;
  const Plane u = plane(target.uv), v = plane(target.uv + 1);
  const auto squared_length = [&](float u_step, float v_step, float q_step) {  // by one pixel
    const float du = (u_step * 256.0f) * target.width - (u.value * target.width) * (q_step * 256.0f);
    const float dv = (v_step * 256.0f) * target.height - (v.value * target.height) * (q_step * 256.0f);
    return du * du + dv * dv;
  };
  const float rho = std::max(squared_length(u.x, v.x, q_x), squared_length(u.y, v.y, q_y)) * (r * r);
  target.lod[at] = 0.5f * log2_estimate(std::min(std::max(rho, 0x1p-60f), 0x1p60f)) + target.lod_bias;
}

// The row element `at`: lane k of the group of eight whose lane 0 has E_1 = first1 and E_2 = first2.
void interpolate_lane(const RasterTriangle& t, int64_t first1, int64_t first2, int k, const InterpolateTarget& target,
                      int at) {
  const float* attributes = t.attributes[target.rendering];
  const LaneWeights lane = lane_weights(t, first1, first2, k);
  for (int j = 0; j < target.n_attributes; ++j) {
    const float* a = attributes + 3 * j;
    target.rows[j * kBatchLanes + at] = (a[0] + lane.l1 * a[1]) + lane.l2 * a[2];
  }
  if (target.lod != nullptr) target.lod[at] = lane_lod(t, lane, attributes + 3 * target.uv, target);
}

void interpolate(const LanePack* packs, int n, SamplePosition origin, const InterpolateTarget& target) {
  for (int p = 0; p < n; ++p) {
    const RasterTriangle& t = *packs[p].triangle;
    const int32_t x = origin.x + 256 * packs[p].x - t.x0, y = origin.y + 256 * packs[p].y - t.y0;
    const int64_t first1 = edge(t, 1, x, y), first2 = edge(t, 2, x, y);
    const bool planar = target.inside && t.planar != 0;
    for (int k = 0; k < 8; ++k) {
      if (planar)
        interpolate_plane(t, static_cast<float>(x + 256 * k), static_cast<float>(y), target, 8 * p + k);
      else
        interpolate_lane(t, first1, first2, k, target, 8 * p + k);
    }
  }
}

// Lanes beyond the last sample repeat it.
void interpolate_lanes(const LaneSample* samples, int n, SamplePosition origin, const InterpolateTarget& target) {
  for (int i = 0; i < (n + 7) / 8 * 8; ++i) {
    const LaneSample& s = samples[std::min(i, n - 1)];
    const RasterTriangle& t = *s.triangle;
    const int k = s.x & 7;
    const int32_t x = origin.x + 256 * (s.x - k) - t.x0, y = origin.y + 256 * s.y - t.y0;
    interpolate_lane(t, edge(t, 1, x, y), edge(t, 2, x, y), k, target, i);
  }
}

// color * texel / 255 + specular of one lane and channel, clamped to 0..255.
float final_color(const float* color, const float* texels, const float* specular, int row) {
  float value = color[row];
  if (texels != nullptr) value = (value * texels[row]) * (1.0f / 255.0f);
  if (specular != nullptr) value = value + specular[row];
  return std::min(std::max(value, 0.0f), 255.0f);
}

void blend(const LanePack* packs, int n, const float* color, const float* texels, const float* specular,
           const float* alpha, uint16_t* colors) {
  for (int p = 0; p < n; ++p)
    for (int k = 0; k < 8; ++k) {
      if ((packs[p].mask >> k & 1) == 0) continue;
      const float share = clamped(alpha[8 * p + k], 0.0f, 1.0f);
      for (int c = 0; c < 3; ++c) {
        uint16_t& at = colors[c * kTileSize * kTileSize + packs[p].y * kTileSize + packs[p].x + k];
        const auto below = static_cast<float>(at);
        const float value = final_color(color, texels, specular, c * kBatchLanes + 8 * p + k);
        at = static_cast<uint16_t>(clamped(below + (value - below) * share, 0.0f, 255.0f) + 0.5f);
      }
    }
}

// Adds a lane's color, `times` over, to the pixel `at`.
void accumulate_lane(int lane, int at, int times, const float* color, const float* texels, const float* specular,
                     const uint8_t background[3], uint16_t* sums) {
  for (int c = 0; c < 3; ++c) {
    const int byte = static_cast<int>(final_color(color, texels, specular, c * kBatchLanes + lane) + 0.5f);
    uint16_t& sum = sums[c * kTileSize * kTileSize + at];
    sum = static_cast<uint16_t>(sum + (byte - background[c]) * times);
  }
}

void accumulate(const LanePack* packs, int n, bool weighted, const float* color, const float* texels,
                const float* specular, const uint8_t background[3], uint16_t* sums) {
  for (int p = 0; p < n; ++p)
    for (int k = 0; k < 8; ++k)
      if ((packs[p].mask >> k & 1) != 0)
        accumulate_lane(8 * p + k, packs[p].y * kTileSize + packs[p].x + k, weighted ? packs[p].weight[k] : 1, color,
                        texels, specular, background, sums);
}

void accumulate_lanes(const LaneSample* samples, int n, bool weighted, const float* color, const float* texels,
                      const float* specular, const uint8_t background[3], uint16_t* sums) {
  for (int i = 0; i < n; ++i)
    accumulate_lane(i, samples[i].y * kTileSize + samples[i].x, weighted ? samples[i].weight : 1, color, texels,
                    specular, background, sums);
}

// The row element `at`: what pixel (px, py) of the tile would be given by its pack if it showed `t`, inside.
void interpolate_pixel(const RasterTriangle& t, SamplePosition origin, int px, int py, const InterpolateTarget& target,
                       int at) {
  const int k = px & 7;
  const int32_t x = origin.x + 256 * (px - k) - t.x0, y = origin.y + 256 * py - t.y0;
  if (t.planar != 0) return interpolate_plane(t, static_cast<float>(x + 256 * k), static_cast<float>(y), target, at);
  interpolate_lane(t, edge(t, 1, x, y), edge(t, 2, x, y), k, target, at);
}

void interpolate_groups(const LanePack* packs, int n, const uint32_t* ids, const RasterTriangle* const* triangles,
                        SamplePosition origin, const InterpolateTarget& target) {
  for (int p = 0; p < n; ++p) {
    const uint32_t* const group = ids + packs[p].y * kTileSize + packs[p].x;
    int lowest = 0;
    while ((packs[p].mask >> lowest & 1) == 0) ++lowest;
    for (int k = 0; k < 8; ++k) {
      const RasterTriangle& t = *triangles[group[(packs[p].mask >> k & 1) != 0 ? k : lowest] - 1];
      interpolate_pixel(t, origin, packs[p].x + k, packs[p].y, target, 8 * p + k);
    }
  }
}

void add_colors(const SampleIds* samples, int n_samples, int width, int height, const RasterTriangle* const* triangles,
                int rendering, const uint8_t background[3], uint16_t* sums) {
  float rows[3 * kBatchLanes];
  const InterpolateTarget target{rendering, 3, rows, nullptr, 0, 0, 0, 0};
  for (int s = 0; s < n_samples; ++s)
    for (int py = 0; py < height; ++py)
      for (int px = 0; px < (width + 7) / 8 * 8; ++px) {
        const uint32_t id = samples[s].ids[py * kTileSize + px];
        if (id == 0) continue;
        interpolate_pixel(*triangles[id - 1], samples[s].origin, px, py, target, 0);
        accumulate_lane(0, py * kTileSize + px, 1, rows, nullptr, nullptr, background, sums);
      }
}

void paint_colors(const uint32_t* ids, int width, int height, const RasterTriangle* const* triangles, int rendering,
                  SamplePosition origin, const uint8_t background[3], uint8_t* rgb, ptrdiff_t stride) {
  float rows[3 * kBatchLanes];
  const InterpolateTarget target{rendering, 3, rows, nullptr, 0, 0, 0, 0};
  for (int py = 0; py < height; ++py)
    for (int px = 0; px < width; ++px) {
      uint8_t* const out = rgb + py * stride + 3 * px;
      const uint32_t id = ids[py * kTileSize + px];
      if (id != 0) interpolate_pixel(*triangles[id - 1], origin, px, py, target, 0);
      for (int c = 0; c < 3; ++c)
        out[c] =
            id == 0 ? background[c] : static_cast<uint8_t>(final_color(rows, nullptr, nullptr, c * kBatchLanes) + 0.5f);
    }
}

void resolve_row(const uint16_t* sums, int shift, int width, uint8_t* rgb) {
  for (int x = 0; x < width; ++x)
    for (int c = 0; c < 3; ++c) rgb[3 * x + c] = static_cast<uint8_t>(sums[c * kTileSize * kTileSize + x] >> shift);
}

}  // namespace

void fill_tile_scalar(TileKernels& table) {
  fill_shade_scalar(table);
  fill_texture_scalar(table);
  fill_paint_scalar(table);
  table.rasterize = rasterize;
  table.rasterize_all = rasterize_all;
  table.collect_packs = collect_packs;
  table.collect_groups = collect_groups;
  table.interpolate = interpolate;
  table.interpolate_lanes = interpolate_lanes;
  table.interpolate_groups = interpolate_groups;
  table.footprint = footprint;
  table.blend = blend;
  table.accumulate = accumulate;
  table.accumulate_lanes = accumulate_lanes;
  table.add_colors = add_colors;
  table.paint_colors = paint_colors;
  table.resolve_row = resolve_row;
}

}  // namespace pac
