// What base/inflate.cpp and base/deflate.cpp must agree on: alphabets and canonical codes of deflate [RFC 1951].
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

namespace pac {

constexpr int kDeflateMaxBits = 15;      // longest literal or distance code
constexpr int kEndOfBlock = 256;         // [RFC 1951 3.2.5]
constexpr size_t kLiteralSymbols = 286;  // literals, end of block, 29 lengths
constexpr size_t kDistanceSymbols = 30;
constexpr size_t kMinMatch = 3, kMaxMatch = 258;
constexpr size_t kWindowSize = 32768;

// Length symbols 257 + i, distance symbols i: base value and extra bits [RFC 1951 3.2.5].
constexpr std::array<uint16_t, 29> kLengthBase{3,  4,  5,  6,  7,  8,  9,  10, 11,  13,  15,  17,  19,  23, 27,
                                               31, 35, 43, 51, 59, 67, 83, 99, 115, 131, 163, 195, 227, 258};
constexpr std::array<uint8_t, 29> kLengthExtraBits{0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2,
                                                   2, 3, 3, 3, 3, 4, 4, 4, 4, 5, 5, 5, 5, 0};
constexpr std::array<uint16_t, 30> kDistanceBase{1,    2,    3,    4,    5,    7,    9,    13,    17,    25,
                                                 33,   49,   65,   97,   129,  193,  257,  385,   513,   769,
                                                 1025, 1537, 2049, 3073, 4097, 6145, 8193, 12289, 16385, 24577};
constexpr std::array<uint8_t, 30> kDistanceExtraBits{0, 0, 0, 0, 1, 1, 2, 2,  3,  3,  4,  4,  5,  5,  6,
                                                     6, 7, 7, 8, 8, 9, 9, 10, 10, 11, 11, 12, 12, 13, 13};

// The order in which code lengths of the code-length code are sent [RFC 1951 3.2.7].
constexpr std::array<uint8_t, 19> kCodeLengthOrder{16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15};

// Codes of fixed blocks [RFC 1951 3.2.6]; symbols 286, 287 and 30, 31 take part in the code but never occur.
constexpr std::array<uint8_t, 288> make_fixed_literal_lengths() {
  std::array<uint8_t, 288> lengths{};
  for (size_t s = 0; s < 288; ++s) lengths[s] = s < 144 ? 8 : s < 256 ? 9 : s < 280 ? 7 : 8;
  return lengths;
}
constexpr std::array<uint8_t, 32> make_fixed_distance_lengths() {
  std::array<uint8_t, 32> lengths{};
  lengths.fill(5);
  return lengths;
}
constexpr std::array<uint8_t, 288> kFixedLiteralLengths = make_fixed_literal_lengths();
constexpr std::array<uint8_t, 32> kFixedDistanceLengths = make_fixed_distance_lengths();

// Index into kLengthBase of a match length 3..258: four symbols an octave above 10.
constexpr size_t length_index(size_t length) {
  if (length == kMaxMatch) return 28;
  const size_t l = length - kMinMatch;
  if (l < 4) return l;
  const auto top = static_cast<size_t>(std::bit_width(l)) - 1;
  return 4 * (top - 1) + (l >> (top - 2) & 3);
}

// Index into kDistanceBase of a distance 1..32768: two symbols an octave.
constexpr size_t distance_index(size_t distance) {
  const size_t d = distance - 1;
  if (d < 2) return d;
  const auto top = static_cast<size_t>(std::bit_width(d)) - 1;
  return 2 * top + (d >> (top - 1) & 1);
}

// Canonical codes from lengths [RFC 1951 3.2.2], each with its bits reversed: ready to be sent lowest bit first.
// codes.size() >= lengths.size().
inline void assign_deflate_codes(std::span<const uint8_t> lengths, std::span<uint16_t> codes) {
  std::array<uint16_t, kDeflateMaxBits + 2> next{};
  for (uint8_t length : lengths)
    if (length != 0) ++next[length + 1u];
  for (size_t length = 1; length <= kDeflateMaxBits; ++length)
    next[length + 1] = static_cast<uint16_t>((next[length] + next[length + 1]) << 1);
  for (size_t s = 0; s < lengths.size(); ++s) {
    if (lengths[s] == 0) continue;
    uint32_t code = next[lengths[s]]++, reversed = 0;
    for (int bit = 0; bit < lengths[s]; ++bit, code >>= 1) reversed = reversed << 1 | (code & 1);
    codes[s] = static_cast<uint16_t>(reversed);
  }
}

}  // namespace pac
