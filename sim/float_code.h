// Floats as they changed against a guess, bit for bit: near guesses take few bits, any pattern comes back.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#include "base/bits.h"

namespace pac::sim {

// Floats in their order as integers: neighbors differ by one. A bijection of all 2^32 patterns.
inline uint32_t ordered_bits(float value) {
  uint32_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return (bits >> 31) != 0 ? ~bits : bits | 0x80000000u;
}

inline float from_ordered_bits(uint32_t value) {
  const uint32_t bits = (value >> 31) != 0 ? value & 0x7FFFFFFFu : ~value;
  float result;
  std::memcpy(&result, &bits, sizeof bits);
  return result;
}

// 0 for no change; 1, five bits of length - 1, then the zigzag code of the change without its leading one.
inline void put_float_change(BitWriter& writer, float value, float guess) {
  const uint32_t difference = ordered_bits(value) - ordered_bits(guess);
  const uint32_t code = difference << 1 ^ ((difference >> 31) != 0 ? 0xFFFFFFFFu : 0u);
  if (code == 0) return writer.put(0, 1);
  int length = 1;
  while (length < 32 && (code >> length) != 0) ++length;
  writer.put(1, 1);
  writer.put(static_cast<uint32_t>(length - 1), 5);
  writer.put(code, length - 1);
}

inline float take_float_change(BitReader& reader, float guess) {
  uint32_t code = 0;
  if (reader.read_flag()) {
    const int rest = static_cast<int>(reader.read(5));
    code = uint32_t{1} << rest | reader.read(rest);
  }
  const uint32_t difference = code >> 1 ^ ((code & 1) != 0 ? 0xFFFFFFFFu : 0u);
  return from_ordered_bits(ordered_bits(guess) + difference);
}

// What was computed in double as a guess; `otherwise` where no float is near it. No NaN either: its bits differ between
// machines.
inline float float_guess(double guess, float otherwise) {
  return std::fabs(guess) <= 3.4028234663852886e38 ? static_cast<float>(guess) : otherwise;
}

}  // namespace pac::sim
