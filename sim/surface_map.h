// What each sample of a frame shows, as keys that say at once whether two samples belong together, and around which of
// them the filter of the reprojection meets nothing else.
#pragma once

#include <span>
#include <vector>

#include "base/image.h"
#include "base/kernels/kernels.h"

namespace pac::sim {

// Filled row by row, from the top.
class SurfaceMap {
 public:
  static constexpr int kBorder = 5;  // nothing is shown there

  SurfaceMap() = default;
  SurfaceMap(int width, int height);

  int width() const { return keys_.width() - 2 * kBorder; }
  int height() const { return keys_.height() - 2 * kBorder; }
  const uint32_t* row(int y) const { return keys_.row(y + kBorder) + kBorder; }

  // The keys of n samples of a frame from (x, y) on, `surfaces` by id, or empty: 1 for all ids but 0. None is smooth
  // before finish(). Then, when all of the row are set, end_row().
  void set(int x, int y, int n, const float* depth, const uint32_t* id, std::span<const uint32_t> surfaces,
           const WarpKernels& kernels);
  void end_row(int y, const WarpKernels& kernels);
  // Every second key of row 2 y, of (width + 1) / 2.
  void set_half_row(int y, const SurfaceMap& full, const WarpKernels& kernels);
  // After the last row, before other frames look things up.
  void finish(const WarpKernels& kernels);

  KeyMap view() const { return {row(0), keys_.stride(), width(), height()}; }

 private:
  // Rows of bits, a word of zeros on both sides: the last kRows of them, by number of the row.
  static constexpr int kRows = 8;
  using BitRow = std::vector<uint64_t>;

  uint32_t* written_row(int y) { return keys_.row(y + kBorder) + kBorder; }
  void mark_smooth(int y, const WarpKernels& kernels);
  void clear(int y);

  IdImage keys_;                         // with a border of 0
  BitRow right_[kRows], above_[kRows];   // keys that do not belong to the next one's, to the one's above
  BitRow mixed_, mixed_above_, spread_;  // of mark_smooth()
};

}  // namespace pac::sim
