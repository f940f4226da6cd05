// Normative definitions: one lane or one sample at a time.
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
      ids[at] = id;
    }
  }
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

// Analytic derivatives of u and v: with weights l_i = f_i / q, dl_i = (df_i - l_i dq) / q.
float lane_lod(const RasterTriangle& t, const LaneWeights& lane, const float* uv, const InterpolateTarget& target) {
  float squared[2];
  for (int axis = 0; axis < 2; ++axis) {
    const int32_t* gradient = axis == 0 ? t.a : t.b;
    const float g0 = pixel_gradient(gradient[0], t.shift) * t.w[0];
    const float g1 = pixel_gradient(gradient[1], t.shift) * t.w[1];
    const float g2 = pixel_gradient(gradient[2], t.shift) * t.w[2];
    const float gq = (g0 + g1) + g2;
    const float d1 = g1 - lane.l1 * gq, d2 = g2 - lane.l2 * gq;
    const float du = d1 * (uv[1] * target.width) + d2 * (uv[2] * target.width);
    const float dv = d1 * (uv[4] * target.height) + d2 * (uv[5] * target.height);
    squared[axis] = du * du + dv * dv;
  }
  const float rho = std::max(squared[0], squared[1]) * (lane.r * lane.r);
  const float bounded = std::min(std::max(rho, 0x1p-60f), 0x1p60f);
  return 0.5f * log2_estimate(bounded) + target.lod_bias;
}

void interpolate(const LanePack* packs, int n, SamplePosition origin, const InterpolateTarget& target) {
  for (int p = 0; p < n; ++p) {
    const RasterTriangle& t = *packs[p].triangle;
    const float* attributes = t.attributes[target.rendering];
    const int32_t x = origin.x + 256 * packs[p].x - t.x0, y = origin.y + 256 * packs[p].y - t.y0;
    const int64_t first1 = edge(t, 1, x, y), first2 = edge(t, 2, x, y);
    for (int k = 0; k < 8; ++k) {
      const LaneWeights lane = lane_weights(t, first1, first2, k);
      for (int j = 0; j < target.n_attributes; ++j) {
        const float* a = attributes + 3 * j;
        target.rows[j * kBatchLanes + 8 * p + k] = (a[0] + lane.l1 * a[1]) + lane.l2 * a[2];
      }
      if (target.lod != nullptr) target.lod[8 * p + k] = lane_lod(t, lane, attributes + 3 * target.uv, target);
    }
  }
}

struct Vector {
  float x, y, z;
};
float dot(Vector a, Vector b) {
  return (a.x * b.x + a.y * b.y) + a.z * b.z;
}
// Unit length, or `otherwise` where the length is not a number in [2^-50, 2^60].
Vector normalized(Vector v, Vector otherwise) {
  const float squared = dot(v, v);
  if (!(squared >= 0x1p-100f && squared <= 0x1p120f)) return otherwise;
  const float r = 1.0f / std::sqrt(squared);
  return {v.x * r, v.y * r, v.z * r};
}

// By repeated squaring; base in [0, 1 + a few ulp].
float power(float base, int exponent) {
  float result = 1.0f;
  for (int e = exponent; e > 0; e >>= 1) {
    if ((e & 1) != 0) result = result * base;
    base = base * base;
  }
  return result;
}

// visibility: of the ambient light, then of light i at (i + 1) * kBatchLanes; or null.
void light_lane(const LightingParameters& m, Vector normal, Vector at, const float* visibility, float* color[3],
                float* specular[3]) {
  const Vector to_eye{m.eye[0] - at.x, m.eye[1] - at.y, m.eye[2] - at.z};
  const Vector v = normalized(to_eye, {0, 0, 1});
  const Vector n = normalized(normal, v);
  const float sky = visibility != nullptr ? visibility[0] : 1.0f;
  float diffuse_sum[3] = {m.ambient[0] * sky, m.ambient[1] * sky, m.ambient[2] * sky}, specular_sum[3] = {0, 0, 0};
  for (int i = 0; i < m.light_count; ++i) {
    const KernelLight& light = m.lights[i];
    Vector l{light.vector[0], light.vector[1], light.vector[2]};
    float intensity = 1.0f;
    if (light.is_point != 0) {
      const Vector to_light{l.x - at.x, l.y - at.y, l.z - at.z};
      l = normalized(to_light, n);
      const float squared = std::min(dot(to_light, to_light), 0x1p120f);
      intensity = 1.0f / (1.0f + squared * (light.inverse_range * light.inverse_range));
      const float along = 0.0f - dot({light.axis[0], light.axis[1], light.axis[2]}, l);
      intensity = intensity * std::min(std::max(along * light.cone_scale + light.cone_offset, 0.0f), 1.0f);
    }
    if (visibility != nullptr) intensity = intensity * visibility[(i + 1) * kBatchLanes];
    const float n_dot_l = std::max(dot(n, l), 0.0f);
    const float diffuse = n_dot_l * intensity;
    for (int c = 0; c < 3; ++c) diffuse_sum[c] = diffuse_sum[c] + light.diffuse[c] * diffuse;
    if (m.has_specular == 0) continue;
    const Vector h = normalized({l.x + v.x, l.y + v.y, l.z + v.z}, {0, 0, 0});
    const float lobe = power(std::max(dot(n, h), 0.0f), m.shininess);
    const float gloss = n_dot_l > 0.0f ? lobe * intensity : 0.0f;
    for (int c = 0; c < 3; ++c) specular_sum[c] = specular_sum[c] + light.specular[c] * gloss;
  }
  for (int c = 0; c < 3; ++c) {
    *color[c] = m.emission[c] + (*color[c] * (1.0f / 255.0f)) * diffuse_sum[c];
    if (m.has_specular != 0) *specular[c] = specular_sum[c];
  }
}

void light(const LightingParameters& parameters, int n, const float* normal, const float* position,
           const float* visibility, float* color, float* specular) {
  for (int k = 0; k < (n + 7) / 8 * 8; ++k) {
    float* colors[3] = {color + k, color + kBatchLanes + k, color + 2 * kBatchLanes + k};
    float* speculars[3] = {specular + k, specular + kBatchLanes + k, specular + 2 * kBatchLanes + k};
    light_lane(parameters, {normal[k], normal[kBatchLanes + k], normal[2 * kBatchLanes + k]},
               {position[k], position[kBatchLanes + k], position[2 * kBatchLanes + k]},
               visibility != nullptr ? visibility + k : nullptr, colors, speculars);
  }
}

Vector cross(Vector a, Vector b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Vector difference(Vector a, const float* b) {
  return {a.x - b[0], a.y - b[1], a.z - b[2]};
}

struct Ray {
  Vector origin, direction, inverse;
  float limit;
};

// 1 / d, with a huge number instead of infinity, so that 0 * infinity cannot occur in the slab test.
float safe_inverse(float d) {
  constexpr float kTiny = 1e-12f;
  return 1.0f / (d < 0.0f ? std::min(d, -kTiny) : std::max(d, kTiny));
}

bool enters(const RayNode& node, const Ray& ray) {
  const Vector low{node.low[0] - ray.origin.x, node.low[1] - ray.origin.y, node.low[2] - ray.origin.z};
  const Vector high{node.high[0] - ray.origin.x, node.high[1] - ray.origin.y, node.high[2] - ray.origin.z};
  const float x0 = low.x * ray.inverse.x, x1 = high.x * ray.inverse.x;
  const float y0 = low.y * ray.inverse.y, y1 = high.y * ray.inverse.y;
  const float z0 = low.z * ray.inverse.z, z1 = high.z * ray.inverse.z;
  const float in = std::max(std::max(std::min(x0, x1), std::min(y0, y1)), std::max(std::min(z0, z1), 0.0f));
  const float out = std::min(std::min(std::max(x0, x1), std::max(y0, y1)), std::min(std::max(z0, z1), ray.limit));
  return in <= out;
}

// Moeller and Trumbore's test. Neighbours overlap by a little: no ray slips between them.
bool hits(const RayTriangle& t, const Ray& ray, float back_limit) {
  constexpr float kSlack = 1e-6f;
  const Vector edge1{t.edge1[0], t.edge1[1], t.edge1[2]}, edge2{t.edge2[0], t.edge2[1], t.edge2[2]};
  const Vector p = cross(ray.direction, edge2);
  const float determinant = dot(edge1, p);
  const float scale = 1.0f / determinant;  // infinity for a parallel ray: then some comparison below is false
  const Vector s = difference(ray.origin, t.corner);
  const float u = dot(s, p) * scale;
  const Vector q = cross(s, edge1);
  const float v = dot(ray.direction, q) * scale;
  const float distance = dot(edge2, q) * scale;
  const bool inside = u >= -kSlack && v >= -kSlack && u + v <= 1.0f + kSlack;
  const float nearest = determinant < 0.0f ? back_limit : 0.0f;
  return inside && distance > nearest && distance < ray.limit;
}

bool is_occluded(const RayTree& tree, const Ray& ray) {
  uint32_t stack[kMaxRayDepth + 1];
  int depth = 0;
  for (uint32_t at = 0;;) {
    const RayNode& node = tree.nodes[at];
    if (enters(node, ray)) {
      if (node.count == 0) {
        stack[depth++] = node.first;
        ++at;
        continue;
      }
      for (uint32_t i = node.first; i < node.first + node.count; ++i)
        if (hits(tree.triangles[i], ray, tree.back_limit)) return true;
    }
    if (depth == 0) return false;
    at = stack[--depth];
  }
}

uint32_t occluded(const RayTree& tree, const float* origin, const float* direction, const float* limit, uint32_t mask) {
  uint32_t found = 0;
  for (uint32_t k = 0; k < 8 && tree.nodes != nullptr; ++k) {
    if ((mask >> k & 1) == 0) continue;
    const Vector d{direction[k], direction[kBatchLanes + k], direction[2 * kBatchLanes + k]};
    const Ray ray{{origin[k], origin[kBatchLanes + k], origin[2 * kBatchLanes + k]},
                  d,
                  {safe_inverse(d.x), safe_inverse(d.y), safe_inverse(d.z)},
                  limit[k]};
    found |= is_occluded(tree, ray) ? 1u << k : 0u;
  }
  return found;
}

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

// Red, green, blue minus 128 in 1/128: in [-16384, 16256]. Vertical weights have 7 bits, horizontal ones 8.
void bilinear(const TextureSampler& texture, int level, float u, float v, int32_t out[3]) {
  const Taps x = taps(u, texture.width[level], texture.clamp, 128);
  const Taps y = taps(v, texture.height[level], texture.clamp, 128);
  const uint8_t* top = texel(texture, level, x.first, y.first);
  const uint8_t* bottom = texel(texture, level, x.first, y.second);
  const int32_t lower = y.fraction >> 1;
  for (int c = 0; c < 3; ++c) {
    const int32_t left = (top[c] - 128) * (128 - lower) + (bottom[c] - 128) * lower;
    const int32_t right = (top[c + 4] - 128) * (128 - lower) + (bottom[c + 4] - 128) * lower;
    out[c] = mix(left, right, x.fraction);
  }
}

void sample_texture(const TextureSampler& texture, int n, const float* u, const float* v, const float* lod,
                    float* texels) {
  const float last_level = static_cast<float>(texture.level_count - 1);
  for (int k = 0; k < (n + 7) / 8 * 8; ++k) {
    const float bounded = std::min(std::max(lod[k], 0.0f), last_level);
    int32_t color[3];
    if (texture.filter == 2) {
      const int32_t fixed = static_cast<int32_t>(bounded * 256.0f);
      const int32_t level = fixed >> 8;
      int32_t coarse[3];
      bilinear(texture, level, u[k], v[k], color);
      bilinear(texture, std::min(level + 1, texture.level_count - 1), u[k], v[k], coarse);
      for (int c = 0; c < 3; ++c) color[c] = mix(color[c], coarse[c], fixed & 255);
    } else {
      const int32_t level = static_cast<int32_t>(bounded + 0.5f);
      if (texture.filter == 1) {
        bilinear(texture, level, u[k], v[k], color);
      } else {
        const uint8_t* nearest = texel(texture, level, taps(u[k], texture.width[level], texture.clamp, 0).first,
                                       taps(v[k], texture.height[level], texture.clamp, 0).first);
        for (int c = 0; c < 3; ++c) color[c] = (nearest[c] - 128) * 128;
      }
    }
    for (int c = 0; c < 3; ++c) texels[c * kBatchLanes + k] = static_cast<float>(color[c]) * (1.0f / 128.0f) + 128.0f;
  }
}

void accumulate(const LanePack* packs, int n, bool weighted, const float* color, const float* texels,
                const float* specular, const uint8_t background[3], uint16_t* sums) {
  for (int p = 0; p < n; ++p) {
    for (int k = 0; k < 8; ++k) {
      if ((packs[p].mask >> k & 1) == 0) continue;
      const int at = packs[p].y * kTileSize + packs[p].x + k;
      for (int c = 0; c < 3; ++c) {
        const int row = c * kBatchLanes + 8 * p + k;
        float value = color[row];
        if (texels != nullptr) value = (value * texels[row]) * (1.0f / 255.0f);
        if (specular != nullptr) value = value + specular[row];
        const int byte = static_cast<int>(std::min(std::max(value, 0.0f), 255.0f) + 0.5f);
        uint16_t& sum = sums[c * kTileSize * kTileSize + at];
        sum = static_cast<uint16_t>(sum + (byte - background[c]) * (weighted ? packs[p].weight[k] : 1));
      }
    }
  }
}

void resolve_row(const uint16_t* sums, int shift, int width, uint8_t* rgb) {
  for (int x = 0; x < width; ++x)
    for (int c = 0; c < 3; ++c) rgb[3 * x + c] = static_cast<uint8_t>(sums[c * kTileSize * kTileSize + x] >> shift);
}

}  // namespace

void fill_tile_scalar(TileKernels& table) {
  table.rasterize = rasterize;
  table.collect_packs = collect_packs;
  table.interpolate = interpolate;
  table.light = light;
  table.occluded = occluded;
  table.sample_texture = sample_texture;
  table.accumulate = accumulate;
  table.resolve_row = resolve_row;
}

}  // namespace pac
