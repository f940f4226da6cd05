#include "jpeg/tokenizer.h"

#include "jpeg/strip.h"

namespace pac::jpeg {

void Tokenizer::reset(const Frame& frame, int restart_interval_mcus) {
  frame_ = &frame;
  restart_interval_ = to_restart_ = restart_interval_mcus;
  next_restart_ = 0;
  for (int& dc : dc_) dc = 0;
}

void Tokenizer::add_mcu_row(int mcu_row, const Levels& levels, std::vector<Token>& tokens) {
  const size_t first = tokens.size();
  size_t n_max = 1;  // a restart marker
  for (int c = 0; c < frame_->n_components; ++c)
    n_max += static_cast<size_t>(frame_->components[c].h * frame_->components[c].v) * kMaxTokensInBlock;
  tokens.resize(first + static_cast<size_t>(frame_->mcus_per_row) * n_max);
  Token* out = tokens.data() + first;
  for (int mcu = 0; mcu < frame_->mcus_per_row; ++mcu) {
    out = restart_if_due(out);
    for (int c = 0; c < frame_->n_components; ++c) out = add_component(c, mcu_row, mcu, levels, out);
  }
  tokens.resize(static_cast<size_t>(out - tokens.data()));
}

Token* Tokenizer::restart_if_due(Token* out) {
  if (restart_interval_ == 0) return out;
  if (to_restart_ == 0) {
    *out++ = kRestartToken | next_restart_;
    next_restart_ = (next_restart_ + 1) & 7;
    to_restart_ = restart_interval_;
    for (int& dc : dc_) dc = 0;
  }
  to_restart_ -= 1;
  return out;
}

// Blocks that complete an MCU past the image's edge repeat the DC before them: the cheapest to code.
Token* Tokenizer::add_component(int c, int mcu_row, int mcu, const Levels& levels, Token* out) {
  const Component& component = frame_->components[c];
  const int n_rows = StripTransform::rows_of_blocks(component, mcu_row);
  const uint32_t table = c == 0 ? kDc0 : kDc1;
  for (int by = 0; by < component.v; ++by) {
    for (int bx = mcu * component.h; bx < (mcu + 1) * component.h; ++bx) {
      if (by >= n_rows || bx >= component.width_blocks) {
        out = tokenize_block(nullptr, 0, 0, table, out);
        continue;
      }
      const size_t i = static_cast<size_t>(by) * static_cast<size_t>(component.width_blocks) + static_cast<size_t>(bx);
      const int16_t* block = levels.zigzag[c].data() + 64 * i;
      out = tokenize_block(block, levels.nonzero[c][i], block[0] - dc_[c], table, out);
      dc_[c] = block[0];
    }
  }
  return out;
}

}  // namespace pac::jpeg
