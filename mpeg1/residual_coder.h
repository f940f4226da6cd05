// One way to code a macroblock: its prediction, the transform of what is left, the levels and what they cost.
#pragma once

#include <cstdint>
#include <vector>

#include "base/kernels/kernels.h"
#include "mpeg1/macroblock.h"
#include "mpeg1/predict.h"
#include "mpeg1/quantizer.h"
#include "mpeg1/trellis.h"

namespace pac::mpeg1 {

constexpr int kBlocks = 6;  // of a macroblock: four of luma, Cb, Cr

// How levels are chosen after the division.
enum class LevelChoice : uint8_t {
  drop_small,  // levels of 1 that do not pay are dropped, and ends of blocks
  trellis,     // every level may be one less or nothing
};

struct Attempt {
  MacroblockKind kind = MacroblockKind::inter;
  uint8_t pattern = 0;
  uint8_t quantizer = 1;
  int64_t lambda = 0;  // a bit in units of distortion
  MotionVector vector;
  int16_t dc[kBlocks] = {};                  // quantized, of intra
  alignas(64) int16_t dct[kBlocks * 64];     // natural order, times 8
  alignas(64) int16_t levels[kBlocks * 64];  // zigzag order
  uint64_t nonzero[kBlocks] = {};            // bit k: level at zigzag position k
  int64_t distortion = 0;                    // squared error times 64, where it was asked for
  int64_t energy = 0;                        // of inter: the same without any level
  const MacroblockPrices* prices = nullptr;  // null: Annex B's code lengths
  int bits = 0;                              // of the coefficients, / kBit
  BlockCost costs[kBlocks];                  // of inter, where it was asked for
  MacroblockSamples prediction;              // of inter
};

struct ResidualTask {
  const Kernels* kernels = nullptr;
  const QuantizerSet* intra = nullptr;
  const QuantizerSet* non_intra = nullptr;
  const int64_t* lambda = nullptr;  // by the quantizer_scale that was asked for, see Attempt
  LevelChoice choice = LevelChoice::drop_small;
};

// Both take `source` at (column, row), attempt.lambda and attempt.quantizer, which they raise where a level would have
// no code. `with_cost`: distortion and bits are wanted. Both return whether they were not given up: they are where
// Annex B's code lengths count and the cost is known to be `limit` or more before all blocks have levels.
bool attempt_intra(const ResidualTask& task, const Planes& source, int column, int row, bool with_cost,
                   Attempt& attempt, int64_t limit = INT64_MAX);
// attempt.prediction holds the prediction. Blocks left out of the pattern count with their whole error.
bool attempt_inter(const ResidualTask& task, const Planes& source, int column, int row, bool with_cost,
                   Attempt& attempt, int64_t limit = INT64_MAX);

// Takes the attempt: reconstructs it into `target`, appends its tokens, describes it in `macroblock`.
void commit(const ResidualTask& task, const Attempt& attempt, const Planes& target, int column, int row,
            std::vector<Token>& tokens, Macroblock& macroblock);

}  // namespace pac::mpeg1
