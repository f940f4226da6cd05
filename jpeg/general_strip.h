// Rows of samples for the encoder from any source and in any sampling: other pixel formats than RGB, rows that are
// pulled, planes of samples, and ratios that the usual kernels do not know.
#pragma once

#include <cstdint>
#include <vector>

#include "base/image.h"
#include "base/kernels/kernels.h"
#include "jpeg/frame.h"
#include "jpeg/pixel_io.h"

namespace pac::jpeg {

// Rows pulled one after the other; `failed` once one could not be had (later rows are black).
struct PulledRows {
  const RowSource* source = nullptr;
  bool failed = false;
};

// Exactly one of its sources has data.
struct SourceImage {
  ConstRgbView rgb;
  PlaneView<const uint8_t> gray;
  // The unusual ones:
  ConstPixelView pixels;         // for pulled rows: size and format alone
  PulledRows* pulled = nullptr;  // one reader, in order
  const YccPlanes* planes = nullptr;

  int width() const { return rgb.data ? rgb.width : gray.data ? gray.width : planes ? planes->width : pixels.width; }
  int height() const {
    return rgb.data ? rgb.height : gray.data ? gray.height : planes ? planes->height : pixels.height;
  }
};

inline SourceImage rgb_image(ConstRgbView rgb) {
  SourceImage image;
  image.rgb = rgb;
  return image;
}

class GeneralStrip {
 public:
  void reset(const Frame& frame, const SourceImage& image, const Kernels& kernels);
  // Whether the source is unusual or the sampling none of 4:4:4, 4:2:2, 4:2:0 and gray.
  bool is_needed() const { return is_needed_; }
  // The samples of component c in that MCU row, whole blocks of them; components and MCU rows in order. Past the edges
  // the last column and the last row of samples are repeated.
  void load(int mcu_row, int c, uint8_t* samples, ptrdiff_t stride);

 private:
  struct FullRows {
    std::vector<uint8_t> samples;
    ptrdiff_t stride = 0;
    uint8_t* row(int y) { return samples.data() + y * stride; }
  };
  void load_full(int mcu_row);
  void load_row(int y, uint8_t* luma, uint8_t* cb, uint8_t* cr);
  const uint8_t* source_row(int y);
  int load_plane(int mcu_row, int c, uint8_t* samples, ptrdiff_t stride) const;
  int reduce(int mcu_row, int c, uint8_t* samples, ptrdiff_t stride);
  void average_row(int c, int y, uint8_t* out);

  Frame frame_;
  SourceImage image_;
  const Kernels* kernels_ = nullptr;
  bool is_needed_ = false;
  FullRows full_[3];  // one MCU row at full resolution
  std::vector<uint8_t> rgb_, pulled_row_, spare_;
};

}  // namespace pac::jpeg
