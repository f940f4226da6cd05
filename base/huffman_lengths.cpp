#include "base/huffman_lengths.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "base/result.h"

namespace pac {
namespace {

// Level k's list: all leaves merged by weight with the packages (adjacent pairs) of level k-1's list. Only "is item i
// a package?" has to be remembered: leaves stay in weight order in each list.
using IsPackage = std::vector<uint8_t>;

// One list from the previous one; `weights` holds the previous list's weights and receives the new ones.
IsPackage merge_level(std::span<const uint64_t> leaves, std::vector<uint64_t>& weights) {
  const size_t n_packages = weights.size() / 2;
  std::vector<uint64_t> merged;
  IsPackage is_package;
  merged.reserve(leaves.size() + n_packages);
  is_package.reserve(leaves.size() + n_packages);
  for (size_t leaf = 0, package = 0; leaf < leaves.size() || package < n_packages;) {
    const uint64_t package_weight = package < n_packages ? weights[2 * package] + weights[2 * package + 1] : UINT64_MAX;
    const bool take_package = leaf == leaves.size() || package_weight < leaves[leaf];
    merged.push_back(take_package ? package_weight : leaves[leaf]);
    is_package.push_back(take_package);
    ++(take_package ? package : leaf);
  }
  weights = std::move(merged);
  return is_package;
}

}  // namespace

void optimal_code_lengths(std::span<const uint32_t> frequencies, int max_length, std::span<uint8_t> lengths) {
  PAC_ASSERT(frequencies.size() == lengths.size() && max_length >= 1 && max_length <= 32);
  std::fill(lengths.begin(), lengths.end(), uint8_t{0});
  std::vector<size_t> symbols;
  for (size_t s = 0; s < frequencies.size(); ++s)
    if (frequencies[s] != 0) symbols.push_back(s);
  PAC_ASSERT(symbols.size() <= uint64_t{1} << max_length);
  if (symbols.size() <= 1) {
    for (size_t s : symbols) lengths[s] = 1;
    return;
  }
  std::stable_sort(symbols.begin(), symbols.end(), [&](size_t a, size_t b) { return frequencies[a] < frequencies[b]; });
  std::vector<uint64_t> leaves(symbols.size());
  for (size_t i = 0; i < symbols.size(); ++i) leaves[i] = frequencies[symbols[i]];

  std::vector<IsPackage> levels;
  std::vector<uint64_t> weights;
  for (int k = 0; k < max_length; ++k) levels.push_back(merge_level(leaves, weights));

  // The cheapest 2n-2 items of the last list; each package stands for two items of the list before. A leaf's code
  // length is the number of lists in which it was taken.
  size_t n_taken = 2 * symbols.size() - 2;
  for (auto level = levels.rbegin(); level != levels.rend() && n_taken > 0; ++level) {
    const auto end = level->begin() + static_cast<ptrdiff_t>(n_taken);
    const auto n_packages = static_cast<size_t>(std::count(level->begin(), end, uint8_t{1}));
    for (size_t i = 0; i < n_taken - n_packages; ++i) ++lengths[symbols[i]];
    n_taken = 2 * n_packages;
  }
}

}  // namespace pac
