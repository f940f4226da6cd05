// Rate-distortion optimal AC levels of a block, given what each symbol costs.
#pragma once

#include <cstdint>

#include "jpeg/huffman.h"
#include "jpeg/jpeg.h"

namespace pac::jpeg {

// Code lengths of the AC symbols RRRRSSSS; kNoCode for symbols without a code.
struct AcCosts {
  static constexpr int kNoCode = 40;
  uint8_t bits[256];
};
AcCosts ac_costs(const HuffmanSpec& spec);

// What an error costs, in zigzag order.
struct TrellisWeights {
  double divisor[64];  // 8 * step
  double weight[64];   // bits for each squared unit of coefficient error
};
// J = bits + 8 * sum((error / reference)^2), error in units of the DCT. See tables.h for the references and for the 8.
TrellisWeights trellis_weights(const QuantTable& steps, const double (&reference)[64]);

// Chooses among, for each coefficient that rounds to a level other than 0, that level, the next smaller one and 0, the
// choice with the least J over all runs and ends of block (dynamic programming over the last level that is not 0).
// levels, nonzero: rounded to nearest at entry (zigzag order), replaced. coefficients: natural order, scaled by 8. DC
// stays. importance: what the block's errors count, 1 = as `weights` say.
void trellis_quantize(const int16_t* coefficients, const TrellisWeights& weights, double importance,
                      const AcCosts& costs, int16_t* levels, uint64_t& nonzero);

// How much a block's errors show beside others' [masking]: 1 / sqrt(variance of its samples + 100). SSIM divides errors
// by the variance; by its root, measured, fewest bytes give that SSIM, because other blocks' bits become too dear else.
double visibility(const int16_t* coefficients);

}  // namespace pac::jpeg
