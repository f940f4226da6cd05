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

// Coding a level at a position: bits after each run, and distortion less that of zero.
constexpr int64_t kNever = int64_t{1} << 60;
struct Choice {
  const uint8_t* bits;
  int64_t gained;
};
template <bool kIsIntra>
inline Choice make_choice(int level, int weight, int c) {
  const int r = 8 * (kIsIntra ? reconstruct_intra(level, weight) : reconstruct_non_intra(level, weight));
  return {bits_of_level(level).data(), r != 0 ? r * (r - 2 * c) : kNever};  // decoders disagree about 0
}

// The cheapest of the paths that end at a position, with one of one or two levels there.
struct Step {
  int64_t cost = kNever;
  int from = 0, bits = 0;
  bool is_second = false;
};
inline void take_cheaper(const LivePath* live, int n_live, int position, int64_t lambda, const Choice& choice,
                         bool is_second, Step& best) {
  for (int i = 0; i < n_live; ++i) {
    const int bits = choice.bits[position - live[i].position - 1];
    const int64_t cost = live[i].cost + choice.gained + lambda * bits;
    if (cost < best.cost) best = {cost, i, bits, is_second};
  }
}

// A path at given prices: its distortion is less the energy, cost and bits are times kBit.
struct Priced {
  int64_t cost, distortion;
  int bits;
};

// Leaves the levels of a path, and nothing else.
void keep_path(const Path* paths, int chosen, int16_t* levels, uint64_t& nonzero) {
  uint64_t kept = 0;
  for (int i = chosen; i != 0; i = paths[i].previous) {
    const Path& path = paths[i];
    levels[path.position] = levels[path.position] < 0 ? static_cast<int16_t>(-path.level) : path.level;
    kept |= uint64_t{1} << path.position;
  }
  for (uint64_t dropped = nonzero & ~kept; dropped != 0; dropped &= dropped - 1) levels[std::countr_zero(dropped)] = 0;
  nonzero = kept;
}

int size_price(const BlockPrices& prices, int position, int level) {
  constexpr int kSizes = BlockPrices::kSizes;
  if (level <= kSizes) return prices.size[position][level - 1];
  return prices.size[position][kSizes - 1] + (level - kSizes) * prices.step[position];
}

// The cheapest way to end at a position: with the level there, or the next smaller one unless that takes away more than
// its code can be shorter. A cost of kNever or about: there is none.
template <bool kIsIntra>
inline Step best_step(const BlockToQuantize& block, const LivePath* live, int n_live, int position, int level) {
  const int c = coefficient(block, position), weight = block.weight[position];
  const int64_t lambda = block.lambda;
  const bool saves = !kIsIntra && position == block.first_position;  // where the level is 1
  Choice first = make_choice<kIsIntra>(level, weight, c);
  if (saves && level == 1) first.gained -= lambda;
  Step best;
  take_cheaper(live, n_live, position, lambda, first, false, best);
  if (level > 1) {
    Choice second = make_choice<kIsIntra>(level - 1, weight, c);
    if (saves && level == 2) second.gained -= lambda;
    if (second.gained < first.gained + lambda * kWriting.longer_level[row_of_level(level)])
      take_cheaper(live, n_live, position, lambda, second, true, best);
  }
  if (saves && level - (best.is_second ? 1 : 0) == 1) --best.bits;
  return best;
}

template <bool kIsIntra>
BlockCost quantize(const BlockToQuantize& block, int16_t* levels, uint64_t& nonzero) {
  const int64_t lambda = block.lambda;
  Path paths[65];
  // Costs grow from path to path: one that a later one beats is dropped, as a longer run never has a shorter code
  // worth speaking of. One that costs more than shorter runs can save is not even begun.
  LivePath live[65];
  int n_paths = 0, n_live = 0;
  paths[n_paths++] = {0, -1, 0, 0};
  live[n_live++] = {0, block.first_position - 1, 0};
  for (uint64_t mask = nonzero; mask != 0; mask &= mask - 1) {
    const int position = std::countr_zero(mask), level = magnitude_of(levels[position]);
    const Step best = best_step<kIsIntra>(block, live, n_live, position, level);
    if (best.cost >= kNever / 2) continue;
    const int previous = live[best.from].path;
    while (n_live > 0 && live[n_live - 1].cost >= best.cost) --n_live;
    if (n_live > 0) {
      const LivePath& cheaper = live[n_live - 1];
      if (best.cost >= cheaper.cost + lambda * kWriting.longer_run[static_cast<size_t>(position - cheaper.position)])
        continue;
    }
    live[n_live++] = {best.cost, position, n_paths};
    paths[n_paths++] = {static_cast<int16_t>(previous), static_cast<int16_t>(position),
                        static_cast<int16_t>(level - (best.is_second ? 1 : 0)),
                        static_cast<int16_t>(paths[previous].bits + best.bits)};
  }
  // Where to end: the first path that codes something is the cheapest one; or nothing at all.
  const int end_bits = kEndOfBlock.length;
  const int first = live[0].path == 0 ? 1 : 0;
  BlockCost result;
  result.distortion = result.energy = energy(block);
  result.bits = kIsIntra ? end_bits : 0;
  int chosen = 0;
  const int64_t cost = first < n_live ? live[first].cost : kNever;
  if (cost + block.lambda * end_bits < block.lambda * result.bits) {
    chosen = live[first].path;
    result.distortion += cost - block.lambda * paths[chosen].bits;
    result.bits = paths[chosen].bits + end_bits;
  }
  result.bits *= kBit;
  keep_path(paths, chosen, levels, nonzero);
  return result;
}

}  // namespace

// The transform keeps energies, but for a factor of 64: 64 * 64 errors of 255^2 and roundings stay below 2^29.
int64_t energy(const BlockToQuantize& block) {
  int32_t sum = 0;
  for (int i = 0; i < 64; ++i) sum += block.dct[i] * block.dct[i];
  return block.first_position == 0 ? sum : sum - squared(block.dct[0]);
}

BlockCost quantize_trellis(const BlockToQuantize& block, int16_t* levels, uint64_t& nonzero) {
  return block.is_intra ? quantize<true>(block, levels, nonzero) : quantize<false>(block, levels, nonzero);
}

// What the zeros between two levels cost is the difference of two sums over all positions before. So the second sum is
// taken from a path before it is known where it goes on, and the cheapest path so far is the only one to go on from.
BlockCost quantize_priced(const BlockToQuantize& block, int16_t* levels, uint64_t& nonzero) {
  const BlockPrices& prices = *block.prices;
  Path paths[65];
  Priced costs[65], ended{block.lambda * (int64_t{prices.left_out} - prices.coded), 0, 0};
  int n_paths = 1, from = 0, chosen = 0, zeros = 0, summed = block.first_position;
  paths[0] = {0, -1, 0, 0};
  costs[0] = {};
  for (uint64_t mask = nonzero; mask != 0; mask &= mask - 1) {
    const int position = std::countr_zero(mask);
    for (; summed < position; ++summed) zeros += prices.zero[summed];
    const int c = coefficient(block, position), rounded = magnitude_of(levels[position]);
    Priced best{INT64_MAX, 0, 0};
    int best_level = 0;
    for (int level = rounded; level >= 1 && level >= rounded - 1; --level) {
      const int r = 8 * reconstruct(block, level, position);
      if (r == 0) continue;  // decoders disagree about it
      const int64_t gained = r * (r - 2 * c);
      const int bits = zeros + prices.level[position] + size_price(prices, position, level);
      const int64_t cost = costs[from].cost + kBit * gained + block.lambda * bits;
      if (cost >= best.cost) continue;
      best = {cost, costs[from].distortion + gained, costs[from].bits + bits};
      best_level = level;
    }
    if (best_level == 0) continue;
    if (const int64_t cost = best.cost + block.lambda * prices.last[position]; cost < ended.cost) {
      ended = {cost, best.distortion, best.bits + prices.last[position]};
      chosen = n_paths;
    }
    const int on = prices.more[position] - zeros - prices.zero[position];
    paths[n_paths] = {static_cast<int16_t>(from), static_cast<int16_t>(position), static_cast<int16_t>(best_level), 0};
    costs[n_paths] = {best.cost + block.lambda * on, best.distortion, best.bits + on};
    if (costs[n_paths].cost < costs[from].cost) from = n_paths;
    ++n_paths;
  }
  BlockCost result;
  result.energy = energy(block);
  result.distortion = result.energy + ended.distortion;
  result.bits = ended.bits;
  keep_path(paths, chosen, levels, nonzero);
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
    cost.bits += (run_level_bits(position - last - 1, level) - saved_at_first(block, position, level)) * kBit;
    last = position;
  }
  if (!is_empty || block.is_intra) cost.bits += kEndOfBlock.length * kBit;
  return cost;
}

}  // namespace pac::mpeg1
