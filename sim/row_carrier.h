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
  // All are borrowed. is_chroma: the maps are of half the size.
  RowCarrier(const SurfaceMap& now, const SurfaceMap& before, bool is_chroma, const Kernels& kernels);

  // Where the samples of the next row to be found were: to be filled in.
  FlowRow flow() { return {x_64_.data(), y_64_.data(), u_before_.data()}; }

  // Finds the samples of row y by flow(). plane_stride: of the planes that fetch() will see.
  void find(int y, ptrdiff_t plane_stride);

  // Those of row y of chroma by flow() of row 2 y of luma.
  void find_half(int y, const RowCarrier& luma, ptrdiff_t plane_stride);

  // The samples of the row; 0 where the frame before did not show them.
  void fetch(const BorderedPlane& plane, int16_t* out);

  size_t found() const { return n_found_; }

 private:
  // A sample between surfaces: those of the four around its place that show its own, with their bilinear weights.
  struct Edge {
    size_t column;
    ptrdiff_t offset;  // of the first of the four in a plane
    int32_t weight[4], sum;
  };

  void find_special(ptrdiff_t plane_stride);
  bool find_edge(size_t column, int32_t x_64, int32_t y_64, ptrdiff_t plane_stride);
  static int16_t mean(const int16_t* samples, ptrdiff_t stride, const Edge& edge);

  const SurfaceMap &now_, &before_;
  bool is_chroma_;
  const WarpKernels& kernels_;

  std::vector<int32_t> x_64_, y_64_;
  std::vector<float> u_before_;
  std::vector<uint8_t> state_;
  std::vector<uint32_t> wanted_;
  std::vector<Edge> edges_;
  std::vector<WarpEdge> edge_points_;
  std::vector<int16_t> edge_samples_;
  size_t n_absent_ = 0, n_edges_ = 0, n_found_ = 0;
};

}  // namespace pac::sim
