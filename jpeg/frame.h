// Geometry of a frame [T.81 A.1, A.2]: how many samples, blocks and MCUs each component has. Encoder and decoder share
// it.
#pragma once

#include <cstdint>

namespace pac::jpeg {

constexpr int kMaxComponents = 4;
constexpr int kMaxBlocksInMcu = 10;  // [T.81 B.2.3]

// n / d rounded up, n >= 0.
constexpr int ceil_div(int n, int d) {
  return (n + d - 1) / d;
}

struct Component {
  uint8_t id = 0;           // C_i
  uint8_t h = 1, v = 1;     // H_i, V_i: sampling factors, 1..4
  uint8_t quant_table = 0;  // Tq_i
  // Filled by finish_frame:
  int width = 0, height = 0;                // samples: x_i, y_i
  int width_blocks = 0, height_blocks = 0;  // that hold at least one sample
  int padded_width_blocks = 0;              // whole MCUs of an interleaved scan
  int padded_height_blocks = 0;
};

struct Frame {
  int width = 0, height = 0;  // X, Y: pixels, 1..65535
  int n_components = 0;       // Nf
  Component components[kMaxComponents];
  // Filled by finish_frame:
  int h_max = 1, v_max = 1;
  int mcus_per_row = 0, mcu_rows = 0;  // of an interleaved scan of all components
};

// Computes what follows from sizes and sampling factors [T.81 A.1.1, A.2.4]. A lone component is never interleaved:
// its MCU is one block whatever its factors, but they still scale nothing since h = h_max.
inline void finish_frame(Frame& frame) {
  frame.h_max = frame.v_max = 1;
  for (int i = 0; i < frame.n_components; ++i) {
    const Component& c = frame.components[i];
    frame.h_max = c.h > frame.h_max ? c.h : frame.h_max;
    frame.v_max = c.v > frame.v_max ? c.v : frame.v_max;
  }
  frame.mcus_per_row = ceil_div(frame.width, 8 * frame.h_max);
  frame.mcu_rows = ceil_div(frame.height, 8 * frame.v_max);
  for (int i = 0; i < frame.n_components; ++i) {
    Component& c = frame.components[i];
    c.width = ceil_div(frame.width * c.h, frame.h_max);
    c.height = ceil_div(frame.height * c.v, frame.v_max);
    c.width_blocks = ceil_div(c.width, 8);
    c.height_blocks = ceil_div(c.height, 8);
    c.padded_width_blocks = frame.mcus_per_row * c.h;
    c.padded_height_blocks = frame.mcu_rows * c.v;
  }
}

}  // namespace pac::jpeg
