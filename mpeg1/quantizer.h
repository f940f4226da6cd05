// Quantization and its inverse for the encoder [11172-2 2.4.4.1, 2.4.4.2].
#pragma once

#include <cstdint>
#include <cstring>

#include "base/kernels/kernels.h"
#include "mpeg1/mpeg1.h"

namespace pac::mpeg1 {

// A block's 64 coefficients become zero: in pieces that compilers make a few vector stores of, where for 128 bytes at
// once they may choose a string instruction that takes longer than a block's transform.
inline void clear_block(int16_t* coefficients) {
  for (int i = 0; i < 64; i += 16) std::memset(coefficients + i, 0, 32);
}

constexpr int kMaxLevel = 255;      // |level| that the escape codes [table B.5f]
constexpr int kMinMatrixEntry = 3;  // the encoder's: smaller divisors do not fit BlockQuantizer

// One matrix at every quantizer_scale.
struct QuantizerSet {
  BlockQuantizer divide[32];  // of coefficients scaled by 8: |level| = (|c| + bias) / (quantizer_scale * entry)
  uint16_t weight[32][64];    // quantizer_scale * entry, zigzag order
  uint16_t least_weight[32];  // of the 64
  bool may_overflow[32];      // an AC level above kMaxLevel is possible
};
// rounding: of a step, added before the division.
void make_quantizers(const QuantizerMatrix& matrix, double rounding, QuantizerSet& set);

// |coefficient| that a decoder makes of |level| >= 1 with quantizer_scale * entry = weight.
inline int reconstruct_intra(int level, int weight) {
  const int value = level * weight >> 3;
  const int is_nonzero = value != 0 ? 1 : 0;
  const int odd = (value - is_nonzero) | is_nonzero;
  return odd < 2047 ? odd : 2047;
}
inline int reconstruct_non_intra(int level, int weight) {
  const int value = (2 * level + 1) * weight >> 4;
  const int is_nonzero = value != 0 ? 1 : 0;
  const int odd = (value - is_nonzero) | is_nonzero;
  return odd < 2047 ? odd : 2047;
}

}  // namespace pac::mpeg1
