// The trellis against all choices there are.
#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "base/kernels/block_kernels.h"
#include "jpeg/scan_writer.h"
#include "jpeg/tables.h"
#include "jpeg/trellis.h"
#include "tests/support/generators.h"

namespace pac::test {
namespace {

struct Block {
  int16_t coefficients[64] = {}, levels[64] = {};  // natural, zigzag order
  uint64_t nonzero = 0;
};

// A few levels of both signs, many small ones, anywhere in the block.
Block random_block(Random& random, const jpeg::TrellisWeights& weights, int n_levels) {
  Block block;
  for (int i = 0; i < n_levels; ++i) {
    const int k = 1 + static_cast<int>(random.next() % 63);
    const int magnitude =
        static_cast<int>(weights.divisor[k] * (0.5 + static_cast<int>(random.next() % 1000) * 0.0045));
    const int level = static_cast<int>(static_cast<float>(magnitude) / weights.divisor[k] + 0.5f);
    const int sign = (random.next() & 1) != 0 ? -1 : 1;
    block.coefficients[kNaturalFromZigzag[k]] = static_cast<int16_t>(sign * magnitude);
    block.levels[k] = static_cast<int16_t>(sign * level);
    if (level != 0) block.nonzero |= uint64_t{1} << k;
  }
  return block;
}

double cost_of(const Block& block, const int16_t* levels, const jpeg::TrellisWeights& weights,
               const jpeg::AcCosts& costs, double importance) {
  double j = 0;
  int last = 0;
  for (int k = 1; k < 64; ++k) {
    const double error =
        block.coefficients[kNaturalFromZigzag[k]] - levels[k] * static_cast<double>(weights.divisor[k]);
    j += importance * weights.weight[k] * error * error;
    if (levels[k] == 0) continue;
    j += costs.bits[std::bit_width(static_cast<uint32_t>(std::abs(levels[k])))][k - last - 1];
    last = k;
  }
  return j + (last < 63 ? costs.end_of_block : 0.0f);
}

// The least cost over every combination of the rounded level, each smaller one and 0.
double best_of_all(const Block& block, int16_t* levels, int k, const jpeg::TrellisWeights& weights,
                   const jpeg::AcCosts& costs, double importance) {
  while (k < 64 && block.levels[k] == 0) ++k;
  if (k == 64) return cost_of(block, levels, weights, costs, importance);
  double best = 1e30;
  const int sign = block.levels[k] < 0 ? -1 : 1;
  for (int level = std::abs(block.levels[k]); level >= 0; --level) {
    if (level > 0 && level < std::abs(block.levels[k]) - 1) continue;
    levels[k] = static_cast<int16_t>(sign * level);
    best = std::min(best, best_of_all(block, levels, k + 1, weights, costs, importance));
  }
  levels[k] = 0;
  return best;
}

TEST_CASE("no choice of smaller levels is cheaper than the trellis's") {
  const jpeg::QuantTables tables = jpeg::annex_k_tables(50);
  const jpeg::ChromaGain none = jpeg::chroma_gain(jpeg::Tune::visual, true, true);
  const jpeg::TrellisWeights weights =
      jpeg::trellis_weights(tables.luma, jpeg::reference_of(tables).luma, none.gain, 8.0);
  const jpeg::AcCosts costs = jpeg::ac_costs(jpeg::standard_ac(0));
  Random random(5);
  int changed = 0;
  for (int i = 0; i < 400; ++i) {
    const Block block = random_block(random, weights, i % 8);
    const float importance = 0.4f + 0.3f * static_cast<float>(i % 4);
    int16_t chosen[64], scratch[64] = {};
    std::copy(block.levels, block.levels + 64, chosen);
    uint64_t nonzero = block.nonzero;
    jpeg::trellis_quantize(block.coefficients, weights, importance, costs, chosen, nonzero);
    for (int k = 1; k < 64; ++k) REQUIRE((chosen[k] != 0) == ((nonzero >> k & 1) != 0));
    const double j = cost_of(block, chosen, weights, costs, importance);
    REQUIRE(j <= best_of_all(block, scratch, 1, weights, costs, importance) + 0.01);
    if (nonzero != block.nonzero) ++changed;
  }
  CHECK(changed > 50);
}

}  // namespace
}  // namespace pac::test
