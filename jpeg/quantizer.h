// From a step table to the multiplications that divide by it.
#pragma once

#include "base/kernels/block_kernels.h"
#include "jpeg/jpeg.h"

namespace pac::jpeg {

// The forward DCT's output is scaled by 8.
constexpr int kDctScale = 8;

// Coefficients are multiplied by a gain before they are divided by their step: what a decoder's upsampling will take
// away (chroma_gain in tables.h). Never more than the step, so that levels stay as small as those of step 1.
constexpr double effective_gain(double gain, int step) {
  return gain < step ? gain : step;
}

// Divisors 8 * step / gain, rounded. Rounds DC to nearest, |AC| at 0.5 + dead_zone (0..0.49): the bias is
// floor(divisor / 2) for DC and floor(divisor * (0.5 - dead_zone)) for AC. steps 1..255.
BlockQuantizer make_quantizer(const QuantTable& steps, double dead_zone, const double (&gain)[64]);

}  // namespace pac::jpeg
