#include <cstddef>
#include <cstdint>

#include "base/kernels/block_kernels.h"

namespace pac {
namespace {

// round(c * 2^13); ck = cos(k*pi/16). The rotations of the LLM flow graph, multiplied out.
constexpr int kConstBits = 13;
constexpr int kPassBits = 2;   // fraction bits kept between the passes
constexpr int k0_541 = 4433;   // sqrt(2) * c6
constexpr int k0_765 = 6270;   // sqrt(2) * (c2 - c6)
constexpr int k1_847 = 15137;  // sqrt(2) * (c2 + c6)
constexpr int k1_175 = 9633;   // sqrt(2) * c3
constexpr int k1_961 = 16069;  // sqrt(2) * (c3 + c5)
constexpr int k0_390 = 3196;   // sqrt(2) * (c3 - c5)
constexpr int k0_298 = 2446;   // sqrt(2) * (-c1 + c3 + c5 - c7)
constexpr int k2_053 = 16819;  // sqrt(2) * ( c1 + c3 - c5 + c7)
constexpr int k3_072 = 25172;  // sqrt(2) * ( c1 + c3 + c5 - c7)
constexpr int k1_501 = 12299;  // sqrt(2) * ( c1 + c3 - c5 - c7)
constexpr int k0_899 = 7373;   // sqrt(2) * (c3 - c7)
constexpr int k2_562 = 20995;  // sqrt(2) * (c1 + c3)

int round_shift(int value, int shift) {
  return (value + (1 << (shift - 1))) >> shift;
}

int wrap16(int value) {
  return static_cast<int16_t>(static_cast<uint16_t>(value));
}

int clamp(int value, int low, int high) {
  return value < low ? low : value > high ? high : value;
}

// One dimension, forward: x[0..7] become sqrt(8) * 2^(13 - shift) times the DCT. Shift 11 leaves kPassBits of fraction
// (first pass), 15 removes them (second).
void fdct_1d(int (&x)[8], int shift) {
  const int sum07 = x[0] + x[7], difference07 = x[0] - x[7], sum16 = x[1] + x[6], difference16 = x[1] - x[6];
  const int sum25 = x[2] + x[5], difference25 = x[2] - x[5], sum34 = x[3] + x[4], difference34 = x[3] - x[4];

  const int even0 = sum07 + sum34, even3 = sum07 - sum34, even1 = sum16 + sum25, even2 = sum16 - sum25;
  const int dc = even0 + even1, c4 = even0 - even1;
  x[0] = shift < kConstBits ? dc * (1 << (kConstBits - shift)) : round_shift(dc, shift - kConstBits);
  x[4] = shift < kConstBits ? c4 * (1 << (kConstBits - shift)) : round_shift(c4, shift - kConstBits);
  x[2] = round_shift(even2 * k0_541 + even3 * (k0_541 + k0_765), shift);
  x[6] = round_shift(even2 * (k0_541 - k1_847) + even3 * k0_541, shift);

  const int z3 = difference34 + difference16, z4 = difference25 + difference07;
  const int odd3 = z3 * (k1_175 - k1_961) + z4 * k1_175, odd4 = z3 * k1_175 + z4 * (k1_175 - k0_390);
  x[7] = round_shift(difference34 * (k0_298 - k0_899) - difference07 * k0_899 + odd3, shift);
  x[1] = round_shift(difference07 * (k1_501 - k0_899) - difference34 * k0_899 + odd4, shift);
  x[5] = round_shift(difference25 * (k2_053 - k2_562) - difference16 * k2_562 + odd4, shift);
  x[3] = round_shift(difference16 * (k3_072 - k2_562) - difference25 * k2_562 + odd3, shift);
}

void fdct_block(const uint8_t* samples, ptrdiff_t stride, int16_t* coefficients) {
  int work[64];
  for (int row = 0; row < 8; ++row) {
    int x[8];
    for (int i = 0; i < 8; ++i) x[i] = samples[row * stride + i] - 128;
    fdct_1d(x, kConstBits - kPassBits);
    for (int i = 0; i < 8; ++i) work[8 * row + i] = x[i];
  }
  for (int column = 0; column < 8; ++column) {
    int x[8];
    for (int i = 0; i < 8; ++i) x[i] = work[8 * i + column];
    fdct_1d(x, kConstBits + kPassBits);
    for (int i = 0; i < 8; ++i) coefficients[8 * i + column] = static_cast<int16_t>(x[i]);
  }
}

void fdct_islow(const uint8_t* samples, ptrdiff_t stride, size_t n_blocks, int16_t* coefficients) {
  for (size_t i = 0; i < n_blocks; ++i) fdct_block(samples + 8 * i, stride, coefficients + 64 * i);
}

// One dimension, inverse, not yet rounded: 2^13 * sqrt(8) times the samples.
void idct_1d(int (&x)[8]) {
  const int even2 = x[2] * (k0_541 + k0_765) + x[6] * k0_541;
  const int even3 = x[2] * k0_541 + x[6] * (k0_541 - k1_847);
  const int even0 = wrap16(x[0] + x[4]) * (1 << kConstBits), even1 = wrap16(x[0] - x[4]) * (1 << kConstBits);
  const int a0 = even0 + even2, a3 = even0 - even2, a1 = even1 + even3, a2 = even1 - even3;

  const int z3 = wrap16(x[7] + x[3]), z4 = wrap16(x[5] + x[1]);
  const int odd3 = z3 * (k1_175 - k1_961) + z4 * k1_175, odd4 = z3 * k1_175 + z4 * (k1_175 - k0_390);
  const int b0 = x[7] * (k0_298 - k0_899) - x[1] * k0_899 + odd3;
  const int b1 = x[5] * (k2_053 - k2_562) - x[3] * k2_562 + odd4;
  const int b2 = x[3] * (k3_072 - k2_562) - x[5] * k2_562 + odd3;
  const int b3 = x[1] * (k1_501 - k0_899) - x[7] * k0_899 + odd4;
  x[0] = a0 + b3, x[7] = a0 - b3, x[1] = a1 + b2, x[6] = a1 - b2;
  x[2] = a2 + b1, x[5] = a2 - b1, x[3] = a3 + b0, x[4] = a3 - b0;
}

// All AC levels zero: both passes by hand. Columns: saturate(4x); rows: (2^13 * that + 2^17) >> 18.
void idct_dc_block(int level, int step, uint8_t* samples, ptrdiff_t stride) {
  const int column = clamp(wrap16(level * step) * (1 << kPassBits), -32768, 32767);
  const auto value = static_cast<uint8_t>(clamp(round_shift(column, kPassBits + 3), -128, 127) + 128);
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) samples[y * stride + x] = value;
}

void idct_block(const int16_t* levels, const uint16_t* steps, uint8_t* samples, ptrdiff_t stride) {
  int work[64];
  for (int column = 0; column < 8; ++column) {
    int x[8];
    for (int i = 0; i < 8; ++i) x[i] = wrap16(levels[8 * i + column] * steps[8 * i + column]);
    idct_1d(x);
    for (int i = 0; i < 8; ++i) work[8 * i + column] = clamp(round_shift(x[i], kConstBits - kPassBits), -32768, 32767);
  }
  for (int row = 0; row < 8; ++row) {
    int x[8];
    for (int i = 0; i < 8; ++i) x[i] = work[8 * row + i];
    idct_1d(x);
    for (int i = 0; i < 8; ++i)
      samples[row * stride + i] =
          static_cast<uint8_t>(clamp(round_shift(x[i], kConstBits + kPassBits + 3), -128, 127) + 128);
  }
}

void idct_islow(const int16_t* levels, const uint16_t* steps, const uint8_t* last, size_t n_blocks, uint8_t* samples,
                ptrdiff_t stride) {
  for (size_t i = 0; i < n_blocks; ++i) {
    if (last[i] == 0)
      idct_dc_block(levels[64 * i], steps[0], samples + 8 * i, stride);
    else
      idct_block(levels + 64 * i, steps, samples + 8 * i, stride);
  }
}

void quantize(const int16_t* coefficients, const BlockQuantizer& quantizer, size_t n_blocks, int16_t* levels,
              uint64_t* nonzero) {
  for (size_t i = 0; i < n_blocks; ++i) {
    uint64_t mask = 0;
    for (int k = 0; k < 64; ++k) {
      const int natural = kNaturalFromZigzag[k];
      const int c = coefficients[64 * i + static_cast<size_t>(natural)];
      const auto n = static_cast<uint32_t>((c < 0 ? -c : c) + quantizer.bias[natural]);
      const uint32_t level = ((n * quantizer.reciprocal[natural] >> 16) * quantizer.scale[natural]) >> 16;
      levels[64 * i + static_cast<size_t>(k)] =
          static_cast<int16_t>(c < 0 ? -static_cast<int>(level) : static_cast<int>(level));
      mask |= static_cast<uint64_t>(level != 0) << k;
    }
    nonzero[i] = mask;
  }
}

void fdct_quantize(const uint8_t* samples, ptrdiff_t stride, size_t n_blocks, const BlockQuantizer& quantizer,
                   int16_t* levels, uint64_t* nonzero) {
  for (size_t i = 0; i < n_blocks; ++i) {
    alignas(16) int16_t coefficients[64];
    fdct_islow(samples + 8 * i, stride, 1, coefficients);
    quantize(coefficients, quantizer, 1, levels + 64 * i, nonzero + i);
  }
}

}  // namespace

void fill_block_scalar(BlockKernels& table) {
  table.fdct_islow = fdct_islow;
  table.idct_islow = idct_islow;
  table.quantize = quantize;
  table.fdct_quantize = fdct_quantize;
}

}  // namespace pac
