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

// The smallest residual of a vertex that has parallelograms.
Vector best_residual(const Stencil& stencil, std::span<const Position> positions, const Position& here) {
  constexpr int kMostTried = 4;
  const int n = std::min(stencil.n_parallelograms, kMostTried);
  Vector sum = {0, 0, 0}, best = {0, 0, 0};
  int32_t least = INT32_MAX;
  const auto offer = [&](const Vector& prediction, int divisor) {
    Vector residual;
    for (size_t axis = 0; axis < 3; ++axis) residual[axis] = here[axis] - prediction[axis] / divisor;
    if (sum_of_magnitudes(residual) >= least) return;
    least = sum_of_magnitudes(residual);
    best = residual;
  };
  for (int i = 0; i < n; ++i) {
    const Stencil::Parallelogram& p = stencil.parallelogram[i];
    Vector prediction;
    for (size_t axis = 0; axis < 3; ++axis) {
      prediction[axis] = positions[p.side_1][axis] + positions[p.side_2][axis] - positions[p.opposite][axis];
      sum[axis] += prediction[axis];
    }
    offer(prediction, 1);
  }
  if (n > 1) offer(sum, n);
  return best;
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
  std::vector<uint32_t> values(kValues + 20);
  std::array<uint32_t, 20> lengths = {};
  uint64_t flags = 0, beyond = 0, of_lengths = 0;
  Stencil stencil;
  for (uint32_t v = 0; v < positions.size(); ++v) {
    stencils.get(v, false, stencil);
    Vector residual;
    if (stencil.n_parallelograms > 0 && !stencil.extended) {
      residual = best_residual(stencil, positions, positions[v]);
      if (stencil.n_parallelograms > 1) flags += static_cast<uint64_t>(std::min(stencil.n_parallelograms, 4));
    } else {
      const uint32_t from = stencil.n_neighbors > 0 ? stencil.neighbor[0] : v > 0 ? v - 1 : 0;
      for (size_t axis = 0; axis < 3; ++axis) residual[axis] = positions[v][axis] - (v > 0 ? positions[from][axis] : 0);
    }
    uint32_t longest = 0;
    for (const int32_t component : residual) {
      const uint32_t zigzag =
          component < 0 ? 2 * static_cast<uint32_t>(-component) - 1 : 2 * static_cast<uint32_t>(component);
      const auto length = static_cast<uint32_t>(std::bit_width(zigzag));
      longest = std::max(longest, length);
      ++values[zigzag < kValues ? zigzag : kValues + length];
      beyond += zigzag < kValues ? 0 : length - 1;
    }
    ++lengths[longest];
    of_lengths += 3 * longest;
  }
  const auto n_values =
      static_cast<uint64_t>(std::count_if(values.begin(), values.end(), [](uint32_t n) { return n > 0; }));
  const uint64_t by_value = entropy(values, 3 * positions.size()) + beyond + kBitsAValue * n_values;
  const uint64_t by_length = entropy(lengths, positions.size()) + of_lengths;
  return (std::min(by_value, by_length) + flags * 4 / 5) / 8;
}

}  // namespace pac::geomcodec
