#include "jpeg/mcu_decoder.h"

#include <algorithm>

#include "jpeg/markers.h"
#include "jpeg/reduced_idct.h"

namespace pac::jpeg {
namespace {

constexpr int64_t kNever = INT64_MAX;

const char* text_of(BlockError error) {
  switch (error) {
    case BlockError::undefined_code:
      return "entropy-coded data: undefined Huffman code";
    case BlockError::past_end:
      return "entropy-coded data: run past the last coefficient";
    default:
      return "entropy-coded data: undefined run/size symbol";
  }
}

}  // namespace

void McuDecoder::start(std::span<const uint8_t> bytes, const Scan& scan, uint64_t offset, Damage& damage,
                       int64_t interval) {
  bytes_ = bytes;
  scan_ = scan;
  damage_ = &damage;
  scan_.to_restart = scan.restart_interval;
  scan_.next_restart = static_cast<int>(interval & 7);
  scan_.next_mcu = interval * scan.restart_interval;
  entropy_.start(bytes, offset);
  for (int i = 0; !scan.is_progressive && i < scan.n_components; ++i) {
    ScanComponent& sc = scan_.components[i];
    if (!scan.keeps_levels) {
      sc.blocks_per_row = static_cast<size_t>(std::min(kBatchMcus, scan.mcus_per_row) * sc.h);
      levels_[i].resize(64 * sc.blocks_per_row * static_cast<size_t>(sc.v));
      sc.levels = levels_[i].data();
    }
    last_[i].resize(sc.blocks_per_row * static_cast<size_t>(sc.v));
    sc.last = last_[i].data();
  }
  slots_.clear();
  if (!scan.keeps_levels) set_up_slots(0);
}

void McuDecoder::jump(uint64_t offset, int64_t interval) {
  entropy_.restart_at(offset);
  scan_.to_restart = scan_.restart_interval;
  scan_.next_restart = static_cast<int>(interval & 7);
  scan_.next_mcu = interval * scan_.restart_interval;
  scan_.resume = 0;
  for (ScanComponent& sc : scan_.components) sc.dc = 0;
}

// The blocks of each component in turn [T.81 A.2.3]: of the batch (as if of row 0), or of a row of MCUs whose levels
// are kept.
void McuDecoder::set_up_slots(int mcu_row) {
  slots_.clear();
  for (int i = 0; i < scan_.n_components; ++i) {
    ScanComponent& sc = scan_.components[i];
    const size_t first = static_cast<size_t>(mcu_row * sc.v) * sc.blocks_per_row;
    for (int by = 0; by < sc.v; ++by)
      for (int bx = 0; bx < sc.h; ++bx) {
        const size_t block = static_cast<size_t>(by) * sc.blocks_per_row + static_cast<size_t>(bx);
        slots_.push_back({sc.dc_table, sc.ac_table, sc.ac_pairs, &sc.dc, sc.levels + 64 * (first + block),
                          sc.last + block, static_cast<size_t>(sc.h)});
      }
  }
}

Result<void> McuDecoder::decode_row(int mcu_row, ComponentPlanes& planes) {
  if (scan_.keeps_levels) return collect_row(mcu_row);
  const int64_t first = scan_.next_mcu - int64_t{mcu_row} * scan_.mcus_per_row;  // above 0 behind a jump
  for (int mcu = static_cast<int>(std::max<int64_t>(first, 0)); mcu < scan_.mcus_per_row; mcu += kBatchMcus) {
    const int n = std::min(kBatchMcus, scan_.mcus_per_row - mcu);
    for (int i = 0; i < scan_.n_components; ++i) {
      std::fill(levels_[i].begin(), levels_[i].end(), int16_t{0});
      std::fill(last_[i].begin(), last_[i].end(), uint8_t{0});
    }
    for (int j = 0; j < n; ++j) {
      mcu_in_batch_ = static_cast<size_t>(j);
      PAC_CHECK(read_next_mcu());
    }
    if (!scan_.needed.has_row(mcu_row) || !scan_.needed.overlaps_columns(mcu, n)) continue;
    for (int i = 0; i < scan_.n_components; ++i) transform_batch(mcu_row, mcu, n, scan_.components[i], planes);
  }
  return {};
}

Result<void> McuDecoder::collect_row(int mcu_row) {
  if (!scan_.is_progressive) set_up_slots(mcu_row);
  for (int mcu = 0; mcu < scan_.mcus_per_row; ++mcu) {
    mcu_in_batch_ = static_cast<size_t>(mcu);
    for (ScanComponent& sc : scan_.components)
      sc.first_block = static_cast<size_t>(mcu_row * sc.v) * sc.blocks_per_row + static_cast<size_t>(mcu * sc.h);
    PAC_CHECK(read_next_mcu());
  }
  return {};
}

// Skips what is lost; looks for a place to go on after a failure.
Result<void> McuDecoder::read_next_mcu() {
  const int64_t mcu = scan_.next_mcu++;
  if (mcu < scan_.resume) return {};
  if (auto done = read_mcu(); !done.ok()) {
    PAC_CHECK(damage_->tolerate(done.failure()));
    scan_.resume = resume_at(mcu);
  }
  return {};
}

Result<void> McuDecoder::read_mcu() {
  if (scan_.restart_interval > 0) {
    if (scan_.to_restart == 0) {
      PAC_CHECK(pass_restart(scan_.next_restart));
      scan_.next_restart = (scan_.next_restart + 1) & 7;
      scan_.to_restart = scan_.restart_interval;
      scan_.eob_run = 0;
      for (ScanComponent& sc : scan_.components) sc.dc = 0;
    }
    scan_.to_restart -= 1;
  }
  entropy_.prepare_mcu();
  const BlockError error = scan_.is_progressive ? read_blocks() : read_mcu_blocks(entropy_, slots_, mcu_in_batch_);
  if (entropy_.overrun()) {
    const uint64_t at = find_marker(bytes_, entropy_.byte_offset());
    if (at == bytes_.size()) return Failure{Error::truncated, at, "file ends inside the entropy-coded data"};
    return Failure{Error::corrupt, at, "marker inside the entropy-coded data"};
  }
  if (error != BlockError::none) return Failure{Error::corrupt, entropy_.byte_offset(), text_of(error)};
  return {};
}

// Of a progressive scan.
BlockError McuDecoder::read_blocks() {
  for (int i = 0; i < scan_.n_components; ++i) {
    ScanComponent& sc = scan_.components[i];
    for (int by = 0; by < sc.v; ++by) {
      for (int bx = 0; bx < sc.h; ++bx) {
        const size_t block = sc.first_block + static_cast<size_t>(by) * sc.blocks_per_row + static_cast<size_t>(bx);
        int16_t* levels = sc.levels + 64 * block;
        const BlockError error =
            read_progressive_block(entropy_, scan_.progression, sc.dc_table, sc.ac_table, sc.dc, scan_.eob_run, levels);
        if (error != BlockError::none) return error;
      }
    }
  }
  return BlockError::none;
}

// Expects RSTm at the reader's position, perhaps behind fill bytes, or behind bytes that nobody needed (a warning).
Result<void> McuDecoder::pass_restart(int expected) {
  const uint64_t due = entropy_.byte_offset(), at = find_marker(bytes_, due);
  if (at == bytes_.size()) return Failure{Error::truncated, at, "file ends where a restart marker is due"};
  if (bytes_[at + 1] != kRst0 + expected)
    return Failure{Error::corrupt, at, "restart marker is missing or out of order"};
  if (bytes_[due] != 0xFF) damage_->warnings += 1;
  entropy_.restart_at(at + 2);
  return {};
}

// After a failure at MCU number `failed_mcu`: sets the reader behind the next usable restart marker and tells the MCU
// that follows it. A marker at most 5 numbers ahead of the one that is due means lost intervals; else it is an old one.
int64_t McuDecoder::resume_at(int64_t failed_mcu) {
  if (scan_.restart_interval == 0) return kNever;
  // Where the marker that is due stands: before the failed MCU if it was missing there, else after its interval.
  const int64_t interval = scan_.restart_interval;
  const int64_t due_mcu = scan_.to_restart == 0 ? failed_mcu : (failed_mcu / interval + 1) * interval;
  const auto due = static_cast<int>((due_mcu / interval - 1) & 7);
  uint64_t at = find_marker(bytes_, entropy_.byte_offset());
  for (; at < bytes_.size() && is_restart(bytes_[at + 1]); at = find_marker(bytes_, at + 2)) {
    const int number = bytes_[at + 1] - kRst0, ahead = (number - due) & 7;
    if (ahead > 5) continue;
    entropy_.restart_at(at + 2);
    for (ScanComponent& sc : scan_.components) sc.dc = 0;
    scan_.eob_run = 0;
    scan_.to_restart = scan_.restart_interval;
    scan_.next_restart = (number + 1) & 7;
    return due_mcu + ahead * interval;
  }
  entropy_.restart_at(at);
  return kNever;
}

void McuDecoder::transform_batch(int mcu_row, int first_mcu, int n_mcus, const ScanComponent& sc,
                                 ComponentPlanes& planes) {
  for (int by = 0; by < sc.v; ++by) {
    const size_t first = static_cast<size_t>(by) * sc.blocks_per_row;
    const int size = planes.block_size(sc.index);
    uint8_t* out = planes.block_row(sc.index, mcu_row * sc.v + by) + size * first_mcu * sc.h;
    const auto n = static_cast<size_t>(n_mcus * sc.h);
    idct_to_size(kernels_->block, size, sc.levels + 64 * first, sc.steps, sc.last + first, n, out,
                 planes.stride(sc.index));
  }
}

}  // namespace pac::jpeg
