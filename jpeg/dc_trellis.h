// Rate-distortion optimal DC levels of a row of MCUs. Each is coded as its difference from the one before [T.81
// F.1.2.1], so that a level's price depends on its neighbors' in the order of the scan.
#pragma once

#include <cstdint>
#include <vector>

#include "jpeg/block_walker.h"
#include "jpeg/frame.h"
#include "jpeg/huffman.h"
#include "jpeg/trellis.h"

namespace pac::jpeg {

// Bits of a difference by its size (magnitudes below 2^size): code and extra bits. Sizes without a code cost 40 bits.
struct DcCosts {
  float bits[12];
};
DcCosts dc_costs(const HuffmanSpec& spec);

// Keeps its buffer from row to row.
class DcTrellis {
 public:
  // Before the first MCU row of a scan, and before one that a restart marker precedes: PRED is 0.
  void reset() {
    for (int& dc : predicted_) dc = 0;
  }

  // Replaces the DC levels of component c in one MCU row. Of the level nearest to each coefficient and its two
  // neighbors it takes those with the least sum of bits + bits_per_squared_step * sum((error / reference)^2), given the
  // last level of the row before and whatever the next row brings. MCU rows in order. levels: rounded to nearest at
  // entry; masks follow. coefficients: scaled by 8, 64 natural ones for each real block, in rows of blocks. importance:
  // of each block, as trellis_quantize has it; null: 1.
  void choose(const Frame& frame, int c, int mcu_row, int restart_interval_mcus, const int16_t* coefficients,
              const float* importance, const TrellisWeights& weights, const DcCosts& costs, Levels& levels);

 private:
  static constexpr size_t kCandidates = 3;
  // A block, and which candidate of the block before goes best with each of its own.
  struct Node {
    uint32_t block = 0;  // number in the row of MCUs
    int16_t level[kCandidates] = {};
    uint8_t from[kCandidates] = {};
  };
  // The paths up to a block: what the cheapest one to each of its candidates costs, less what all have in common.
  struct Paths {
    float cost[kCandidates];
    int level[kCandidates];
  };
  void add(uint32_t block, int rounded, float coefficient, float weight, float divisor, bool restarts,
           const DcCosts& costs, Paths& paths);

  std::vector<Node> nodes_;  // in the order of the scan
  int predicted_[3] = {0, 0, 0};
};

}  // namespace pac::jpeg
