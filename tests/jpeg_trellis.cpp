// The trellis against all choices there are.
#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "base/kernels/block_kernels.h"
#include "jpeg/dc_trellis.h"
#include "jpeg/scan_writer.h"
#include "jpeg/strip.h"
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

TEST_CASE("a block whose levels all cost more than their error is zeroed whole, however many it has") {
  const jpeg::QuantTables tables = jpeg::annex_k_tables(50);
  const jpeg::ChromaGain none = jpeg::chroma_gain(jpeg::Tune::visual, true, true);
  const jpeg::TrellisWeights weights =
      jpeg::trellis_weights(tables.luma, jpeg::reference_of(tables).luma, none.gain, 8.0);
  const jpeg::AcCosts costs = jpeg::ac_costs(jpeg::standard_ac(0));
  for (const int n_levels : {1, 4, 12}) {
    Block block;
    block.levels[0] = 3;
    block.nonzero = 1;
    for (int i = 0; i < n_levels; ++i) {
      const int k = 20 + 3 * i;  // long runs: dear codes
      block.coefficients[kNaturalFromZigzag[k]] = static_cast<int16_t>(0.55f * weights.divisor[k]);
      block.levels[k] = 1;
      block.nonzero |= uint64_t{1} << k;
    }
    jpeg::trellis_quantize(block.coefficients, weights, 1.0f, costs, block.levels, block.nonzero);
    CHECK(block.nonzero == 1);
    CHECK(block.levels[0] == 3);
    for (int k = 1; k < 64; ++k) CHECK(block.levels[k] == 0);
  }
}

// A component's DC levels and coefficients in one MCU row of a picture.
struct DcRow {
  jpeg::Frame frame;
  jpeg::Levels levels;
  std::vector<int16_t> coefficients;
  std::vector<size_t> order;  // block numbers as the scan visits them
};

// Two rows of blocks, 2x2 in an MCU, a column of blocks past the edge.
DcRow random_dc_row(Random& random, const jpeg::TrellisWeights& weights) {
  DcRow row;
  row.frame = jpeg::make_frame(40, 16, jpeg::Subsampling::yuv420);
  constexpr size_t kBlocks = 10;
  row.levels.zigzag[0].resize(64 * kBlocks);
  row.levels.nonzero[0].resize(kBlocks);
  row.coefficients.resize(64 * kBlocks);
  for (size_t i = 0; i < kBlocks; ++i) {
    const double exact = 3.0 + static_cast<double>(random.next() % 400) * 0.01;
    const int rounded = static_cast<int>(exact + 0.5);
    row.coefficients[64 * i] = static_cast<int16_t>(exact * static_cast<double>(weights.divisor[0]));
    row.levels.zigzag[0][64 * i] = static_cast<int16_t>(rounded);
    row.levels.nonzero[0][i] = rounded != 0 ? 5 : 4;
  }
  for (const int first : {0, 2, 4})
    for (const int by : {0, 1})
      for (int x = first; x < std::min(first + 2, 5); ++x) row.order.push_back(static_cast<size_t>(5 * by + x));
  return row;
}

double dc_cost_of(const DcRow& row, const std::vector<int>& levels, int predicted, int restart,
                  const jpeg::TrellisWeights& weights, const jpeg::DcCosts& costs) {
  double j = 0;
  for (size_t i = 0; i < row.order.size(); ++i) {
    if (restart > 0 && i % (4 * static_cast<size_t>(restart)) == 0) predicted = 0;
    const double error = row.coefficients[64 * row.order[i]] - levels[i] * static_cast<double>(weights.divisor[0]);
    j += static_cast<double>(costs.bits[std::bit_width(static_cast<uint32_t>(std::abs(levels[i] - predicted)))]) +
         static_cast<double>(weights.weight[0]) * error * error;
    predicted = levels[i];
  }
  return j;
}

double best_dc_of_all(const DcRow& row, std::vector<int>& levels, size_t i, int restart,
                      const jpeg::TrellisWeights& weights, const jpeg::DcCosts& costs) {
  if (i == row.order.size()) return dc_cost_of(row, levels, 0, restart, weights, costs);
  double best = 1e30;
  const int rounded = row.levels.zigzag[0][64 * row.order[i]];
  for (int level = rounded - 1; level <= rounded + 1; ++level) {
    levels[i] = level;
    best = std::min(best, best_dc_of_all(row, levels, i + 1, restart, weights, costs));
  }
  return best;
}

TEST_CASE("no choice of neighboring DC levels along a row is cheaper than the trellis's, restarts or not") {
  const jpeg::QuantTables tables = jpeg::annex_k_tables(50);
  const jpeg::ChromaGain none = jpeg::chroma_gain(jpeg::Tune::visual, true, true);
  const jpeg::TrellisWeights weights =
      jpeg::trellis_weights(tables.luma, jpeg::reference_of(tables).luma, none.gain, 8.0);
  const jpeg::DcCosts costs = jpeg::dc_costs(jpeg::standard_dc(0));
  Random random(6);
  int changed = 0;
  for (int i = 0; i < 12; ++i) {
    const int restart = i % 3;
    DcRow row = random_dc_row(random, weights);
    std::vector<int> scratch(row.order.size()), chosen;
    const double best = best_dc_of_all(row, scratch, 0, restart, weights, costs);
    const jpeg::Levels rounded = row.levels;
    jpeg::DcTrellis trellis;
    trellis.choose(row.frame, 0, 0, restart, row.coefficients.data(), nullptr, weights, costs, row.levels);
    for (const size_t block : row.order) {
      const int level = row.levels.zigzag[0][64 * block];
      chosen.push_back(level);
      REQUIRE(row.levels.nonzero[0][block] == (level != 0 ? 5u : 4u));
      if (level != rounded.zigzag[0][64 * block]) ++changed;
    }
    REQUIRE(dc_cost_of(row, chosen, 0, restart, weights, costs) <= best + 0.01);
  }
  CHECK(changed > 5);
}

}  // namespace
}  // namespace pac::test
