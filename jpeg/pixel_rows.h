// One row of pixels from RGB to a format and back.
#pragma once

#include <cstddef>
#include <cstdint>

#include "jpeg/pixels.h"

namespace pac::jpeg {

// n pixels; `rgb` and the other row do not overlap. gray: luma as PixelKernels::ycc_from_rgb_row has it.
void pixels_from_rgb(PixelFormat format, const uint8_t* rgb, size_t n, uint8_t* pixels);
// format is not gray.
void rgb_from_pixels(PixelFormat format, const uint8_t* pixels, size_t n, uint8_t* rgb);

}  // namespace pac::jpeg
