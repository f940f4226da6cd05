#include "mpeg1/trellis.h"

#include <bit>
#include <cstring>

#include "base/kernels/block_kernels.h"
#include "mpeg1/vlc_tables.h"

namespace pac::mpeg1 {
namespace {

int magnitude_of(int value) {
  return value < 0 ? -value : value;
}

int64_t squared(int64_t value) {
  return value * value;
}

int reconstruct(const BlockToQuantize& block, int level, int position) {
  return block.is_intra ? reconstruct_intra(level, block.weight[position])
                        : reconstruct_non_intra(level, block.weight[position]);
}

int coefficient(const BlockToQuantize& block, int position) {
  return magnitude_of(block.dct[kNaturalFromZigzag[position]]);
}

// dct_coeff_first spends a bit less on run 0, level 1 [table B.5c].
int token_bits(const BlockToQuantize& block, int run, int level, bool is_first) {
  return run_level_bits(run, level) - (is_first && !block.is_intra && run == 0 && level == 1 ? 1 : 0);
}

// A way to code everything up to a position that ends with a level there.
struct Path {
  int64_t cost;  // minus the energy of positions up to and with this one
  int previous;  // index of the path before, -1: none
  int16_t position, level;
  int bits;
  int64_t distortion;  // less that energy, too
};

}  // namespace

int64_t energy(const BlockToQuantize& block) {
  int64_t sum = 0;
  for (int i = 0; i < 64; ++i) sum += squared(block.dct[i]);
  return block.first_position == 0 ? sum : sum - squared(block.dct[0]);
}

BlockCost quantize_trellis(const BlockToQuantize& block, int16_t* levels, uint64_t& nonzero) {
  const int64_t total_energy = energy(block);
  Path paths[65];
  int live[65], n_live = 0, n_paths = 0;
  // Paths that a later one beats are dropped: a longer run never has a shorter code worth speaking of.
  const int start = block.first_position - 1;
  paths[n_paths++] = {0, -1, static_cast<int16_t>(start), 0, 0, 0};
  live[n_live++] = 0;
  for (uint64_t mask = nonzero; mask != 0; mask &= mask - 1) {
    const int position = std::countr_zero(mask);
    const int c = coefficient(block, position), rounded = magnitude_of(levels[position]);
    Path best{INT64_MAX, -1, static_cast<int16_t>(position), 0, 0, 0};
    for (int level = rounded; level >= 1 && level >= rounded - 1; --level) {
      const int reconstruction = reconstruct(block, level, position);
      if (reconstruction == 0) continue;  // decoders disagree about it
      const int64_t gained = squared(c - 8 * int64_t{reconstruction}) - squared(c);
      for (int i = 0; i < n_live; ++i) {
        const Path& from = paths[live[i]];
        const int bits = token_bits(block, position - from.position - 1, level, from.previous < 0 && live[i] == 0);
        const int64_t cost = from.cost + gained + block.lambda * bits;
        if (cost >= best.cost) continue;
        best = {cost,
                live[i],
                static_cast<int16_t>(position),
                static_cast<int16_t>(level),
                from.bits + bits,
                from.distortion + gained};
      }
    }
    if (best.previous < 0) continue;
    while (n_live > 0 && paths[live[n_live - 1]].cost >= best.cost) --n_live;
    if (n_live > 0 && best.cost > paths[live[n_live - 1]].cost + 24 * block.lambda) continue;
    paths[n_paths] = best;
    live[n_live++] = n_paths++;
  }
  // Where to end: every path, or nothing at all.
  const int end_bits = kEndOfBlock.length;
  int chosen = 0;
  int64_t least = block.is_intra ? block.lambda * end_bits : 0;
  for (int i = 0; i < n_live; ++i) {
    if (live[i] == 0) continue;
    const int64_t cost = paths[live[i]].cost + block.lambda * end_bits;
    if (cost < least) least = cost, chosen = live[i];
  }
  BlockCost result;
  result.energy = total_energy;
  result.distortion = total_energy + paths[chosen].distortion;
  result.bits = paths[chosen].bits + (chosen != 0 || block.is_intra ? end_bits : 0);
  uint64_t kept = 0;
  int16_t old[64];
  std::memcpy(old, levels, sizeof old);
  std::memset(levels + block.first_position, 0,
              sizeof old - sizeof(int16_t) * static_cast<size_t>(block.first_position));
  for (int i = chosen; i != 0; i = paths[i].previous) {
    const Path& path = paths[i];
    levels[path.position] = static_cast<int16_t>(old[path.position] < 0 ? -path.level : path.level);
    kept |= uint64_t{1} << path.position;
  }
  nonzero = kept;
  return result;
}

void drop_small_levels(const BlockToQuantize& block, int16_t* levels, uint64_t& nonzero) {
  int last = block.first_position - 1, end = last;  // the block had better end after `end`
  uint64_t kept = 0;
  int64_t saved = 0, most_saved = 0;
  for (uint64_t mask = nonzero; mask != 0; mask &= mask - 1) {
    const int position = std::countr_zero(mask), level = magnitude_of(levels[position]);
    const int64_t r = 8 * int64_t{reconstruct(block, level, position)};
    const int64_t c = coefficient(block, position);
    const int64_t paid = r * (2 * c - r) -  // c^2 - (c - r)^2
                         block.lambda * run_level_bits(position - last - 1, level);
    if (r == 0 || (level == 1 && paid <= 0)) continue;  // of r = 0 decoders make different things
    saved += paid;
    kept |= uint64_t{1} << position;
    last = position;
    if (saved > most_saved) most_saved = saved, end = position;
  }
  kept &= end < 0 ? 0 : ~uint64_t{0} >> (63 - end);
  for (uint64_t dropped = nonzero & ~kept; dropped != 0; dropped &= dropped - 1) levels[std::countr_zero(dropped)] = 0;
  nonzero = kept;
}

BlockCost cost_of(const BlockToQuantize& block, const int16_t* levels, uint64_t nonzero) {
  BlockCost cost;
  cost.distortion = cost.energy = energy(block);
  int last = block.first_position - 1;
  const bool is_empty = nonzero == 0;
  for (uint64_t mask = nonzero; mask != 0; mask &= mask - 1) {
    const int position = std::countr_zero(mask), level = magnitude_of(levels[position]);
    const int64_t c = coefficient(block, position);
    cost.distortion += squared(c - 8 * int64_t{reconstruct(block, level, position)}) - squared(c);
    cost.bits += token_bits(block, position - last - 1, level, last == block.first_position - 1);
    last = position;
  }
  if (!is_empty || block.is_intra) cost.bits += kEndOfBlock.length;
  return cost;
}

}  // namespace pac::mpeg1
