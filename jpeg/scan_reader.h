// Entropy decoding [T.81 F.2.2]: a sticky bit reader over one restart interval at a time, and blocks of levels from it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "jpeg/huffman.h"

namespace pac::jpeg {

// Bits of entropy-coded data with the stuffed zero bytes removed. At a marker or at the end of the file it stops and
// delivers zeros; overrun() tells, at any later time, that some of those were consumed.
class EntropyReader {
 public:
  EntropyReader(std::span<const uint8_t> file, uint64_t offset)
      : begin_(file.data()), next_(file.data() + offset), end_(file.data() + file.size()) {}

  // At least 56 bits are in the reservoir afterwards.
  void refill() {
    if (n_bits_ >= 48) return;
    if (end_ - next_ >= 8) {
      uint64_t bytes = 0;
      for (int i = 0; i < 8; ++i) bytes = bytes << 8 | next_[i];
      // A byte is 0xFF where its complement is zero: the classic test for a zero byte, on ~bytes.
      if (((~bytes - 0x0101010101010101u) & bytes & 0x8080808080808080u) == 0) {
        reservoir_ |= bytes >> n_bits_;
        next_ += (63 - n_bits_) >> 3;
        n_bits_ |= 56;
        return;
      }
    }
    refill_bytewise();
  }
  // The next `count` bits, 1..32, of those that refill() fetched.
  uint32_t peek(int count) const { return static_cast<uint32_t>(reservoir_ >> (64 - count)); }
  void skip(int count) {
    reservoir_ <<= count;
    n_bits_ -= count;
  }
  uint32_t read(int count) {
    const uint32_t bits = peek(count);
    skip(count);
    return bits;
  }

  bool overrun() const { return n_padding_bits_ > n_bits_; }
  // Position of the next byte that holds unread bits; after the last bit: of the marker (or end of the file).
  uint64_t byte_offset() const;
  // Drops the bits of the current byte and goes on with the byte at `offset`.
  void restart_at(uint64_t offset);

 private:
  void refill_bytewise();

  const uint8_t* begin_;
  const uint8_t* next_;
  const uint8_t* end_;
  uint64_t reservoir_ = 0;      // unread bits, left-aligned; below them may be bits that next_ delivers again
  int n_bits_ = 0;              // unread bits in it
  int64_t n_padding_bits_ = 0;  // zeros appended since the data ended
};

enum class BlockError : uint8_t { none, undefined_code, past_end, undefined_symbol };

// Reads one block's levels into `levels` (64 in natural order, all zero before). `dc` is PRED, updated (wraps modulo
// 2^16). Returns the zigzag position of the last level read in *last. On an error the levels read so far stay.
BlockError read_block(EntropyReader& reader, const HuffmanDecoder& dc_table, const HuffmanDecoder& ac_table, int& dc,
                      int16_t* levels, uint8_t& last);

}  // namespace pac::jpeg
