// Where in its picture the macroblock in work is, and what its neighbors tell about it.
#pragma once

#include <algorithm>
#include <cstdlib>

#include "mpeg1/macroblock_coder.h"
#include "mpeg1/motion_search.h"

namespace pac::mpeg1 {

// Bits of macroblock_type in P pictures [table B.2b], address increment of 1 included.
constexpr int kBitsMotionCoded = 2, kBitsCoded = 3, kBitsMotion = 4, kBitsIntra = 6, kBitsSkipped = 1;

constexpr int kMaxCandidates = 16;

// Of SAD a bit, over quantizer_scale / 16: a good prediction saves more than the bits of its levels.
constexpr uint32_t kVectorLambdaQ4 = 8;

class MacroblockPlace {
 protected:
  MacroblockPlace(const PictureTask& task, Band& band)
      : task_(task), band_(band), motion_(task.residual.kernels->motion) {}

  int address() const { return row_ * task_.columns + column_; }
  int quantizer() const { return task_.quantizers[address()]; }
  int64_t lambda() const {
    return task_.lambdas != nullptr ? task_.lambdas[address()] : task_.residual.lambda[quantizer()];
  }
  const uint8_t* source() const { return task_.source.at(0, column_, row_); }
  VectorRange range() const { return vector_range(task_.reference, column_, row_, task_.f_code); }

  MotionVector vector_at(int column, int row) const { return task_.macroblocks[row * task_.columns + column].vector; }

  // What the stream predicts the vector from, as far as the band knows.
  MotionVector predicted_vector() const { return column_ > 0 ? vector_at(column_ - 1, row_) : MotionVector{}; }

  int vector_bits(MotionVector v) const {
    const MotionVector p = predicted_vector();
    return task_.bits_of_difference[std::min(std::abs(v.x_halfpel - p.x_halfpel), kMaxDifference)] +
           task_.bits_of_difference[std::min(std::abs(v.y_halfpel - p.y_halfpel), kMaxDifference)];
  }

  // The caller's, those of the neighbors in the band, those of the picture before. Returns how
  // many.
  int collect_candidates(MotionVector (&candidates)[kMaxCandidates]) const {
    int n = 0;
    const auto add = [&](MotionVector v) {
      if (n < kMaxCandidates) candidates[n++] = v;
    };
    for (int i = 0; i < std::min(task_.candidates_per_macroblock, 8); ++i)
      add(task_.candidates[address() * task_.candidates_per_macroblock + i]);
    if (column_ > 0) add(vector_at(column_ - 1, row_));
    if (row_ > band_.first_row) {
      add(vector_at(column_, row_ - 1));
      if (column_ + 1 < task_.columns) add(vector_at(column_ + 1, row_ - 1));
    }
    if (task_.last_vectors != nullptr) {
      const MotionVector* last = task_.last_vectors + address();
      add(last[0]);
      if (column_ + 1 < task_.columns) add(last[1]);
      if (row_ + 1 < task_.rows) add(last[task_.columns]);
    }
    return n;
  }

  SearchInput search_input(const MotionVector* candidates, int n_candidates) const {
    SearchInput input;
    input.kernels = &motion_;
    input.source = source();
    input.source_stride = task_.source.stride[0];
    input.reference = task_.reference;
    input.column = column_;
    input.row = row_;
    input.range = range();
    input.predicted = predicted_vector();
    input.candidates = candidates;
    input.n_candidates = n_candidates;
    if (task_.ahead_vectors != nullptr) input.far_vector = task_.ahead_vectors + address();
    if (task_.coarse_vectors != nullptr)
      input.far_vector = task_.coarse_vectors + (row_ / 2 * task_.coarse_columns + column_ / 2);
    input.lambda_q4 = kVectorLambdaQ4 * static_cast<uint32_t>(quantizer());
    input.bits_of_difference = task_.bits_of_difference;
    return input;
  }

  // error: of the best prediction, squared, about; against the macroblock's own variation, with `bias` in thousandths.
  bool may_be_intra(uint64_t error, uint64_t bias) const {
    uint32_t sum = 0, sum_of_squares = 0;
    motion_.moments16(source(), task_.source.stride[0], &sum, &sum_of_squares);
    const uint64_t variation = sum_of_squares - static_cast<uint64_t>(sum) * sum / 256;
    return error * bias > (variation + 256 * 16) * 1000;
  }

  // The first and the last macroblock of a slice are never skipped [2.4.4.4].
  bool may_skip() const {
    const bool is_first = column_ == 0 && row_ % task_.slice_rows == 0;
    const bool is_last = column_ == task_.columns - 1 && ((row_ + 1) % task_.slice_rows == 0 || row_ + 1 == task_.rows);
    return !is_first && !is_last;
  }

  const PictureTask& task_;
  Band& band_;
  const MotionKernels& motion_;
  int row_ = 0, column_ = 0;
};

}  // namespace pac::mpeg1
