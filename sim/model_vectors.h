// Motion vectors of blocks from the model instead of from search [Wallach94]: exact where a block shows one surface,
// whatever the distance, zoom or rotation, and however often the texture repeats. Candidates: the encoder decides.
#pragma once

#include <span>
#include <vector>

#include "mpeg1/mpeg1.h"
#include "sim/model_flow.h"

namespace pac::sim {

constexpr int kModelVectors = 4;  // a macroblock

// kModelVectors for each macroblock of the flow's picture, in raster order, for mpeg1::PictureOptions::candidates: the
// median of 16 points spread over it, the point farthest from that, the one farthest from both, and the middle. Zero
// where nothing is found.
std::vector<mpeg1::MotionVector> vectors_of(const Flow& flow);

}  // namespace pac::sim
