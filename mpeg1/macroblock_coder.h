// Decides how each macroblock of a band is coded, from top to bottom, and has residual_coder do it.
#pragma once

#include <cstdint>
#include <vector>

#include "base/kernels/kernels.h"
#include "mpeg1/macroblock.h"
#include "mpeg1/mpeg1.h"
#include "mpeg1/predict.h"
#include "mpeg1/residual_coder.h"

namespace pac::mpeg1 {

// What all bands of a picture share. Nobody writes but each band its own macroblocks and rows of the target.
struct PictureTask {
  ResidualTask residual;
  Effort effort = Effort::normal;
  PictureType type = PictureType::I;
  int columns = 0, rows = 0, slice_rows = 0;
  Planes source, reference, target;  // target: the reconstruction
  // Of each macroblock, raster order: quantizer_scale; if `wanted` is not null, that is what it should be, between
  // integers, `lambdas` what a bit is worth then, and the band settles it.
  uint8_t* quantizers = nullptr;
  const float* wanted = nullptr;
  const int64_t* lambdas = nullptr;
  bool vary_quantizers = false;                  // where another one costs less
  bool is_replaced = false;                      // the reference is the caller's: mostly right where it is
  const MotionVector* last_vectors = nullptr;    // of the picture before, or null
  const MotionVector* coarse_vectors = nullptr;  // of each 2 x 2 macroblocks, coarse_columns a row, or null
  int coarse_columns = 0;
  const MotionVector* ahead_vectors = nullptr;  // of each macroblock, by the lookahead, instead; or null
  const MotionVector* candidates = nullptr;     // of the caller
  int candidates_per_macroblock = 0;
  const MacroblockPrices* prices = nullptr;  // of each macroblock, instead of Annex B's lengths; or null
  const uint8_t* must_be_intra = nullptr;    // intra refresh: a byte a macroblock, or null
  const uint8_t* shows_reference = nullptr;  // a byte a macroblock: the target holds the reference's samples; or null
  int f_code = 4;                            // vectors stay in its range
  const uint8_t* bits_of_difference = nullptr;  // see SearchInput
  Macroblock* macroblocks = nullptr;            // result, raster order
};

// Codes a row of the band, the row above having been coded before if it is the band's, too: fills its macroblocks, the
// band's tokens and the target's samples.
void code_row(const PictureTask& task, Band& band, int row);

}  // namespace pac::mpeg1
