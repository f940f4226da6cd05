#include "raster/lit_vertices.h"

#include <algorithm>

#include "raster/corner_attributes.h"

namespace pac::raster {
namespace {

constexpr uint32_t kNone = UINT32_MAX;
constexpr size_t kRange = 4096;  // vertices that one thread takes at a time

// Points that wait for the kernel, all of one material.
struct Batch {
  uint32_t material = kNone;
  int count = 0;
  LitPoint points[kBatchLanes];
  size_t vertices[kBatchLanes];
  float colors[kBatchLanes][6];
};

}  // namespace

void LitVertices::assign_materials(const Mesh& mesh, const std::vector<Surface>& surfaces) {
  if (surfaces.size() == 1) {  // vertices of no face too: lit for nothing, but without a walk over the faces
    materials_.assign(mesh.vertices.size(), 0);
    return;
  }
  materials_.assign(mesh.vertices.size(), kNone);
  const size_t n_indices = mesh.indices.size();
  const auto n_vertices = static_cast<uint32_t>(materials_.size());
  uint32_t* const materials = materials_.data();
  for (const Face& face : mesh.faces) {
    if (face.material >= surfaces.size() || surfaces[face.material].lit != Surface::Lit::per_corner) continue;
    if (face.first > n_indices || face.count > n_indices - face.first) continue;
    const uint32_t* const indices = mesh.indices.data() + face.first;
    for (uint32_t k = 0; k < face.count; ++k)
      if (indices[k] < n_vertices) materials[indices[k]] = face.material;
  }
}

void LitVertices::light_range(const Mesh& mesh, const std::vector<Surface>& surfaces, const TileKernels& kernels,
                              const uint32_t* outcodes, size_t first, size_t last) {
  Batch batch;
  const auto flush = [&] {
    if (batch.count == 0) return;
    light_points(surfaces[batch.material], kernels, batch.count, batch.points, batch.colors);
    for (int i = 0; i < batch.count; ++i) std::copy_n(batch.colors[i], 6, &colors_[6 * batch.vertices[i]]);
    batch.count = 0;
  };
  for (size_t v = first; v < last; ++v) {
    const uint32_t material = materials_[v];
    if (material == kNone) continue;
    const Vertex& vertex = mesh.vertices[v];
    LitPoint point{{}, &vertex};
    const float* eye = surfaces[material].lighting.eye;
    const bool usable = (outcodes[v] & (kOutView | kNotFinite)) == 0 && own_normal(vertex, point.normal);
    const float towards_eye =
        (point.normal.x * (eye[0] - vertex.position[0]) + point.normal.y * (eye[1] - vertex.position[1])) +
        point.normal.z * (eye[2] - vertex.position[2]);
    if (!usable || !(towards_eye >= 0)) {  // likely not drawn, or lit from its other side
      materials_[v] = kNone;
      continue;
    }
    if (material != batch.material || batch.count == kBatchLanes) flush();
    batch.material = material;
    batch.vertices[batch.count] = v;
    batch.points[batch.count++] = point;
  }
  flush();
}

void LitVertices::prepare(const Mesh& mesh, const std::vector<Surface>& surfaces, const TileKernels& kernels,
                          const uint32_t* outcodes, ThreadPool& pool) {
  n_materials_ = 0;
  const bool wanted = std::any_of(surfaces.begin(), surfaces.end(),
                                  [](const Surface& surface) { return surface.lit == Surface::Lit::per_corner; });
  if (!wanted) return;
  n_materials_ = surfaces.size();
  assign_materials(mesh, surfaces);
  const size_t n = mesh.vertices.size();
  if (colors_.size() < 6 * n) colors_.resize(6 * n);
  pool.for_each(static_cast<int64_t>((n + kRange - 1) / kRange), [&](int64_t range) {
    const size_t first = static_cast<size_t>(range) * kRange;
    light_range(mesh, surfaces, kernels, outcodes, first, std::min(first + kRange, n));
  });
}

}  // namespace pac::raster
