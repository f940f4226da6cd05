// MCUs of a scan: bits -> levels -> samples, with restarts and what damage leaves of them.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/kernels/kernels.h"
#include "jpeg/component_planes.h"
#include "jpeg/frame.h"
#include "jpeg/picture_window.h"
#include "jpeg/progressive.h"
#include "jpeg/restart_markers.h"
#include "jpeg/scan_reader.h"

namespace pac::jpeg {

// What was wrong with a file.
struct Damage {
  bool lenient = false;
  std::optional<Failure> first;
  int errors = 0;    // passed over in lenient mode
  int warnings = 0;  // oddities that harm nothing
  // In lenient mode a failure is remembered and passed over.
  Result<void> tolerate(const Failure& failure) {
    if (!lenient) return failure;
    if (!first) first = failure;
    errors += 1;
    return {};
  }
};

// What remains the same for all blocks of a component in a scan, and PRED.
struct ScanComponent {
  const Component* component = nullptr;
  int index = 0;     // in the frame
  int h = 1, v = 1;  // blocks in an MCU
  const HuffmanDecoder* dc_table = nullptr;
  const HuffmanDecoder* ac_table = nullptr;
  const AcPairs* ac_pairs = nullptr;
  const uint16_t* steps = nullptr;
  int dc = 0;
  // Blocks from one row of blocks to the next: of the batch, or of all levels of the component; of the latter, the
  // first block of the MCU at hand.
  size_t first_block = 0, blocks_per_row = 0;
  int16_t* levels = nullptr;  // natural order
  uint8_t* last = nullptr;    // zigzag positions behind which all is 0; null where levels are kept
};

struct Scan {
  int n_components = 0;
  ScanComponent components[kMaxComponents];
  bool is_progressive = false;
  bool keeps_levels = false;  // of whole components, not turned into samples batch by batch; so if progressive
  Progression progression;
  uint32_t eob_run = 0;
  int mcus_per_row = 0, mcu_rows = 0;
  McuWindow needed;          // other MCUs are read, not transformed
  int restart_interval = 0;  // MCUs, 0 = none
  int to_restart = 0;        // MCUs before the next marker
  int next_restart = 0;      // its number
  int64_t next_mcu = 0;      // number of the next MCU
  int64_t resume = 0;        // MCUs before this one are lost
};

// Keeps its buffers from scan to scan. start(), then rows in order.
class McuDecoder {
 public:
  explicit McuDecoder(const Kernels& kernels) : kernels_(&kernels) {}

  // At the start of the restart interval number `interval`, whose data begin at `offset`. Levels and `last` of a
  // sequential scan are set here. `damage` must outlive the rows, as the bytes and what `scan` points to.
  void start(std::span<const uint8_t> bytes, const Scan& scan, uint64_t offset, Damage& damage, int64_t interval = 0);
  // Goes on with a later restart interval, whose data begin at `offset`: MCUs before it are not read. Not for levels
  // that are kept.
  void jump(uint64_t offset, int64_t interval);
  // Number of the MCU that is read next.
  int64_t next_mcu() const { return scan_.next_mcu; }
  // One MCU row, from next_mcu() on where jump() went into it. In lenient mode never fails.
  Result<void> decode_row(int mcu_row, ComponentPlanes& planes);
  // Behind the last MCU read: its next byte, or the marker.
  uint64_t byte_offset() const { return entropy_.byte_offset(); }

 private:
  // MCUs whose levels are read before they are transformed: few enough to stay in the first-level cache.
  static constexpr int kBatchMcus = 16;

  Result<void> collect_row(int mcu_row);
  Result<void> read_next_mcu();
  Result<void> read_mcu();
  void set_up_slots(int mcu_row);
  BlockError read_blocks();
  Result<void> pass_restart(int expected);
  int64_t resume_at(int64_t failed_mcu);
  void transform_batch(int mcu_row, int first_mcu, int n_mcus, const ScanComponent& sc, ComponentPlanes& planes);

  const Kernels* kernels_;
  std::span<const uint8_t> bytes_;
  Scan scan_;
  Damage* damage_ = nullptr;
  EntropyReader entropy_;
  std::vector<int16_t> levels_[kMaxComponents];
  std::vector<uint8_t> last_[kMaxComponents];
  std::vector<BlockSlot> slots_;  // of an MCU of a sequential scan
  size_t mcu_in_batch_ = 0;
};

}  // namespace pac::jpeg
