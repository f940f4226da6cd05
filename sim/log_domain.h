// Samples as logarithms, so that a difference of two is a ratio: what light does to a texture is the same number
// whatever the texel. The code of v is 255 log(1 + v / kOffset) / log(1 + 255 / kOffset), rounded: exact integer
// tables.
#pragma once

#include <array>
#include <cstdint>

#include "base/image.h"

namespace pac::sim {

constexpr int kLogOffset = 64;  // measured: docs/video.md

// Of each sample value its code, and of each code the value nearest to where it stands.
const std::array<uint8_t, 256>& log_codes();
const std::array<uint8_t, 256>& values_of_log_codes();

// Views of one size; `codes` may be `picture`.
void log_from_rgb(ConstRgbView picture, RgbView codes);

// The values of `codes`, which began as those of `low`: where a code is low's own, the sample is. `shown` may be
// `codes`.
void rgb_from_log(ConstRgbView low, ConstRgbView codes, RgbView shown);

}  // namespace pac::sim
