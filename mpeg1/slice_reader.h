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

// One matrix for reading: what levels become [2.4.4.1].
struct Dequantizer {
  uint16_t scaled[32][64] = {};  // quantizer_scale times the matrix, zigzag order, for each scale 1..31
  bool is_flat = false;          // non-intra, all entries equal: the value depends on the level alone
  int16_t values[32][512] = {};  // then, of level -255..255 at [256 + level]
};
void make_dequantizer(const QuantizerMatrix& matrix, bool is_intra, Dequantizer& dequantizer);

// How a macroblock of a picture came about. kept, copied: a copy of what the picture's forward reference shows there,
// the last reference picture or a caller's.
enum Coverage : uint8_t { kMissing = 0, kDecoded = 1, kKept = 2, kCopied = kCopiedMacroblock };

// What all slices of a picture share. `covered` has a Coverage a macroblock.
//
// The target of a P picture holds the reference picture before last, of which the last one kept some macroblocks:
// there the target shows already what the forward reference shows. `kept_before`, if not null, tells where.
struct PictureContext {
  const MotionKernels* kernels = nullptr;
  PictureHeader header;
  int columns = 0, rows = 0;  // macroblocks
  Planes target, forward, backward;
  const Dequantizer* intra = nullptr;
  const Dequantizer* non_intra = nullptr;
  std::vector<uint8_t>* covered = nullptr;
  const uint8_t* kept_before = nullptr;
  Coverage skipped = kDecoded;  // what a skipped macroblock of a P picture is
};

// Reconstructs the macroblocks of slices.
class SliceReader {
 public:
  explicit SliceReader(const PictureContext& picture);
  // The context describes another picture.
  void start_picture();

  // `bytes` begin after the slice start code and end before the next start code; row = slice_vertical_position - 1,
  // inside the picture. Null, or what is wrong: the macroblocks before it stand.
  const char* read(std::span<const uint8_t> bytes, int row);

  // Of the violation, from the slice's first byte.
  uint64_t byte_offset() const { return static_cast<uint64_t>(bits_.position_bits()) / 8; }

 private:
  // Blocks that wait for their transform, of some macroblocks: in pairs and well after their coefficients were stored.
  static constexpr size_t kWaiting = 20;
  struct Pending {
    size_t n = 0;
    uint8_t* samples[kWaiting];
    ptrdiff_t strides[kWaiting];
    alignas(64) int16_t coefficients[kWaiting * 64];  // zeros from 64 * n on
  };
  using Transform = void (*)(const int16_t*, size_t, uint8_t* const*, const ptrdiff_t*);
  // The first `keep` of them; all wait no longer.
  static void transform(Transform transform, Pending& pending, size_t keep);
  void transform_all();

  bool fail(const char* text) {
    error_ = text;
    return false;
  }
  // All that reads takes the reader of the slice, and is part of read_macroblocks(), where it lives in registers.
  const char* read_macroblocks(std::span<const uint8_t> bytes);
  bool read_slice_header(UnitReader& bits);
  bool read_macroblock(UnitReader& bits);
  bool read_address(UnitReader& bits, int& address);
  bool read_quantizer(UnitReader& bits);
  bool read_vectors(UnitReader& bits);
  bool read_component(UnitReader& bits, int r_size, int16_t& component);
  bool read_dc(UnitReader& bits, int block, int& dc);
  bool read_intra_blocks(UnitReader& bits);
  template <class Dequantize>
  bool read_coded_blocks(UnitReader& bits, int pattern, const Dequantize& dequantize);

  bool skip_macroblocks(int count);
  void keep_macroblocks(int first, int count);
  bool shows_reference(int address) const;
  void give_up_macroblock();
  void predict();
  void reset_dc() { dc_[0] = dc_[1] = dc_[2] = 1024; }
  void reset_vectors() { vectors_[0] = vectors_[1] = {}; }
  void advance(int count);
  // Where block 0..5 of the macroblock lies.
  uint8_t* samples_of(int block) const {
    return picture_.target.data[plane_of(block)] + row_offsets_[block] + (block < 4 ? 16 : 8) * column_;
  }
  static int plane_of(int block) { return block < 4 ? 0 : block - 3; }

  const PictureContext& picture_;
  ptrdiff_t offsets_[6] = {}, strides_[6] = {};  // of each block: from its macroblock's first sample of the plane
  ptrdiff_t row_offsets_[6] = {};                // from the plane's first sample to that of the row's first block
  uint8_t* covered_ = nullptr;                   // the picture's
  const uint8_t* kept_before_ = nullptr;         // the picture's, until something went wrong
  UnitReader bits_;                              // where the last slice's reader stopped
  const char* error_ = nullptr;
  int address_ = 0, column_ = 0, row_ = 0;  // address_ = row_ * columns + column_
  int quantizer_ = 1;
  uint8_t flags_ = 0;        // macroblock_type of the macroblock, and of the one before for B's skipped ones
  int dc_[3] = {};           // predictions, times 8 [2.4.4.1]
  MotionVector vectors_[2];  // forward, backward: predictions, in the units of the stream
  Pending inter_, intra_;    // to be added to predictions, to be put
};

}  // namespace pac::mpeg1
