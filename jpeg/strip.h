// First half of the encoder: image -> one MCU row at a time -> component samples -> DCT coefficients.
#pragma once

#include <cstdint>
#include <vector>

#include "base/image.h"
#include "base/kernels/kernels.h"
#include "jpeg/frame.h"
#include "jpeg/general_strip.h"
#include "jpeg/jpeg.h"

namespace pac::jpeg {

// Sampling factors, ids 1..3 and quantization table numbers as JFIF wants them.
SamplingFactors factors_of(Subsampling subsampling);
Frame make_frame(int width, int height, int n_components, const SamplingFactors& sampling);
Frame make_frame(int width, int height, Subsampling subsampling);
Frame make_frame(const SourceImage& image, const EncodeOptions& options);

// Cuts an image into MCU rows. Samples past the right and bottom edge repeat the last column, and the last
// *downsampled* row, as the IJG software does. Keeps its buffers from image to image.
class StripTransform {
 public:
  void reset(const Frame& frame, const SourceImage& image, const Kernels& kernels);

  // Coefficients (scaled by 8, natural order) of the real blocks of component c in MCU row `mcu_row`: `rows_of_blocks`
  // rows of frame.components[c].width_blocks blocks, to out[c].
  void transform(int mcu_row, int16_t* const (&out)[3]);

  // The same, quantized: levels in zigzag order and masks, as BlockKernels::quantize has them. quantizers: of the first
  // component, of the others.
  void quantize(int mcu_row, const BlockQuantizer (&quantizers)[2], int16_t* const (&levels)[3],
                uint64_t* const (&nonzero)[3]);

  // Rows of real blocks that component c has in that MCU row: v, or fewer at the bottom.
  static int rows_of_blocks(const Component& c, int mcu_row);

 private:
  struct Plane {
    std::vector<uint8_t> samples;
    ptrdiff_t stride = 0;
    uint8_t* row(int y) { return samples.data() + y * stride; }
  };
  void load(int mcu_row);
  void load_420(int mcu_row);
  void repeat_last_rows(int n_rows);
  void load_row(int y, uint8_t* luma, uint8_t* cb, uint8_t* cr) const;

  Frame frame_;
  SourceImage image_;
  const Kernels* kernels_ = nullptr;
  Plane planes_[3];             // one MCU row of each component, whole blocks wide
  Plane full_chroma_[2];        // a row of Cb and Cr before downsampling
  GeneralStrip general_;        // where the source or the sampling is none of the usual ones
  std::vector<uint8_t> spare_;  // rows that are computed and not wanted (chroma of a gray encoding)
};

}  // namespace pac::jpeg
