// stb_image as a judge of our JPEG files.
#pragma once

#include <cstdint>
#include <span>

#include "base/image.h"

namespace pac::test {

// Whether the header was there when the tests were built (Debian: libstb-dev). As have_peer() where not.
bool have_stb();

// The picture, or an empty one where stb_image refuses the file.
RgbImage stb_decode(std::span<const uint8_t> file);

}  // namespace pac::test
