// Rate-distortion optimal AC levels of a block, given what each symbol costs. DC: jpeg/dc_trellis.h.
#pragma once

#include <cstdint>

#include "jpeg/huffman.h"
#include "jpeg/tables.h"

namespace pac::jpeg {

// Bits of a level after a run of zeros, both codes and extra bits: [size of the level][run 0..62], ZRLs included.
struct AcCosts {
  float bits[16][64];
  float least[16];  // of any run
  float end_of_block;
};
// Symbols without a code cost 40 bits.
AcCosts ac_costs(const HuffmanSpec& spec);

// What an error costs, in zigzag order.
struct TrellisWeights {
  float divisor[64];  // of coefficients, which are scaled by 8: 8 * step / gain
  float weight[64];   // bits for each squared unit of coefficient error
};
// J = bits + bits_per_squared_step * sum((error / reference)^2), error in units of the DCT.
TrellisWeights trellis_weights(const QuantTable& steps, const double (&reference)[64], const double (&gain)[64],
                               double bits_per_squared_step);

// Chooses, for each coefficient that rounds to a level other than 0, among that level, 0, and the next smaller level if
// it has fewer bits, the choice with the least J over all runs and ends of block. levels, nonzero: rounded to nearest
// at entry (zigzag order), replaced. coefficients: natural order, scaled by 8. DC stays. importance: what the block's
// errors count, 1 = as `weights` say.
void trellis_quantize(const int16_t* coefficients, const TrellisWeights& weights, float importance,
                      const AcCosts& costs, int16_t* levels, uint64_t& nonzero);

// How much a block's errors show beside others' [masking]. SSIM divides squared errors by the variance of the samples;
// ssim: (variance + 100)^-0.75, visual: its third root, hvs: (variance + 100)^-0.5, found best on training pictures
// because other blocks' bits become too dear beyond; psnr: 1.
float visibility(Tune tune, const int16_t* coefficients);

}  // namespace pac::jpeg
