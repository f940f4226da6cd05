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
  void forget() {
    scales_.clear();
    vectors_.clear();
  }

  // Of the group's picture, from 0 on: what quantizer_scale is multiplied by in each macroblock, raster order, at most
  // 1. Null for pictures that were not looked at.
  const float* scales(int picture) const {
    const auto i = static_cast<size_t>(picture);
    return i < scales_.size() ? scales_[i].data() : nullptr;
  }

  // By how much that makes the picture's quantizers finer, on average; 1 where nothing was looked at.
  double finer(int picture) const;
  // The same of the group's P pictures.
  double finer_on_average(int group_length) const;

  // Vectors of its macroblocks to the frame before. Null for the group's first picture, too.
  const MotionVector* vectors(int picture) const {
    const auto i = static_cast<size_t>(picture) - 1;
    return picture > 0 && i < vectors_.size() ? vectors_[i].data() : nullptr;
  }

 private:
  // How the macroblocks are predicted from the frame before.
  using Vectors = std::vector<MotionVector>;
  using Shares = std::vector<float>;  // of the errors there that they take over, 0..1
  struct Step;                        // from one frame to the next

  void predict_row(const Step& step, const Band& band, int row, Vectors& vectors, Shares& shares) const;
  MotionVector search(const Step& step, const Band& band, int column, int row, const Vectors& vectors) const;
  float share(const Step& step, int column, int row, MotionVector vector) const;
  void pass_on(const Vectors& vectors, const Shares& shares, const std::vector<float>& worth,
               std::vector<float>& before) const;

  int columns_, rows_;
  std::vector<std::vector<float>> scales_;
  std::vector<Vectors> vectors_;  // from the second frame on
};

}  // namespace pac::mpeg1
