#include "jpeg/trellis.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>

#include "base/kernels/block_kernels.h"
#include "jpeg/quantizer.h"

namespace pac::jpeg {
namespace {

// Squared levels: below this variance errors show no more than in flat blocks.
constexpr float kMaskFloor = 100.0f;

}  // namespace

AcCosts ac_costs(const HuffmanSpec& spec) {
  constexpr uint32_t kNoCode = 40;
  HuffmanCodes codes;
  make_codes(spec, codes);
  const auto length = [&](int symbol) {
    const uint32_t bits = codes.code_and_length[symbol] & 255;
    return static_cast<float>(bits > 0 ? bits : kNoCode);
  };
  AcCosts costs{};
  costs.end_of_block = length(0);
  for (int size = 1; size < 16; ++size) {
    for (int run = 0; run < 64; ++run)
      costs.bits[size][run] =
          static_cast<float>(run / 16) * length(0xF0) + length((run % 16) << 4 | size) + static_cast<float>(size);
    costs.least[size] = *std::min_element(costs.bits[size], costs.bits[size] + 63);
  }
  return costs;
}

TrellisWeights trellis_weights(const QuantTable& steps, const double (&reference)[64], const double (&gain)[64],
                               double bits_per_squared_step) {
  TrellisWeights weights;
  for (int k = 0; k < 64; ++k) {
    const size_t natural = kNaturalFromZigzag[k];
    const double g = effective_gain(gain[natural], steps[natural]), unit = kDctScale * reference[natural] / g;
    weights.divisor[k] = static_cast<float>(kDctScale * steps[natural] / g);
    weights.weight[k] = static_cast<float>(bits_per_squared_step / (unit * unit));
  }
  return weights;
}

float visibility(Tune tune, const int16_t* coefficients) {
  if (tune == Tune::psnr) return 1.0f;
  int64_t sum = 0;  // of 64 squares below 2^28
  for (int i = 1; i < 64; ++i) sum += coefficients[i] * coefficients[i];
  // The transform is orthonormal but for kDctScale: its sum of squares is 64 times the variance.
  const float variance = static_cast<float>(sum) * (1.0f / (64 * kDctScale * kDctScale));
  const float root = std::sqrt(variance + kMaskFloor), fourth_root = std::sqrt(root);
  return 1.0f / (tune == Tune::ssim ? root * fourth_root : tune == Tune::hvs ? root : fourth_root);
}

// Dynamic programming over the levels kept: node n is "the n-th candidate is kept, whatever precedes it". All costs are
// relative to a block of zeros, so what is skipped costs nothing and what is kept *gains* its error's decrease.
void trellis_quantize(const int16_t* coefficients, const TrellisWeights& weights, float importance,
                      const AcCosts& costs, int16_t* levels, uint64_t& nonzero) {
  uint64_t rest = nonzero & ~uint64_t{1};
  if (rest == 0) return;
  // Node 0 is the block's start. least[n]: the smallest cost of nodes 0..n.
  float cost[64], least[64];
  int position[64], predecessor[64];
  int16_t level[64];
  cost[0] = least[0] = 0.0f;
  position[0] = 0;
  int n_nodes = 1, best_end = 0;
  float best = costs.end_of_block;
  for (; rest != 0; rest &= rest - 1) {
    const int k = std::countr_zero(rest), rounded = std::abs(levels[k]);
    const float twice = 2.0f * static_cast<float>(std::abs(coefficients[kNaturalFromZigzag[k]]));
    const float weight = importance * weights.weight[k];
    // A smaller level of the same size would cost as many bits and err more: only 2^n - 1 instead of 2^n is cheaper.
    const bool is_power = rounded > 1 && (rounded & (rounded - 1)) == 0;
    float found = 1e30f;
    for (int candidate = rounded; candidate >= rounded - (is_power ? 1 : 0); --candidate) {
      // (x - value)^2 - x^2
      const float value = static_cast<float>(candidate) * weights.divisor[k];
      const float gain = weight * (value * (value - twice));
      const int size = static_cast<int>(std::bit_width(static_cast<uint32_t>(candidate)));
      const float* bits = costs.bits[size] + k - 1;
      const float fewest = costs.least[size];
      for (int n = n_nodes - 1; n >= 0 && least[n] + fewest + gain < found; --n) {
        const float total = cost[n] + bits[-position[n]] + gain;
        if (total >= found) continue;
        found = total;
        level[n_nodes] = static_cast<int16_t>(candidate);
        predecessor[n_nodes] = n;
      }
    }
    cost[n_nodes] = found;
    least[n_nodes] = std::min(found, least[n_nodes - 1]);
    position[n_nodes] = k;
    const float end = found + (k < 63 ? costs.end_of_block : 0.0f);
    if (end < best) {
      best = end;
      best_end = n_nodes;
    }
    n_nodes += 1;
  }

  uint64_t kept = 0;
  for (int n = best_end; n > 0; n = predecessor[n]) {
    const int k = position[n];
    levels[k] = static_cast<int16_t>(levels[k] < 0 ? -level[n] : level[n]);
    kept |= uint64_t{1} << k;
  }
  for (uint64_t dropped = nonzero & ~(kept | 1); dropped != 0; dropped &= dropped - 1)
    levels[std::countr_zero(dropped)] = 0;
  nonzero = kept | (nonzero & 1);
}

}  // namespace pac::jpeg
