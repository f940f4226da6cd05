// Normative definitions of lights, shadows, normal maps, reflections and fog: one lane at a time.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/kernels/tile_kernels.h"

namespace pac {
namespace {

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

// In [low, high]; what is not a number becomes low.
float clamped(float value, float low, float high) {
  return std::min(std::max(low, value), high);
}

Vector row_vector(const float* rows, int k) {
  return {rows[k], rows[kBatchLanes + k], rows[2 * kBatchLanes + k]};
}

// The part of v that is orthogonal to the unit vector n, of unit length, or zero.
Vector tangent_part(Vector v, Vector n) {
  const float along = dot(n, v);
  return normalized({v.x - n.x * along, v.y - n.y * along, v.z - n.z * along}, {0, 0, 0});
}

void bend_normals(int n, float scale, const float* texels, const float* tangents, float* normal) {
  for (int k = 0; k < (n + 7) / 8 * 8; ++k) {
    const Vector old = normalized(row_vector(normal, k), {0, 0, 0});
    const Vector t = tangent_part(row_vector(tangents, k), old);
    const Vector b = tangent_part(row_vector(tangents + 3 * kBatchLanes, k), old);
    if (!(std::min(std::min(dot(old, old), dot(t, t)), dot(b, b)) >= 0.5f)) continue;
    const Vector map = row_vector(texels, k);
    const float x = ((map.x - 128.0f) * (1.0f / 127.0f)) * scale, y = ((map.y - 128.0f) * (1.0f / 127.0f)) * scale,
                z = (map.z - 128.0f) * (1.0f / 127.0f);
    normal[k] = (t.x * x + b.x * y) + old.x * z;
    normal[kBatchLanes + k] = (t.y * x + b.y * y) + old.y * z;
    normal[2 * kBatchLanes + k] = (t.z * x + b.z * y) + old.z * z;
  }
}

// Angle of (x, y) from the x axis in turns, in [-0.5, 0.5], within 2e-6. atan by a polynomial in [0, 1]
// [Abramowitz and Stegun 4.4.49 in a shorter form].
float angle_turns(float y, float x) {
  const float ax = std::max(x, 0.0f - x), ay = std::max(y, 0.0f - y);
  const float a = std::min(ax, ay) / std::max(std::max(ax, ay), 0x1p-60f);
  const float s = a * a;
  float p = -0.01172120f * s + 0.05265332f;
  p = p * s - 0.11643287f;
  p = p * s + 0.19354346f;
  p = p * s - 0.33262347f;
  p = p * s + 0.99997726f;
  float turns = (p * a) * 0.15915494f;
  if (ax < ay) turns = 0.25f - turns;
  if (x < 0.0f) turns = 0.5f - turns;
  return y < 0.0f ? 0.0f - turns : turns;
}

void reflect(const float eye[3], int n, const float* normal, const float* position, float* u, float* v) {
  for (int k = 0; k < (n + 7) / 8 * 8; ++k) {
    const Vector at = row_vector(position, k);
    const Vector view = normalized({eye[0] - at.x, eye[1] - at.y, eye[2] - at.z}, {0, 0, 1});
    const Vector up = normalized(row_vector(normal, k), view);
    const float twice = 2.0f * dot(up, view);
    const Vector r{up.x * twice - view.x, up.y * twice - view.y, up.z * twice - view.z};
    u[k] = angle_turns(r.x, 0.0f - r.z) + 0.5f;
    v[k] = 2.0f * angle_turns(std::sqrt(r.x * r.x + r.z * r.z), r.y);
  }
}

// 2^x within 2e-6 of it; x clamped to [-126, 0].
float exp2_of_negative(float x) {
  const float bounded = clamped(x, -126.0f, 0.0f);
  const float whole = std::floor(bounded), f = bounded - whole;
  float p = 0.00187758f * f + 0.00898934f;
  p = p * f + 0.05582631f;
  p = p * f + 0.24015361f;
  p = p * f + 0.69315307f;
  p = p * f + 1.0f;
  const uint32_t bits = static_cast<uint32_t>(static_cast<int32_t>(whole) + 127) << 23;
  float power;
  std::memcpy(&power, &bits, sizeof power);
  return p * power;
}

float fog_share(const FogParameters& fog, Vector at) {
  const Vector from_eye{at.x - fog.eye[0], at.y - fog.eye[1], at.z - fog.eye[2]};
  const float distance = std::sqrt(dot(from_eye, from_eye));
  if (fog.power == 0) return clamped((fog.end - distance) * fog.rate, 0.0f, 1.0f);
  const float x = distance * fog.rate;
  return exp2_of_negative(0.0f - (fog.power == 1 ? x : x * x));
}

void fog(const FogParameters& parameters, int n, const float* position, const float* texels, const float* specular,
         float* color) {
  for (int k = 0; k < (n + 7) / 8 * 8; ++k) {
    const float share = fog_share(parameters, row_vector(position, k));
    for (int c = 0; c < 3; ++c) {
      const int row = c * kBatchLanes + k;
      float value = color[row];
      if (texels != nullptr) value = (value * texels[row]) * (1.0f / 255.0f);
      if (specular != nullptr) value = value + specular[row];
      color[row] = parameters.color[c] + (clamped(value, 0.0f, 255.0f) - parameters.color[c]) * share;
    }
  }
}

float transformed(const float row[4], Vector p) {
  return ((row[0] * p.x + row[1] * p.y) + row[2] * p.z) + row[3];
}

float shadow_share(const ShadowMap& map, Vector normal, Vector at) {
  const Vector n = normalized(normal, {0, 0, 0});
  const Vector q{at.x + map.normal_offset * n.x, at.y + map.normal_offset * n.y, at.z + map.normal_offset * n.z};
  const float w = transformed(map.m[3], q);
  const float inverse = 1.0f / std::max(0x1p-60f, w);
  const auto side = static_cast<float>(map.side);
  const float column = transformed(map.m[0], q) * inverse, row = transformed(map.m[1], q) * inverse;
  const float z = transformed(map.m[2], q) * inverse - map.depth_bias;
  if (!(w >= 0x1p-60f && column >= 0.0f && column <= side && row >= 0.0f && row <= side)) return 1.0f;
  const float x = column - 0.5f, y = row - 0.5f;
  const float left = std::floor(x), top = std::floor(y), fx = x - left, fy = y - top;
  const float weight_x[4] = {1.0f - fx, 1.0f, 1.0f, fx}, weight_y[4] = {1.0f - fy, 1.0f, 1.0f, fy};
  float sum = 0;
  for (int j = 0; j < 4; ++j) {
    const int32_t texel_y = std::min(std::max(static_cast<int32_t>(top) + (j - 1), 0), map.side - 1);
    float line = 0;
    for (int i = 0; i < 4; ++i) {
      const int32_t texel_x = std::min(std::max(static_cast<int32_t>(left) + (i - 1), 0), map.side - 1);
      const float lit = z <= map.depths[texel_y * map.side + texel_x] ? 1.0f : 0.0f;
      line = line + weight_x[i] * lit;
    }
    sum = sum + weight_y[j] * line;
  }
  return sum * (1.0f / 9.0f);
}

void shadow_map(const ShadowMap& map, int n, const float* normal, const float* position, float* share) {
  for (int k = 0; k < (n + 7) / 8 * 8; ++k)
    share[k] = shadow_share(map, row_vector(normal, k), row_vector(position, k));
}

}  // namespace

void fill_shade_scalar(TileKernels& table) {
  table.light = light;
  table.occluded = occluded;
  table.bend_normals = bend_normals;
  table.reflect = reflect;
  table.fog = fog;
  table.shadow_map = shadow_map;
}

}  // namespace pac
