#include "raster/batch_shader.h"

#include <algorithm>
#include <cmath>

namespace pac::raster {
namespace {

// rows[c] + scale[c] * texels[c]; null `rows` are zeros.
void add_scaled(const float scale[3], const float* texels, int lanes, const float* rows, float* out) {
  for (int c = 0; c < 3; ++c)
    for (int k = c * kBatchLanes; k < c * kBatchLanes + lanes; ++k)
      out[k] = rows != nullptr ? rows[k] + scale[c] * texels[k] : scale[c] * texels[k];
}

// Keeps filters of the environment off the other pole: half a texel of the coarser of the levels they mix.
void clamp_latitude(const TextureSampler& environment, float lod, int lanes, float* v) {
  const int level = std::min(static_cast<int>(std::floor(lod)) + 1, environment.level_count - 1);
  const float margin = 0.5f / static_cast<float>(environment.height[level]);
  for (int k = 0; k < lanes; ++k) v[k] = std::min(std::max(v[k], margin), 1.0f - margin);
}

}  // namespace

// The rays to lights with a size, and into the sky, are shared out among the places where a pixel is shaded.
const float* BatchShader::cast(const Batch& batch) {
  const Surface& surface = batch.surface;
  if (surface.shadows == nullptr) return nullptr;
  uint8_t masks[kBatchPacks];
  for (int i = 0; i < batch.n; ++i) masks[i] = batch.packs[i].mask;
  const int n_rays = std::max(surface.shadows->samples.count / batch.pass.count, 1);
  cast_shadows(*surface.shadows, batch.kernels, surface.lighting, batch.n, masks, {batch.pass.number * n_rays, n_rays},
               row(surface.layout.normal), row(surface.layout.position), visibility_);
  return visibility_;
}

// Normal map, shadows, lights; returns the highlights or null. Shadows start from the normal that is not bent.
const float* BatchShader::light(const Batch& batch) {
  const Surface& surface = batch.surface;
  const AttributeLayout& layout = surface.layout;
  const float* visibility = cast(batch);
  if (surface.maps != nullptr && surface.maps->has_normal) {
    sample_map(batch, surface.maps->normal);
    batch.kernels.bend_normals(8 * batch.n, surface.maps->normal_scale, map_, row(layout.tangents), row(layout.normal));
  }
  batch.kernels.light(surface.lighting, 8 * batch.n, row(layout.normal), row(layout.position), visibility, rows_,
                      specular_);
  return surface.lighting.has_specular != 0 ? specular_ : nullptr;
}

void BatchShader::sample_base(const Batch& batch) {
  const Surface& surface = batch.surface;
  const float *u = row(surface.layout.uv), *v = row(surface.layout.uv + 1);
  if (surface.max_probes == 1) return batch.kernels.sample_texture(surface.sampler, 8 * batch.n, u, v, lod_, texels_);
  sample_map(batch, surface.sampler);
  std::copy_n(map_lod_, 8 * batch.n, lod_);
  std::copy_n(map_, 3 * kBatchLanes, texels_);
}

// Texels of any map at the vertices' texture coordinates -> map_, map_lod_.
void BatchShader::sample_map(const Batch& batch, const TextureSampler& sampler) {
  const Surface& surface = batch.surface;
  const int uv = surface.layout.uv;
  float *const axis_u = footprint_, *const axis_v = footprint_ + kBatchLanes, *const probes = axis_v + kBatchLanes;
  const bool isotropic = surface.max_probes == 1;
  const FootprintTarget target{batch.pass.rendering,
                               uv,
                               static_cast<float>(sampler.width[0]),
                               static_cast<float>(sampler.height[0]),
                               surface.lod_bias,
                               surface.lod_scale,
                               static_cast<float>(surface.max_probes),
                               map_lod_,
                               isotropic ? nullptr : axis_u,
                               isotropic ? nullptr : axis_v,
                               isotropic ? nullptr : probes};
  batch.kernels.footprint(batch.packs, batch.n, batch.pass.origin, target);
  if (isotropic)
    batch.kernels.sample_texture(sampler, 8 * batch.n, row(uv), row(uv + 1), map_lod_, map_);
  else
    batch.kernels.sample_anisotropic(sampler, 8 * batch.n, row(uv), row(uv + 1), map_lod_, axis_u, axis_v, probes,
                                     map_);
}

// Specular map, emission map and reflection: what is added to the color in the end, or null.
const float* BatchShader::add_maps(const Batch& batch, const float* added) {
  const SurfaceMaps& maps = *batch.surface.maps;
  const AttributeLayout& layout = batch.surface.layout;
  const int lanes = 8 * batch.n;
  if (maps.has_specular && added != nullptr) {
    sample_map(batch, maps.specular);
    for (int c = 0; c < 3; ++c)
      for (int k = c * kBatchLanes; k < c * kBatchLanes + lanes; ++k)
        specular_[k] = (added[k] * map_[k]) * (1.0f / 255.0f);
    added = specular_;
  }
  if (maps.has_emission) {
    sample_map(batch, maps.emission);
    add_scaled(maps.emission_color, map_, lanes, added, specular_);
    added = specular_;
  }
  if (maps.has_environment) {
    float *const u = footprint_, *const v = footprint_ + kBatchLanes;
    batch.kernels.reflect(batch.surface.lighting.eye, lanes, row(layout.normal), row(layout.position), u, v);
    clamp_latitude(maps.environment, maps.environment_lod, lanes, v);
    std::fill_n(map_lod_, lanes, maps.environment_lod);
    batch.kernels.sample_texture(maps.environment, lanes, u, v, map_lod_, map_);
    add_scaled(maps.reflection, map_, lanes, added, specular_);
    added = specular_;
  }
  return added;
}

// Vertex alpha * material's opacity * texel's alpha -> alpha_, in [0, 1]; lod_ is the base texture's.
const float* BatchShader::opacity(const Batch& batch) {
  const Surface& surface = batch.surface;
  const int lanes = 8 * batch.n;
  const float* vertex_alpha = row(surface.layout.alpha);
  const float scale = surface.opacity * (1.0f / 255.0f);
  for (int k = 0; k < lanes; ++k) alpha_[k] = vertex_alpha[k] * scale;
  if (!surface.alpha_textured) return alpha_;
  batch.kernels.sample_alpha(surface.sampler, lanes, row(surface.layout.uv), row(surface.layout.uv + 1), lod_, map_);
  for (int k = 0; k < lanes; ++k) alpha_[k] = alpha_[k] * (map_[k] * (1.0f / 255.0f));
  return alpha_;
}

InterpolateTarget BatchShader::interpolate_target(const Surface& surface, const ShadePass& pass) {
  const AttributeLayout& layout = surface.layout;
  InterpolateTarget target{pass.rendering,   layout.count, rows_, nullptr, layout.uv, 0, 0,
                           surface.lod_bias, pass.inside};
  if (surface.textured || surface.alpha_textured) {
    target.lod = lod_;
    target.width = static_cast<float>(surface.sampler.width[0]);
    target.height = static_cast<float>(surface.sampler.height[0]);
  }
  return target;
}

ShadedBatch BatchShader::shade(const TileKernels& kernels, const Surface& surface, const ShadePass& pass,
                               const LanePack* packs, int n) {
  kernels.interpolate(packs, n, pass.origin, interpolate_target(surface, pass));
  return finish({kernels, surface, pass, packs, n});
}

ShadedBatch BatchShader::shade_lanes(const TileKernels& kernels, const Surface& surface, const ShadePass& pass,
                                     const LaneSample* samples, int n) {
  kernels.interpolate_lanes(samples, n, pass.origin, interpolate_target(surface, pass));
  return finish({kernels, surface, pass, nullptr, (n + 7) / 8});
}

ShadedBatch BatchShader::shade_groups(const TileKernels& kernels, const Surface& surface, const ShadePass& pass,
                                      const LanePack* packs, int n, const uint32_t* ids,
                                      const RasterTriangle* const* triangles) {
  kernels.interpolate_groups(packs, n, ids, triangles, pass.origin, interpolate_target(surface, pass));
  return finish({kernels, surface, pass, nullptr, n});
}

// From interpolated attributes to colors.
ShadedBatch BatchShader::finish(const Batch& batch) {
  const Surface& surface = batch.surface;
  const AttributeLayout& layout = surface.layout;
  const float* added = layout.specular >= 0 ? row(layout.specular) : nullptr;
  if (surface.lit == Surface::Lit::per_sample) added = light(batch);
  if (surface.textured) sample_base(batch);
  if (surface.maps != nullptr) added = add_maps(batch, added);
  ShadedBatch out{rows_, surface.textured ? texels_ : nullptr, added, nullptr};
  if (surface.fogged) {
    batch.kernels.fog(surface.fog, 8 * batch.n, row(layout.position), out.texels, out.added, rows_);
    out.texels = out.added = nullptr;
  }
  if (surface.alpha == AlphaMode::blend) out.alpha = opacity(batch);
  return out;
}

void BatchShader::cut_out(const TileKernels& kernels, const Surface& surface, const ShadePass& pass, LanePack* packs,
                          int n) {
  InterpolateTarget target{pass.rendering,  surface.layout.alpha + 1, rows_, nullptr, surface.layout.uv, 0, 0,
                           surface.lod_bias};
  if (surface.alpha_textured) {
    target.lod = lod_;
    target.width = static_cast<float>(surface.sampler.width[0]);
    target.height = static_cast<float>(surface.sampler.height[0]);
  }
  kernels.interpolate(packs, n, pass.origin, target);
  const float* alpha = opacity({kernels, surface, pass, packs, n});
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < 8; ++k)
      if (!(alpha[8 * i + k] >= surface.alpha_cutoff)) packs[i].mask &= static_cast<uint8_t>(~(1u << k));
}

}  // namespace pac::raster
