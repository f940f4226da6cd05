// A scan of all components that has restart markers, decoded by several threads at once.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/image.h"
#include "base/parallel.h"
#include "jpeg/mcu_decoder.h"

namespace pac::jpeg {

struct BandedScan {
  std::span<const uint8_t> bytes;
  const Scan* scan = nullptr;
  uint64_t data_offset = 0;
  const Frame* frame = nullptr;
  ColorModel color = ColorModel::unknown;
};

// Keeps its buffers from image to image.
class BandDecoder {
 public:
  // Decodes into `out` (the whole image) and tells where the scan ends. Nothing, and unspecified pixels, where the
  // stream has too few restart markers or anything odd in it: then one thread must decode it, which knows what to say.
  std::optional<uint64_t> decode(const BandedScan& job, ThreadPool& pool, const Kernels& kernels, RgbView out);

 private:
  // MCU rows between two restart markers.
  struct Band {
    explicit Band(const Kernels& kernels) : mcus(kernels) {}
    int first_row = 0, end_row = 0;
    int64_t first_interval = 0;
    bool sound = false;
    McuDecoder mcus;
    ComponentPlanes planes;
    ComponentPlanes seam;                      // with the band above
    int n_sides_done = 0;                      // of the seam; atomic while threads run
    std::vector<uint8_t> top[kMaxComponents];  // its first row of samples, for the band above
  };

  bool find_all_restarts(const BandedScan& job);
  void split(const BandedScan& job, int n_threads, const Kernels& kernels);
  uint64_t offset_of(const BandedScan& job, const Band& band) const;
  void decode_band(const BandedScan& job, size_t i, const Kernels& kernels, RgbView out);
  bool decode_rows(const BandedScan& job, Band& band, Damage& damage, RgbView out) const;
  bool ends_well(const BandedScan& job, const Band& band) const;
  void write_seam(const BandedScan& job, Band& above, Band& below, const Kernels& kernels, RgbView out) const;

  std::vector<uint64_t> restarts_;  // offsets of the markers
  uint64_t data_end_ = 0;           // offset of what follows the scan's data
  std::vector<Band> bands_;
  std::vector<size_t> order_;  // of bands_, costliest first
};

}  // namespace pac::jpeg
