// What full lighting adds: how much of each light, and of the ambient light, reaches a point. By rays in fixed
// directions, so that every machine counts the same.
#pragma once

#include <cstdint>

#include "base/kernels/tile_kernels.h"
#include "raster/occluder_tree.h"

namespace pac::raster {

constexpr int kMaxLightSamples = 64;

// Points of the unit ball (for lights) and of the unit sphere (for ambient occlusion): the first n of set n. Fibonacci
// spirals, in an order in which any few neighbors are spread out.
struct LightSamples {
  int count;
  float ball[kMaxLightSamples][3];
  float sphere[kMaxLightSamples][3];
};
LightSamples make_light_samples(int count);

// What the rays of one frame share.
struct ShadowScene {
  RayTree tree;
  float offset;         // of a ray's start from its surface
  float ambient_reach;  // 0: no ambient occlusion
  LightSamples samples;
  // Instead of rays: the map of each light, `depths` null where it casts no shadows.
  bool by_maps = false;
  ShadowMap maps[kMaxKernelLights];
};

// Which of the samples one call uses: `count` from `first` on, in a circle.
struct SampleRange {
  int first, count;
};

// Rows of factors in [0, 1] as TileKernels::light() wants them, for n groups of eight lanes: the ambient light, then
// each light. Lanes outside a group's mask get 1. normal (any length, on the side that is seen), position: 3 rows.
// visibility: 1 + light_count rows.
void cast_shadows(const ShadowScene& scene, const TileKernels& kernels, const LightingParameters& lighting, int n,
                  const uint8_t* masks, SampleRange range, const float* normal, const float* position,
                  float* visibility);

}  // namespace pac::raster
