// Quantization with an eye on the bits: which levels of a block are worth what they cost.
#pragma once

#include <cstdint>

#include "mpeg1/quantizer.h"

namespace pac::mpeg1 {

// Distortions are squared errors of coefficients scaled by 8, so 64 times those of samples; lambda is in their units a
// bit.
constexpr int64_t kDistortionScale = 64;

constexpr int kBit = 256;  // costs are in parts of a bit

// What so many bits are worth at lambda.
inline int64_t worth(int64_t lambda, int64_t bits) {
  return lambda * bits / kBit;
}

struct BlockToQuantize {
  const int16_t* dct;      // natural order, times 8
  const uint16_t* weight;  // quantizer_scale * entry, zigzag order
  int first_position = 0;  // 1 for intra blocks: DC is none of our business
  bool is_intra = false;
  int64_t lambda = 0;
  const BlockPrices* prices = nullptr;  // null: Annex B's code lengths
};

struct BlockCost {
  int64_t distortion = 0;  // of positions from first_position on
  int64_t energy = 0;      // the distortion if nothing is coded
  int bits = 0;            // of the coefficients and end_of_block, / kBit; 0 where nothing is left
};

// Squared error of all positions if nothing is coded.
int64_t energy(const BlockToQuantize& block);

// In: rounded levels (zigzag) with the mask of nonzero ones. Out: the levels, no larger, that minimize distortion +
// lambda * bits over all choices of each level, the next smaller one or zero. Dynamic programming over positions.
BlockCost quantize_trellis(const BlockToQuantize& block, int16_t* levels, uint64_t& nonzero);

// The same where block.prices says what each costs: nothing hangs on the run before, so that one pass over the
// positions finds the least. The block may be left out of the pattern; what the pattern costs is not counted in the
// bits.
BlockCost quantize_priced(const BlockToQuantize& block, int16_t* levels, uint64_t& nonzero);

// One pass: levels of 1 that cost more than they save become zero, and those after the best place to end the block.
void drop_small_levels(const BlockToQuantize& block, int16_t* levels, uint64_t& nonzero);

// What these levels cost.
BlockCost cost_of(const BlockToQuantize& block, const int16_t* levels, uint64_t nonzero);

}  // namespace pac::mpeg1
