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
  uint8_t counts[6] = {};    // tokens of each block
  uint32_t first_token = 0;  // in the band's tokens
};

// One coefficient after a run of zeros: run 0..63, level -255..255 but not 0.
using Token = uint16_t;
inline Token make_token(int run, int level) {
  return static_cast<Token>(run << 9 | (level + 256));
}
inline int token_run(Token token) {
  return token >> 9;
}
inline int token_level(Token token) {
  return (token & 511) - 256;
}

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
