// Quantized blocks in scan order [T.81 A.2.3], with DC prediction and restart intervals.
#pragma once

#include <cstdint>
#include <vector>

#include "jpeg/frame.h"
#include "jpeg/strip.h"

namespace pac::jpeg {

// One MCU row of quantized blocks: of component c, in rows of width_blocks.
struct Levels {
  std::vector<int16_t> zigzag[3];    // 64 a block
  std::vector<uint64_t> nonzero[3];  // one mask a block
};

// Visits the blocks of a scan in order.
class BlockWalker {
 public:
  // At the start of a scan, or before an MCU row that a restart marker precedes. `frame` must outlive the use.
  void reset(const Frame& frame, int restart_interval_mcus, int first_row = 0) {
    frame_ = &frame;
    restart_interval_ = restart_interval_mcus;
    to_restart_ = first_row == 0 ? restart_interval_mcus : 0;
    next_restart_ = 0;
    if (first_row > 0)
      next_restart_ = static_cast<uint32_t>(int64_t{first_row} * frame.mcus_per_row / restart_interval_mcus - 1) & 7;
    for (int& dc : dc_) dc = 0;
  }

  // MCU rows in order. Calls on_restart(m) where RSTm stands, and for each block
  //   on_block(const int16_t* levels, uint64_t nonzero, int dc_difference, int table)     table 0: luma, 1: chroma.
  // Blocks that complete an MCU past the image's edge repeat the DC before them, the cheapest to code: levels is null,
  // nonzero and dc_difference are 0.
  template <class OnBlock, class OnRestart>
  void walk(int mcu_row, const Levels& levels, OnBlock&& on_block, OnRestart&& on_restart) {
    Slot slots[kMaxBlocksInMcu];
    Slot* const end = make_slots(mcu_row, levels, slots);
    for (int mcu = 0; mcu < frame_->mcus_per_row; ++mcu) {
      if (restart_interval_ > 0) {
        if (to_restart_ == 0) {
          on_restart(next_restart_);
          next_restart_ = (next_restart_ + 1) & 7;
          to_restart_ = restart_interval_;
          for (int& dc : dc_) dc = 0;
        }
        to_restart_ -= 1;
      }
      for (Slot* slot = slots; slot != end; ++slot) {
        if (mcu >= slot->n_real) {
          on_block(static_cast<const int16_t*>(nullptr), uint64_t{0}, 0, slot->table);
          continue;
        }
        const int16_t* block = slot->levels;
        const int dc = block[0];
        on_block(block, *slot->nonzero, dc - *slot->dc, slot->table);
        *slot->dc = dc;
        slot->levels += 64 * slot->step;
        slot->nonzero += slot->step;
      }
    }
  }

 private:
  // One of an MCU's blocks.
  struct Slot {
    const int16_t* levels = nullptr;  // of the MCU at hand
    const uint64_t* nonzero = nullptr;
    int* dc = nullptr;  // PRED
    int step = 1;       // blocks to the next MCU's
    int n_real = 0;     // MCUs whose block lies in the image
    int table = 0;
  };

  // In the order of the scan; returns their end.
  Slot* make_slots(int mcu_row, const Levels& levels, Slot* out) {
    for (int c = 0; c < frame_->n_components; ++c) {
      const Component& component = frame_->components[c];
      const int n_rows = StripTransform::rows_of_blocks(component, mcu_row);
      for (int by = 0; by < component.v; ++by) {
        for (int bx = 0; bx < component.h; ++bx, ++out) {
          *out = {};
          out->dc = &dc_[c];
          out->table = c == 0 ? 0 : 1;
          if (by >= n_rows || bx >= component.width_blocks) continue;
          const size_t first =
              static_cast<size_t>(by) * static_cast<size_t>(component.width_blocks) + static_cast<size_t>(bx);
          out->levels = levels.zigzag[c].data() + 64 * first;
          out->nonzero = levels.nonzero[c].data() + first;
          out->step = component.h;
          out->n_real = ceil_div(component.width_blocks - bx, component.h);
        }
      }
    }
    return out;
  }

  const Frame* frame_ = nullptr;
  int restart_interval_ = 0, to_restart_ = 0;
  uint32_t next_restart_ = 0;
  int dc_[3] = {0, 0, 0};
};

}  // namespace pac::jpeg
