// Entropy coding [T.81 F.1.2]: quantized blocks -> tokens (a Huffman symbol with its extra bits) -> histogram -> bits.
// Tokens let the optimal tables be made without transforming or scanning any block twice.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "jpeg/byte_sink.h"
#include "jpeg/frame.h"
#include "jpeg/huffman.h"

namespace pac::jpeg {

// The four tables of a scan: DC and AC, for the first component (0) and the others (1).
enum TableIndex : uint32_t { kDc0 = 0, kAc0 = 1, kDc1 = 2, kAc1 = 3 };
constexpr int kTableCount = 4;

// extra bits in 0..15 (16 bits; DC and AC need at most 11), symbol in 16..23, TableIndex in 24..25, or bit 31: RSTm
// with m in the low bits.
using Token = uint32_t;
constexpr Token kRestartToken = 0x80000000u;
constexpr size_t kMaxTokensInBlock = 66;  // DC, 63 AC, and EOB; fewer AC make room for each ZRL

struct Histogram {
  uint64_t count[kTableCount][256] = {};
};

// The tokens of one block. levels: 64 in zigzag order; bit k of `nonzero`: level k is not 0. dc_difference: DIFF,
// within
// +-2047. |AC| <= 1023. dc_table: kDc0 or kDc1 (its AC table follows). Returns the end of what it wrote.
Token* tokenize_block(const int16_t* levels, uint64_t nonzero, int dc_difference, uint32_t dc_table, Token* out);

void add_to_histogram(const Token* begin, const Token* end, Histogram& histogram);

struct ScanTables {
  HuffmanSpec spec[kTableCount];
};
ScanTables standard_tables();
ScanTables optimal_tables(const Histogram& histogram);

// Writes tokens as bits with the 0xFF bytes stuffed [T.81 B.1.1.5]. Call finish() at the end of the scan.
class ScanWriter {
 public:
  explicit ScanWriter(ByteSink& sink) : sink_(sink) {}
  // Before the first write.
  void set_tables(const ScanTables& tables);
  void write(const Token* begin, const Token* end);
  // Pads the last byte with ones [T.81 F.1.2.3].
  void finish();

 private:
  static constexpr size_t kChunk = 16384;
  static constexpr size_t kMaxFlush = 18;  // bytes that one put or flush adds at most: 8 stuffed ones, a marker

  // The state of the bit buffer, in a local copy while tokens are written.
  struct Bits {
    uint64_t pending = 0;  // the low n_pending bits wait for the rest of their 8 bytes; above them may be old ones
    int n_pending = 0;     // 0..64
    uint8_t* out = nullptr;
  };
  static void put(Bits& bits, uint32_t value, int count);
  static void put_bytes(Bits& bits, uint64_t value, int n_bytes);
  static void pad_to_byte(Bits& bits);
  void flush_chunk(Bits& bits);

  uint32_t code_and_length_[kTableCount * 256] = {};
  ByteSink& sink_;
  Bits bits_;
  uint8_t chunk_[kChunk + kMaxFlush];
};

}  // namespace pac::jpeg
