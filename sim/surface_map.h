// What each sample of a frame shows, as keys that say at once whether two samples belong together, and around which of
// them the filter of the reprojection meets nothing else.
#pragma once

#include <cstdlib>
#include <span>
#include <vector>

#include "base/image.h"
#include "base/kernels/kernels.h"

namespace pac::sim {

inline bool same_surface(uint32_t key, uint32_t wanted) {
  return std::abs(static_cast<int32_t>((key & kKeyBits) - (wanted & kKeyBits))) <= kKeyTolerance;
}

class SurfaceMap {
 public:
  static constexpr int kBorder = 5;  // nothing is shown there

  SurfaceMap() = default;
  SurfaceMap(int width, int height);

  int width() const { return keys_.width() - 2 * kBorder; }
  int height() const { return keys_.height() - 2 * kBorder; }
  const uint32_t* row(int y) const { return keys_.row(y + kBorder) + kBorder; }

  // The keys of a frame, `surfaces` by id, or empty: 1 for all ids but 0. None is smooth yet.
  void set(PlaneView<const float> depth, PlaneView<const uint32_t> id, std::span<const uint32_t> surfaces,
           const WarpKernels& kernels);
  // Every second key of every second row; (width + 1) / 2 and (height + 1) / 2 of them.
  void set_half(const SurfaceMap& full);

  // Marks keys as smooth: before other frames look things up.
  void find_smooth(const WarpKernels& kernels);

  KeyMap view() const { return {row(0), keys_.stride(), width(), height()}; }

 private:
  uint32_t* written_row(int y) { return keys_.row(y + kBorder) + kBorder; }

  static constexpr int kRows = 5;  // where the taps of a point and of its next ones meet other surfaces: pairs of them

  IdImage keys_;     // with a border of 0
  GrayImage mixed_;  // the last kRows rows of WarpKernels::mark_mixed(), two columns from the left; and one of 0
};

}  // namespace pac::sim
