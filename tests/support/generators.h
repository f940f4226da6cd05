// Inputs for exactness tests: the shapes of data on which a vector kernel and its scalar definition part ways.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace pac::test {

// A small generator of the same numbers everywhere (splitmix64).
class Random {
 public:
  explicit Random(uint64_t seed) : state_(seed) {}
  uint64_t next() {
    uint64_t z = state_ += 0x9E3779B97F4A7C15u;
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
    z = (z ^ z >> 27) * 0x94D049BB133111EBu;
    return z ^ z >> 31;
  }
  // Uniform enough in [low, high].
  int64_t in(int64_t low, int64_t high) {
    return low + static_cast<int64_t>(next() % (static_cast<uint64_t>(high - low) + 1));
  }
  // In [0, 1).
  double unit() { return static_cast<double>(next() >> 11) * 0x1p-53; }

 private:
  uint64_t state_;
};

enum class Pattern : uint8_t {
  zeros,
  lowest,
  highest,
  alternating,  // highest, lowest, highest, ...
  stripes,      // rows of eight: highest, lowest
  sparse,       // zeros, one element in sixteen random
  dc_only,      // the first of each 64 random, else zero
  ramp,
  random,
  extremes,     // each element lowest or highest, at random
  basis_signs,  // per 64: the signs of one 8x8 DCT basis function (which one: the seed) at lowest / highest; the inputs
                // that drive that coefficient, or that pixel, to its largest magnitude
};
constexpr Pattern kPatterns[] = {Pattern::zeros,   Pattern::lowest,   Pattern::highest,    Pattern::alternating,
                                 Pattern::stripes, Pattern::sparse,   Pattern::dc_only,    Pattern::ramp,
                                 Pattern::random,  Pattern::extremes, Pattern::basis_signs};

inline std::string pattern_name(Pattern pattern) {
  constexpr const char* kNames[] = {"zeros",   "lowest", "highest", "alternating", "stripes",    "sparse",
                                    "dc_only", "ramp",   "random",  "extremes",    "basis_signs"};
  return kNames[static_cast<size_t>(pattern)];
}

// Whether the 8x8 DCT basis function `index` (0..63: 8 * v + u) is negative at sample `at` (0..63).
inline bool basis_is_negative(uint64_t index, size_t at) {
  const auto is_negative = [](uint64_t frequency, uint64_t position) {
    return ((2 * position + 1) * frequency + 8) / 16 % 2 != 0;  // cos((2x+1) u pi / 16) < 0
  };
  return is_negative(index % 8, at % 8) != is_negative(index / 8 % 8, at / 8 % 8);
}

// Fills `out` with integers from [low, high] (0 counts as the range's nearest value).
template <class T, size_t kExtent>
void fill(std::span<T, kExtent> out, Pattern pattern, int64_t low, int64_t high, uint64_t seed) {
  Random random(seed * 64 + static_cast<uint64_t>(pattern));
  const int64_t zero = low > 0 ? low : high < 0 ? high : 0;
  for (size_t i = 0; i < out.size(); ++i) {
    int64_t value = zero;
    switch (pattern) {
      case Pattern::zeros:
        break;
      case Pattern::lowest:
        value = low;
        break;
      case Pattern::highest:
        value = high;
        break;
      case Pattern::alternating:
        value = i % 2 == 0 ? high : low;
        break;
      case Pattern::stripes:
        value = i / 8 % 2 == 0 ? high : low;
        break;
      case Pattern::sparse:
        if (random.next() % 16 == 0) value = random.in(low, high);
        break;
      case Pattern::dc_only:
        if (i % 64 == 0) value = random.in(low, high);
        break;
      case Pattern::ramp:
        value = low + static_cast<int64_t>((i * 5 + seed) % static_cast<uint64_t>(high - low + 1));
        break;
      case Pattern::random:
        value = random.in(low, high);
        break;
      case Pattern::extremes:
        value = random.next() % 2 == 0 ? low : high;
        break;
      case Pattern::basis_signs:
        value = basis_is_negative(seed, i % 64) ? low : high;
        break;
    }
    out[i] = static_cast<T>(value);
  }
}

}  // namespace pac::test
