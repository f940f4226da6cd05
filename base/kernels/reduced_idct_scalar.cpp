#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "base/kernels/block_kernels.h"

namespace pac {
namespace {

// A sample of a 1-D transform of 8 is sum_u c_u x_u cos((2 i + 1) u pi / 16), with c_0 = 1 and c_u = sqrt(2) after the
// scaling that the transforms here share with idct_islow. The mean of two neighbors replaces the cosine by
//   cos(u pi / 16) cos((2 X + 1) u pi / 8),                  X = 0..3
// and that of four by cos(u pi / 16) cos(u pi / 8) cos((2 X + 1) u pi / 4), X = 0, 1. Both are 0 for u = 4; the second
// also for u = 2 and 6. The constants are 13-bit fixed point of 2 c_u (4 c_u) times that, at X = 0 and, for four
// samples, X = 1; the other half mirrors them, odd u with the other sign.
constexpr ReducedIdctFactors kFactors{};
constexpr int kConstBits = 13, kPass1Bits = 2;

// Sums that wrap: only damaged files get there.
int32_t product(int32_t a, int32_t b) {
  return static_cast<int32_t>(static_cast<uint32_t>(a) * static_cast<uint32_t>(b));
}
int32_t sum(int32_t a, int32_t b) {
  return static_cast<int32_t>(static_cast<uint32_t>(a) + static_cast<uint32_t>(b));
}
int32_t difference(int32_t a, int32_t b) {
  return static_cast<int32_t>(static_cast<uint32_t>(a) - static_cast<uint32_t>(b));
}
int32_t rounded(int32_t value, int shift) {
  return sum(value, 1 << (shift - 1)) >> shift;
}
int32_t odd_part(const int32_t (&weights)[4], const int32_t (&x)[8]) {
  return sum(sum(product(weights[0], x[1]), product(weights[1], x[3])),
             sum(product(weights[2], x[5]), product(weights[3], x[7])));
}

// One dimension. shift: bits to drop.
void transform4(const int32_t (&x)[8], int shift, int32_t (&out)[4]) {
  const int32_t mean = product(x[0], 1 << (kConstBits + 1));
  const int32_t even = sum(product(kFactors.even2, x[2]), product(kFactors.even6, x[6]));
  const int32_t outer = sum(mean, even), inner = difference(mean, even);
  const int32_t odd_outer = odd_part(kFactors.odd4[0], x), odd_inner = odd_part(kFactors.odd4[1], x);
  out[0] = rounded(sum(outer, odd_outer), shift);
  out[1] = rounded(sum(inner, odd_inner), shift);
  out[2] = rounded(difference(inner, odd_inner), shift);
  out[3] = rounded(difference(outer, odd_outer), shift);
}

void transform2(const int32_t (&x)[8], int shift, int32_t (&out)[2]) {
  const int32_t mean = product(x[0], 1 << (kConstBits + 2)), odd = odd_part(kFactors.odd2, x);
  out[0] = rounded(sum(mean, odd), shift);
  out[1] = rounded(difference(mean, odd), shift);
}

uint8_t to_sample(int32_t value) {
  return static_cast<uint8_t>(std::clamp(value, -128, 127) + 128);
}

int32_t dequantized(const int16_t* levels, const uint16_t* steps, int i) {
  return static_cast<int16_t>(static_cast<uint16_t>(product(levels[i], steps[i])));
}

// Columns, then rows; the columns that no row uses are left out.
template <int kSize, class Transform>
void block_of(const int16_t* levels, const uint16_t* steps, Transform&& transform, uint8_t* samples, ptrdiff_t stride) {
  constexpr int kSpare = kSize == 4 ? 1 : 2;  // each column is scaled by so many bits too many
  int32_t work[kSize][8] = {};
  for (int column = 0; column < 8; ++column) {
    if (column == 4 || (kSize == 2 && column > 0 && column % 2 == 0)) continue;
    int32_t x[8], out[kSize];
    for (int u = 0; u < 8; ++u) x[u] = dequantized(levels, steps, 8 * u + column);
    transform(x, kConstBits - kPass1Bits + kSpare, out);
    for (int y = 0; y < kSize; ++y) work[y][column] = out[y];
  }
  for (int y = 0; y < kSize; ++y) {
    int32_t out[kSize];
    transform(work[y], kConstBits + kPass1Bits + 3 + kSpare, out);
    for (int i = 0; i < kSize; ++i) samples[y * stride + i] = to_sample(out[i]);
  }
}

void idct_4x4(const int16_t* levels, const uint16_t* steps, size_t n_blocks, uint8_t* samples, ptrdiff_t stride) {
  for (size_t i = 0; i < n_blocks; ++i) block_of<4>(levels + 64 * i, steps, transform4, samples + 4 * i, stride);
}

void idct_2x2(const int16_t* levels, const uint16_t* steps, size_t n_blocks, uint8_t* samples, ptrdiff_t stride) {
  for (size_t i = 0; i < n_blocks; ++i) block_of<2>(levels + 64 * i, steps, transform2, samples + 2 * i, stride);
}

void idct_1x1(const int16_t* levels, const uint16_t* steps, size_t n_blocks, uint8_t* samples, ptrdiff_t) {
  for (size_t i = 0; i < n_blocks; ++i) samples[i] = to_sample(rounded(dequantized(levels + 64 * i, steps, 0), 3));
}

}  // namespace

void fill_reduced_idct_scalar(BlockKernels& table) {
  table.idct_4x4 = idct_4x4;
  table.idct_2x2 = idct_2x2;
  table.idct_1x1 = idct_1x1;
}

}  // namespace pac
