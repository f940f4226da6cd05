// From a step table to the multiplications that divide by it.
#pragma once

#include "base/kernels/block_kernels.h"
#include "jpeg/jpeg.h"

namespace pac::jpeg {

// The forward DCT's output is scaled by 8.
constexpr int kDctScale = 8;

// Divisors 8 * step. Rounds DC to nearest, |AC| / step at 0.5 + dead_zone (0..0.49): the bias is floor(divisor/2) for
// DC and floor(divisor * (0.5 - dead_zone)) for AC. steps 1..255.
BlockQuantizer make_quantizer(const QuantTable& steps, double dead_zone);

}  // namespace pac::jpeg
