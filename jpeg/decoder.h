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
#include "jpeg/scan_reader.h"

namespace pac::jpeg {

// Keeps its buffers from image to image.
class ScanDecoder {
 public:
  explicit ScanDecoder(const Kernels& kernels) : kernels_(kernels) {}
  Result<RgbImage> decode(std::span<const uint8_t> bytes, const Limits& limits, bool lenient);
  const std::optional<Failure>& first_failure() const { return first_failure_; }
  int warnings() const { return warnings_; }

 private:
  struct ScanComponent;
  void note(const Failure& failure);
  Result<RgbImage> prepare(const Headers& headers, const ScanHeader& scan, const Limits& limits);
  Result<void> set_up(const Headers& headers, const ScanHeader& scan, ScanComponent (&components)[4]);
  Result<void> decode_scan(const Headers& headers, const ScanHeader& scan, RgbView out);
  BlockError read_mcu(EntropyReader& reader, int mcu, ScanComponent* components, int n_components);
  Result<void> pass_restart(EntropyReader& reader, int expected);
  void transform_row(int mcu_row, const ScanComponent& sc);
  void write_finished_rows(int mcu_row, int mcu_rows, int mcu_height, RgbView out);

  const Kernels& kernels_;
  std::span<const uint8_t> bytes_;
  bool lenient_ = false;
  bool single_scan_ = false;  // all components in the first scan: rows go out while the scan is read
  bool decoded_[kMaxComponents] = {};
  uint64_t position_ = 0;  // behind the last scan's data
  std::optional<Failure> first_failure_;
  int warnings_ = 0;
  ComponentPlanes planes_;
  HuffmanDecoder tables_[2][4];
  uint16_t steps_[kMaxComponents][64] = {};
  std::vector<int16_t> levels_[kMaxComponents];  // one MCU row of each component of the scan
  std::vector<uint8_t> last_[kMaxComponents];
};

}  // namespace pac::jpeg
