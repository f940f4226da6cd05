#include "jpeg/huffman.h"

#include <algorithm>
#include <cstring>
#include <vector>

namespace pac::jpeg {
namespace {

struct Node {
  uint64_t weight;
  bool package;  // of two nodes of the level below, else a leaf
};

// Code lengths of leaves with ascending weights: package-merge. levels[0] holds the pairs bought with the deepest bits.
void package_merge(std::span<const uint64_t> weights, std::span<int> lengths) {
  const size_t n = weights.size();
  std::vector<Node> levels[kMaxCodeLength];
  for (int level = 0; level < kMaxCodeLength; ++level) {
    std::vector<Node>& nodes = levels[level];
    const std::vector<Node> none;
    const std::vector<Node>& below = level > 0 ? levels[level - 1] : none;
    size_t leaf = 0, pair = 0;
    while (leaf < n || 2 * pair + 1 < below.size()) {
      const bool have_pair = 2 * pair + 1 < below.size();
      const uint64_t pair_weight = have_pair ? below[2 * pair].weight + below[2 * pair + 1].weight : 0;
      if (leaf < n && (!have_pair || weights[leaf] <= pair_weight))
        nodes.push_back({weights[leaf++], false});
      else
        nodes.push_back({pair_weight, true}), ++pair;
    }
  }
  // The 2n - 2 cheapest nodes of the top level are bought; each leaf among them, at any level, costs its symbol a bit.
  // Within a level the bought nodes are a prefix, so the bought leaves are the lightest ones.
  std::fill(lengths.begin(), lengths.end(), 0);
  size_t bought = 2 * n - 2;
  for (int level = kMaxCodeLength - 1; level >= 0 && bought > 0; --level) {
    size_t leaves = 0, packages = 0;
    for (size_t i = 0; i < bought; ++i) (levels[level][i].package ? packages : leaves) += 1;
    for (size_t i = 0; i < leaves; ++i) lengths[i] += 1;
    bought = 2 * packages;
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
  struct Leaf {
    uint64_t weight;
    int symbol;
  };
  std::vector<Leaf> leaves{{0, -1}};
  for (int symbol = 0; symbol < 256; ++symbol)
    if (frequency[static_cast<size_t>(symbol)] > 0) leaves.push_back({frequency[static_cast<size_t>(symbol)], symbol});
  HuffmanSpec spec;
  if (leaves.size() == 1) return spec;
  std::stable_sort(leaves.begin(), leaves.end(), [](const Leaf& a, const Leaf& b) { return a.weight < b.weight; });
  std::vector<uint64_t> weights(leaves.size());
  std::vector<int> lengths(leaves.size());
  for (size_t i = 0; i < leaves.size(); ++i) weights[i] = leaves[i].weight;
  package_merge(weights, lengths);

  // Lengths fall as weights rise: walking from the heaviest lists the symbols by code length.
  int k = 0;
  for (size_t i = leaves.size() - 1; i > 0; --i) {
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
