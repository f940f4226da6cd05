// A bounding volume hierarchy over a mesh's triangles: what shadow rays of full lighting are tested against.
#pragma once

#include <cstdint>
#include <vector>

#include "base/kernels/tile_kernels.h"
#include "base/mesh.h"

namespace pac::raster {

// Keeps its memory between updates. Same bits on every machine. Faces are fans about their first corner.
class OccluderTree {
 public:
  // Makes the tree of `mesh`; does nothing if positions, faces and indices are those of the last call. Triangles that
  // are not finite, or with coordinates beyond 2^40, or whose indices are out of range, are left out.
  void update(const Mesh& mesh);

  // Valid until the next update().
  RayTree view() const;
  // Of the bounding box of what update() took; 0 for nothing.
  float diagonal() const { return diagonal_; }

 private:
  struct Item;  // a triangle with its bounds, while the tree is being built
  bool is_same(const Mesh& mesh) const;
  void remember(const Mesh& mesh);
  void add_face(const Face& face);
  void split(std::vector<Item>& items, uint32_t first, uint32_t count, int depth);

  std::vector<float> positions_;
  std::vector<uint32_t> indices_;
  std::vector<Face> faces_;
  std::vector<RayNode> nodes_;
  std::vector<RayTriangle> triangles_;
  float diagonal_ = 0;
};

}  // namespace pac::raster
