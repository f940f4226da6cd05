#include "mpeg1/trellis.h"

#include <bit>

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
int saved_at_first(const BlockToQuantize& block, int position, int level) {
  return !block.is_intra && position == block.first_position && level == 1 ? 1 : 0;
}

// A way to code everything up to a position that ends with a level there, for going back along it.
struct Path {
  int16_t previous;  // index of the path before; 0: nothing was coded before
  int16_t position, level;
  int16_t bits;  // of all its codes: at most 64 * 28
};

// A path that later levels may follow. Its distortion is cost - lambda * bits.
struct LivePath {
  int64_t cost;  // minus the energy of positions up to and with this one
  int position;
  int path;
};

// The cheapest of the paths that end at a position.
struct Step {
  int64_t cost = INT64_MAX;
  int from = 0, level = 0, bits = 0;
};

// Coding |level| at the position, after the cheapest of the live paths; `gained` is its distortion less that of zero.
inline void take_cheapest(const BlockToQuantize& block, const LivePath* live, int n_live, int position, int level,
                          int64_t gained, Step& best) {
  const uint8_t* bits_of_run = bits_of_level(level).data();
  const int saved = saved_at_first(block, position, level);
  for (int i = 0; i < n_live; ++i) {
    const int bits = bits_of_run[position - live[i].position - 1] - saved;
    const int64_t cost = live[i].cost + gained + block.lambda * bits;
    if (cost < best.cost) best = {cost, i, level, bits};
  }
}

}  // namespace

// |c| <= 16384: eight squares fit 32 bits.
int64_t energy(const BlockToQuantize& block) {
  uint32_t sums[8] = {};
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) {
      const int c = block.dct[8 * y + x];
      sums[x] += static_cast<uint32_t>(c * c);
    }
  int64_t sum = block.first_position == 0 ? 0 : -squared(block.dct[0]);
  for (const uint32_t part : sums) sum += part;
  return sum;
}

BlockCost quantize_trellis(const BlockToQuantize& block, int16_t* levels, uint64_t& nonzero) {
  Path paths[65];
  // Costs grow from path to path: one that a later one beats is dropped, as a longer run never has a shorter code
  // worth speaking of.
  LivePath live[65];
  int n_paths = 0, n_live = 0;
  paths[n_paths++] = {0, -1, 0, 0};
  live[n_live++] = {0, block.first_position - 1, 0};
  for (uint64_t mask = nonzero; mask != 0; mask &= mask - 1) {
    const int position = std::countr_zero(mask);
    const int c = coefficient(block, position), rounded = magnitude_of(levels[position]);
    Step best;
    for (int level = rounded; level >= 1 && level >= rounded - 1; --level) {
      const int r = 8 * reconstruct(block, level, position);
      if (r == 0) continue;                                                        // decoders disagree about it
      take_cheapest(block, live, n_live, position, level, r * (r - 2 * c), best);  // (c - r)^2 - c^2
    }
    if (best.level == 0) continue;
    const int previous = live[best.from].path;
    while (n_live > 0 && live[n_live - 1].cost >= best.cost) --n_live;
    if (n_live > 0 && best.cost > live[n_live - 1].cost + 24 * block.lambda) continue;
    live[n_live++] = {best.cost, position, n_paths};
    paths[n_paths++] = {static_cast<int16_t>(previous), static_cast<int16_t>(position),
                        static_cast<int16_t>(best.level), static_cast<int16_t>(paths[previous].bits + best.bits)};
  }
  // Where to end: the first path that codes something is the cheapest one; or nothing at all.
  const int end_bits = kEndOfBlock.length;
  const int first = live[0].path == 0 ? 1 : 0;
  BlockCost result;
  result.distortion = result.energy = energy(block);
  result.bits = block.is_intra ? end_bits : 0;
  int chosen = 0;
  if (first < n_live && live[first].cost + block.lambda * end_bits < block.lambda * result.bits) {
    chosen = live[first].path;
    result.distortion += live[first].cost - block.lambda * paths[chosen].bits;
    result.bits = paths[chosen].bits + end_bits;
  }
  uint64_t kept = 0;
  for (int i = chosen; i != 0; i = paths[i].previous) {
    const Path& path = paths[i];
    levels[path.position] = levels[path.position] < 0 ? static_cast<int16_t>(-path.level) : path.level;
    kept |= uint64_t{1} << path.position;
  }
  for (uint64_t dropped = nonzero & ~kept; dropped != 0; dropped &= dropped - 1) levels[std::countr_zero(dropped)] = 0;
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
    cost.bits += run_level_bits(position - last - 1, level) - saved_at_first(block, position, level);
    last = position;
  }
  if (!is_empty || block.is_intra) cost.bits += kEndOfBlock.length;
  return cost;
}

}  // namespace pac::mpeg1
