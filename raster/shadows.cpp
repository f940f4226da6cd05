#include "raster/shadows.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/exact_math.h"

namespace pac::raster {
namespace {

constexpr int kLanes = 8;

// The rays of eight lanes, in the kernels' layout of rows.
struct Rays {
  alignas(32) float origin[3 * kBatchLanes];
  alignas(32) float direction[3 * kBatchLanes];
  alignas(32) float limit[kLanes];
};

// To unit length; false where there is none.
bool normalize(float v[3]) {
  const float squared = (v[0] * v[0] + v[1] * v[1]) + v[2] * v[2];
  if (!(squared >= 0x1p-100f && squared <= 0x1p120f)) return false;
  const float r = 1.0f / std::sqrt(squared);
  for (int c = 0; c < 3; ++c) v[c] = v[c] * r;
  return true;
}

// Eight points to light: their unit normals and where their rays start.
struct Points {
  float normal[kLanes][3];
  uint32_t mask;  // those with a normal
};

Points start_rays(const ShadowScene& scene, uint32_t mask, const float* normal, const float* position, Rays& rays) {
  Points points{};
  for (int k = 0; k < kLanes; ++k) {
    float* n = points.normal[k];
    for (int c = 0; c < 3; ++c) n[c] = normal[c * kBatchLanes + k];
    if ((mask >> k & 1) != 0 && normalize(n)) points.mask |= 1u << k;
    for (int c = 0; c < 3; ++c) rays.origin[c * kBatchLanes + k] = position[c * kBatchLanes + k] + n[c] * scene.offset;
  }
  return points;
}

// Lanes whose ray towards one sample of the light leaves above the surface; the others see nothing of it.
uint32_t aim(const KernelLight& light, const float sample[3], const Points& points, Rays& rays) {
  uint32_t lanes = 0;
  for (int k = 0; k < kLanes; ++k) {
    if ((points.mask >> k & 1) == 0) continue;
    float d[3];
    for (int c = 0; c < 3; ++c) {
      d[c] = light.vector[c] + light.radius * sample[c];
      if (light.is_point != 0) d[c] = d[c] - rays.origin[c * kBatchLanes + k];
    }
    const float squared = (d[0] * d[0] + d[1] * d[1]) + d[2] * d[2];
    if (!normalize(d)) continue;
    const float* n = points.normal[k];
    if (!((n[0] * d[0] + n[1] * d[1]) + n[2] * d[2] > 0.0f)) continue;
    rays.limit[k] = light.is_point != 0 ? std::sqrt(squared) : 0x1p100f;
    for (int c = 0; c < 3; ++c) rays.direction[c * kBatchLanes + k] = d[c];
    lanes |= 1u << k;
  }
  return lanes;
}

// A direction of the hemisphere around the normal, as probable as its cosine: normal + a point of the unit sphere.
uint32_t aim_at_sky(const float sample[3], float reach, const Points& points, Rays& rays) {
  uint32_t lanes = 0;
  for (int k = 0; k < kLanes; ++k) {
    if ((points.mask >> k & 1) == 0) continue;
    float d[3];
    for (int c = 0; c < 3; ++c) d[c] = points.normal[k][c] + sample[c];
    if (!normalize(d)) std::copy_n(points.normal[k], 3, d);
    rays.limit[k] = reach;
    for (int c = 0; c < 3; ++c) rays.direction[c * kBatchLanes + k] = d[c];
    lanes |= 1u << k;
  }
  return lanes;
}

// Fractions of `total` rays that arrived; lanes without a normal are lit as if in the open.
void store_fractions(const Points& points, const int seen[kLanes], int total, float* row) {
  for (int k = 0; k < kLanes; ++k)
    row[k] = (points.mask >> k & 1) == 0 ? 1.0f : static_cast<float>(seen[k]) / static_cast<float>(total);
}

void count_lanes(uint32_t lanes, int seen[kLanes]) {
  for (; lanes != 0; lanes &= lanes - 1) ++seen[std::countr_zero(lanes)];
}

void look_up_maps(const ShadowScene& scene, const TileKernels& kernels, const LightingParameters& lighting, int n,
                  const float* normal, const float* position, float* visibility) {
  std::fill_n(visibility, kLanes * n, 1.0f);
  for (int l = 0; l < lighting.light_count; ++l) {
    float* row = visibility + (l + 1) * kBatchLanes;
    if (scene.maps[l].depths != nullptr)
      kernels.shadow_map(scene.maps[l], kLanes * n, normal, position, row);
    else
      std::fill_n(row, kLanes * n, 1.0f);
  }
}

}  // namespace

LightSamples make_light_samples(int count) {
  LightSamples samples{};
  samples.count = std::clamp(count, 1, kMaxLightSamples);
  const int n = samples.count;
  if (n == 1) {  // the middle of the light; the zenith
    samples.sphere[0][0] = samples.sphere[0][1] = samples.sphere[0][2] = 0;
    return samples;
  }
  int stride = static_cast<int>(0.38 * n + 0.5);  // through the spiral, so that neighbors are far apart
  const auto common = [&](int a, int b) {
    while (b != 0) {
      const int rest = a % b;
      a = b;
      b = rest;
    }
    return a;
  };
  while (common(stride, n) != 1) ++stride;
  constexpr double kGoldenAngle = 2.39996322972865332;
  for (int i = 0; i < n; ++i) {
    const int at = i * stride % n;
    const double z = 1.0 - (2 * at + 1) / static_cast<double>(n);
    const double ring = std::sqrt(1.0 - z * z), angle = kGoldenAngle * at;
    const double point[3] = {ring * exact_cos(angle), z, ring * exact_sin(angle)};
    // Radii of equal volume, in an order of their own.
    const double volume = (((at * stride) % n) + 0.5) / n;
    const double radius = exact_pow(volume, 1.0 / 3.0);
    for (int c = 0; c < 3; ++c) {
      samples.sphere[i][c] = static_cast<float>(point[c]);
      samples.ball[i][c] = static_cast<float>(radius * point[c]);
    }
  }
  return samples;
}

void cast_shadows(const ShadowScene& scene, const TileKernels& kernels, const LightingParameters& lighting, int n,
                  const uint8_t* masks, SampleRange range, const float* normal, const float* position,
                  float* visibility) {
  if (scene.by_maps) return look_up_maps(scene, kernels, lighting, n, normal, position, visibility);
  Rays rays{};
  const auto sample_number = [&](int i) { return (range.first + i) % scene.samples.count; };
  for (int group = 0; group < n; ++group) {
    const int at = kLanes * group;
    const Points points = start_rays(scene, masks[group], normal + at, position + at, rays);
    int sky[kLanes] = {};
    const int n_sky = scene.ambient_reach > 0 ? range.count : 0;
    for (int i = 0; i < n_sky; ++i) {
      const uint32_t lanes = aim_at_sky(scene.samples.sphere[sample_number(i)], scene.ambient_reach, points, rays);
      count_lanes(lanes & ~kernels.occluded(scene.tree, rays.origin, rays.direction, rays.limit, lanes), sky);
    }
    if (n_sky > 0)
      store_fractions(points, sky, n_sky, visibility + at);
    else
      std::fill_n(visibility + at, kLanes, 1.0f);

    for (int l = 0; l < lighting.light_count; ++l) {
      const KernelLight& light = lighting.lights[l];
      float* row = visibility + (l + 1) * kBatchLanes + at;
      if (light.has_shadow == 0) {
        std::fill_n(row, kLanes, 1.0f);
        continue;
      }
      int seen[kLanes] = {};
      static constexpr float kMiddle[3] = {0, 0, 0};
      const int n_samples = light.radius > 0 ? range.count : 1;
      for (int i = 0; i < n_samples; ++i) {
        const float* sample = light.radius > 0 ? scene.samples.ball[sample_number(i)] : kMiddle;
        const uint32_t lanes = aim(light, sample, points, rays);
        count_lanes(lanes & ~kernels.occluded(scene.tree, rays.origin, rays.direction, rays.limit, lanes), seen);
      }
      store_fractions(points, seen, n_samples, row);
    }
  }
}

}  // namespace pac::raster
