#include "raster/surface.h"

#include <algorithm>
#include <cmath>

namespace pac::raster {
namespace {

// Finite and of bounded magnitude; what is not a number becomes 0.
float bounded(float value, float limit) {
  if (!(std::fabs(value) <= INFINITY)) return 0.0f;
  return std::min(std::max(value, -limit), limit);
}

constexpr float kColorLimit = 1024.0f;         // 1 = full intensity
constexpr float kPositionLimit = 0x1p60f;      // squares stay finite
constexpr float kSmallestRange = 1.0f / 1e6f;  // of a point light

// Unit length, or zero where there is no direction.
void set_direction(const glm::vec3& direction, float sign, float out[3]) {
  float squared = 0;
  for (int c = 0; c < 3; ++c) {
    out[c] = sign * bounded(direction[c], 0x1p40f);
    squared = squared + out[c] * out[c];
  }
  const float scale = squared >= 0x1p-100f ? 1.0f / std::sqrt(squared) : 0.0f;
  for (int c = 0; c < 3; ++c) out[c] = out[c] * scale;
}

// Linear in the cosine: 0 at the outer angle, 1 at the inner one.
void set_cone(const Light& light, KernelLight& out) {
  out.cone_scale = 0;
  out.cone_offset = 1;
  for (float& component : out.axis) component = 0;
  if (light.kind != Light::Kind::spot) return;
  set_direction(light.direction, 1.0f, out.axis);
  const float outer = bounded(light.cone_outer, 1.0f);
  out.cone_scale = 1.0f / std::max(bounded(light.cone_inner, 1.0f) - outer, 1e-4f);
  out.cone_offset = -outer * out.cone_scale;
}

void set_light(const Light& light, const Material& material, KernelLight& out) {
  out.is_point = light.kind != Light::Kind::directional ? 1 : 0;
  for (int c = 0; c < 3; ++c) {
    const float color = bounded(light.color[c], kColorLimit) * 255.0f;
    out.diffuse[c] = color * bounded(material.diffuse[c], kColorLimit);
    out.specular[c] = color * bounded(material.specular[c], kColorLimit);
    out.vector[c] = bounded(light.position[c], kPositionLimit);
  }
  if (out.is_point == 0) set_direction(light.direction, -1.0f, out.vector);
  set_cone(light, out);
  out.radius = std::max(bounded(light.radius, 0x1p40f), 0.0f);
  out.has_shadow = light.casts_shadows ? 1 : 0;
  out.inverse_range = light.range >= kSmallestRange ? 1.0f / light.range : 0.0f;
}

// Colors are scaled by `mean` where the texture is switched off, except the specular ones.
void set_lighting(const Scene& scene, const Camera& camera, const Material& material, Surface& surface) {
  LightingParameters& out = surface.lighting;
  out.light_count = static_cast<int32_t>(scene.lights.size());
  out.shininess = std::clamp(material.shininess, 0, 1000);
  out.has_specular = 0;
  for (int c = 0; c < 3; ++c) {
    out.eye[c] = bounded(camera.eye[c], kPositionLimit);
    out.emission[c] = bounded(material.emission[c], kColorLimit) * 255.0f * surface.mean[c];
    out.ambient[c] = bounded(material.ambient[c], kColorLimit) * bounded(scene.ambient_light[c], kColorLimit) * 255.0f *
                     surface.mean[c];
    if (material.specular[c] != 0) out.has_specular = 1;
  }
  for (size_t i = 0; i < scene.lights.size(); ++i) {
    set_light(scene.lights[i], material, out.lights[i]);
    for (int c = 0; c < 3; ++c) out.lights[i].diffuse[c] = out.lights[i].diffuse[c] * surface.mean[c];
  }
  if (scene.lights.empty()) out.has_specular = 0;
}

Result<void> set_sampler(const Texture& texture, const Material& material, TextureSampler& out) {
  if (texture.levels.size() > kMaxMipLevels || texture.width() > 1 << (kMaxMipLevels - 1) ||
      texture.height() > 1 << (kMaxMipLevels - 1))
    return Failure{Error::limit_exceeded, 0, "texture side over 32768"};
  out.texels = texture.texels.data();
  out.level_count = static_cast<int32_t>(texture.levels.size());
  out.filter = material.filter == Filter::nearest ? 0 : material.filter == Filter::bilinear ? 1 : 2;
  out.clamp = material.wrap == Wrap::clamp ? 1 : 0;
  for (int i = 0; i < kMaxMipLevels; ++i) {  // beyond the last level: the last level again
    const Texture::Level& level = texture.levels[std::min(static_cast<size_t>(i), texture.levels.size() - 1)];
    const size_t size_shift = std::min(static_cast<size_t>(i), texture.levels.size() - 1);
    if (level.width != std::max(texture.width() >> size_shift, 1) ||
        level.height != std::max(texture.height() >> size_shift, 1) || level.width < 1 || level.height < 1 ||
        level.pitch != level.width + 1 ||
        (level.offset + static_cast<size_t>(level.pitch) * static_cast<size_t>(level.height)) * 4 >
            texture.texels.size())
      return Failure{Error::corrupt, 0, "texture was not made by make_texture"};
    out.offset[i] = static_cast<int32_t>(level.offset);
    out.width[i] = level.width;
    out.height[i] = level.height;
    out.pitch[i] = level.pitch;
  }
  return {};
}

Surface::Lit lit_where(const Material& material, const RenderQuality& quality) {
  if (!material.lit) return Surface::Lit::no;
  if (quality.shading == Shading::flat) return Surface::Lit::per_face;
  return quality.shading == Shading::gouraud ? Surface::Lit::per_corner : Surface::Lit::per_sample;
}

AttributeLayout layout_of(const Surface& surface, bool textured) {
  AttributeLayout layout;
  if (textured) {
    layout.uv = layout.count;
    layout.count += 2;
  }
  if (surface.lit == Surface::Lit::per_sample) {
    layout.normal = layout.count;
    layout.position = layout.count + 3;
    layout.count += 6;
  } else if (surface.lit != Surface::Lit::no && textured && surface.lighting.has_specular != 0) {
    layout.specular = layout.count;
    layout.count += 3;
  }
  return layout;
}

}  // namespace

Result<void> prepare_surfaces(const Scene& scene, const Camera& camera, const RenderQuality& quality,
                              const ShadowScene* shadows, std::vector<Surface>& surfaces) {
  if (scene.lights.size() > kMaxKernelLights)
    return Failure{Error::limit_exceeded, scene.lights.size(), "more lights than 16"};
  surfaces.resize(scene.materials.size());
  constexpr uint32_t kNone = UINT32_MAX;
  uint32_t first_plain = kNone;
  float bias = 0;  // -log2(sqrt(places where a pixel is shaded))
  for (int n = quality.shading_samples == 0 ? quality.samples : quality.shading_samples; n > 1; n /= 4) bias -= 1.0f;
  // A pixel's one texel should look like the mean of finer ones: the blur of the filter is less than the pixel's own.
  if (quality.shading_samples != 0) bias -= 0.75f;
  for (uint32_t i = 0; i < surfaces.size(); ++i) {
    const Material& material = scene.materials[i];
    Surface& surface = surfaces[i];
    if (material.texture < -1 || material.texture >= static_cast<int64_t>(scene.textures.size()))
      return Failure{Error::corrupt, i, "material names a texture that does not exist"};
    const Texture* texture = material.texture >= 0 ? &scene.textures[static_cast<size_t>(material.texture)] : nullptr;
    const bool textured = texture != nullptr && quality.texture && !texture->empty();
    surface.drop_back_faces = quality.cull_back_faces && !material.two_sided;
    surface.lit = lit_where(material, quality);
    for (int c = 0; c < 3; ++c)
      surface.mean[c] = texture != nullptr && !textured
                            ? static_cast<float>(texture->mean_color()[static_cast<size_t>(c)]) * (1.0f / 255.0f)
                            : 1.0f;
    surface.lighting.light_count = surface.lighting.has_specular = 0;
    surface.shadows = quality.lighting == Lighting::full ? shadows : nullptr;
    if (surface.lit != Surface::Lit::no) set_lighting(scene, camera, material, surface);
    surface.layout = layout_of(surface, textured);
    surface.lod_bias = bias;
    if (textured) PAC_CHECK(set_sampler(*texture, material, surface.sampler));
    surface.batch = i;
    if (surface.layout == AttributeLayout{}) {  // interpolated colors alone: the material no longer matters
      if (first_plain == kNone) first_plain = i;
      surface.batch = first_plain;
    }
  }
  return {};
}

}  // namespace pac::raster
