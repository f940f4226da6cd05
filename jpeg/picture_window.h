// Which part of a picture is decoded, and at which scale.
#pragma once

#include <algorithm>
#include <cstdint>

#include "jpeg/frame.h"
#include "jpeg/jpeg.h"

namespace pac::jpeg {

// Scaled geometry [as the IJG software scales]: a block of a component gives 8, 4, 2 or 1 samples squared. Components
// that have fewer samples than others keep up to 8, so that upsampling shrinks before samples are thrown away.
struct ScaledFrame {
  Frame frame;  // sizes in samples, and sampling factors, after scaling; blocks as in the file
  int block_size[kMaxComponents] = {8, 8, 8, 8};
  int scale = 1;  // 1, 2, 4, 8: each side divided by it, rounded up
  int mcu_width() const { return 8 / scale * frame.h_max; }
};

inline ScaledFrame scaled_frame(const Frame& frame, int scale) {
  ScaledFrame scaled;
  scaled.frame = frame;
  scaled.scale = scale;
  const int least = 8 / scale;
  scaled.frame.width = ceil_div(frame.width, scale);
  scaled.frame.height = ceil_div(frame.height, scale);
  for (int i = 0; i < frame.n_components; ++i) {
    const Component& in = frame.components[i];
    Component& out = scaled.frame.components[i];
    int size = least;
    while (size < 8 && frame.h_max * least % (in.h * size * 2) == 0 && frame.v_max * least % (in.v * size * 2) == 0)
      size *= 2;
    scaled.block_size[i] = size;
    out.h = static_cast<uint8_t>(in.h * size / least);
    out.v = static_cast<uint8_t>(in.v * size / least);
    out.width = ceil_div(frame.width * in.h * size, frame.h_max * 8);
    out.height = ceil_div(frame.height * in.v * size, frame.v_max * 8);
  }
  return scaled;
}

// What of the file the window needs, in units of a scan's MCUs: half-open ranges.
struct McuWindow {
  int first_row = 0, end_row = 0, first_column = 0, end_column = 0;
  bool has_row(int row) const { return row >= first_row && row < end_row; }
  bool overlaps_columns(int first, int n) const { return first < end_column && first + n > first_column; }
};

// mcu_width, mcu_height: pixels of the scaled picture. One more MCU on each side: upsampling looks at neighbors.
inline McuWindow mcus_of(const Crop& window, int mcu_width, int mcu_height, int mcus_per_row, int mcu_rows) {
  return {std::max(window.y / mcu_height - 1, 0), std::min((window.y + window.height - 1) / mcu_height + 2, mcu_rows),
          std::max(window.x / mcu_width - 1, 0), std::min((window.x + window.width - 1) / mcu_width + 2, mcus_per_row)};
}

}  // namespace pac::jpeg
