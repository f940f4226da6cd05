// A camera in 15 to 40 bytes instead of 76, bit for bit: against an earlier camera, by what a rigid camera with the
// same lens must be. Six numbers (eye, two of the direction, one of the roll) are coded as they changed; the others are
// predicted from them and corrected in the last place. A camera that is nothing of the kind takes more bits, no more
// than 88 bytes, and comes back just the same.
#pragma once

#include "base/bits.h"
#include "raster/scene.h"

namespace pac::sim {

// Appends `camera`, given `base`. Any bit patterns, also of numbers that are not finite.
void write_camera_change(BitWriter& writer, const raster::Camera& camera, const raster::Camera& base);

// The reverse; `base` has the writer's bits. Past the reader's end it gives some camera: check overrun().
raster::Camera read_camera_change(BitReader& reader, const raster::Camera& base);

}  // namespace pac::sim
