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
constexpr float kSmallestRange = 1.0f / 1e6f;  // of a point light; of linear fog
constexpr int kMaxAnisotropy = 8;

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

// One of the material's textures besides the base texture.
struct MapChoice {
  bool present = false;
  const Texture* use = nullptr;  // present, and texturing is on
  float mean[3] = {1, 1, 1};     // otherwise 1
};

Result<MapChoice> choose_map(const Scene& scene, int32_t number, bool texture_on, size_t material) {
  if (number < -1 || number >= static_cast<int64_t>(scene.textures.size()))
    return Failure{Error::corrupt, material, "material names a texture that does not exist"};
  MapChoice choice;
  if (number < 0) return choice;
  const Texture& texture = scene.textures[static_cast<size_t>(number)];
  if (texture.empty()) return choice;
  choice.present = true;
  if (texture_on)
    choice.use = &texture;
  else
    for (size_t c = 0; c < 3; ++c) choice.mean[c] = static_cast<float>(texture.mean_color()[c]) * (1.0f / 255.0f);
  return choice;
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
    set_light(posed_light(scene, scene.lights[i]), material, out.lights[i]);
    for (int c = 0; c < 3; ++c) out.lights[i].diffuse[c] = out.lights[i].diffuse[c] * surface.mean[c];
  }
  if (scene.lights.empty()) out.has_specular = 0;
}

int filter_number(Filter filter) {
  return filter == Filter::nearest ? 0 : filter == Filter::bilinear ? 1 : 2;
}

Result<void> set_sampler(const Texture& texture, Filter filter, Wrap wrap, TextureSampler& out) {
  if (texture.levels.size() > kMaxMipLevels || texture.width() > 1 << (kMaxMipLevels - 1) ||
      texture.height() > 1 << (kMaxMipLevels - 1))
    return Failure{Error::limit_exceeded, 0, "texture side over 32768"};
  out.texels = texture.texels.data();
  out.level_count = static_cast<int32_t>(texture.levels.size());
  out.filter = filter_number(filter);
  out.clamp = wrap == Wrap::clamp ? 1 : 0;
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

AttributeLayout layout_of(const Surface& surface) {
  AttributeLayout layout;
  const auto take = [&](int& first, int n) {
    first = layout.count;
    layout.count += n;
  };
  const SurfaceMaps* maps = surface.maps.get();
  const bool per_sample = surface.lit == Surface::Lit::per_sample;
  const bool has_environment = maps != nullptr && maps->has_environment;
  if (surface.textured || surface.alpha_textured ||
      (maps != nullptr && (maps->has_normal || maps->has_specular || maps->has_emission)))
    take(layout.uv, 2);
  if (surface.alpha != AlphaMode::opaque) take(layout.alpha, 1);
  if (surface.lit != Surface::Lit::no && !per_sample && surface.lighting.has_specular != 0 &&
      (surface.textured || (maps != nullptr && maps->has_specular)))
    take(layout.specular, 3);
  if (per_sample || has_environment) take(layout.normal, 3);
  if (per_sample || has_environment || surface.fogged) take(layout.position, 3);
  if (maps != nullptr && maps->has_normal) take(layout.tangents, 6);
  return layout;
}

// Normal, specular and emission maps and the environment, where the material is lit and has any.
Result<void> set_maps(const Scene& scene, const RenderQuality& quality, size_t number, Surface& surface) {
  const Material& material = scene.materials[number];
  PAC_TRY(const MapChoice normal, choose_map(scene, material.normal_texture, quality.texture, number));
  PAC_TRY(const MapChoice specular, choose_map(scene, material.specular_texture, quality.texture, number));
  PAC_TRY(const MapChoice emission, choose_map(scene, material.emission_texture, quality.texture, number));
  const bool reflects = material.reflection != glm::vec3(0.0f);
  PAC_TRY(const MapChoice environment, choose_map(scene, reflects ? scene.environment : -1, quality.texture, number));
  LightingParameters& lighting = surface.lighting;
  for (int c = 0; c < 3; ++c) {
    const float glow = bounded(material.emission[c], kColorLimit) * 255.0f;
    if (emission.present) lighting.emission[c] = emission.use != nullptr ? 0.0f : glow * emission.mean[c];
    if (environment.present && environment.use == nullptr)
      lighting.emission[c] =
          lighting.emission[c] + bounded(material.reflection[c], kColorLimit) * 255.0f * environment.mean[c];
    for (int i = 0; i < lighting.light_count; ++i)
      lighting.lights[i].specular[c] = lighting.lights[i].specular[c] * specular.mean[c];
  }
  const bool bends = normal.use != nullptr && surface.lit == Surface::Lit::per_sample;
  const bool has_specular = specular.use != nullptr && lighting.has_specular != 0;
  if (!bends && !has_specular && emission.use == nullptr && environment.use == nullptr) return {};
  if (surface.maps == nullptr) surface.maps = std::make_unique<SurfaceMaps>();
  SurfaceMaps& maps = *surface.maps;
  maps.has_normal = bends;
  maps.has_specular = has_specular;
  maps.has_emission = emission.use != nullptr;
  maps.has_environment = environment.use != nullptr;
  if (bends) PAC_CHECK(set_sampler(*normal.use, material.filter, material.wrap, maps.normal));
  if (has_specular) PAC_CHECK(set_sampler(*specular.use, material.filter, material.wrap, maps.specular));
  if (maps.has_emission) PAC_CHECK(set_sampler(*emission.use, material.filter, material.wrap, maps.emission));
  if (maps.has_environment) PAC_CHECK(set_sampler(*environment.use, Filter::trilinear, Wrap::repeat, maps.environment));
  maps.normal_scale = bounded(material.normal_scale, 1000.0f);
  for (int c = 0; c < 3; ++c) {
    maps.emission_color[c] = bounded(material.emission[c], kColorLimit);
    maps.reflection[c] = bounded(material.reflection[c], kColorLimit);
  }
  if (maps.has_environment)
    maps.environment_lod =
        std::max(bounded(material.reflection_blur, 1.0f), 0.0f) * static_cast<float>(maps.environment.level_count - 1);
  return {};
}

// Masks are geometry: by the texture even where texturing is off.
Result<void> set_alpha(const Material& material, const Texture* texture, bool textured, Surface& surface) {
  surface.alpha = material.alpha;
  surface.alpha_textured = false;
  if (material.alpha == AlphaMode::opaque) return {};
  surface.opacity = std::min(std::max(bounded(material.opacity, 1.0f), 0.0f), 1.0f);
  surface.alpha_cutoff = bounded(material.alpha_cutoff, 2.0f);
  if (texture == nullptr || texture->empty()) return {};
  surface.alpha_textured = textured || material.alpha == AlphaMode::mask;
  if (!surface.alpha_textured)
    surface.opacity = surface.opacity * (static_cast<float>(texture->mean_color()[3]) * (1.0f / 255.0f));
  if (!textured && surface.alpha_textured)
    PAC_CHECK(set_sampler(*texture, material.filter, material.wrap, surface.sampler));
  return {};
}

void set_fog(const Scene& scene, const Camera& camera, Surface& surface) {
  const Fog& fog = scene.fog;
  surface.fogged = fog.kind != Fog::Kind::none;
  if (!surface.fogged) return;
  FogParameters& out = surface.fog;
  for (int c = 0; c < 3; ++c) {
    out.eye[c] = bounded(camera.eye[c], kPositionLimit);
    out.color[c] = std::min(std::max(bounded(fog.color[c], 1.0f), 0.0f), 1.0f) * 255.0f;
  }
  out.end = bounded(fog.end, kPositionLimit);
  out.power = fog.kind == Fog::Kind::linear ? 0 : fog.kind == Fog::Kind::exponential ? 1 : 2;
  if (out.power == 0) {
    out.rate = 1.0f / std::max(out.end - bounded(fog.start, kPositionLimit), kSmallestRange);
    return;
  }
  // exp(-x) = exp2(-x log2 e); squared, the factor is its root.
  out.rate = std::max(bounded(fog.density, 0x1p20f), 0.0f) * (out.power == 1 ? 1.44269504f : 1.20112241f);
}

}  // namespace

Result<void> prepare_surfaces(const Scene& scene, const Camera& camera, const RenderQuality& quality,
                              const ShadowScene* shadows, std::vector<Surface>& surfaces) {
  if (scene.lights.size() > kMaxKernelLights)
    return Failure{Error::limit_exceeded, scene.lights.size(), "more lights than 16"};
  if (scene.environment < -1 || scene.environment >= static_cast<int64_t>(scene.textures.size()))
    return Failure{Error::corrupt, 0, "the environment is a texture that does not exist"};
  surfaces.resize(scene.materials.size());
  constexpr uint32_t kNone = UINT32_MAX;
  uint32_t first_plain = kNone;
  float bias = 0, scale = 1;  // bias: -log2(sqrt(places where a pixel is shaded))
  for (int n = quality.shading_samples == 0 ? quality.samples : quality.shading_samples; n > 1; n /= 4) {
    bias -= 1.0f;
    scale *= 0.5f;
  }
  // A pixel's one texel should look like the mean of finer ones: the blur of the filter is less than the pixel's own.
  if (quality.shading_samples != 0) bias -= 0.75f;
  for (uint32_t i = 0; i < surfaces.size(); ++i) {
    const Material& material = scene.materials[i];
    Surface& surface = surfaces[i];
    if (material.texture < -1 || material.texture >= static_cast<int64_t>(scene.textures.size()))
      return Failure{Error::corrupt, i, "material names a texture that does not exist"};
    const Texture* texture = material.texture >= 0 ? &scene.textures[static_cast<size_t>(material.texture)] : nullptr;
    surface.textured = texture != nullptr && quality.texture && !texture->empty();
    surface.drop_back_faces = quality.cull_back_faces && !material.two_sided;
    surface.lit = lit_where(material, quality);
    for (int c = 0; c < 3; ++c)
      surface.mean[c] = texture != nullptr && !surface.textured
                            ? static_cast<float>(texture->mean_color()[static_cast<size_t>(c)]) * (1.0f / 255.0f)
                            : 1.0f;
    surface.lighting.light_count = surface.lighting.has_specular = 0;
    surface.shadows = quality.lighting != Lighting::local ? shadows : nullptr;
    surface.sampler.clamp = material.wrap == Wrap::clamp ? 1 : 0;
    surface.lod_bias = bias;
    surface.lod_scale = scale;
    surface.max_probes = material.filter == Filter::trilinear ? std::clamp(material.anisotropy, 1, kMaxAnisotropy) : 1;
    if (surface.textured) PAC_CHECK(set_sampler(*texture, material.filter, material.wrap, surface.sampler));
    PAC_CHECK(set_alpha(material, texture, surface.textured, surface));
    surface.maps.reset();
    if (surface.lit != Surface::Lit::no) {
      set_lighting(scene, camera, material, surface);
      PAC_CHECK(set_maps(scene, quality, i, surface));
    }
    set_fog(scene, camera, surface);
    surface.layout = layout_of(surface);
    surface.batch = i;
    if (surface.layout == AttributeLayout{}) {  // interpolated colors alone: the material no longer matters
      if (first_plain == kNone) first_plain = i;
      surface.batch = first_plain;
    }
  }
  return {};
}

Result<void> prepare_depth_surfaces(const Scene& scene, std::vector<Surface>& surfaces) {
  surfaces.resize(scene.materials.size());
  for (uint32_t i = 0; i < surfaces.size(); ++i) {
    const Material& material = scene.materials[i];
    Surface& surface = surfaces[i];
    if (material.texture < -1 || material.texture >= static_cast<int64_t>(scene.textures.size()))
      return Failure{Error::corrupt, i, "material names a texture that does not exist"};
    const Texture* texture = material.texture >= 0 ? &scene.textures[static_cast<size_t>(material.texture)] : nullptr;
    surface = Surface();
    surface.sampler.clamp = material.wrap == Wrap::clamp ? 1 : 0;
    PAC_CHECK(set_alpha(material, texture, false, surface));
    surface.layout = layout_of(surface);
    surface.batch = i;
  }
  return {};
}

}  // namespace pac::raster
