// Where each pixel's content was one frame earlier, from depth, two cameras and where objects were: no search, no bits
// [Levoy95 s.5, Wallach 94, Guenter 93].
#pragma once

#include <span>

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

// An object's vertices as a camera sees them; `world_from_object` is affine.
struct MovedView {
  const raster::Camera& camera;
  const glm::mat4& world_from_object;
};

// The map from (x, y, 1 - depth) of one window to homogeneous (x, y, 1 - depth, w) of another, linear in all three.
class Reprojection {
 public:
  // Depth and content of a pixel were taken at (sample_x, sample_y) inside it, 0..1. Composed in double by + - * / in a
  // fixed order, so equal on every machine.
  Reprojection(const raster::Camera& from, const raster::Camera& to, int width, int height, double sample_x,
               double sample_y);

  // Of an object that moved. Where its volume vanished nothing is found.
  Reprojection(const MovedView& from, const MovedView& to, int width, int height, double sample_x, double sample_y);

  // The part of row y that does not depend on depth and column, columns counted from `first`.
  ReprojectionRow row(int y, int first = 0) const;

 private:
  double matrix_[4][4];  // [row x, y, u, w][column x, y, u, 1], indices of pixels
};

// The whole picture. `flow` is made anew where its size differs.
void reproject(const Reprojection& reprojection, PlaneView<const float> depth, Flow& flow, Isa isa = best_isa());

// The whole picture where things move: pixels of face id i go ways[way_of_id[i]], and ids beyond the end ways[0], of
// which there is one at least. kNoWay: nowhere.
constexpr uint32_t kNoWay = UINT32_MAX;
void reproject(std::span<const Reprojection> ways, std::span<const uint32_t> way_of_id, PlaneView<const float> depth,
               PlaneView<const uint32_t> id, Flow& flow, Isa isa = best_isa());

// A row's runs of pixels that go one way: use(first, n, way), nullptr: nowhere. An empty way_of_id: all go ways[0].
template <class Use>
void for_each_way(std::span<const Reprojection> ways, std::span<const uint32_t> way_of_id, const uint32_t* ids,
                  int width, const Use& use) {
  PAC_ASSERT(!ways.empty());
  if (way_of_id.empty()) return use(0, width, ways.data());
  const auto way_at = [&](int x) { return ids[x] < way_of_id.size() ? way_of_id[ids[x]] : 0; };
  for (int first = 0; first < width;) {
    const uint32_t way = way_at(first);
    int end = first + 1;
    while (end < width && way_at(end) == way) ++end;
    use(first, end - first, way == kNoWay ? nullptr : &ways[way]);
    first = end;
  }
}

}  // namespace pac::sim
