#include "mpeg1/trellis.h"

#include <array>
#include <bit>

#include "base/kernels/block_kernels.h"
#include "mpeg1/vlc_tables.h"

namespace pac::mpeg1 {
namespace {

int magnitude_of(int value) {
  const int sign = value >> 31;
  return (value ^ sign) - sign;
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

// Ways to code everything up to a position that ends with a level there, for going back along them.
struct Paths {
  int count = 1;         // the first one: nothing is coded
  uint8_t previous[65];  // index of the path before
  uint8_t position[65];
  int16_t level[65];

  int add(int before, int at, int coded) {
    const auto i = static_cast<size_t>(count);
    previous[i] = static_cast<uint8_t>(before);
    position[i] = static_cast<uint8_t>(at);
    level[i] = static_cast<int16_t>(coded);
    return count++;
  }
};

// A path that later levels may follow. Costs in the search are times kKeys; its distortion is cost - lambda * bits.
struct LivePath {
  int64_t cost;  // minus the energy of positions up to and with this one
  int position;
  int path, bits;
};

// One of the ways to end at a position: which live path it goes on from, and with which of two levels. Added to its
// cost it makes a key: the least key is that of the least cost, the first of several.
constexpr int64_t kKeys = 256, kSecond = 128;

// Coding a level at a position: bits after each run, and distortion less that of zero.
constexpr int64_t kNever = int64_t{1} << 60;
struct Choice {
  const uint8_t* bits;
  int64_t gained;
};
template <bool kIsIntra>
inline Choice make_choice(const uint8_t* bits, int level, int weight, int c) {
  const int r = 8 * (kIsIntra ? reconstruct_intra(level, weight) : reconstruct_non_intra(level, weight));
  return {bits, r != 0 ? kKeys * (r * (r - 2 * c)) : kNever};  // decoders disagree about 0
}

// The key of going on from a live path with that level. lambda: times kKeys.
inline int64_t key_of(const LivePath& path, int position, int64_t lambda, const Choice& choice, int64_t which) {
  return path.cost + lambda * choice.bits[position - path.position - 1] + (choice.gained + which);
}
inline int64_t lesser(int64_t a, int64_t b) {
  return b < a ? b : a;
}

// A path at given prices: its distortion is less the energy, cost and bits are times kBit.
struct Priced {
  int64_t cost, distortion;
  int bits;
};

// Leaves the levels of a path, and nothing else.
void keep_path(const Paths& paths, int chosen, int16_t* levels, uint64_t& nonzero) {
  uint64_t kept = 0;
  for (auto i = static_cast<size_t>(chosen); i != 0; i = paths.previous[i]) {
    const int position = paths.position[i], sign = levels[position] >> 15;  // without a branch: signs have no pattern
    levels[position] = static_cast<int16_t>((paths.level[i] ^ sign) - sign);
    kept |= uint64_t{1} << position;
  }
  for (uint64_t dropped = nonzero & ~kept; dropped != 0; dropped &= dropped - 1) levels[std::countr_zero(dropped)] = 0;
  nonzero = kept;
}

int size_price(const BlockPrices& prices, int position, int level) {
  constexpr int kSizes = BlockPrices::kSizes;
  if (level <= kSizes) return prices.size[position][level - 1];
  return prices.size[position][kSizes - 1] + (level - kSizes) * prices.step[position];
}

// Bits of level 1 as dct_coeff_first: one less after run 0 [table B.5c].
constexpr std::array<uint8_t, 64> kFirstOne = [] {
  std::array<uint8_t, 64> bits{};
  bits[0] = 2;
  return bits;
}();

template <bool kIsIntra>
BlockCost quantize(const BlockToQuantize& block, int16_t* levels, uint64_t& nonzero) {
  const int64_t lambda = kKeys * block.lambda;
  Paths paths;
  // Costs grow from path to path: one that a later one beats is dropped, as a longer run never has a shorter code
  // worth speaking of. One that costs more than shorter runs can save is not even begun. Mostly one is left: the last
  // one stands apart from those before it.
  LivePath before[65], last{0, block.first_position - 1, 0, 0};
  int n_before = 0;
  const uint8_t* const ones = bits_of_level(1).data();
  const bool first_is_first = !kIsIntra && (nonzero >> block.first_position & 1) != 0;
  const uint8_t* next_ones = first_is_first ? kFirstOne.data() : ones;
  for (uint64_t mask = nonzero; mask != 0; mask &= mask - 1) {
    const int position = std::countr_zero(mask), level = magnitude_of(levels[position]);
    const int c = coefficient(block, position), weight = block.weight[position];
    const uint8_t* const these_ones = next_ones;
    next_ones = ones;
    const auto bits_of = [&](int of) { return of == 1 ? these_ones : bits_of_level(of).data(); };
    const auto least_key = [&](const Choice& choice, int64_t which, int64_t least) {
      for (int i = 0; i < n_before; ++i) least = lesser(least, key_of(before[i], position, lambda, choice, which + i));
      return lesser(least, key_of(last, position, lambda, choice, which + n_before));
    };
    const Choice first = make_choice<kIsIntra>(bits_of(level), level, weight, c);
    Choice chosen = first;
    int64_t key = least_key(first, 0, kNever / 2);
    if (level > 1) {
      const Choice second = make_choice<kIsIntra>(bits_of(level - 1), level - 1, weight, c);
      // Nothing is gained where less is saved than its code can be shorter by.
      const int shorter = kWriting.longer_level[row_of_level(level)] + (these_ones != ones && level == 2 ? 1 : 0);
      if (second.gained < first.gained + lambda * shorter) key = least_key(second, kSecond, key);
      if ((key & kSecond) != 0) chosen = second;
    }
    if (key >= kNever / 2) continue;
    const int i = static_cast<int>(key & (kSecond - 1)), is_second = (key & kSecond) != 0 ? 1 : 0;
    const LivePath& from = i == n_before ? last : before[i];
    const int64_t cost = key & -kKeys;
    const int from_path = from.path, bits = from.bits + chosen.bits[position - from.position - 1];
    bool any = true;  // of the live paths is left
    while (any && last.cost >= cost) {
      any = n_before > 0;
      if (any) last = before[--n_before];
    }
    if (any) {
      if (cost >= last.cost + lambda * kWriting.longer_run[static_cast<size_t>(position - last.position)]) continue;
      before[n_before++] = last;
    }
    last = {cost, position, paths.add(from_path, position, level - is_second), bits};
  }
  // Where to end: the first path that codes something is the cheapest one; or nothing at all.
  before[n_before++] = last;
  const int first = before[0].path == 0 ? 1 : 0;
  const int end_bits = kEndOfBlock.length;
  BlockCost result;
  result.distortion = result.energy = energy(block);
  result.bits = kIsIntra ? end_bits : 0;
  int chosen = 0;
  if (first < n_before) {
    const LivePath& cheapest = before[first];
    const int64_t cost = cheapest.cost / kKeys;
    if (cost + block.lambda * end_bits < block.lambda * result.bits) {
      chosen = cheapest.path;
      result.distortion += cost - block.lambda * cheapest.bits;
      result.bits = cheapest.bits + end_bits;
    }
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
  Paths paths;
  Priced costs[65], ended{block.lambda * (int64_t{prices.left_out} - prices.coded), 0, 0};
  int from = 0, chosen = 0, zeros = 0, summed = block.first_position;
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
      chosen = paths.count;
    }
    const int on = prices.more[position] - zeros - prices.zero[position];
    const int path = paths.add(from, position, best_level);
    costs[path] = {best.cost + block.lambda * on, best.distortion, best.bits + on};
    if (costs[path].cost < costs[from].cost) from = path;
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
