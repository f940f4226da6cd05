// Every operation that has more than one implementation: one pointer each, one contract line each.
// The scalar file of a family defines what its operations compute; every other file equals it bit for bit.
#pragma once

#include "base/isa.h"
#include "base/kernels/block_kernels.h"
#include "base/kernels/front_kernels.h"
#include "base/kernels/motion_kernels.h"
#include "base/kernels/pixel_kernels.h"
#include "base/kernels/tile_kernels.h"
#include "base/kernels/warp_kernels.h"

namespace pac {

struct Kernels {
  Isa isa = Isa::scalar;
  BlockKernels block;    // 8x8 transforms and quantization
  MotionKernels motion;  // block distances, prediction, transforms of prediction errors
  PixelKernels pixel;    // color conversion, chroma resampling, difference and composite
  FrontKernels front;    // vertices to the screen, triangle setup
  TileKernels tile;      // rasterization inside one tile
  WarpKernels warp;      // reprojection from the frame before
};

// The table of best_isa(). One atomic load after the first call; thread-safe.
const Kernels& kernels();

// The table of one instruction set, or null where it is not built or not supported here.
const Kernels* kernels_for(Isa isa);

}  // namespace pac
