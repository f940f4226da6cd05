// One slice: macroblock headers, motion vectors, blocks, reconstruction [11172-2 2.4.2.6 to 2.4.2.8, 2.4.4].
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/kernels/kernels.h"
#include "mpeg1/bit_reader.h"
#include "mpeg1/mpeg1.h"
#include "mpeg1/predict.h"

namespace pac::mpeg1 {

// quantizer_scale times the matrix, in zigzag order, for each scale 1..31.
using ScaledMatrices = std::array<std::array<uint16_t, 64>, 32>;
void scale_matrix(const QuantizerMatrix& matrix, ScaledMatrices& scaled);

// What all slices of a picture share. `covered` has a byte a macroblock: 1 once reconstructed.
struct PictureContext {
  const MotionKernels* kernels = nullptr;
  PictureHeader header;
  int columns = 0, rows = 0;  // macroblocks
  Planes target, forward, backward;
  const ScaledMatrices* intra = nullptr;
  const ScaledMatrices* non_intra = nullptr;
  std::vector<uint8_t>* covered = nullptr;
};

// Reconstructs the macroblocks of one slice.
class SliceReader {
 public:
  explicit SliceReader(const PictureContext& picture) : picture_(picture) {}

  // `bytes` begin after the slice start code and end before the next start code; row = slice_vertical_position - 1,
  // inside the picture. Null, or what is wrong: the macroblocks before it stand.
  const char* read(std::span<const uint8_t> bytes, int row);

  // Of the violation, from the slice's first byte.
  uint64_t byte_offset() const { return static_cast<uint64_t>(bits_.position_bits()) / 8; }

 private:
  // A block waiting for its transform.
  struct Pending {
    alignas(64) int16_t coefficients[6 * 64];
    uint8_t* samples[6];
    ptrdiff_t strides[6];
    size_t count = 0;
  };

  bool fail(const char* text) {
    error_ = text;
    return false;
  }
  bool read_macroblock();
  bool read_address(int& address);
  bool skip_macroblocks(int from, int to);
  bool read_quantizer();
  bool read_vector(int direction, bool full_pel, int f_code);
  bool read_component(int r_size, int16_t& component);
  bool read_vectors(uint8_t flags);
  bool read_dc(int block, int& dc);
  template <bool kIsIntra>
  int read_coefficients(const uint16_t* scaled, int position, int16_t* coefficients);
  bool read_intra_blocks();
  bool read_coded_blocks(int pattern);
  void predict();
  void reset_dc() { dc_[0] = dc_[1] = dc_[2] = 1024; }
  void reset_vectors() { vectors_[0] = vectors_[1] = {}; }
  void place(int block, uint8_t*& samples, ptrdiff_t& stride) const;

  const PictureContext& picture_;
  UnitReader bits_;
  const char* error_ = nullptr;
  int address_ = 0, column_ = 0, row_ = 0;
  int quantizer_ = 1;
  uint8_t flags_ = 0;        // macroblock_type of the macroblock, and of the one before for B's skipped ones
  int dc_[3] = {};           // predictions, times 8 [2.4.4.1]
  MotionVector vectors_[2];  // forward, backward: predictions, in the units of the stream
  Pending pending_;
};

}  // namespace pac::mpeg1
