// Levels of whole MCU rows -> tokens in scan order [T.81 A.2.3, F.1.2], with DC prediction and restart markers.
#pragma once

#include <cstdint>
#include <vector>

#include "jpeg/frame.h"
#include "jpeg/scan_writer.h"

namespace pac::jpeg {

// One MCU row of quantized blocks: of component c, in rows of width_blocks.
struct Levels {
  std::vector<int16_t> zigzag[3];    // 64 a block
  std::vector<uint64_t> nonzero[3];  // one mask a block
};

class Tokenizer {
 public:
  // At the start of a scan. `frame` must outlive the use.
  void reset(const Frame& frame, int restart_interval_mcus);
  // MCU rows in order.
  void add_mcu_row(int mcu_row, const Levels& levels, std::vector<Token>& tokens);

 private:
  Token* restart_if_due(Token* out);
  Token* add_component(int c, int mcu_row, int mcu, const Levels& levels, Token* out);

  const Frame* frame_ = nullptr;
  int restart_interval_ = 0, to_restart_ = 0;
  uint32_t next_restart_ = 0;
  int dc_[3] = {0, 0, 0};
};

}  // namespace pac::jpeg
