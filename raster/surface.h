// What one rendering makes of each material: how corners are colored and how samples are shaded.
#pragma once

#include <cstdint>
#include <vector>

#include "base/kernels/tile_kernels.h"
#include "base/result.h"
#include "raster/renderer.h"
#include "raster/scene.h"
#include "raster/shadows.h"

namespace pac::raster {

// The attributes that a triangle's record holds, in this order: color (3), texture coordinates (2, if textured), then
// specular color (3, where corners are lit and a texture must not touch it) or normal and position (6, if lit at
// samples). -1 = absent.
struct AttributeLayout {
  int count = 3;
  int uv = -1;
  int specular = -1;
  int normal = -1;
  int position = -1;

  bool operator==(const AttributeLayout&) const = default;
};

struct Surface {
  enum class Lit : uint8_t { no, per_face, per_corner, per_sample } lit = Lit::no;
  bool drop_back_faces = false;
  AttributeLayout layout;
  float mean[3] = {1, 1, 1};  // the mean texel / 255 where a texture is switched off
  LightingParameters lighting;
  const ShadowScene* shadows = nullptr;  // full lighting
  TextureSampler sampler;
  float lod_bias = 0;
  uint32_t batch = 0;  // surfaces of equal `batch` may be shaded together: the number of the first of them
};

// One Surface a material; `shadows` is given where the quality asks for full lighting. Fails with corrupt (texture
// index out of range) or limit_exceeded (too many lights, texture sides over 32768). The scene's textures and `shadows`
// must outlive the surfaces.
Result<void> prepare_surfaces(const Scene& scene, const Camera& camera, const RenderQuality& quality,
                              const ShadowScene* shadows, std::vector<Surface>& surfaces);

}  // namespace pac::raster
