// What the quality of a macroblock is worth: pictures after it repeat its samples, and with them its errors, where they
// are predicted from it so well that hardly anything is coded anew. A bit spent on it there improves them all.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/kernels/kernels.h"
#include "base/parallel.h"
#include "mpeg1/macroblock.h"
#include "mpeg1/mpeg1.h"
#include "mpeg1/predict.h"

namespace pac::mpeg1 {

class Lookahead {
 public:
  // Macroblocks of the pictures.
  Lookahead(int columns, int rows) : columns_(columns), rows_(rows) {}

  // Looks at a group: `first`, then `following` in order, each of the sequence's size; `quantizer_scale` is that of its
  // P pictures. The result depends on `bands`, not on the pool's threads.
  void look(const Frame420& first, std::span<const Frame420* const> following, double quantizer_scale,
            std::span<const Band> bands, const MotionKernels& kernels, ThreadPool& pool);
  void forget() { scales_.clear(); }

  // Of the group's picture, from 0 on: what quantizer_scale is multiplied by in each macroblock, raster order, at most
  // 1. Null for pictures that were not looked at.
  const float* scales(int picture) const {
    const auto i = static_cast<size_t>(picture);
    return i < scales_.size() ? scales_[i].data() : nullptr;
  }

 private:
  // How a macroblock is predicted from the frame before.
  struct Prediction {
    MotionVector vector;
    float share = 0;  // of the errors there that it takes over, 0..1
  };
  using Predictions = std::vector<Prediction>;
  struct Step;  // from one frame to the next

  void predict_band(const Step& step, const Band& band, Predictions& predictions) const;
  MotionVector search(const Step& step, const Band& band, int column, int row, const Predictions& predictions) const;
  float share(const Step& step, int column, int row, MotionVector vector) const;
  void pass_on(const Predictions& predictions, const std::vector<float>& worth, std::vector<float>& before) const;

  int columns_, rows_;
  std::vector<std::vector<float>> scales_;
};

}  // namespace pac::mpeg1
