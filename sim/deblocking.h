// A filter for what is shown, not kept, of a decoded difference: steps at the borders of coded blocks are smoothed
// where both sides show one polygon, never across its edge [Luo 94, with the edges known instead of guessed].
#pragma once

#include <cstdint>

#include "base/image.h"
#include "sim/bordered_plane.h"

namespace pac::sim {

// One object, one thread at a time.
class Deblocker {
 public:
  Deblocker() = default;
  Deblocker(int width, int height);

  // Row y of the frame's polygons, by number, from the top.
  void see_row(int y, const uint32_t* ids);

  // Luma of the difference, in 1/32, to `out` of its size; `coded` and `reference` of that frame: macroblocks where
  // they are equal were not coded, and borders between two of these stay as they are.
  void filter(const BorderedPlane& difference, PlaneView<const uint8_t> coded, PlaneView<const uint8_t> reference,
              BorderedPlane& out);

 private:
  bool is_coded(int x, int y) const { return *coded_.view().pixel(x / 16, y / 16) != 0; }

  IdImage last_row_;
  GrayImage across_, down_;  // 1 where both sides of a border show one polygon: columns 8 k, rows 8 k
  GrayImage coded_;          // macroblocks
};

}  // namespace pac::sim
