#include "geomcodec/plain_estimate.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>
#include <vector>

#include "geomcodec/size_estimator.h"

namespace pac::geomcodec {
namespace {

using Vector = std::array<int32_t, 3>;

int32_t sum_of_magnitudes(const Vector& residual) {
  return std::abs(residual[0]) + std::abs(residual[1]) + std::abs(residual[2]);
}

// Of a vertex that has parallelograms, from the first four: the smallest residual there is, and the one where a single
// parallelogram has to be better than the mean of all by half.
struct Residuals {
  Vector smallest, steady;
  bool is_single = false;  // `steady`: one parallelogram's, not the mean's
};
constexpr int kMostTried = 4;

Residuals residuals_of(const Stencil& stencil, std::span<const Position> positions, const Position& here) {
  const int n = std::min(stencil.n_parallelograms, kMostTried);
  Vector sum = {0, 0, 0}, best = {0, 0, 0}, mean;
  int32_t least = INT32_MAX;
  for (int i = 0; i < n; ++i) {
    const Stencil::Parallelogram& p = stencil.parallelogram[i];
    Vector residual;
    for (size_t axis = 0; axis < 3; ++axis) {
      const int32_t prediction = positions[p.side_1][axis] + positions[p.side_2][axis] - positions[p.opposite][axis];
      residual[axis] = here[axis] - prediction;
      sum[axis] += prediction;
    }
    if (sum_of_magnitudes(residual) >= least) continue;
    least = sum_of_magnitudes(residual);
    best = residual;
  }
  if (n == 1) return {best, best};
  for (size_t axis = 0; axis < 3; ++axis) mean[axis] = here[axis] - sum[axis] / n;
  const int32_t of_mean = sum_of_magnitudes(mean);
  if (2 * of_mean <= 3 * least + 2) return {of_mean < least ? mean : best, mean};
  return {best, best, true};
}

// Entropy of counts times their sum, in bits.
uint64_t entropy(std::span<const uint32_t> counts, uint64_t total) {
  uint64_t parts = 0;
  for (const uint32_t count : counts)
    if (count > 0) parts += count * logarithm_of(count);
  const uint64_t whole = total == 0 ? 0 : total * logarithm_of(static_cast<uint32_t>(total));
  return (whole - std::min(whole, parts)) >> 16;
}

}  // namespace

uint64_t estimate_plainly(const Stencils& stencils, std::span<const Position> positions) {
  constexpr size_t kValues = 2048;     // residuals with a count of their own, by zigzag; then by bit length
  constexpr uint64_t kBitsAValue = 8;  // to tell how frequent one is
  std::vector<uint32_t> values(kValues + 20), steady_values(kValues + 20);
  std::array<uint32_t, 20> lengths = {};
  std::array<std::array<uint32_t, 2>, kMostTried + 1> choices = {};  // by how many there are
  uint64_t flags = 0, beyond = 0, steady_beyond = 0, of_lengths = 0;
  Stencil stencil;
  const auto zigzag = [](int32_t component) {
    return component < 0 ? 2 * static_cast<uint32_t>(-component) - 1 : 2 * static_cast<uint32_t>(component);
  };
  for (uint32_t v = 0; v < positions.size(); ++v) {
    stencils.get(v, false, stencil);
    Residuals residual;
    if (stencil.n_parallelograms > 0 && !stencil.extended) {
      residual = residuals_of(stencil, positions, positions[v]);
      const auto n = static_cast<size_t>(std::min(stencil.n_parallelograms, kMostTried));
      if (n > 1) {
        flags += n;
        ++choices[n][residual.is_single ? 1 : 0];
      }
    } else {
      const uint32_t from = stencil.n_neighbors > 0 ? stencil.neighbor[0] : v > 0 ? v - 1 : 0;
      for (size_t axis = 0; axis < 3; ++axis)
        residual.smallest[axis] = positions[v][axis] - (v > 0 ? positions[from][axis] : 0);
      residual.steady = residual.smallest;
    }
    uint32_t longest = 0;
    const auto count = [](uint32_t value, std::vector<uint32_t>& counts, uint64_t& bits_beyond) {
      const auto length = static_cast<uint32_t>(std::bit_width(value));
      ++counts[value < kValues ? value : kValues + length];
      bits_beyond += value < kValues ? 0 : length - 1;
      return length;
    };
    for (size_t axis = 0; axis < 3; ++axis) {
      longest = std::max(longest, count(zigzag(residual.smallest[axis]), values, beyond));
      count(zigzag(residual.steady[axis]), steady_values, steady_beyond);
    }
    ++lengths[longest];
    of_lengths += 3 * longest;
  }
  const auto bits_of = [&](const std::vector<uint32_t>& counts) {
    const auto n_kinds =
        static_cast<uint64_t>(std::count_if(counts.begin(), counts.end(), [](uint32_t n) { return n > 0; }));
    return entropy(counts, 3 * positions.size()) + kBitsAValue * n_kinds;
  };
  uint64_t steady_bits = bits_of(steady_values) + steady_beyond;
  for (size_t n = 2; n <= kMostTried; ++n)  // and which parallelogram it is
    steady_bits += entropy(choices[n], uint64_t{choices[n][0]} + choices[n][1]) +
                   (choices[n][1] * logarithm_of(static_cast<uint32_t>(n)) >> 16);
  const uint64_t bits = std::min(bits_of(values) + beyond, entropy(lengths, positions.size()) + of_lengths);
  return std::min(bits + flags * 4 / 5, steady_bits) / 8;
}

}  // namespace pac::geomcodec
