// One MPEG-1 picture as the elements of its syntax: bits in, bits out. For whoever codes the same elements another way
// (sim/picture_packing.h).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/file_io.h"
#include "mpeg1/macroblock.h"
#include "mpeg1/mpeg1.h"

namespace pac::sim {

// A coefficient after a run of zeros: run 0..63, level -255..255 but not 0.
struct RunLevel {
  uint8_t run;
  int16_t level;
};

struct PictureSyntax {
  mpeg1::PictureHeader header;
  std::vector<mpeg1::Macroblock> macroblocks;  // raster order; `counts` and `first_token` are of `levels`
  std::vector<RunLevel> levels;                // of all of them
};

// `bytes`: a picture header and one slice of the whole picture of columns x rows macroblocks, I or P, nothing behind
// them. False where they are anything else; `picture` then holds nothing of use.
bool read_picture(std::span<const uint8_t> bytes, int columns, int rows, PictureSyntax& picture);

// Appends what read_picture() read, as mpeg1::Encoder writes it.
void write_picture(const PictureSyntax& picture, int columns, int rows, Bytes& out);

}  // namespace pac::sim
