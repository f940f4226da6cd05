// The decoder's walk through a file: headers -> scans -> MCU rows -> levels -> samples -> RGB.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/image.h"
#include "base/kernels/kernels.h"
#include "jpeg/component_planes.h"
#include "jpeg/header_reader.h"
#include "jpeg/jpeg.h"
#include "jpeg/progressive.h"
#include "jpeg/scan_reader.h"

namespace pac::jpeg {

// Keeps its buffers from image to image. Call open(), then decode() once.
class ScanDecoder {
 public:
  explicit ScanDecoder(const Kernels& kernels) : kernels_(&kernels) {}

  // Headers up to the first scan; refuses what is not supported or exceeds the limits; allocates. `bytes` must stay
  // until decode() returns.
  Result<void> open(std::span<const uint8_t> bytes, const Limits& limits);
  int width() const { return reader_.headers().frame.width; }
  int height() const { return reader_.headers().frame.height; }

  // All scans, into `out` (width() x height()). Lenient: never fails; see first_failure().
  Result<void> decode(RgbView out, bool lenient);
  const std::optional<Failure>& first_failure() const { return first_failure_; }
  int warnings() const { return warnings_ + reader_.headers().warnings; }

 private:
  // MCUs whose levels are read before they are transformed: few enough to stay in the first-level cache.
  static constexpr int kBatchMcus = 16;

  // What remains the same for all blocks of a component in a scan, and PRED.
  struct ScanComponent {
    const Component* component = nullptr;
    int index = 0;     // in the frame
    int h = 1, v = 1;  // blocks in an MCU
    const HuffmanDecoder* dc_table = nullptr;
    const HuffmanDecoder* ac_table = nullptr;
    const uint16_t* steps = nullptr;
    int dc = 0;
    // The first block of the MCU at hand, and blocks from one row of blocks to the next: of the batch, or, if
    // progressive, of all levels of the component.
    size_t first_block = 0, blocks_per_row = 0;
    int16_t* levels = nullptr;  // natural order
    uint8_t* last = nullptr;
  };
  struct Scan {
    int n_components = 0;
    ScanComponent components[kMaxComponents];
    bool is_progressive = false;
    Progression progression;
    uint32_t eob_run = 0;
    int mcus_per_row = 0, mcu_rows = 0;
    int restart_interval = 0;  // MCUs, 0 = none
    int to_restart = 0;        // MCUs before the next marker
    int next_restart = 0;      // its number
    int64_t next_mcu = 0;      // number of the next MCU
    int64_t resume = 0;        // MCUs before this one are lost
  };

  Result<void> decode_scans(RgbView out);
  Result<void> set_up(const ScanHeader& header, Scan& scan);
  Result<const HuffmanDecoder*> set_up_table(const ScanHeader& header, int table_class, uint8_t id);
  Result<void> set_up_component(const ScanHeader& header, int i, ScanComponent& sc);
  Result<void> decode_scan(const ScanHeader& header, RgbView out);
  Result<void> decode_sequential_row(int mcu_row, Scan& scan);
  Result<void> decode_progressive_row(int mcu_row, Scan& scan);
  Result<void> read_next_mcu(Scan& scan);
  Result<void> read_mcu(Scan& scan);
  BlockError read_blocks(Scan& scan);
  Result<void> pass_restart(int expected);
  int64_t resume_at(int64_t failed_mcu, Scan& scan);
  void transform_batch(int mcu_row, int first_mcu, int n_mcus, const ScanComponent& sc);
  void transform_progressive(RgbView out);
  void write_finished_rows(int mcu_row, int mcu_rows, int mcu_height, RgbView out);
  Result<void> tolerate(const Failure& failure);

  const Kernels* kernels_;
  std::span<const uint8_t> bytes_;
  HeaderReader reader_{{}, {}};
  ScanHeader first_scan_;
  bool lenient_ = false;
  bool is_progressive_ = false;  // all levels are kept until the last scan
  bool single_scan_ = false;     // all components in the first scan: rows go out while the scan is read
  bool decoded_[kMaxComponents] = {};
  uint64_t position_ = 0;  // behind the last scan's data
  std::optional<Failure> first_failure_;
  int warnings_ = 0;
  ComponentPlanes planes_;
  EntropyReader entropy_;
  HuffmanDecoder tables_[2][4];    // [class][destination]
  HuffmanSpec table_specs_[2][4];  // that tables_ were made of
  uint16_t steps_[kMaxComponents][64] = {};
  std::vector<int16_t> levels_[kMaxComponents];
  std::vector<uint8_t> last_[kMaxComponents];
};

}  // namespace pac::jpeg
