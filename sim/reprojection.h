// Where each pixel's content was one frame earlier, from depth and two cameras: no search, no bits [Levoy95 s.5,
// Wallach 94, Guenter 93].
#pragma once

#include <vector>

#include "base/image.h"
#include "base/isa.h"
#include "base/kernels/warp_kernels.h"
#include "raster/scene.h"

namespace pac::sim {

// Per pixel: position of its content in the earlier frame, in 1/64 pixel between pixel centers (0, 0 = the center of
// the first pixel), or kWarpNowhere; and 1 - depth it had there.
struct Flow {
  Image<int32_t, 1> x_64, y_64;
  DepthImage u_before;
};

// The map from (x, y, 1 - depth) of one window to homogeneous (x, y, 1 - depth, w) of another, linear in all three.
class Reprojection {
 public:
  // Depth and content of a pixel were taken at (sample_x, sample_y) inside it, 0..1. Composed in double by + - * / in a
  // fixed order, so equal on every machine.
  Reprojection(const raster::Camera& from, const raster::Camera& to, int width, int height, double sample_x,
               double sample_y);

  // The part of row y that does not depend on depth and column.
  ReprojectionRow row(int y) const;

 private:
  double matrix_[4][4];  // [row x, y, u, w][column x, y, u, 1], indices of pixels
};

// The whole picture. `flow` is made anew where its size differs.
void reproject(const Reprojection& reprojection, PlaneView<const float> depth, Flow& flow, Isa isa = best_isa());

}  // namespace pac::sim
