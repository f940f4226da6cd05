// One row of samples fetched from the frame before: points whose taps all show one surface as they are, points near an
// edge with what shows something else replaced. The codec's planes of one resolution share the points.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "base/kernels/kernels.h"
#include "sim/model_prediction.h"

namespace pac::sim {

// Depths of one surface at two pixels belong together where u differs by less than a share of it. A floor seen at a
// grazing angle changes by about 1 % a pixel; things that hide each other are farther apart.
inline bool same_depth(float a, float b) {
  return std::fabs(a - b) <= kWarpDepthTolerance * (a > b ? a : b);
}

class RowCarrier {
 public:
  // All are borrowed. `flow` is of luma; is_chroma: the maps are of half its size.
  RowCarrier(const SurfaceMap& now, const SurfaceMap& before, const Flow& flow, bool is_chroma, const Kernels& kernels)
      : now_(now), before_(before), flow_(flow), is_chroma_(is_chroma), kernels_(kernels) {}

  // Finds where the samples of row y were. plane_stride: of the planes that fetch() will see.
  void find(int y, ptrdiff_t plane_stride);

  // Writes the samples that were found at their columns of `out`; the others are left alone.
  void fetch(const BorderedPlane& plane, int16_t* out);

  size_t found() const { return n_found_; }

 private:
  // What a sample looks for in the frame before, and where, in 1/64.
  struct Point {
    int column, x_64, y_64;
    uint32_t surface;
    float u;
  };

  void find_plain(int y, ptrdiff_t plane_stride);
  void add_place(const Point& point, int32_t offset);
  void add_edge(const Point& point, ptrdiff_t plane_stride);
  bool shows(int x, int y, const Point& point) const;
  bool is_inside(const Point& point) const;
  int16_t nearest_mean(const BorderedPlane& plane, size_t edge) const;
  void cut_patches(const BorderedPlane& plane);
  void cut_at_border(const BorderedPlane& plane, size_t edge);

  const SurfaceMap &now_, &before_;
  const Flow& flow_;
  bool is_chroma_;
  const Kernels& kernels_;

  // Of all points, the first n_found_: plain ones first, then those near an edge. At most one a column.
  std::vector<int32_t> offset_;  // of tap (-2, -2) in the plane; near an edge in the patches
  std::vector<uint8_t> phase_x_, phase_y_;
  std::vector<int> column_;
  size_t n_plain_ = 0, n_found_ = 0;

  // Of points near an edge.
  std::vector<Point> candidates_, edge_points_;
  std::vector<EdgePoint> edges_;
  std::vector<uint8_t> nearest_;  // which of the four nearest samples are shown: bit 2 * row + column
  std::vector<int16_t> patches_, picked_;
};

}  // namespace pac::sim
