// Where the decoder's finished rows go: an RGB image, pixels of any format, or a callback.
#pragma once

#include <cstdint>
#include <vector>

#include "base/image.h"
#include "jpeg/component_planes.h"
#include "jpeg/picture_window.h"
#include "jpeg/pixels.h"

namespace pac::jpeg {

// One of the three; views have the window's size.
struct RowTarget {
  RgbView rgb;
  PixelView pixels;
  const RowSink* sink = nullptr;
  PixelFormat format = PixelFormat::rgb;  // for the sink
};

class RowOutput {
 public:
  // first_column: pixel of the scaled picture where what `planes` writes begins (see ComponentPlanes::narrow); width:
  // of what it writes. The target must outlive the use.
  void start(const RowTarget& target, const Crop& window, int first_column, int width, ColorModel color);

  // Rows [begin, end) of the scaled picture can be made. Takes those that lie in the window.
  void rows_ready(int begin, int end, ComponentPlanes& planes);
  // The sink wants no more.
  bool is_stopped() const { return is_stopped_; }

 private:
  const uint8_t* rgb_row(int y, ComponentPlanes& planes);
  void write_row(int y, ComponentPlanes& planes);

  RowTarget target_;
  Crop window_;
  ColorModel color_ = ColorModel::unknown;
  int skipped_ = 0, row_width_ = 0;
  bool is_stopped_ = false;
  std::vector<uint8_t> rgb_, converted_;  // one row each
};

}  // namespace pac::jpeg
