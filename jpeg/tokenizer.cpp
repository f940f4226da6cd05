#include "jpeg/tokenizer.h"

namespace pac::jpeg {

void Tokenizer::reset(const Frame& frame, int restart_interval_mcus, int first_row) {
  frame_ = &frame;
  restart_interval_mcus_ = restart_interval_mcus;
  walker_.reset(frame, restart_interval_mcus, first_row);
  tokens_.clear();
  for (Histogram& counts : counts_) counts = {};
}

void Tokenizer::add_mcu_row(int mcu_row, const Levels& levels) {
  size_t n_max = 1;  // a restart marker
  for (int c = 0; c < frame_->n_components; ++c)
    n_max += static_cast<size_t>(frame_->components[c].h * frame_->components[c].v) * kMaxTokensInBlock;
  Token* out = tokens_.reserve(static_cast<size_t>(frame_->mcus_per_row) * n_max);
  size_t turn = 0;
  walker_.walk(
      mcu_row, levels,
      [&](const int16_t* block, uint64_t nonzero, int dc_difference, int table) {
        const uint32_t dc_table = table == 0 ? kDc0 : kDc1;
        out = tokenize_block(block, nonzero, dc_difference, dc_table, counts_[turn], out);
        turn ^= 1;
      },
      [&](uint32_t number) { *out++ = kRestartToken | number; });
  tokens_.set_end(out);
}

void Tokenizer::add_histogram(Histogram& to) const {
  for (int table = 0; table < kTableCount; ++table)
    for (int symbol = 0; symbol < 256; ++symbol)
      to.count[table][symbol] += counts_[0].count[table][symbol] + counts_[1].count[table][symbol];
}

}  // namespace pac::jpeg
