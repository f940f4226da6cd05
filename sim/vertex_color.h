// The color that untextured Gouraud shading gives the corners of a face: what the transmitted model sends.
#pragma once

#include <memory>
#include <vector>

#include "base/result.h"
#include "raster/scene.h"

namespace pac::sim {

// RGB in 0..255, not yet rounded.
struct CornerColor {
  double rgb[3];
};

// Lights corners by the rasterizer's own rules (raster/surface.h, raster/corner_attributes.h).
class VertexLighter {
 public:
  // Keeps no reference to `scene`. Fails as Renderer::render.
  static Result<VertexLighter> create(const raster::Scene& scene, const raster::Camera& camera);
  ~VertexLighter();
  VertexLighter(VertexLighter&&) noexcept;
  VertexLighter& operator=(VertexLighter&&) noexcept;

  // One color for each corner of `face`, which must be valid. Two-sided lighting takes the side of the eye.
  void light_face(const Mesh& mesh, const Face& face, std::vector<CornerColor>& colors) const;

 private:
  struct State;
  explicit VertexLighter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace pac::sim
