// How many bits positions would take: a coder that only counts, for an encoder that chooses between predictions.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdlib>

#include "geomcodec/range_coder.h"
#include "geomcodec/symbol_model.h"

namespace pac::geomcodec {

// [i]: log2(1 + i / 256) in 1/65536, by squaring.
inline constexpr auto kLogarithms = [] {
  std::array<uint32_t, 257> logarithm{};
  for (uint64_t i = 0; i < 256; ++i) {
    uint64_t x = (256 + i) << 23;  // 1 .. 2 in 1/2^31
    for (int bit = 0; bit < 16; ++bit) {
      x = x * x >> 31;
      const uint64_t two_or_more = x >> 32;
      x >>= two_or_more;
      logarithm[i] = logarithm[i] << 1 | static_cast<uint32_t>(two_or_more);
    }
  }
  logarithm[256] = 65536;
  return logarithm;
}();

// log2(x) in 1/65536, x > 0: in integers, so that all machines write the same streams.
inline uint64_t logarithm_of(uint32_t x) {
  const auto whole = static_cast<uint32_t>(std::bit_width(x)) - 1;
  const uint64_t fraction = (uint64_t{x} << (31 - whole)) & 0x7FFFFFFFu;
  const uint64_t below = kLogarithms[fraction >> 23], above = kLogarithms[(fraction >> 23) + 1];
  return (uint64_t{whole} << 16) + below + ((above - below) * (fraction & 0x7FFFFF) >> 23);
}

// Counts residuals' magnitude classes by role and scale, their signs and leading bits by role and class; what these
// take is the counts' entropy and something for learning them. On the meshes of bench/peers/geom_peers the sums are
// within 12 % of the bytes that a RangeEncoder writes, and differences of more than 1/256 between predictions of one
// mesh have their sign, but for exact hits and repetition.
class SizeEstimator {
 public:
  static constexpr bool kDecodes = false, kTables = false, kEstimates = true;

  uint32_t raw(int count, uint32_t value) {
    raw_bits_ += static_cast<uint64_t>(count);
    return value;
  }
  uint32_t symbol(const Starts& starts, uint32_t symbol) {
    const uint32_t end = symbol + 1 < Starts::kSymbols ? starts.at[symbol + 1] : 65536u;
    symbols_ += (uint64_t{16} << 16) - logarithm_of(end - starts.at[symbol]);
    return symbol;
  }
  // Of role 0..2, where the neighbors' classes have a mean of scale / 2; as code_residual() would split it.
  void residual(size_t role, uint32_t scale, int32_t residual) {
    const uint32_t length = class_of(residual);
    ++classes_[role][scale / 2][length];
    if (length == 0) return;
    const int below = static_cast<int>(length) - 1, modeled = std::min(below, 3), left = below - modeled;
    const auto magnitude = static_cast<uint32_t>(std::abs(residual));
    ++details_[role][length][(residual < 0 ? 1u << modeled : 0) | (magnitude >> left & ((1u << modeled) - 1))];
    raw_bits_ += static_cast<uint64_t>(left);
  }
  // All so far.
  uint64_t bits() const {
    uint64_t sum = symbols_;
    for (size_t role = 0; role < 3; ++role) {
      for (const auto& counts : classes_[role]) sum += entropy(counts, true);
      for (const auto& counts : details_[role]) sum += entropy(counts, false);
    }
    return raw_bits_ + (sum >> 16);
  }

 private:
  // The counts' entropy times their sum in 1/65536 bit; if learned, for each kind met but one 3/10 of log2(sum + 1) on
  // top, which did best of what was tried.
  template <size_t kCount>
  static uint64_t entropy(const std::array<uint32_t, kCount>& counts, bool learned) {
    uint32_t total = 0;
    uint64_t parts = 0, n_kinds = 0;
    for (const uint32_t count : counts) {
      if (count == 0) continue;
      total += count;
      ++n_kinds;
      parts += count * logarithm_of(count);
    }
    if (n_kinds <= 1) return 0;
    const uint64_t whole = total * logarithm_of(total);
    return whole - std::min(whole, parts) + (learned ? 3 * (n_kinds - 1) * logarithm_of(total + 1) / 10 : 0);
  }

  std::array<std::array<uint32_t, kClasses>, kClasses> classes_[3] = {};
  std::array<std::array<uint32_t, 16>, kClasses> details_[3] = {};
  uint64_t symbols_ = 0;  // in 1/65536 bit
  uint64_t raw_bits_ = 0;
};
inline void release(SizeEstimator& /*coder*/, const SizeEstimator& /*held*/) {}

}  // namespace pac::geomcodec
