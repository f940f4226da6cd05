// PGM and PPM files, plain and raw (P2, P3, P5, P6) [netpbm pgm(5), ppm(5)].
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/image.h"
#include "base/result.h"

namespace pac {

struct PnmHeader {
  int width = 0, height = 0;  // pixels, >= 1
  int maxval = 0;             // 1..65535
  bool is_rgb = false;        // PPM, else PGM
  bool is_plain = false;      // samples as decimal text
  size_t data_offset = 0;     // of the first sample's byte
};

// True if the bytes begin with P2, P3, P5 or P6 and white space or a comment.
bool is_pnm(std::span<const uint8_t> bytes);

// The header with its comments; the samples may be missing.
Result<PnmHeader> read_pnm_header(std::span<const uint8_t> bytes);

// The first picture of the file (what follows it is ignored). Samples become (v * 255 + maxval / 2) / maxval. Gray is
// spread to three channels; decode_pgm takes PGM only (else unsupported). Fails with truncated, corrupt (a sample over
// maxval among others), unsupported (P1, P4) or limit_exceeded.
Result<RgbImage> decode_pnm_rgb(std::span<const uint8_t> bytes, const Limits& limits = {});
Result<GrayImage> decode_pgm(std::span<const uint8_t> bytes, const Limits& limits = {});

// Raw files with maxval 255. Sides >= 1.
std::vector<uint8_t> encode_ppm(ConstRgbView image);
std::vector<uint8_t> encode_pgm(PlaneView<const uint8_t> image);

}  // namespace pac
