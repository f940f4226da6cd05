#include "sim/model_flow.h"

#include <algorithm>
#include <utility>

namespace pac::sim {

ModelFlow::ModelFlow(int width, int height, double sample_x, double sample_y, std::vector<uint32_t> movers, Isa isa)
    : width_(width), height_(height), sample_x_(sample_x), sample_y_(sample_y), movers_(std::move(movers)), isa_(isa) {}

// One way through the two cameras for what stands, one more for each object that moved since.
void ModelFlow::prepare(const raster::Camera& camera, std::span<const glm::mat4> objects) {
  ways_.assign(1, Reprojection(camera, camera_, width_, height_, sample_x_, sample_y_));
  way_of_id_.clear();
  std::vector<uint32_t> way_of_mover(objects.size() + 1, 0);
  const size_t n_known = movers_.empty() ? 0 : std::min(objects.size(), objects_.size());
  for (size_t i = 0; i < n_known; ++i) {
    if (same_transform(objects[i], objects_[i])) continue;
    way_of_mover[i + 1] = static_cast<uint32_t>(ways_.size());
    ways_.emplace_back(MovedView{camera, objects[i]}, MovedView{camera_, objects_[i]}, width_, height_, sample_x_,
                       sample_y_);
  }
  if (ways_.size() == 1) return;
  way_of_id_.assign(movers_.size(), 0);
  for (size_t i = 0; i < movers_.size(); ++i)
    way_of_id_[i] = movers_[i] < way_of_mover.size() ? way_of_mover[movers_[i]] : kNoWay;
}

const Flow& ModelFlow::find(PlaneView<const float> depth, PlaneView<const uint32_t> id, const raster::Camera& camera,
                            std::span<const glm::mat4> objects) {
  prepare(camera, objects);
  reproject(ways_, way_of_id_, depth, id, flow_, isa_);
  return flow_;
}

void ModelFlow::remember(const raster::Camera& camera, std::span<const glm::mat4> objects) {
  camera_ = camera;
  objects_.assign(objects.begin(), objects.end());
}

}  // namespace pac::sim
