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
#include "jpeg/decode_request.h"
#include "jpeg/header_reader.h"
#include "jpeg/jpeg.h"
#include "jpeg/mcu_decoder.h"
#include "jpeg/picture_window.h"
#include "jpeg/row_output.h"

namespace pac::jpeg {

// Keeps its buffers from image to image. Call open(), then decode() once.
class ScanDecoder {
 public:
  explicit ScanDecoder(const Kernels& kernels) : kernels_(&kernels), mcus_(kernels) {}

  // Before open(): how many decode what restart markers separate; 0 = all processors. Results never depend on it.
  void set_threads(int n_threads);

  // Headers up to the first scan; refuses what is not supported or exceeds the limits; allocates. `bytes` must stay
  // until decode() returns.
  // bad_argument: the crop does not lie inside the scaled picture.
  Result<void> open(std::span<const uint8_t> bytes, const DecodeRequest& request);
  // Of the output.
  int width() const { return window_.width; }
  int height() const { return window_.height; }
  const Headers& headers() const { return reader_.headers(); }

  // All scans, to `target` (width() x height()). Lenient: never fails; see first_failure().
  Result<void> decode(const RowTarget& target, bool lenient);
  // The same into the samples of each component, which planes() and scaled() then tell.
  Result<void> decode_planes(bool lenient) { return decode({}, lenient); }
  ComponentPlanes& planes() { return planes_; }
  const ScaledFrame& scaled() const { return scaled_; }
  // After decode(), Wanted::levels: of component c, whole MCUs, natural order; and its steps.
  std::vector<int16_t> take_levels(int c) { return std::move(levels_[c]); }
  const uint16_t* steps(int c) const { return steps_[c]; }
  const std::optional<Failure>& first_failure() const { return damage_.first; }
  int errors() const { return damage_.errors; }
  int warnings() const { return damage_.warnings + reader_.headers().warnings; }

 private:
  Result<void> choose_window(const DecodeRequest& request);
  Result<void> check_memory(const DecodeRequest& request);
  Result<void> decode_scans();
  Result<void> set_up(const ScanHeader& header, Scan& scan);
  Result<const HuffmanDecoder*> set_up_table(const ScanHeader& header, int table_class, uint8_t id);
  const AcPairs* set_up_pairs(uint8_t id);
  Result<void> set_up_component(const ScanHeader& header, int i, ScanComponent& sc);
  Result<void> decode_scan(const ScanHeader& header);
  void find_crop_restarts(const ScanHeader& header, const Scan& scan, int end_row);
  int skip_to_crop(const Scan& scan, int row);
  bool decode_bands(const ScanHeader& header, const Scan& scan);
  void transform_progressive();
  void write_finished_rows(int mcu_row, int mcu_rows, int mcu_height);

  const Kernels* kernels_;
  std::span<const uint8_t> bytes_;
  HeaderReader reader_{{}, {}};
  ScanHeader first_scan_;
  bool is_progressive_ = false;
  bool keeps_levels_ = false;  // all of them until the last scan: progressive, or the caller wants them
  bool single_scan_ = false;   // all components in the first scan: rows go out while the scan is read
  Wanted wanted_ = Wanted::rows;
  bool is_partial_ = false;  // a crop: what nobody needs of the last scan is not read
  ScaledFrame scaled_;
  Crop window_;
  McuWindow needed_;  // in MCUs of an interleaved scan
  RowTarget target_;
  RowOutput output_;
  bool decoded_[kMaxComponents] = {};
  uint64_t position_ = 0;  // behind the last scan's data
  Damage damage_;
  ComponentPlanes planes_;
  McuDecoder mcus_;
  BandDecoder bands_;
  bool use_bands_ = false;
  std::vector<uint64_t> crop_restarts_;  // offsets of markers that a crop may go to; empty: it must read all MCUs
  std::optional<ThreadPool> pool_;       // where several threads decode
  HuffmanDecoder tables_[2][4];          // [class][destination]
  HuffmanSpec table_specs_[2][4];        // that tables_ were made of
  AcPairs ac_pairs_[4];                  // made of tables_[1], where has_ac_pairs_
  bool has_ac_pairs_[4] = {};
  int64_t ac_pixels_[4] = {};  // of the pictures that used tables_[1]
  uint16_t steps_[kMaxComponents][64] = {};
  std::vector<int16_t> levels_[kMaxComponents];
};

}  // namespace pac::jpeg
