// The quantized DCT coefficients of a file, read and written without going to pixels: what lossless transcoding,
// editing in the transform domain and requantization need.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "jpeg/jpeg.h"

namespace pac::jpeg {

// One component. Blocks in rows; whole MCUs of the frame, so up to 3 rows and columns more than the picture needs.
struct CoefficientPlane {
  uint8_t id = 1;        // any, distinct
  uint8_t h = 1, v = 1;  // sampling factors, 1..4
  QuantTable steps{};    // natural order, 1..65535
  int width_blocks = 0, height_blocks = 0;
  std::vector<int16_t> levels;  // 64 a block, natural order; DC itself, not its difference

  int16_t* block(int x, int y) { return levels.data() + 64 * index(x, y); }
  const int16_t* block(int x, int y) const { return levels.data() + 64 * index(x, y); }

 private:
  size_t index(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(width_blocks) + static_cast<size_t>(x);
  }
};

struct CoefficientImage {
  int width = 0, height = 0;  // pixels, 1..65535
  ColorModel color = ColorModel::ycc;
  std::vector<CoefficientPlane> components;  // 1, 3 or 4
};

struct CoefficientsRead {
  CoefficientImage image;
  std::optional<Failure> failure;  // lenient: the first thing wrong
  int errors = 0, warnings = 0;    // as LenientImage
};

// Of a baseline, extended sequential or progressive file. options: limits and isa alone count. Errors: as decode(), or
// with `lenient` as decode_lenient().
Result<CoefficientsRead> read_coefficients(std::span<const uint8_t> file, const DecodeOptions& options = {},
                                           bool lenient = false);

struct CoefficientWriteOptions {
  Huffman huffman = Huffman::optimal;
  int restart_interval_mcus = 0;       // 0..65535; 0 = none
  const Metadata* metadata = nullptr;  // see jpeg/metadata.h
};

// A sequential file that decodes to exactly the pixels of those coefficients: baseline where all steps are at most 255,
// else extended (SOF1). One interleaved scan, or one for each component where an MCU would have more than 10 blocks.
// Files that are neither gray nor YCbCr get Adobe's marker instead of JFIF's. Errors: bad_argument (sizes that do not
// fit each other; a level beyond what 8-bit baseline files can hold: AC within +-1023, differences of DC within
// +-2047).
Result<std::vector<uint8_t>> write_coefficients(const CoefficientImage& image,
                                                const CoefficientWriteOptions& options = {});

// Other steps for the first component (and a fourth) and for the others: each level becomes the nearest multiple,
// halves away from 0. Steps 1..255.
void requantize(CoefficientImage& image, const QuantTables& steps);

}  // namespace pac::jpeg
