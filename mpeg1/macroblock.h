// What the encoder decided about each macroblock of a picture: made by macroblock_coder, written by slice_writer.
#pragma once

#include <cstdint>
#include <vector>

#include "mpeg1/mpeg1.h"

namespace pac::mpeg1 {

enum class MacroblockKind : uint8_t { skipped, inter, intra };

struct Macroblock {
  MacroblockKind kind = MacroblockKind::skipped;
  uint8_t pattern = 0;       // coded_block_pattern, of inter
  uint8_t quantizer = 1;     // quantizer_scale, where there are coefficients
  MotionVector vector;       // of inter; zero otherwise
  int16_t dc[6] = {};        // quantized, of intra: 0..255
  uint8_t counts[6] = {};    // tokens of each block, its end included
  uint32_t first_token = 0;  // in the band's tokens
};

// What stands in the stream for a coefficient after a run of zeros, or end_of_block: code << 5 | length, of 2..28 bits.
using Token = uint32_t;

class CoefficientStatistics;

// Macroblock rows that are coded from top to bottom, each after the one above: what they know of one another ends at
// the band's. How a picture is divided depends on its size only.
struct Band {
  int first_row = 0, end_row = 0;
  std::vector<Token> tokens;
  int last_quantizer = 0;  // of the last macroblock with coefficients in the rows so far and their slice; 0: none
  CoefficientStatistics* statistics = nullptr;  // of its coefficients, where anybody asks
};

}  // namespace pac::mpeg1
