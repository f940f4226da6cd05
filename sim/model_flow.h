// Where each pixel was in the frame that was remembered last, by what both sides know: depth, cameras, objects.
#pragma once

#include <span>
#include <vector>

#include "sim/object_motion.h"
#include "sim/reprojection.h"

namespace pac::sim {

// One object, one thread at a time.
class ModelFlow {
 public:
  // sample_x, sample_y: where in a pixel the rasterizer takes depth and id, 0..1; `movers`: movers_of() the scene
  // drawn, empty where nothing moves.
  ModelFlow(int width, int height, double sample_x, double sample_y, std::vector<uint32_t> movers, Isa isa);

  // From a frame with that depth, face ids, camera and places of its objects. Valid until the next call.
  const Flow& find(PlaneView<const float> depth, PlaneView<const uint32_t> id, const raster::Camera& camera,
                   std::span<const glm::mat4> objects);

  // The same by rows: once for the frame, then each row's runs of pixels by for_each_way().
  void prepare(const raster::Camera& camera, std::span<const glm::mat4> objects);
  std::span<const Reprojection> ways() const { return ways_; }
  std::span<const uint32_t> way_of_id() const { return way_of_id_; }

  // The frame to which find() leads.
  void remember(const raster::Camera& camera, std::span<const glm::mat4> objects);

 private:
  int width_, height_;
  double sample_x_, sample_y_;
  std::vector<uint32_t> movers_;
  Isa isa_;
  raster::Camera camera_;
  Transforms objects_;
  std::vector<Reprojection> ways_;
  std::vector<uint32_t> way_of_id_;  // empty: all go ways_[0]
  Flow flow_;
};

}  // namespace pac::sim
