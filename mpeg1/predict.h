// Motion-compensated prediction of one macroblock [11172-2 2.4.4.2, 2.4.4.3].
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/image.h"
#include "base/kernels/kernels.h"
#include "mpeg1/mpeg1.h"

namespace pac::mpeg1 {

// The three planes of a picture whose sides are multiples of 16 in luma: what prediction reads and writes.
struct Planes {
  uint8_t* data[3] = {};
  ptrdiff_t stride[3] = {};
  int width = 0, height = 0;  // luma

  static Planes of(Frame420& frame) {
    return {{frame.y.row(0), frame.cb.row(0), frame.cr.row(0)},
            {frame.y.stride(), frame.cb.stride(), frame.cr.stride()},
            frame.width(),
            frame.height()};
  }
  // The macroblock's top left sample.
  uint8_t* at(int plane, int column, int row) const {
    const int size = plane == 0 ? 16 : 8;
    return data[plane] + ptrdiff_t{size} * row * stride[plane] + ptrdiff_t{size} * column;
  }
};

// A macroblock's samples outside a picture: luma 16x16, then Cb and Cr 8x8.
struct alignas(64) MacroblockSamples {
  uint8_t y[256], cb[64], cr[64];
  Planes planes() { return {{y, cb, cr}, {16, 8, 8}, 16, 16}; }
};

// The macroblock of `source` at (column, row), its prediction in that of `prediction` at another place.
inline PredictedSamples predicted_samples(const Planes& source, int column, int row, const Planes& prediction,
                                          int prediction_column, int prediction_row) {
  PredictedSamples samples;
  for (const int plane : {0, 1, 2}) {
    samples.source[plane] = source.at(plane, column, row);
    samples.source_stride[plane] = source.stride[plane];
    samples.prediction[plane] = prediction.at(plane, prediction_column, prediction_row);
    samples.prediction_stride[plane] = prediction.stride[plane];
  }
  return samples;
}

// Predicts the macroblock at (column, row) from `reference` into that of `target`, whose own macroblock is at
// (target_column, target_row). Vectors may lead anywhere: samples outside the picture repeat its edge.
void predict_macroblock(const MotionKernels& kernels, const Planes& reference, int column, int row, MotionVector vector,
                        const Planes& target, int target_column, int target_row);
inline void predict_macroblock(const MotionKernels& kernels, const Planes& reference, int column, int row,
                               MotionVector vector, const Planes& target) {
  predict_macroblock(kernels, reference, column, row, vector, target, column, row);
}

// Averages a second prediction into the target [2.4.4.3].
void average_macroblock(const MotionKernels& kernels, const Planes& reference, int column, int row, MotionVector vector,
                        const Planes& target);

// Zero vector, no error: `count` macroblocks from (column, row) rightwards, inside one row.
void copy_macroblocks(const Planes& reference, int column, int row, int count, const Planes& target);

// A caller's frame into planes of whole macroblocks; the edge is repeated outwards.
void fill_planes(const FrameView& frame, const Planes& target);
// A caller's frame in whole macroblocks, to be read only: where it is, if its sides are multiples of 16, or else in
// `copy`, which gets the size for it.
Planes whole_macroblocks(const Frame420& frame, Frame420& copy);

}  // namespace pac::mpeg1
