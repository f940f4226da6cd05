// Material libraries: MTL.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "raster/load_obj.h"
#include "raster/scene.h"

namespace pac::raster {

// A texture statement: the file's name with slashes, or empty, and where it stands.
struct MtlMap {
  std::string name;
  uint64_t offset = 0;
};

struct MtlMaterial {
  Material material;                  // whose texture numbers are set by the caller
  MtlMap base;                        // map_Kd
  MtlMap specular;                    // map_Ks
  MtlMap emission;                    // map_Ke
  MtlMap opacity;                     // map_d
  MtlMap bump;                        // map_Bump, bump, norm: heights or a normal map
  float bump_scale = 1;               // -bm
  float texcoord_scale[2] = {1, 1};   // map_Kd's -s
  float texcoord_offset[2] = {0, 0};  // map_Kd's -o
};

// Nothing in a library stops the loading: what cannot be read is warned about (`name` = library) and keeps its default.
// Ka, Kd, Ks, Ke, Ns, illum, d, Tr and the maps above (-bm; of map_Kd -s, -o, -clamp; other options skipped) are used.
// illum 0 makes a material unlit (its Kd is its color), illum 1 takes the highlight off. d below 1 makes it blend.
std::vector<MtlMaterial> parse_mtl(std::span<const uint8_t> bytes, const std::string& name,
                                   std::vector<Warning>& warnings);

}  // namespace pac::raster
