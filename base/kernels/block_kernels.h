// 8x8 block operations: forward and inverse DCT, quantization. Blocks are 64 int16 in natural (row) order.
//
// The transforms are those of Loeffler, Ligtenberg and Moschytz (ICASSP 1989: 11 multiplications in one dimension) in
// 13-bit fixed point, as the IJG software's "islow" does them, so that other decoders see what our encoder saw.
#pragma once

#include <cstddef>
#include <cstdint>

namespace pac {

// Natural (row) index of the k-th coefficient in zigzag order [T.81 figure A.6; 11172-2 2.4.4.1].
constexpr uint8_t kNaturalFromZigzag[64] = {0,  1,  8,  16, 9,  2,  3,  10, 17, 24, 32, 25, 18, 11, 4,  5,   //
                                            12, 19, 26, 33, 40, 48, 41, 34, 27, 20, 13, 6,  7,  14, 21, 28,  //
                                            35, 42, 49, 56, 57, 50, 43, 36, 29, 22, 15, 23, 30, 37, 44, 51,  //
                                            58, 59, 52, 45, 38, 31, 39, 46, 53, 60, 61, 54, 47, 55, 62, 63};

// Division by 64 divisors without dividing, natural order. With h(a, b) = (a * b) >> 16 on unsigned 16-bit lanes,
//   h(h(n, reciprocal[i]), scale[i]) == n / divisor[i]   for 0 <= n < 2^15 (make_quantizer in jpeg/ proves it).
struct alignas(64) BlockQuantizer {
  uint16_t reciprocal[64];
  uint16_t scale[64];  // powers of two: the second multiplication is a right shift by a count of its own in each lane
  uint16_t bias[64];   // added to |x| before the division: divisor / 2 rounds to nearest, less is a dead zone;
                       // below the divisor, so that 0 stays 0
};

// Of idct_4x4 and idct_2x2: 13-bit fixed point, for u = 2 and 6, and for u = 1, 3, 5, 7 (reduced_idct_scalar.cpp).
struct ReducedIdctFactors {
  int32_t even2 = 15137, even6 = -6270;  // 1.847759065, -0.765366865 at X = 0; X = 1: negated
  int32_t odd4[2][4] = {
      {20995, 7373, -4926, -4176},   // 2.562915447, 0.899976223, -0.601344887, -0.509795579
      {8697, -17799, 11893, -1730},  // 1.061594337, -2.172734803, 1.451774981, -0.211164243
  };
  int32_t odd2[4] = {29692, -10426, 6967, -5906};  // 3.624509785, -1.272758580, 0.850430095, -0.720959822
};

struct BlockKernels {
  // Forward DCT of `n_blocks` horizontally adjacent 8x8 blocks of samples: block i starts at samples + 8*i, rows are
  // `stride` bytes apart. Subtracts 128, transforms. Output: coefficients scaled by 8, |c| <= 8200, block i at
  // coefficients + 64*i. No alignment assumed; reads only those samples. Rows first: each 1-D transform is scaled by
  // 4*sqrt(8) and rounded to int16 (values below 2^13 * sqrt(8) / 2, so sums stay inside 16 bits), then columns with
  // the 4 removed; rounding is (x + 2^(s-1)) >> s. Every product sum fits int32 (pmaddwd pairs of int16 are exact).
  void (*fdct_islow)(const uint8_t* samples, ptrdiff_t stride, size_t n_blocks, int16_t* coefficients);

  // Inverse DCT of `n_blocks` blocks of levels (natural order, 64 each) that all have the quantizer steps `steps`
  // (natural order, 1..65535), to horizontally adjacent 8x8 blocks of samples: block i at samples + 8*i.
  // last[i]: levels of block i after zigzag position last[i] are zero (a promise that allows short cuts; 63 promises
  // nothing; results never depend on it). No alignment assumed; writes only those samples. For any input whatever:
  //  1. x = int16(level * step)                            low 16 bits of the product
  //  2. columns, then rows; in each the sums x0+x4, x0-x4, x7+x3, x5+x1 wrap to int16, everything else is int32
  //     (magnitudes stay below 64570 * 2^15 < 2^31)
  //  3. after columns (v + 2^10) >> 11, saturated to int16
  //  4. after rows (v + 2^17) >> 18, clamped to -128..127, plus 128.
  void (*idct_islow)(const int16_t* levels, const uint16_t* steps, const uint8_t* last, size_t n_blocks,
                     uint8_t* samples, ptrdiff_t stride);

  // The same to fewer samples, each the mean of those it stands for: 4x4, 2x2 or 1 a block, block i at samples + 4*i,
  // 2*i or i. Those of the IJG software's reduced transforms on every file that an encoder made. For any input
  // whatever: x as in 1. above, all sums wrap modulo 2^32; 4x4: columns (v + 2^11) >> 12, rows (v + 2^18) >> 19; 2x2:
  // columns (v + 2^12) >> 13, rows (v + 2^19) >> 20; 1x1: (x + 4) >> 3; clamped to -128..127, plus 128.
  void (*idct_4x4)(const int16_t* levels, const uint16_t* steps, size_t n_blocks, uint8_t* samples, ptrdiff_t stride);
  void (*idct_2x2)(const int16_t* levels, const uint16_t* steps, size_t n_blocks, uint8_t* samples, ptrdiff_t stride);
  void (*idct_1x1)(const int16_t* levels, const uint16_t* steps, size_t n_blocks, uint8_t* samples, ptrdiff_t stride);

  // Quantizes `n_blocks` blocks of coefficients (natural order, |c| < 2^14): level = sign(c) * ((|c| + bias) /
  // divisor). Output in *zigzag* order, 64 levels a block, and one mask a block: bit k set where the level at zigzag
  // position k is not zero. No alignment assumed. `levels` may not overlap `coefficients`.
  void (*quantize)(const int16_t* coefficients, const BlockQuantizer& quantizer, size_t n_blocks, int16_t* levels,
                   uint64_t* nonzero);

  // fdct_islow() and then quantize() of its result, which is not kept.
  void (*fdct_quantize)(const uint8_t* samples, ptrdiff_t stride, size_t n_blocks, const BlockQuantizer& quantizer,
                        int16_t* levels, uint64_t* nonzero);
};

// One per instruction set: overwrites the entries that it improves.
void fill_block_scalar(BlockKernels& table);
void fill_block_sse41(BlockKernels& table);
void fill_block_avx2(BlockKernels& table);
void fill_block_neon(BlockKernels& table);
void fill_reduced_idct_scalar(BlockKernels& table);
void fill_reduced_idct_sse41(BlockKernels& table);
void fill_reduced_idct_avx2(BlockKernels& table);
void fill_reduced_idct_neon(BlockKernels& table);

}  // namespace pac
