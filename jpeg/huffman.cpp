#include "jpeg/huffman.h"

#include <algorithm>
#include <cstring>

namespace pac::jpeg {
namespace {

constexpr size_t kMaxLeaves = 257;  // 256 symbols and the one that reserves the code of all ones
struct Leaf {
  uint64_t weight;
  int symbol;
};

// Code lengths of leaves with ascending weights: package-merge. Level 0 holds what can be bought with the deepest bits.
// Each level merges, by weight, the leaves with the pairs of the level below (a leaf first where they weigh the same).
void package_merge(std::span<const Leaf> leaves, int* lengths) {
  const size_t n = leaves.size();
  bool is_pair[kMaxCodeLength][2 * kMaxLeaves];
  uint64_t weights[2][2 * kMaxLeaves];
  size_t n_below = 0;
  for (int level = 0; level < kMaxCodeLength; ++level) {
    const uint64_t* below = weights[(level + 1) & 1];
    uint64_t* here = weights[level & 1];
    size_t leaf = 0, pair = 0, n_here = 0;
    while (leaf < n || 2 * pair + 1 < n_below) {
      const bool have_pair = 2 * pair + 1 < n_below;
      const uint64_t pair_weight = have_pair ? below[2 * pair] + below[2 * pair + 1] : 0;
      const bool take_leaf = leaf < n && (!have_pair || leaves[leaf].weight <= pair_weight);
      is_pair[level][n_here] = !take_leaf;
      here[n_here++] = take_leaf ? leaves[leaf].weight : pair_weight;
      (take_leaf ? leaf : pair) += 1;
    }
    n_below = n_here;  // at most n + (2n - 1) / 2 < 2n
  }
  // The 2n - 2 cheapest nodes of the top level are bought; each leaf among them, at any level, costs its symbol a bit.
  // Within a level the bought nodes are a prefix, so the bought leaves are the lightest ones.
  std::fill(lengths, lengths + n, 0);
  size_t bought = 2 * n - 2;
  for (int level = kMaxCodeLength - 1; level >= 0 && bought > 0; --level) {
    size_t n_pairs = 0;
    for (size_t i = 0; i < bought; ++i) n_pairs += is_pair[level][i] ? 1 : 0;
    for (size_t i = 0; i < bought - n_pairs; ++i) lengths[i] += 1;
    bought = 2 * n_pairs;
  }
}

HuffmanDecoder::Entry lookup_entry(uint32_t index, int code_length, uint8_t symbol) {
  const int size = symbol & 15, spare = HuffmanDecoder::kLookupBits - code_length;
  HuffmanDecoder::Entry entry{0, symbol, static_cast<uint8_t>(code_length)};
  if (size > 0 && size <= spare) {
    const uint32_t bits = index >> (spare - size) & ((1u << size) - 1);
    entry.value = static_cast<int16_t>(extend(bits, size));
    entry.length = static_cast<uint8_t>(code_length + size);
  }
  return entry;
}

}  // namespace

bool is_valid(const HuffmanSpec& spec) {
  int total = 0;
  uint32_t free_codes = 1;  // of the current length
  for (int length = 1; length <= kMaxCodeLength; ++length) {
    free_codes *= 2;
    if (spec.count[length] > free_codes) return false;
    free_codes -= spec.count[length];
    total += spec.count[length];
  }
  return total <= 256;
}

void make_codes(const HuffmanSpec& spec, HuffmanCodes& codes) {
  codes = {};
  uint32_t code = 0;
  int k = 0;
  for (int length = 1; length <= kMaxCodeLength; ++length, code <<= 1)
    for (int i = 0; i < spec.count[length]; ++i, ++code, ++k)
      codes.code_and_length[spec.symbols[k]] = code << 8 | static_cast<uint32_t>(length);
}

HuffmanSpec optimal_huffman(std::span<const uint32_t, 256> frequency) {
  // Leaf 0 is nobody's symbol: it weighs nothing, so no code is longer than its, and given the last code of its length
  // (all ones) it keeps that one free.
  Leaf leaves[kMaxLeaves] = {{0, -1}};
  size_t n = 1;
  for (size_t symbol = 0; symbol < 256; ++symbol)
    if (frequency[symbol] > 0) leaves[n++] = {frequency[symbol], static_cast<int>(symbol)};
  HuffmanSpec spec;
  if (n == 1) return spec;
  std::sort(leaves, leaves + n, [](const Leaf& a, const Leaf& b) {
    return a.weight != b.weight ? a.weight < b.weight : a.symbol < b.symbol;
  });
  int lengths[kMaxLeaves];
  package_merge({leaves, n}, lengths);

  // Lengths fall as weights rise: walking from the heaviest lists the symbols by code length.
  int k = 0;
  for (size_t i = n - 1; i > 0; --i) {
    spec.count[lengths[i]] = static_cast<uint8_t>(spec.count[lengths[i]] + 1);
    spec.symbols[k++] = static_cast<uint8_t>(leaves[i].symbol);
  }
  return spec;
}

void make_decoder(const HuffmanSpec& spec, HuffmanDecoder& decoder) {
  constexpr int kBits = HuffmanDecoder::kLookupBits;
  std::memset(&decoder, 0, sizeof decoder);
  std::memcpy(decoder.symbols, spec.symbols, sizeof decoder.symbols);
  int32_t code = 0, k = 0;
  for (int length = 1; length <= kMaxCodeLength; ++length, code <<= 1) {
    decoder.offset[length] = k - code;
    for (int i = 0; i < spec.count[length]; ++i, ++code, ++k) {
      if (length > kBits) continue;
      const uint32_t first = static_cast<uint32_t>(code) << (kBits - length), n = 1u << (kBits - length);
      for (uint32_t j = 0; j < n; ++j) decoder.lookup[first + j] = lookup_entry(j, length, spec.symbols[k]);
    }
    decoder.max_code[length] = spec.count[length] > 0 ? code - 1 : -1;
  }
  decoder.max_code[kMaxCodeLength + 1] = INT32_MAX;
}

}  // namespace pac::jpeg
