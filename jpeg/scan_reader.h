// Entropy decoding [T.81 F.2.2]: a sticky bit reader over one restart interval at a time, and blocks of levels from it.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>

#include "jpeg/ac_pairs.h"
#include "jpeg/huffman.h"

namespace pac::jpeg {

// Up to 64 bits that come next, and where further ones are.
struct BitWindow {
  uint64_t reservoir = 0;         // unread bits, left-aligned; below them may be bits that `next` delivers again
  int n_bits = 0;                 // unread bits in it, 0..63
  const uint8_t* next = nullptr;  // the byte that refill() fetches next, and seven more behind it

  // At least 56 bits are in the reservoir afterwards.
  void refill() {
    uint64_t bytes;
    std::memcpy(&bytes, next, 8);
    if constexpr (std::endian::native == std::endian::little) bytes = __builtin_bswap64(bytes);
    reservoir |= bytes >> n_bits;
    next += (63 - n_bits) >> 3;
    n_bits |= 56;
  }
  // The next `count` bits, 1..32, of those that refill() fetched.
  uint32_t peek(int count) const { return static_cast<uint32_t>(reservoir >> (64 - count)); }
  void skip(int count) {
    reservoir <<= count;
    n_bits -= count;
  }
  uint32_t read(int count) {
    const uint32_t bits = peek(count);
    skip(count);
    return bits;
  }
};

// Bits of entropy-coded data. The stuffed zero bytes are taken out some kilobytes at a time, so that reading needs no
// test for them; zeros follow a marker or the end of the file. overrun() tells, at any later time, that some of those
// were consumed.
class EntropyReader {
 public:
  // A block has at most 64 codes of 16 bits with at most 16 extra bits, an MCU 10 blocks; a window looks 16 bytes
  // ahead.
  static constexpr ptrdiff_t kMaxMcuBytes = 10 * 64 * 4 + 16;

  EntropyReader();
  // Entropy-coded data from that offset on. Keeps a pointer to the file's bytes.
  void start(std::span<const uint8_t> file, uint64_t offset);
  // Drops the bits of the current byte and goes on with the byte at `offset`.
  void restart_at(uint64_t offset);

  // Before each MCU: makes sure that kMaxMcuBytes can be read.
  void prepare_mcu() {
    if (end_ - bits.next < kMaxMcuBytes && !is_at_marker_) top_up();
  }
  bool overrun() const { return (bits.next - end_) * 8 > bits.n_bits; }
  // Position of the next byte that holds unread bits; after the last bit: of the marker (or end of the file).
  uint64_t byte_offset() const;

  BitWindow bits;  // to read from; loops take a copy and put it back

 private:
  static constexpr ptrdiff_t kChunk = 24 * 1024;
  static constexpr ptrdiff_t kPadding = kMaxMcuBytes + 16;

  void top_up();

  const uint8_t* file_begin_ = nullptr;
  const uint8_t* file_end_ = nullptr;
  const uint8_t* raw_ = nullptr;       // the file's next byte that is not yet in the buffer
  std::unique_ptr<uint8_t[]> buffer_;  // kChunk + kPadding
  const uint8_t* end_ = nullptr;       // of the data in it; zeros follow if is_at_marker_
  bool is_at_marker_ = false;          // raw_ stands at a marker or at the end of the file
};

enum class BlockError : uint8_t { none, undefined_code, past_end, undefined_symbol };

// A block of each MCU of a sequential scan: what decodes it and where it goes.
struct BlockSlot {
  const HuffmanDecoder* dc_table = nullptr;
  const HuffmanDecoder* ac_table = nullptr;
  const AcPairs* ac_pairs = nullptr;  // made from ac_table, or null: small images are done before the look-up is made
  int* dc = nullptr;                  // PRED, updated (wraps modulo 2^16)
  int16_t* levels = nullptr;          // of the MCU at hand: 64 in natural order, all zero before
  uint8_t* last = nullptr;            // gets the zigzag position of the last level read
  size_t blocks_in_row = 1;           // to the same block of the next MCU
};

// Reads the blocks of MCU number `mcu` of a batch. On an error the levels read so far stay.
BlockError read_mcu_blocks(EntropyReader& reader, std::span<const BlockSlot> slots, size_t mcu);

// One symbol [T.81 F.2.2.3 DECODE], or -1. At least 16 bits must be in the reservoir.
int read_symbol(BitWindow& bits, const HuffmanDecoder& table);

}  // namespace pac::jpeg
