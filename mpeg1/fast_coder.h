// Macroblocks at Effort::fast: one prediction each, one pass over its levels.
#pragma once

#include "mpeg1/macroblock_place.h"

namespace pac::mpeg1 {

class FastCoder : private MacroblockPlace {
 public:
  FastCoder(const PictureTask& task, Band& band) : MacroblockPlace(task, band) {}

  enum class Outcome : uint8_t {
    done,
    intra,     // nothing was coded: the macroblock is better off without a prediction
    too_large  // nothing was coded: a level has no code at this quantizer; vector() predicts
  };
  Outcome code(int column, int row);
  // Without a prediction; done or too_large.
  Outcome code_intra(int column, int row);
  MotionVector vector() const { return vector_; }

 private:
  bool stays(const uint32_t (&quarters)[4]) const;
  void keep_reference();
  MotionVector search(uint32_t still_sad, uint32_t& sad) const;
  Outcome code_errors();
  void start_blocks();
  template <bool kIsIntra>
  bool choose_levels(int block, const int16_t* levels, uint64_t nonzero);
  bool is_worth_coding() const;
  uint8_t* samples_of(int block) const;
  ptrdiff_t stride_of(int block) const { return task_.target.stride[block < 4 ? 0 : block - 3]; }
  template <class Transform>
  void transform_full(Transform&& transform) const;
  void reconstruct() const;
  void describe();
  void append_tokens(Macroblock& macroblock);

  MotionVector vector_;
  // Of the blocks with levels, in the order of the stream.
  struct Coded {
    int n_tokens = 0;
    int64_t saved = 0;  // distortion that the levels take away, less what their bits are worth
    uint8_t pattern = 0;
    uint8_t counts[kBlocks] = {};
    Token tokens[65 * kBlocks];
    // Flat blocks have nothing but the first coefficient; the others' coefficients lie in their order.
    size_t n_flat = 0, n_full = 0;
    uint8_t flat_blocks[kBlocks] = {}, full_blocks[kBlocks] = {};
    int16_t flat[kBlocks] = {};
    alignas(64) int16_t coefficients[64 * kBlocks];
  } coded_;
  alignas(64) int16_t dct_[64 * kBlocks];
};

}  // namespace pac::mpeg1
