#include "jpeg/trellis.h"

#include <bit>
#include <cmath>
#include <cstdlib>

#include "base/kernels/block_kernels.h"
#include "jpeg/quantizer.h"
#include "jpeg/tables.h"

namespace pac::jpeg {
namespace {

// Predecessors examined for each coefficient: the nearest ones. Longer skips over levels that are not 0 are never the
// best choice in practice, and dense blocks would take quadratic time.
constexpr int kMaxLookBack = 12;

// Squared levels: below this variance errors show no more than in flat blocks.
constexpr double kMaskFloor = 100.0;

struct Stage {
  int k = 0;             // zigzag position
  int level = 0;         // magnitude, >= 1
  int predecessor = -1;  // stage index; -1: the block's start
  double cost = 0;       // J of everything up to and with k, if k's level is not 0
};

// Bits of `run` zeros and a level of `size` bits.
int run_bits(const AcCosts& costs, int run, int size) {
  int bits = size;
  for (; run > 15; run -= 16) bits += costs.bits[0xF0];
  return bits + costs.bits[run << 4 | size];
}

}  // namespace

AcCosts ac_costs(const HuffmanSpec& spec) {
  HuffmanCodes codes;
  make_codes(spec, codes);
  AcCosts costs;
  for (int i = 0; i < 256; ++i) {
    const auto length = static_cast<uint8_t>(codes.code_and_length[i] & 255);
    costs.bits[i] = length > 0 ? length : AcCosts::kNoCode;
  }
  return costs;
}

TrellisWeights trellis_weights(const QuantTable& steps, const double (&reference)[64]) {
  TrellisWeights weights;
  for (int k = 0; k < 64; ++k) {
    const size_t natural = kNaturalFromZigzag[k];
    const double unit = kDctScale * reference[natural];
    weights.divisor[k] = static_cast<double>(kDctScale) * steps[natural];
    weights.weight[k] = kBitsPerSquaredStep / (unit * unit);
  }
  return weights;
}

double visibility(const int16_t* coefficients) {
  int64_t sum = 0;  // of 64 squares below 2^28
  for (int i = 1; i < 64; ++i) sum += coefficients[i] * coefficients[i];
  // The transform is orthonormal but for kDctScale: its sum of squares is 64 times the variance.
  const double variance = static_cast<double>(sum) / (64.0 * kDctScale * kDctScale);
  return 1.0 / std::sqrt(variance + kMaskFloor);
}

void trellis_quantize(const int16_t* coefficients, const TrellisWeights& weights, double importance,
                      const AcCosts& costs, int16_t* levels, uint64_t& nonzero) {
  // zero_cost[k]: J of making positions 1..k all zero.
  double zero_cost[64];
  zero_cost[0] = 0.0;
  for (int k = 1; k < 64; ++k) {
    const double c = coefficients[kNaturalFromZigzag[k]];
    zero_cost[k] = zero_cost[k - 1] + importance * weights.weight[k] * c * c;
  }
  Stage stages[63];
  int n_stages = 0, best_end = -1;
  double best = zero_cost[63] + costs.bits[0];
  for (uint64_t rest = nonzero & ~uint64_t{1}; rest != 0; rest &= rest - 1) {
    Stage& stage = stages[n_stages];
    stage.k = std::countr_zero(rest);
    const int k = stage.k, rounded = std::abs(levels[k]);
    const double magnitude = std::abs(coefficients[kNaturalFromZigzag[k]]);
    bool first = true;
    for (int level = rounded; level >= 1 && level >= rounded - 1; --level) {
      const double error = magnitude - level * weights.divisor[k];
      const double distortion = importance * weights.weight[k] * error * error;
      const int size = static_cast<int>(std::bit_width(static_cast<uint32_t>(level)));
      const int oldest = n_stages > kMaxLookBack ? n_stages - kMaxLookBack : 0;
      for (int j = n_stages - 1; j >= oldest - 1; --j) {
        if (j == oldest - 1 && oldest > 0) break;  // the block's start is too far back
        const int from = j < 0 ? 0 : stages[j].k;
        const double before = j < 0 ? 0.0 : stages[j].cost;
        const double cost =
            before + (zero_cost[k - 1] - zero_cost[from]) + run_bits(costs, k - from - 1, size) + distortion;
        if (first || cost < stage.cost) {
          stage.cost = cost;
          stage.level = level;
          stage.predecessor = j;
          first = false;
        }
      }
    }
    const double end = stage.cost + (zero_cost[63] - zero_cost[k]) + (k < 63 ? costs.bits[0] : 0);
    if (end < best) {
      best = end;
      best_end = n_stages;
    }
    n_stages += 1;
  }

  uint64_t kept = nonzero & 1;
  int16_t chosen[64] = {};
  for (int i = best_end; i >= 0; i = stages[i].predecessor) {
    const Stage& stage = stages[i];
    chosen[stage.k] = static_cast<int16_t>(levels[stage.k] < 0 ? -stage.level : stage.level);
    kept |= uint64_t{1} << stage.k;
  }
  for (int k = 1; k < 64; ++k) levels[k] = chosen[k];
  nonzero = kept;
}

}  // namespace pac::jpeg
