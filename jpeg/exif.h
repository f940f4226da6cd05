// The one Exif field that a viewer needs.
#pragma once

#include <cstdint>
#include <span>

namespace pac::jpeg {

// Orientation (tag 0x0112 of the first image file directory), 1..8, from the TIFF structure behind "Exif\0\0"; 0 if it
// is absent or the structure is broken (metadata never makes a picture unreadable).
int exif_orientation(std::span<const uint8_t> tiff);

}  // namespace pac::jpeg
