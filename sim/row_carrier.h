// One row of samples fetched from the frame before: points whose taps all show one surface by the filter, of those
// between surfaces luma by the filter, too, with a stand-in for what shows something else, and chroma by the mean of
// the nearest samples that show theirs. The codec's planes of one resolution share the points.
#pragma once

#include <cstdint>
#include <vector>

#include "base/kernels/kernels.h"
#include "sim/bordered_plane.h"
#include "sim/reprojection.h"
#include "sim/surface_map.h"

namespace pac::sim {

class RowCarrier {
 public:
  // Both are borrowed. `before`: what the planes that are fetched from show.
  RowCarrier(const SurfaceMap& before, const Kernels& kernels);

  // Finds the samples of a row: runs of them, n from column x on, which have that depth, the keys `now` and lie
  // `from_first` columns after the first of `way`.
  void begin() { counts_ = {}, lost_ = 0; }
  void find(int x, int n, const ReprojectionRow& way, int from_first, const float* depth, const uint32_t* now);
  void find_nowhere(int x, int n);

  // Those of a row of chroma by the points of every second row of luma.
  void find_half(RowCarrier& luma);

  // The samples of the row; 0 where the frame before did not show them.
  void fetch_luma(const BorderedPlane& plane, int16_t* out);
  void fetch_chroma(const BorderedPlane& cb, const BorderedPlane& cr, int16_t* cb_out, int16_t* cr_out);

  // How many of the row the frame before did show, after they were fetched.
  size_t found() const { return counts_.plain + counts_.edges - lost_; }

 private:
  WarpPlaces places(int x = 0);

  const SurfaceMap& before_;
  const WarpKernels& kernels_;

  size_t width_;
  std::vector<int32_t> x_64_, y_64_;
  std::vector<uint8_t> state_;
  std::vector<uint32_t> wanted_;
  WarpCounts counts_ = {};
  size_t lost_ = 0;
};

}  // namespace pac::sim
