// Material libraries: MTL.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "raster/load_obj.h"
#include "raster/scene.h"

namespace pac::raster {

struct MtlMaterial {
  Material material;         // material.texture is set by the caller
  std::string texture_name;  // map_Kd's file with slashes, or empty
  uint64_t texture_offset = 0;
  float texcoord_scale[2] = {1, 1};   // -s
  float texcoord_offset[2] = {0, 0};  // -o
};

// Nothing in a library stops the loading: what cannot be read is warned about (`name` = library) and keeps its default.
// Ka, Kd, Ks, Ke, Ns, illum, map_Kd (-s, -o, -clamp, other options skipped) are used; d and Tr below opaque warn.
// illum 0 makes a material unlit (its Kd is its color), illum 1 takes the highlight off.
std::vector<MtlMaterial> parse_mtl(std::span<const uint8_t> bytes, const std::string& name,
                                   std::vector<Warning>& warnings);

}  // namespace pac::raster
