// Gouraud lighting of each vertex once, however many triangles share it.
#pragma once

#include <cstdint>
#include <vector>

#include "base/kernels/kernels.h"
#include "base/parallel.h"
#include "raster/clip.h"
#include "raster/surface.h"

namespace pac::raster {

// Keeps its memory between frames.
class LitVertices {
 public:
  // Lights the vertices in view whose own normal is on the eye's side, each with the material of the last face that
  // names it. Does nothing where no material is lit at corners. Faces need not be valid. `outcodes`: one a vertex.
  void prepare(const Mesh& mesh, const std::vector<Surface>& surfaces, const Kernels& kernels, const uint32_t* outcodes,
               ThreadPool& pool);

  // What light_points() gives a vertex under a material by its own normal, or null: light it there. Four floats are
  // readable.
  const float* find(uint32_t vertex, uint32_t material) const {
    return has(vertex, material) ? &colors_[stride_ * size_t{vertex}] : nullptr;
  }

  // Whether find() is not null; then it is colors() + stride() * vertex.
  bool has(uint32_t vertex, uint32_t material) const {
    return material < n_materials_ && materials_[vertex] == material;
  }
  const float* colors() const { return colors_.data(); }
  size_t stride() const { return stride_; }

 private:
  void assign_materials(const Mesh& mesh, const std::vector<Surface>& surfaces);
  void light_range(const Mesh& mesh, const std::vector<Surface>& surfaces, const Kernels& kernels, const float eye[3],
                   const uint32_t* outcodes, size_t first, size_t last);

  size_t n_materials_ = 0;           // 0: nothing prepared
  std::vector<uint32_t> materials_;  // a vertex; kNone = not lit
  size_t stride_ = 0;                // floats a vertex: kLitSpecular where no material keeps specular color apart
  std::vector<float> colors_;
};

}  // namespace pac::raster
