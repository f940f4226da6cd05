// Bits of slices: headers, macroblock types, vectors, blocks [11172-2 2.4.2.6 to 2.4.2.8].
#pragma once

#include <span>
#include <vector>

#include "mpeg1/bit_writer.h"
#include "mpeg1/macroblock.h"
#include "mpeg1/mpeg1.h"

namespace pac::mpeg1 {

// A macroblock of few bits. Some players (jsmpeg) look for the next start code from the next byte boundary on,
// and never see a slice's last macroblock where it ends before that one: stuffing then leads to the next byte.
struct ShortCode {
  uint32_t bits = 0;
  int length = 0;  // 0: there is none
};

struct PictureToWrite {
  PictureHeader header;
  int columns = 0, rows = 0;                // macroblocks
  int slice_rows = 0;                       // macroblock rows a slice, 1..rows
  const Macroblock* macroblocks = nullptr;  // raster order
};

// Bits of a motion vector component for the prediction of cost, f_code - 1 = r_size.
int motion_bits(int vector, int predicted, int r_size);

// The smallest f_code that reaches every vector of the picture, 1..7.
int needed_f_code(const PictureToWrite& picture);

// The bits before the rows' first slice start code, which go on where the rows before ended, and those from it on.
struct RowBits {
  FastBitWriter head, slices;
  ShortCode tail;  // after head: the last macroblock of the slice that goes on there, where it is as short as that
};
// Writes the macroblocks of rows [first_row, end_row), which are of one band with these tokens. A slice that began in
// an earlier row goes on: what it predicts from is found in the macroblocks before.
void write_rows(const PictureToWrite& picture, const Token* tokens, int first_row, int end_row, RowBits& bits);

// Appends the bits of all rows, in order, slices on byte boundaries.
void join_rows(std::span<const RowBits> rows, std::vector<uint8_t>& out);

}  // namespace pac::mpeg1
