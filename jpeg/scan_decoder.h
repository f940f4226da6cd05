// The decoder's walk through a file: headers -> scans -> MCU rows -> levels -> samples -> RGB.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/image.h"
#include "base/kernels/kernels.h"
#include "base/parallel.h"
#include "jpeg/band_decoder.h"
#include "jpeg/component_planes.h"
#include "jpeg/header_reader.h"
#include "jpeg/jpeg.h"
#include "jpeg/mcu_decoder.h"

namespace pac::jpeg {

// Keeps its buffers from image to image. Call open(), then decode() once.
class ScanDecoder {
 public:
  explicit ScanDecoder(const Kernels& kernels) : kernels_(&kernels), mcus_(kernels) {}

  // Before open(): how many decode what restart markers separate; 0 = all processors. Results never depend on it.
  void set_threads(int n_threads);

  // Headers up to the first scan; refuses what is not supported or exceeds the limits; allocates. `bytes` must stay
  // until decode() returns.
  Result<void> open(std::span<const uint8_t> bytes, const Limits& limits);
  int width() const { return reader_.headers().frame.width; }
  int height() const { return reader_.headers().frame.height; }

  // All scans, into `out` (width() x height()). Lenient: never fails; see first_failure().
  Result<void> decode(RgbView out, bool lenient);
  const std::optional<Failure>& first_failure() const { return damage_.first; }
  int warnings() const { return damage_.warnings + reader_.headers().warnings; }

 private:
  Result<void> decode_scans(RgbView out);
  Result<void> set_up(const ScanHeader& header, Scan& scan);
  Result<const HuffmanDecoder*> set_up_table(const ScanHeader& header, int table_class, uint8_t id);
  Result<void> set_up_component(const ScanHeader& header, int i, ScanComponent& sc);
  Result<void> decode_scan(const ScanHeader& header, RgbView out);
  void transform_progressive(RgbView out);
  void write_finished_rows(int mcu_row, int mcu_rows, int mcu_height, RgbView out);

  const Kernels* kernels_;
  std::span<const uint8_t> bytes_;
  HeaderReader reader_{{}, {}};
  ScanHeader first_scan_;
  bool is_progressive_ = false;  // all levels are kept until the last scan
  bool single_scan_ = false;     // all components in the first scan: rows go out while the scan is read
  bool decoded_[kMaxComponents] = {};
  uint64_t position_ = 0;  // behind the last scan's data
  Damage damage_;
  ComponentPlanes planes_;
  McuDecoder mcus_;
  BandDecoder bands_;
  bool use_bands_ = false;
  std::optional<ThreadPool> pool_;  // where several threads decode
  HuffmanDecoder tables_[2][4];     // [class][destination]
  HuffmanSpec table_specs_[2][4];   // that tables_ were made of
  uint16_t steps_[kMaxComponents][64] = {};
  std::vector<int16_t> levels_[kMaxComponents];
};

}  // namespace pac::jpeg
