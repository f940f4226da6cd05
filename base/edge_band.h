// Errors near geometry edges apart from the rest: Levoy's second reason for polygons is that edges stay sharp and free
// of ringing [Levoy95 s.1]. The caller owns the geometry, so the mask comes from the renderer's id or depth image.
#pragma once

#include <cstdint>

#include "base/image.h"

namespace pac {

// 255 within `reach` pixels of a place where neighboring ids differ, else 0. An edge lies between two pixels (left and
// right, upper and lower): reach 1 marks these two, reach 2 (the project's convention) one more on either side, and
// everything in the square around. reach >= 1.
GrayImage edge_band(PlaneView<const uint32_t> id, int reach = 2);

// The same where neighboring depths differ by more than `relative_step` times the smaller one: silhouettes, but not
// slopes. Depths are positive or +infinity (background).
GrayImage edge_band(PlaneView<const float> depth, float relative_step, int reach = 2);

struct MaskedError {
  double rms = 0;         // over the three samples of each masked pixel, levels of 0..255; 0 for an empty mask
  uint64_t n_pixels = 0;  // masked
};
// Over the pixels whose mask is not 0. All of one, nonzero size (else PAC_ASSERT).
MaskedError masked_rms(ConstRgbView reference, ConstRgbView test, PlaneView<const uint8_t> mask);

}  // namespace pac
