// Cuts a polygon into triangles.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/mesh.h"

namespace pac::raster {

// Three corners of the face, as positions in its list of indices: 0..count - 1.
struct CornerTriple {
  uint32_t corner[3];
};

// The polygon's normal by Newell's sum over its edges: length = twice its area; counter-clockwise seen from its tip.
struct FaceNormal {
  float x, y, z;
};
FaceNormal face_normal(const Mesh& mesh, const Face& face);

// Keeps its buffers between calls. One object, one thread at a time.
class PolygonCutter {
 public:
  // count - 2 triangles with the polygon's orientation. Triangles as they are, convex polygons as a fan around corner
  // 0, others by clipping ears (in the plane of the two largest components of the normal). Depends on the positions
  // only. Self-crossing, degenerate or non-finite polygons are cut somehow, in bounded time. The face must be valid.
  std::span<const CornerTriple> cut(const Mesh& mesh, const Face& face);

 private:
  struct Point {
    double x, y;
  };
  void project(const Mesh& mesh, const Face& face);
  bool is_convex() const;
  static bool is_convex_quadrilateral(const Mesh& mesh, const Face& face);
  double turn(uint32_t a, uint32_t b, uint32_t c) const;
  bool is_ear(uint32_t corner, int64_t& budget) const;
  void clip_ears();

  std::vector<CornerTriple> triangles_;
  std::vector<Point> points_;
  std::vector<uint32_t> next_, previous_;
  std::vector<uint32_t> reflex_;  // corners that are or were reflex
};

}  // namespace pac::raster
