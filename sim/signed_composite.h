// What the client shows where the difference is signed and in 4:2:0: L in full color resolution plus the difference.
#pragma once

#include "base/image.h"
#include "base/isa.h"
#include "sim/model_prediction.h"

namespace pac::sim {

// C = clamp(L + M d): d = (Y, Cb, Cr) differences of -255..255 at the luma resolution, chroma brought there by the
// triangle filter of base/kernels (signed), M the linear part of JFIF's RGB from YCbCr in 16-bit fixed point. The
// planes' borders must be extended. L keeps its chroma edges: only the difference is subsampled.
void composite_signed(ConstRgbView low, const BorderedPlane& y, const BorderedPlane& cb, const BorderedPlane& cr,
                      RgbView composite, Isa isa = best_isa());

}  // namespace pac::sim
