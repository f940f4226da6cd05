// Integers as adaptive bits: a magnitude class (its bit length) in a binary tree, then the sign, the bits below the
// leading one: the highest two learned, the rest raw. One template each for encoding and decoding.
#pragma once

#include <bit>
#include <cstdint>

#include "geomcodec/range_coder.h"

namespace pac::geomcodec {

// The low `bits` bits of value, most significant first, each in the context of those before it. tree: 2^bits entries.
template <class Coder>
uint32_t code_tree(Coder& coder, AdaptiveBit* tree, int bits, uint32_t value) {
  uint32_t node = 1;
  for (int i = bits - 1; i >= 0; --i) node = node << 1 | coder.bit(tree[node], value >> i & 1u);
  return node - (1u << bits);
}

// The same where two contexts predict each bit.
template <class Coder>
uint32_t code_tree(Coder& coder, AdaptiveBit* first, AdaptiveBit* second, int bits, uint32_t value) {
  uint32_t node = 1;
  for (int i = bits - 1; i >= 0; --i) node = node << 1 | coder.bit(first[node], second[node], value >> i & 1u);
  return node - (1u << bits);
}

// The bits of a number of `bit_length` (1..32) bits below its leading one.
struct MantissaModel {
  AdaptiveBit high[33][4];
};
template <class Coder>
uint32_t code_mantissa(Coder& coder, MantissaModel& model, int bit_length, uint32_t number) {
  if (bit_length <= 1) return static_cast<uint32_t>(bit_length);  // 0 or 1: nothing below
  int left = bit_length - 1;
  uint32_t result = 1;
  const int learned = left < 2 ? left : 2;
  left -= learned;
  result =
      result << learned | code_tree(coder, model.high[bit_length], learned, number >> left & ((1u << learned) - 1));
  while (left > 0) {
    const int count = left < 16 ? left : 16;
    left -= count;
    result = result << count | coder.raw(count, number >> left & ((1u << count) - 1));
  }
  return result;
}

// Any 32-bit number; small ones are cheap.
struct NumberModel {
  AdaptiveBit length[64];  // tree of the bit length 0..32; 6 bits
  MantissaModel mantissa;
};
template <class Coder>
uint32_t code_number(Coder& coder, NumberModel& model, uint32_t number) {
  const uint32_t length = code_tree(coder, model.length, 6, static_cast<uint32_t>(std::bit_width(number)));
  return code_mantissa(coder, model.mantissa, length <= 32 ? static_cast<int>(length) : 32, number);
}

// 0, 1, 2, 3, 4 ... <- 0, -1, 1, -2, 2 ...
inline uint32_t zigzag(int32_t value) {
  return static_cast<uint32_t>(value) << 1 ^ static_cast<uint32_t>(value >> 31);
}
inline int32_t unzigzag(uint32_t code) {
  return static_cast<int32_t>(code >> 1 ^ (0u - (code & 1u)));
}

}  // namespace pac::geomcodec
