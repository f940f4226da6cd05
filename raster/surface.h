// What one rendering makes of each material: how corners are colored and how samples are shaded.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "base/kernels/tile_kernels.h"
#include "base/result.h"
#include "raster/renderer.h"
#include "raster/scene.h"
#include "raster/shadows.h"

namespace pac::raster {

// The attributes that a triangle's record holds, in this order, each where something reads it: color (3, always),
// texture coordinates (2), vertex alpha (1, in 0..255), specular color (3, where corners are lit and a texture must not
// touch it), normal (3), position (3), tangent and bitangent (6: right and up in the texture). -1 = absent.
struct AttributeLayout {
  int count = 3;
  int uv = -1;
  int alpha = -1;
  int specular = -1;
  int normal = -1;
  int position = -1;
  int tangents = -1;

  bool operator==(const AttributeLayout&) const = default;
};

// What only some materials have.
struct SurfaceMaps {
  bool has_normal = false, has_specular = false, has_emission = false, has_environment = false;
  TextureSampler normal, specular, emission, environment;
  float normal_scale = 1;
  float emission_color[3] = {0, 0, 0};  // of texel 1 = 1/255
  float reflection[3] = {0, 0, 0};      // likewise
  float environment_lod = 0;
};

struct Surface {
  enum class Lit : uint8_t { no, per_face, per_corner, per_sample } lit = Lit::no;
  bool drop_back_faces = false;
  AttributeLayout layout;
  float mean[3] = {1, 1, 1};  // the mean texel / 255 where a texture is switched off
  LightingParameters lighting;
  const ShadowScene* shadows = nullptr;  // full lighting
  bool textured = false;                 // colors are multiplied by texels
  bool alpha_textured = false;           // alpha is multiplied by texels
  TextureSampler sampler;                // where either is
  float lod_bias = 0, lod_scale = 1;     // log2 and the distance of samples in pixels
  int max_probes = 1;                    // anisotropic filter
  std::unique_ptr<SurfaceMaps> maps;
  AlphaMode alpha = AlphaMode::opaque;
  float alpha_cutoff = 0;
  float opacity = 1;  // where alpha is not textured, with the mean texel's
  bool fogged = false;
  FogParameters fog;
  uint32_t batch = 0;  // surfaces of equal `batch` may be shaded together: the number of the first of them
};

// One Surface a material; `shadows` is given where the quality asks for full lighting. Fails with corrupt (texture
// index out of range) or limit_exceeded (too many lights, texture sides over 32768). The scene's textures and `shadows`
// must outlive the surfaces.
Result<void> prepare_surfaces(const Scene& scene, const Camera& camera, const RenderQuality& quality,
                              const ShadowScene* shadows, std::vector<Surface>& surfaces);

// The same for depth alone: nothing but masks is shaded.
Result<void> prepare_depth_surfaces(const Scene& scene, std::vector<Surface>& surfaces);

}  // namespace pac::raster
