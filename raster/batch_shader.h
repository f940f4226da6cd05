// Colors of a batch of samples of one material: interpolate -> light -> texture -> maps -> fog.
#pragma once

#include "base/kernels/tile_kernels.h"
#include "raster/surface.h"

namespace pac::raster {

// Which samples a batch belongs to.
struct ShadePass {
  int rendering;      // which of RasterTriangle::attributes
  int number, count;  // of the places where a pixel is shaded
  SamplePosition origin;
  bool weighted;        // the packs' lanes stand for several samples
  bool inside = false;  // of packs: the samples of the masks are inside their triangles
};

// Rows of kBatchLanes for accumulate() and blend(): color * texel / 255 + added, clamped. Valid until the next call.
struct ShadedBatch {
  const float* color;
  const float* texels;  // or null
  const float* added;   // highlights, glow, reflections; or null
  const float* alpha;   // opacity in [0, 1]; null for opaque materials
};

// The working memory of one thread.
class BatchShader {
 public:
  // Shades n <= kBatchPacks packs whose triangles all have `surface`.
  ShadedBatch shade(const TileKernels& kernels, const Surface& surface, const ShadePass& pass, const LanePack* packs,
                    int n);
  // The same for n <= kBatchLanes samples of any triangles with `surface`, where shades_lanes(surface).
  ShadedBatch shade_lanes(const TileKernels& kernels, const Surface& surface, const ShadePass& pass,
                          const LaneSample* samples, int n);
  // The same for packs of collect_groups(); ids and triangles: what they were collected from.
  ShadedBatch shade_groups(const TileKernels& kernels, const Surface& surface, const ShadePass& pass,
                           const LanePack* packs, int n, const uint32_t* ids, const RasterTriangle* const* triangles);
  // Nothing that the surface asks for needs to know how samples are packed.
  static bool shades_lanes(const Surface& surface) {
    return surface.maps == nullptr && surface.max_probes == 1 && surface.shadows == nullptr;
  }
  // The attributes are colors alone and, interpolated, final: surfaces that differ may be shaded together.
  static bool has_final_colors(const Surface& surface) {
    return surface.lit != Surface::Lit::per_sample && !surface.textured && !surface.fogged && surface.maps == nullptr &&
           surface.layout.count == 3 && surface.alpha == AlphaMode::opaque;
  }
  // Final colors like those, or textured ones that nothing is added to: TileKernels::paint_textured() does it all.
  static bool has_painted_colors(const Surface& surface) {
    const AttributeLayout& layout = surface.layout;
    return has_final_colors(surface) ||
           (surface.textured && surface.lit != Surface::Lit::per_sample && !surface.fogged && surface.maps == nullptr &&
            surface.max_probes == 1 && layout.count == 5 && layout.uv == 3 && surface.alpha == AlphaMode::opaque);
  }
  // Takes the samples whose opacity is below the cutoff off the packs' masks. The surface's alpha is AlphaMode::mask.
  void cut_out(const TileKernels& kernels, const Surface& surface, const ShadePass& pass, LanePack* packs, int n);

 private:
  // What the steps of one call share.
  struct Batch {
    const TileKernels& kernels;
    const Surface& surface;
    const ShadePass& pass;
    const LanePack* packs;  // null: lanes of any triangles
    int n;                  // groups of eight lanes
  };
  InterpolateTarget interpolate_target(const Surface& surface, const ShadePass& pass);
  ShadedBatch finish(const Batch& batch);
  float* row(int attribute) { return rows_ + attribute * kBatchLanes; }
  void sample_base(const Batch& batch);
  void sample_map(const Batch& batch, const TextureSampler& sampler);
  const float* light(const Batch& batch);
  const float* cast(const Batch& batch);
  const float* add_maps(const Batch& batch, const float* added);
  const float* opacity(const Batch& batch);

  alignas(64) float rows_[kMaxAttributes * kBatchLanes];
  alignas(64) float lod_[kBatchLanes];
  alignas(64) float texels_[3 * kBatchLanes];
  alignas(64) float specular_[3 * kBatchLanes];
  alignas(64) float visibility_[(kMaxKernelLights + 1) * kBatchLanes];
  alignas(64) float map_[3 * kBatchLanes];        // texels of a map
  alignas(64) float footprint_[3 * kBatchLanes];  // axis, number of probes; of reflections: u and v
  alignas(64) float map_lod_[kBatchLanes];
  alignas(64) float alpha_[kBatchLanes];
};

}  // namespace pac::raster
