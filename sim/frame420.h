// RGB pictures to planar 4:2:0 and back, by the kernels that JPEG uses: full-range BT.601 (JFIF), chroma between the
// luma columns and rows.
#pragma once

#include "base/image.h"
#include "base/isa.h"

namespace pac::sim {

// Chroma is the box mean of 2x2 pixels; odd sides repeat their last column or row. `frame` must have the picture's
// size.
void frame420_from_rgb(ConstRgbView picture, Frame420& frame, Isa isa = best_isa());

// The same of rows first..last - 1 of the picture; `first` is even, and `last` is even or the picture's height.
void frame420_rows_from_rgb(ConstRgbView picture, int first, int last, Frame420& frame, Isa isa = best_isa());

// Chroma by the triangle filter. `picture` must have the frame's size.
void rgb_from_frame420(const Frame420& frame, RgbView picture, Isa isa = best_isa());

// One chroma plane at the size of luma, by the same filter. full is 2 * half or one less, in each direction.
void upsample_chroma(PlaneView<const uint8_t> half, PlaneView<uint8_t> full, Isa isa = best_isa());

}  // namespace pac::sim
