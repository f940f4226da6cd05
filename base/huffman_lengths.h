// Optimal prefix codes with a bound on the code length: package-merge [Larmore and Hirschberg 1990].
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace pac {

constexpr size_t kMaxHuffmanSymbols = 320;

// Sets lengths[s] to the code length of symbol s, 1..max_length, or 0 where frequencies[s] == 0, so that the sum of
// frequency * length is the least possible. One symbol alone gets length 1. Both spans have the same size <=
// kMaxHuffmanSymbols; the number of symbols with a frequency is at most 2^max_length; 1 <= max_length <= 32. Equal
// frequencies are ordered by symbol, so the result depends on nothing else. Allocates nothing.
void optimal_code_lengths(std::span<const uint32_t> frequencies, int max_length, std::span<uint8_t> lengths);

}  // namespace pac
