// Levels of whole MCU rows -> tokens [T.81 F.1.2].
#pragma once

#include <cstdint>

#include "jpeg/block_walker.h"
#include "jpeg/scan_writer.h"

namespace pac::jpeg {

// Tokens of MCU rows, and how often each symbol occurs. Keeps its buffer from scan to scan.
class Tokenizer {
 public:
  void reset(const Frame& frame, int restart_interval_mcus);
  void add_mcu_row(int mcu_row, const Levels& levels);

  const Token* begin() const { return tokens_.begin(); }
  const Token* end() const { return tokens_.end(); }
  Histogram histogram() const { return merged(counts_[0], counts_[1]); }

 private:
  static Histogram merged(const Histogram& a, const Histogram& b);

  const Frame* frame_ = nullptr;
  BlockWalker walker_;
  TokenBuffer tokens_;
  Histogram counts_[2];  // of every other block: equal symbols in a row would wait for one counter
};

}  // namespace pac::jpeg
