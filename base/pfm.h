// PFM files: planes of 32-bit floats, here depth. "Pf", width, height, a scale whose sign tells the byte order, rows
// from bottom to top.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/image.h"
#include "base/result.h"

namespace pac {

// The plane with its bits unchanged (NaN and infinities too), top row first. Either byte order; the scale's magnitude
// is not applied. Fails with truncated, corrupt, unsupported ("PF", three channels) or limit_exceeded.
Result<DepthImage> decode_pfm(std::span<const uint8_t> bytes, const Limits& limits = {});

// A little-endian file of scale 1. Sides >= 1.
std::vector<uint8_t> encode_pfm(PlaneView<const float> plane);

}  // namespace pac
