// Logarithms as integers, the same everywhere: for tables that are made when the program is compiled.
#pragma once

#include <cstdint>

namespace pac {

// floor(log2(n) * 2^digits), but for what mantissas of 31 bits lose; 1 <= n < 2^31, 0 <= digits <= 31. Each squaring of
// the mantissa gives a digit.
constexpr int64_t fixed_log2(uint32_t n, int digits) {
  int64_t log = 0;
  while (n >> (log + 1) != 0) ++log;
  uint64_t mantissa = uint64_t{n} << (31 - log);  // 1..2 in 2^-31
  for (int digit = 0; digit < digits; ++digit) {
    mantissa = mantissa * mantissa >> 31;
    log = log << 1 | static_cast<int64_t>(mantissa >> 32);
    mantissa >>= mantissa >> 32;
  }
  return log;
}

}  // namespace pac
