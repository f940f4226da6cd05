// Where a motion takes vertices, and the motion that takes most of a frame's where they are. FORMAT.md section 14.
#pragma once

#include <span>

#include "geomcodec/frames.h"
#include "geomcodec/positions.h"

namespace pac::geomcodec {

// `motion` within its bounds; bits: of the frame's grid.
Position expected_position(const uint16_t (&from)[3], const FrameMotion& motion, int bits);

// A projective map by iteratively reweighted least squares. False where there is none to be found. Both spans are of
// the same length.
bool fit_motion(std::span<const QuantizedVertex> reference, int reference_bits, std::span<const QuantizedVertex> frame,
                int frame_bits, FrameMotion& motion);

}  // namespace pac::geomcodec
