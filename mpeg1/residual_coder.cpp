#include "mpeg1/residual_coder.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "base/kernels/block_kernels.h"
#include "mpeg1/trellis.h"
#include "mpeg1/vlc_tables.h"

namespace pac::mpeg1 {
namespace {

alignas(64) constexpr uint8_t kZeros[16] = {};
constexpr uint32_t kAllBlocks = (1u << kBlocks) - 1;

// |level| of a pair of blocks: without branches, so that compilers compare many at a time.
int largest_level(const int16_t* levels) {
  int16_t largest = 0, least = 0;
  for (int i = 0; i < 128; ++i) {
    largest = std::max(largest, levels[i]);
    least = std::min(least, levels[i]);
  }
  return std::max<int>(largest, -least);
}

// Divides a pair of blocks; DC of intra is none of its business. Returns whether every level has a code.
bool divide_pair(const BlockKernels& kernels, const QuantizerSet& set, int block, bool is_intra, Attempt& attempt) {
  int16_t* levels = attempt.levels + 64 * block;
  uint64_t* nonzero = attempt.nonzero + block;
  kernels.quantize(attempt.dct + 64 * block, set.divide[attempt.quantizer], 2, levels, nonzero);
  if (is_intra) {
    levels[0] = levels[64] = 0;
    nonzero[0] &= ~uint64_t{1}, nonzero[1] &= ~uint64_t{1};
  }
  return !set.may_overflow[attempt.quantizer] || largest_level(levels) <= kMaxLevel;
}

// Divides the blocks of `reaching` at the attempt's quantizer, or the next one at which every level has a code. The
// others have no levels.
void divide(const BlockKernels& kernels, const QuantizerSet& set, bool is_intra, uint32_t reaching, Attempt& attempt) {
  for (;; ++attempt.quantizer) {
    bool is_coded = true;
    for (int block = 0; block < kBlocks; block += 2) {
      attempt.nonzero[block] = attempt.nonzero[block + 1] = 0;
      if ((reaching >> block & 3) != 0) is_coded &= divide_pair(kernels, set, block, is_intra, attempt);
    }
    if (is_coded) return;
    if (attempt.quantizer == 31) break;
  }
  for (int block = 0; block < kBlocks; ++block)
    for (uint64_t mask = attempt.nonzero[block]; mask != 0; mask &= mask - 1) {
      int16_t& level = attempt.levels[64 * block + std::countr_zero(mask)];
      level = static_cast<int16_t>(std::clamp<int>(level, -kMaxLevel, kMaxLevel));
    }
}

// Chooses the levels of one block.
BlockCost choose_levels(const ResidualTask& task, const BlockToQuantize& block, bool with_cost, int16_t* levels,
                        uint64_t& nonzero) {
  if (nonzero == 0) {
    BlockCost nothing;
    if (with_cost) nothing.distortion = nothing.energy = energy(block);
    nothing.bits = block.is_intra ? 2 * kBit : 0;
    return nothing;
  }
  if (block.prices != nullptr) return quantize_priced(block, levels, nonzero);
  if (task.choice == LevelChoice::trellis) return quantize_trellis(block, levels, nonzero);
  drop_small_levels(block, levels, nonzero);
  return with_cost ? cost_of(block, levels, nonzero) : BlockCost{};
}

void place(int block, const Planes& target, int column, int row, uint8_t*& samples, ptrdiff_t& stride) {
  const int plane = block < 4 ? 0 : block - 3;
  stride = target.stride[plane];
  samples = target.at(plane, column, row);
  if (block < 4) samples += (block & 1) * 8 + (block >> 1) * 8 * stride;
}

template <bool kIsIntra>
void dequantize(const int16_t* levels, uint64_t mask, const uint16_t* weight, int16_t* coefficients) {
  clear_block(coefficients);
  for (; mask != 0; mask &= mask - 1) {
    const int position = std::countr_zero(mask);
    const int level = levels[position], magnitude = level < 0 ? -level : level;
    const int value =
        kIsIntra ? reconstruct_intra(magnitude, weight[position]) : reconstruct_non_intra(magnitude, weight[position]);
    coefficients[kNaturalFromZigzag[position]] = static_cast<int16_t>(level < 0 ? -value : value);
  }
}

// The levels' codes and the end of the block.
int append_tokens(const int16_t* levels, uint64_t mask, int last_position, std::vector<Token>& tokens) {
  Token made[65];
  int count = 0;
  if (last_position < 0 && (mask & 1) != 0 && (levels[0] == 1 || levels[0] == -1)) {
    made[count++] = first_one_code(levels[0]);
    last_position = 0;
    mask &= mask - 1;
  }
  for (; mask != 0; mask &= mask - 1) {
    const int position = std::countr_zero(mask);
    made[count++] = coefficient_code(position - last_position - 1, levels[position]);
    last_position = position;
  }
  made[count++] = kEndOfBlockCode;
  tokens.insert(tokens.end(), made, made + count);
  return count;
}

void copy_prediction(const MacroblockSamples& prediction, const Planes& target, int column, int row) {
  for (int y = 0; y < 16; ++y) std::memcpy(target.at(0, column, row) + y * target.stride[0], prediction.y + 16 * y, 16);
  for (int y = 0; y < 8; ++y) {
    std::memcpy(target.at(1, column, row) + y * target.stride[1], prediction.cb + 8 * y, 8);
    std::memcpy(target.at(2, column, row) + y * target.stride[2], prediction.cr + 8 * y, 8);
  }
}

}  // namespace

bool attempt_intra(const ResidualTask& task, const Planes& source, int column, int row, bool with_cost,
                   Attempt& attempt, int64_t limit) {
  attempt.kind = MacroblockKind::intra;
  attempt.vector = {};
  attempt.pattern = 0;
  attempt.distortion = 0;
  attempt.bits = 0;
  const Planes nothing = {
      {const_cast<uint8_t*>(kZeros), const_cast<uint8_t*>(kZeros), const_cast<uint8_t*>(kZeros)}, {0, 0, 0}, 16, 16};
  task.kernels->motion.fdct_macroblock(predicted_samples(source, column, row, nothing, 0, 0), 1, attempt.dct);
  divide(task.kernels->block, *task.intra, true, kAllBlocks, attempt);
  BlockToQuantize block;
  block.weight = task.intra->weight[attempt.quantizer];
  block.lambda = attempt.lambda;
  block.first_position = 1;
  block.is_intra = true;
  for (int i = 0; i < kBlocks; ++i) {
    block.dct = attempt.dct + 64 * i;
    const int dc = std::clamp((block.dct[0] + 32) >> 6, 0, 255);
    attempt.dc[i] = static_cast<int16_t>(dc);
    const BlockCost cost = choose_levels(task, block, with_cost, attempt.levels + 64 * i, attempt.nonzero[i]);
    const int64_t dc_error = block.dct[0] - 64 * dc;
    attempt.distortion += cost.distortion + dc_error * dc_error;
    attempt.bits += cost.bits;
    if (attempt.distortion + worth(attempt.lambda, attempt.bits) >= limit && attempt.prices == nullptr) return false;
  }
  return true;
}

bool attempt_inter(const ResidualTask& task, const Planes& source, int column, int row, bool with_cost,
                   Attempt& attempt, int64_t limit) {
  attempt.kind = MacroblockKind::inter;
  attempt.pattern = 0;
  attempt.distortion = attempt.energy = 0;
  attempt.bits = 0;
  const uint32_t reaching =
      task.kernels->motion.fdct_macroblock(predicted_samples(source, column, row, attempt.prediction.planes(), 0, 0),
                                           task.non_intra->least_weight[attempt.quantizer], attempt.dct);
  divide(task.kernels->block, *task.non_intra, false, reaching, attempt);
  BlockToQuantize block;
  block.weight = task.non_intra->weight[attempt.quantizer];
  block.lambda = attempt.lambda;
  int64_t least = 0;  // with or without each block
  for (int i = 0; i < kBlocks; ++i) {
    block.dct = attempt.dct + 64 * i;
    if (attempt.prices != nullptr) block.prices = attempt.prices->blocks + i;
    const BlockCost cost = choose_levels(task, block, with_cost, attempt.levels + 64 * i, attempt.nonzero[i]);
    if (attempt.nonzero[i] != 0) attempt.pattern = static_cast<uint8_t>(attempt.pattern | 32 >> i);
    attempt.costs[i] = cost;
    attempt.energy += cost.energy;
    attempt.distortion += cost.distortion;
    attempt.bits += cost.bits;
    least += std::min(cost.energy, cost.distortion + worth(attempt.lambda, cost.bits));
    if (least >= limit && attempt.prices == nullptr) return false;
  }
  return true;
}

void commit(const ResidualTask& task, const Attempt& attempt, const Planes& target, int column, int row,
            std::vector<Token>& tokens, Macroblock& macroblock) {
  const bool is_intra = attempt.kind == MacroblockKind::intra;
  macroblock.kind = attempt.kind;
  macroblock.vector = attempt.vector;
  macroblock.pattern = attempt.pattern;
  macroblock.quantizer = attempt.quantizer;
  macroblock.first_token = static_cast<uint32_t>(tokens.size());
  if (!is_intra) copy_prediction(attempt.prediction, target, column, row);
  alignas(64) int16_t coefficients[kBlocks * 64];
  uint8_t* samples[kBlocks];
  ptrdiff_t strides[kBlocks];
  size_t n = 0;
  for (int block = 0; block < kBlocks; ++block) {
    if (!is_intra && (attempt.pattern & 32 >> block) == 0) continue;
    const int16_t* levels = attempt.levels + 64 * block;
    const uint64_t mask = attempt.nonzero[block];
    macroblock.counts[block] = static_cast<uint8_t>(append_tokens(levels, mask, is_intra ? 0 : -1, tokens));
    if (is_intra) {
      macroblock.dc[block] = attempt.dc[block];
      dequantize<true>(levels, mask, task.intra->weight[attempt.quantizer], coefficients + 64 * n);
      coefficients[64 * n] = static_cast<int16_t>(8 * attempt.dc[block]);
    } else {
      dequantize<false>(levels, mask, task.non_intra->weight[attempt.quantizer], coefficients + 64 * n);
    }
    place(block, target, column, row, samples[n], strides[n]);
    ++n;
  }
  if (is_intra)
    task.kernels->motion.idct_put(coefficients, n, samples, strides);
  else if (n != 0)
    task.kernels->motion.idct_add(coefficients, n, samples, strides);
}

}  // namespace pac::mpeg1
