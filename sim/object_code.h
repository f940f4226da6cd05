// The transforms of moved objects, bit for bit against earlier ones: 1 bit where nothing moved, about 11 bytes for an
// object that was shifted, 16 to 22 for one that turned as well. Of a rotation (with any scale) three numbers are coded
// as they changed; the other six are predicted from them and corrected in the last place.
#pragma once

#include <span>

#include "base/bits.h"
#include "sim/object_motion.h"

namespace pac::sim {

// Appends `now` given `before`: as many, is_transform() all of them. Nothing where there are none.
void write_object_changes(BitWriter& writer, std::span<const glm::mat4> now, std::span<const glm::mat4> before);

// The reverse; `before` has the writer's bits. Any bits give as many transforms as `before` has, last rows 0 0 0 1;
// check is_transform() and overrun().
Transforms read_object_changes(BitReader& reader, std::span<const glm::mat4> before);

}  // namespace pac::sim
