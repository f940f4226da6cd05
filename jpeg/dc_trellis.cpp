#include "jpeg/dc_trellis.h"

#include <algorithm>
#include <bit>
#include <cstdlib>

#include "jpeg/strip.h"

namespace pac::jpeg {

DcCosts dc_costs(const HuffmanSpec& spec) {
  constexpr uint32_t kNoCode = 40;
  HuffmanCodes codes;
  make_codes(spec, codes);
  DcCosts costs{};
  for (uint32_t size = 0; size < 12; ++size) {
    const uint32_t length = codes.code_and_length[size] & 255;
    costs.bits[size] = static_cast<float>((length > 0 ? length : kNoCode) + size);
  }
  return costs;
}

// One step of the dynamic program: from the paths to the block before to those to this one.
void DcTrellis::add(uint32_t block, int rounded, float coefficient, float weight, float divisor, bool restarts,
                    const DcCosts& costs, Paths& paths) {
  constexpr int kOffsets[kCandidates] = {0, -1, 1};  // the nearest level wins ties
  Node node;
  node.block = block;
  Paths next;
  for (size_t j = 0; j < kCandidates; ++j) {
    const int level = rounded + kOffsets[j];
    const float error = static_cast<float>(level) * divisor - coefficient;
    float best = 1e30f;
    for (size_t i = 0; i < kCandidates; ++i) {
      const auto difference = static_cast<uint32_t>(std::abs(level - (restarts ? 0 : paths.level[i])));
      // Levels are within -1025..1025: 8-bit samples have DC within +-1024 and steps are at least 1.
      const float total = paths.cost[i] + costs.bits[std::min(static_cast<int>(std::bit_width(difference)), 11)];
      if (total >= best) continue;
      best = total;
      node.from[j] = static_cast<uint8_t>(i);
    }
    next.cost[j] = best + weight * (error * error);
    next.level[j] = level;
    node.level[j] = static_cast<int16_t>(level);
  }
  // Sums over long rows would lose the bits that decide.
  const float least = *std::min_element(next.cost, next.cost + kCandidates);
  for (float& cost : next.cost) cost -= least;
  paths = next;
  nodes_.push_back(node);
}

void DcTrellis::choose(const Frame& frame, int c, int mcu_row, int restart_interval_mcus, const int16_t* coefficients,
                       const float* importance, const TrellisWeights& weights, const DcCosts& costs, Levels& levels) {
  const Component& component = frame.components[c];
  const int n_rows = StripTransform::rows_of_blocks(component, mcu_row), width = component.width_blocks;
  int& predicted = predicted_[c];
  Paths paths{{0.0f, 1e30f, 1e30f}, {predicted, predicted, predicted}};
  nodes_.clear();
  for (int mcu = 0; mcu < frame.mcus_per_row; ++mcu) {
    const int64_t number = int64_t{mcu_row} * frame.mcus_per_row + mcu;
    bool restarts = restart_interval_mcus > 0 && number % restart_interval_mcus == 0;
    for (int by = 0; by < n_rows; ++by)
      for (int x = mcu * component.h; x < std::min((mcu + 1) * component.h, width); ++x) {
        const auto block = static_cast<size_t>(by * width + x);
        const float weight = weights.weight[0] * (importance != nullptr ? importance[block] : 1.0f);
        add(static_cast<uint32_t>(block), levels.zigzag[c][64 * block], static_cast<float>(coefficients[64 * block]),
            weight, weights.divisor[0], restarts, costs, paths);
        restarts = false;
      }
  }
  if (nodes_.empty()) return;
  auto chosen = static_cast<size_t>(std::min_element(paths.cost, paths.cost + kCandidates) - paths.cost);
  predicted = paths.level[chosen];
  for (size_t n = nodes_.size(); n-- > 0;) {
    const Node& node = nodes_[n];
    levels.zigzag[c][64 * size_t{node.block}] = node.level[chosen];
    uint64_t& nonzero = levels.nonzero[c][node.block];
    nonzero = (nonzero & ~uint64_t{1}) | uint64_t{node.level[chosen] != 0};
    chosen = node.from[chosen];
  }
}

}  // namespace pac::jpeg
