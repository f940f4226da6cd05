#include "sim/vertex_color.h"

#include <algorithm>
#include <utility>

#include "base/kernels/kernels.h"
#include "raster/corner_attributes.h"
#include "raster/surface.h"
#include "raster/triangulate.h"

namespace pac::sim {

struct VertexLighter::State {
  std::vector<raster::Surface> surfaces;
  glm::vec3 eye{0};
};

Result<VertexLighter> VertexLighter::create(const raster::Scene& scene, const raster::Camera& camera) {
  raster::RenderQuality quality;
  quality.shading = raster::Shading::gouraud;
  quality.texture = false;
  auto state = std::make_unique<State>();
  PAC_CHECK(raster::prepare_surfaces(scene, camera, quality, nullptr, state->surfaces));
  state->eye = camera.eye;
  return VertexLighter(std::move(state));
}

VertexLighter::VertexLighter(std::unique_ptr<State> state) : state_(std::move(state)) {}
VertexLighter::~VertexLighter() = default;
VertexLighter::VertexLighter(VertexLighter&&) noexcept = default;
VertexLighter& VertexLighter::operator=(VertexLighter&&) noexcept = default;

void VertexLighter::light_face(const Mesh& mesh, const Face& face, std::vector<CornerColor>& colors) const {
  const raster::FaceNormal normal = raster::face_normal(mesh, face);
  const Vertex& first = mesh.vertices[mesh.indices[face.first]];
  const bool front = normal.x * (state_->eye.x - first.position[0]) + normal.y * (state_->eye.y - first.position[1]) +
                         normal.z * (state_->eye.z - first.position[2]) >=
                     0;
  const raster::FaceNormal unit = raster::unit_normal(normal);
  constexpr const float* kNotLit[3] = {nullptr, nullptr, nullptr};
  colors.resize(face.count);
  raster::CornerAttributes attributes;
  for (uint32_t k = 0; k < face.count; k += 3) {  // the rasterizer lights three corners at a time
    const Vertex* corners[3];
    for (uint32_t i = 0; i < 3; ++i)
      corners[i] = &mesh.vertices[mesh.indices[face.first + std::min(k + i, face.count - 1)]];
    raster::corner_attributes(state_->surfaces[face.material], kernels().tile, unit, corners, kNotLit, first, front,
                              attributes);
    for (uint32_t i = 0; i < 3 && k + i < face.count; ++i)
      for (int c = 0; c < 3; ++c) colors[k + i].rgb[c] = double{attributes.value[i][c]};
  }
}

}  // namespace pac::sim
