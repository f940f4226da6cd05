// Motion-compensated coding: block distances, half-sample prediction, transforms of prediction errors
// [ISO/IEC 11172-2 2.4.4, Annex A].
//
// The transforms are those of Loeffler, Ligtenberg and Moschytz as in block_kernels.h, with scalings that fit
// prediction errors (9 bits) and meet the accuracy of IEEE 1180-1990.
#pragma once

#include <cstddef>
#include <cstdint>

namespace pac {

// Half-sample flags of a prediction: the sample at (x + h/2, y + v/2) of the reference is
//   0 0: a            1 0: (a + b + 1) >> 1  (b right of a)
//   0 1: (a + c + 1) >> 1  (c below a)       1 1: (a + b + c + d + 2) >> 2.
// Index of the tables below: h + 2 * v. Reads width + h samples of height + v rows of the reference, no others.
constexpr int kHalfPelKinds = 4;

// The first samples of a macroblock's planes Y, Cb, Cr, and how far apart the rows are.
struct PredictedSamples {
  const uint8_t* source[3];
  ptrdiff_t source_stride[3];
  const uint8_t* prediction[3];
  ptrdiff_t prediction_stride[3];
};

struct MotionKernels {
  // Sum of |source - reference| over 16x16 samples, any alignment.
  uint32_t (*sad16)(const uint8_t* source, ptrdiff_t source_stride, const uint8_t* reference,
                    ptrdiff_t reference_stride);
  // The same against four references of one stride.
  void (*sad16_x4)(const uint8_t* source, ptrdiff_t source_stride, const uint8_t* const* references,
                   ptrdiff_t reference_stride, uint32_t* sads);
  // The same over each 8x8 block of the 16x16 samples, in raster order.
  void (*sad16_quarters)(const uint8_t* source, ptrdiff_t source_stride, const uint8_t* reference,
                         ptrdiff_t reference_stride, uint32_t* sads);
  // Sum of |source - reference| over 8x8 samples.
  uint32_t (*sad8)(const uint8_t* source, ptrdiff_t source_stride, const uint8_t* reference,
                   ptrdiff_t reference_stride);
  // sads[k], k < n: of sad8() at reference + 2 k. From each fourth place on 16 samples a row are readable, and there is
  // room for n sads rounded up to a multiple of 4.
  void (*sad8_across)(const uint8_t* source, ptrdiff_t source_stride, const uint8_t* reference,
                      ptrdiff_t reference_stride, int n, uint32_t* sads);
  // Against the prediction of kind h + 2 * v.
  uint32_t (*sad16_half[kHalfPelKinds])(const uint8_t* source, ptrdiff_t source_stride, const uint8_t* reference,
                                        ptrdiff_t reference_stride);
  // Sum over the four 8x8 blocks of the 16x16 samples of |8x8 Hadamard transform of source - prediction|, halved per
  // block: (sum + 2) >> 2.
  uint32_t (*satd16)(const uint8_t* source, ptrdiff_t source_stride, const uint8_t* prediction,
                     ptrdiff_t prediction_stride);
  // Sum of squared differences over width (8 or 16) x height samples.
  uint32_t (*sse)(const uint8_t* a, ptrdiff_t a_stride, const uint8_t* b, ptrdiff_t b_stride, int width, int height);
  // Sum of the 16x16 samples, and of their squares.
  void (*moments16)(const uint8_t* source, ptrdiff_t stride, uint32_t* sum, uint32_t* sum_of_squares);
  // Means of n squares of 4x4 samples side by side, rounded: (sum + 8) >> 4. n: a multiple of 4.
  void (*means_4x4)(const uint8_t* samples, ptrdiff_t stride, int n, uint8_t* means);

  // Predictions of 16 samples width; height any. No overlap of the two.
  void (*predict16[kHalfPelKinds])(const uint8_t* reference, ptrdiff_t reference_stride, uint8_t* prediction,
                                   ptrdiff_t prediction_stride, int height);
  // The same of 8x8 samples from each of two references: both chroma planes.
  void (*predict8_pair[kHalfPelKinds])(const uint8_t* const references[2], ptrdiff_t reference_stride,
                                       uint8_t* const predictions[2], ptrdiff_t prediction_stride);
  // prediction = (prediction + other + 1) >> 1 over width (8 or 16) x height samples.
  void (*average)(uint8_t* prediction, ptrdiff_t prediction_stride, const uint8_t* other, ptrdiff_t other_stride,
                  int width, int height);

  // Forward DCT of source - prediction of a macroblock's six 8x8 blocks: those of 16x16 samples of luma in raster
  // order, Cb, Cr. Output as fdct_islow: 8 times the DCT of 11172-2's definition, natural order, |c| <= 16384, block i
  // at coefficients + 64 * i. Returns which blocks have a coefficient with |c| >= threshold (1..32767): bit i for
  // block i.
  uint32_t (*fdct_macroblock)(const PredictedSamples& samples, int threshold, int16_t* coefficients);
  // The same, but where neither block of a pair (0 1, 2 3, 4 5) reaches the threshold, its coefficients are
  // unspecified: blocks of too little energy need no transform.
  uint32_t (*fdct_reaching)(const PredictedSamples& samples, int threshold, int16_t* coefficients);

  // Inverse DCT of `n_blocks` blocks of coefficients (natural order, -2048..2047, block i at coefficients + 64 * i),
  // added to the samples at samples[i] (rows strides[i] apart) and clamped to 0..255. Three bits of fraction stay
  // between the passes. For any input:
  //  1. columns, then rows; the sums x0+x4, x0-x4, x7+x3, x5+x1 saturate to int16, everything else is int32
  //  2. after columns (v + 2^9) >> 10, saturated to int16; after rows (v + 2^18) >> 19, saturated to int16
  //  3. added to the sample, clamped.
  void (*idct_add)(const int16_t* coefficients, size_t n_blocks, uint8_t* const* samples, const ptrdiff_t* strides);
  // The same with zeros in place of the samples: intra blocks.
  void (*idct_put)(const int16_t* coefficients, size_t n_blocks, uint8_t* const* samples, const ptrdiff_t* strides);
  // The same results for a block whose only coefficient is dc: adds (dc + 4) >> 3 (of dc within -2048..2047).
  void (*idct_dc_add)(int dc, uint8_t* samples, ptrdiff_t stride);
};

// One per instruction set: overwrites the entries that it improves.
void fill_motion_scalar(MotionKernels& table);
void fill_motion_sse41(MotionKernels& table);
void fill_motion_avx2(MotionKernels& table);
void fill_motion_neon(MotionKernels& table);

}  // namespace pac
