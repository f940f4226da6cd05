// Levels of whole MCU rows -> tokens [T.81 F.1.2].
#pragma once

#include <cstdint>

#include "jpeg/block_walker.h"
#include "jpeg/scan_writer.h"

namespace pac::jpeg {

// Tokens of MCU rows, and how often each symbol occurs. Keeps its buffer from scan to scan.
class Tokenizer {
 public:
  // first_row: of the MCU rows to come; a restart marker stands before it, or the scan begins with it.
  void reset(const Frame& frame, int restart_interval_mcus, int first_row = 0);
  // The next row's blocks are predicted as a scan's first ones are.
  void restart_predictions() { walker_.reset(*frame_, restart_interval_mcus_); }
  void add_mcu_row(int mcu_row, const Levels& levels);

  const Token* begin() const { return tokens_.begin(); }
  const Token* end() const { return tokens_.end(); }
  // Adds to the counts in `to`.
  void add_histogram(Histogram& to) const;

 private:
  const Frame* frame_ = nullptr;
  int restart_interval_mcus_ = 0;
  BlockWalker walker_;
  TokenBuffer tokens_;
  Histogram counts_[2];  // of every other block: equal symbols in a row would wait for one counter
};

}  // namespace pac::jpeg
