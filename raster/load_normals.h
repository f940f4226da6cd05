// Normals for faces that come without them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "raster/load_obj_file.h"

namespace pac::raster {

// Rule. Each face has the Newell normal of its polygon, as long as twice its area. A corner's normal is the sum of
// those of the faces around the same position that smooth with its own face, made unit length: area-weighted. Two faces
// smooth
// - where the file has `s` statements: if they are in the same group other than 0;
// - else: if their normals are less than 60 degrees apart (at positions with more than 256 corners: always).
// Faces of zero area take what their neighbors give; where nothing is left the normal is (0, 0, 0).

// As much of a face as the rule needs.
struct SmoothFace {
  uint32_t first = 0, count = 0;  // into `corner_position`
  uint32_t smoothing_group = 0;
};
// Three floats for each corner of corner_position (numbers of positions, 3 floats each).
std::vector<float> smooth_normals(std::span<const float> positions, std::span<const uint32_t> corner_position,
                                  std::span<const SmoothFace> faces, bool has_smoothing_groups);

}  // namespace pac::raster
