// The DCT coefficients of an image: a strip at a time for one pass, or all of them for the encoders that look twice.
#pragma once

#include <cstdint>
#include <vector>

#include "jpeg/block_walker.h"
#include "jpeg/strip.h"

namespace pac::jpeg {

class CoefficientSource {
 public:
  // Serves the MCU rows [first_row, end_row). keep_all: transform all of them now; else each MCU row when row() asks
  // for it. Keeps its buffers.
  void reset(const SourceImage& image, const Frame& frame, const Kernels& kernels, bool keep_all, int first_row,
             int end_row);

  const Frame& frame() const { return frame_; }
  // Makes the blocks of that MCU row available through row(). Without keep_all: any earlier row is gone.
  void load(int mcu_row);
  // Levels of that MCU row, rounded; row() tells nothing then without keep_all. quantizers: luma, chroma.
  void quantize(int mcu_row, const BlockQuantizer (&quantizers)[2], Levels& levels);
  // Coefficients (scaled by 8, natural order) of the real blocks of component c in the loaded MCU row.
  const int16_t* row(int c) const { return row_[c]; }
  size_t n_blocks(int c, int mcu_row) const {
    const Component& component = frame_.components[c];
    return static_cast<size_t>(StripTransform::rows_of_blocks(component, mcu_row)) *
           static_cast<size_t>(component.width_blocks);
  }

 private:
  int16_t* strip(int c, int mcu_row);

  Frame frame_;
  StripTransform strips_;
  const Kernels* kernels_ = nullptr;
  bool keep_all_ = false;
  int first_row_ = 0;
  std::vector<int16_t> coefficients_[3];
  const int16_t* row_[3] = {};
};

}  // namespace pac::jpeg
