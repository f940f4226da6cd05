// Entropy coding [T.81 F.1.2], in one of two ways: quantized blocks -> bits at once, with tables known before; or
// blocks -> tokens (a Huffman symbol with its extra bits) and a histogram -> bits, so that optimal tables are made
// without transforming or scanning any block twice.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "jpeg/block_walker.h"
#include "jpeg/byte_sink.h"
#include "jpeg/huffman.h"
#include "jpeg/jpeg.h"

namespace pac::jpeg {

// The four tables of a scan: DC and AC, for the first component (0) and the others (1).
enum TableIndex : uint32_t { kDc0 = 0, kAc0 = 1, kDc1 = 2, kAc1 = 3 };
constexpr int kTableCount = 4;

// extra bits in 0..15 (16 bits; DC and AC need at most 11), symbol in 16..23, TableIndex in 24..25, or bit 31: RSTm
// with m in the low bits.
using Token = uint32_t;
constexpr Token kRestartToken = 0x80000000u;
constexpr size_t kMaxTokensInBlock = 66;  // DC, 63 AC, and EOB; fewer AC make room for each ZRL

// Grows without filling what it grows by; keeps its memory.
class TokenBuffer {
 public:
  void clear() { size_ = 0; }
  // Room for n more tokens behind the last one; what is written there counts after set_end().
  Token* reserve(size_t n);
  void set_end(const Token* end) { size_ = static_cast<size_t>(end - tokens_.get()); }
  const Token* begin() const { return tokens_.get(); }
  const Token* end() const { return tokens_.get() + size_; }

 private:
  std::unique_ptr<Token[]> tokens_;
  size_t size_ = 0, capacity_ = 0;
};

struct Histogram {
  uint32_t count[kTableCount][256] = {};
};

// The tokens of one block. levels: 64 in zigzag order (null: DIFF alone); bit k of `nonzero`: level k is not 0.
// dc_difference: DIFF, within +-2047. |AC| <= 1023. dc_table: kDc0 or kDc1 (its AC table follows). Counts them in
// `histogram`. Returns the end of what it wrote.
Token* tokenize_block(const int16_t* levels, uint64_t nonzero, int dc_difference, uint32_t dc_table,
                      Histogram& histogram, Token* out);

struct ScanTables {
  HuffmanSpec spec[kTableCount];
};
ScanTables standard_tables();
ScanTables difference_tables();
// Those that need no look at the image: difference_tables() where asked for, else the standard ones.
ScanTables fixed_tables(Huffman huffman);
ScanTables optimal_tables(const Histogram& histogram);

// Writes blocks or tokens as bits with the 0xFF bytes stuffed [T.81 B.1.1.5]. Reusable: keeps what it derived from the
// last tables. begin(), then write_mcu_row() or write(), then finish().
class ScanWriter {
 public:
  ScanWriter();
  ScanWriter(ScanWriter&&) noexcept;
  ScanWriter& operator=(ScanWriter&&) noexcept;
  ~ScanWriter();

  // direct: write_mcu_row() will be called, which needs larger tables.
  void begin(const ScanTables& tables, bool direct, ByteSink& sink);
  // As the tokens of that MCU row written. MCU rows in order, `walker` at the start of the scan before the first.
  void write_mcu_row(int mcu_row, const Levels& levels, BlockWalker& walker);
  void write(const Token* begin, const Token* end);
  // Pads the last byte with ones [T.81 F.1.2.3].
  void finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pac::jpeg
