#include "raster/lit_vertices.h"

#include <algorithm>
#include <cstddef>

#include "raster/corner_attributes.h"

namespace pac::raster {
namespace {

constexpr uint32_t kNone = UINT32_MAX;
constexpr size_t kRange = 4096;  // vertices that one thread takes at a time

// Vertices that wait for the kernel, all of one material.
struct Batch {
  uint32_t material = kNone;
  int count = 0;
  uint32_t vertices[kBatchLanes];
  const float* at[kBatchLanes];
  LitRows rows;
  float colors[kBatchLanes][kLitFloats] = {};
};

static_assert(sizeof(Vertex) % sizeof(float) == 0 && offsetof(Vertex, position) == 0 &&
                  offsetof(Vertex, normal) == 12 && offsetof(Vertex, color) == 32,
              "as the kernels read them");

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

void LitVertices::light_range(const Mesh& mesh, const std::vector<Surface>& surfaces, const Kernels& kernels,
                              const float eye[3], const uint32_t* outcodes, size_t first, size_t last) {
  Batch batch;
  const auto copy = [this](const float* from, float* to) {
    std::copy_n(from, kLitSpecular, to);
    if (stride_ > kLitSpecular) std::copy_n(from + kLitSpecular, kLitFloats - kLitSpecular, to + kLitSpecular);
  };
  const auto flush = [&] {
    if (batch.count == 0) return;
    LitRows& rows = batch.rows;
    kernels.front.gather_vertices(batch.count, batch.at, rows.normal[0], rows.position[0], rows.color[0]);
    light_points(surfaces[batch.material], kernels.tile, batch.count, rows, batch.colors);
    for (int i = 0; i < batch.count; ++i) copy(batch.colors[i], &colors_[stride_ * size_t{batch.vertices[i]}]);
    batch.count = 0;
  };
  for (size_t eight = first; eight < last; eight += 8) {
    const auto n = static_cast<int>(std::min<size_t>(8, last - eight));
    const uint32_t facing =
        kernels.front.faces_eye(eye, mesh.vertices[eight].position, sizeof(Vertex) / sizeof(float), n);
    for (int k = 0; k < n; ++k) {
      const size_t v = eight + static_cast<size_t>(k);
      const uint32_t material = materials_[v];
      if (material == kNone) continue;
      if ((facing >> k & 1) == 0 || (outcodes[v] & (kOutView | kNotFinite)) != 0) {
        materials_[v] = kNone;  // likely not drawn, or lit from its other side
        continue;
      }
      if (material != batch.material || batch.count == kBatchLanes) flush();
      batch.material = material;
      batch.vertices[batch.count] = static_cast<uint32_t>(v);
      batch.at[batch.count++] = mesh.vertices[v].position;
    }
  }
  flush();
}

void LitVertices::prepare(const Mesh& mesh, const std::vector<Surface>& surfaces, const Kernels& kernels,
                          const uint32_t* outcodes, ThreadPool& pool) {
  n_materials_ = 0;
  const auto lit = std::find_if(surfaces.begin(), surfaces.end(),
                                [](const Surface& surface) { return surface.lit == Surface::Lit::per_corner; });
  if (lit == surfaces.end()) return;
  n_materials_ = surfaces.size();
  assign_materials(mesh, surfaces);
  const size_t n = mesh.vertices.size();
  const bool apart = std::any_of(surfaces.begin(), surfaces.end(), [](const Surface& surface) {
    return surface.lit == Surface::Lit::per_corner && surface.layout.specular >= 0;
  });
  stride_ = apart ? kLitFloats : kLitSpecular;
  if (colors_.size() < stride_ * n) colors_.resize(stride_ * n);
  pool.for_each(static_cast<int64_t>((n + kRange - 1) / kRange), [&](int64_t range) {
    const size_t first = static_cast<size_t>(range) * kRange;
    light_range(mesh, surfaces, kernels, lit->lighting.eye, outcodes, first, std::min(first + kRange, n));
  });
}

}  // namespace pac::raster
