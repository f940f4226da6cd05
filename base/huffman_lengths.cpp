#include "base/huffman_lengths.h"

#include <algorithm>
#include <cstddef>

#include "base/result.h"

namespace pac {
namespace {

// Level k's list: all leaves merged by weight with the packages (adjacent pairs) of level k-1's list. Only "is item i
// a package?" has to be remembered, a bit for each level: leaves stay in weight order in each list.
struct Lists {
  static constexpr size_t kMaxItems = 2 * kMaxHuffmanSymbols;
  uint64_t weights[2][kMaxItems];  // of the newest list and the one before, in turn
  uint32_t package_in[kMaxItems] = {};
  size_t n_items = 0;  // of the newest

  void add_level(int k, std::span<const uint64_t> leaves) {
    const uint64_t* const before = weights[(k + 1) & 1];
    uint64_t* const merged = weights[k & 1];
    const size_t n_packages = n_items / 2;
    n_items = 0;
    for (size_t leaf = 0, package = 0; leaf < leaves.size() || package < n_packages; ++n_items) {
      const uint64_t package_weight = package < n_packages ? before[2 * package] + before[2 * package + 1] : UINT64_MAX;
      const bool take_package = leaf == leaves.size() || package_weight < leaves[leaf];
      merged[n_items] = take_package ? package_weight : leaves[leaf];
      package_in[n_items] |= static_cast<uint32_t>(take_package) << k;
      ++(take_package ? package : leaf);
    }
  }
  size_t count_packages(int k, size_t n_taken) const {
    size_t n = 0;
    for (size_t i = 0; i < n_taken; ++i) n += package_in[i] >> k & 1;
    return n;
  }
};

}  // namespace

void optimal_code_lengths(std::span<const uint32_t> frequencies, int max_length, std::span<uint8_t> lengths) {
  PAC_ASSERT(frequencies.size() == lengths.size() && max_length >= 1 && max_length <= 32);
  PAC_ASSERT(frequencies.size() <= kMaxHuffmanSymbols);
  std::fill(lengths.begin(), lengths.end(), uint8_t{0});
  size_t symbols[kMaxHuffmanSymbols], n = 0;
  for (size_t s = 0; s < frequencies.size(); ++s)
    if (frequencies[s] != 0) symbols[n++] = s;
  PAC_ASSERT(n <= uint64_t{1} << max_length);
  if (n <= 1) {
    for (size_t i = 0; i < n; ++i) lengths[symbols[i]] = 1;
    return;
  }
  std::sort(symbols, symbols + n, [&](size_t a, size_t b) {
    return frequencies[a] != frequencies[b] ? frequencies[a] < frequencies[b] : a < b;
  });
  uint64_t leaves[kMaxHuffmanSymbols];
  for (size_t i = 0; i < n; ++i) leaves[i] = frequencies[symbols[i]];
  Lists lists;
  for (int k = 0; k < max_length; ++k) lists.add_level(k, {leaves, n});

  // The cheapest 2n-2 items of the last list; each package stands for two items of the list before. A leaf's code
  // length is the number of lists in which it was taken.
  size_t n_taken = 2 * n - 2;
  for (int k = max_length - 1; k >= 0 && n_taken > 0; --k) {
    const size_t n_packages = lists.count_packages(k, n_taken);
    for (size_t i = 0; i < n_taken - n_packages; ++i) ++lengths[symbols[i]];
    n_taken = 2 * n_packages;
  }
}

}  // namespace pac
