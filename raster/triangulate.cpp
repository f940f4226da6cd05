#include "raster/triangulate.h"

#include <algorithm>
#include <cmath>

namespace pac::raster {
namespace {

const float* position(const Mesh& mesh, const Face& face, uint32_t corner) {
  return mesh.vertices[mesh.indices[face.first + corner]].position;
}

// Drops the axis along which the normal is longest, keeping the polygon counter-clockwise.
struct Axes {
  int u, v;
};
Axes projection_axes(const FaceNormal& n) {
  const float ax = std::fabs(n.x), ay = std::fabs(n.y), az = std::fabs(n.z);
  const int axis = ax > ay ? (ax > az ? 0 : 2) : (ay > az ? 1 : 2);
  const float along = axis == 0 ? n.x : axis == 1 ? n.y : n.z;
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  return along < 0 ? Axes{v, u} : Axes{u, v};
}

}  // namespace

FaceNormal face_normal(const Mesh& mesh, const Face& face) {
  double sum[3] = {0, 0, 0};
  const float* origin = position(mesh, face, 0);
  for (uint32_t i = 1; i + 1 < face.count; ++i) {
    const float *p = position(mesh, face, i), *q = position(mesh, face, i + 1);
    double a[3], b[3];
    for (int k = 0; k < 3; ++k) {
      a[k] = static_cast<double>(p[k]) - static_cast<double>(origin[k]);
      b[k] = static_cast<double>(q[k]) - static_cast<double>(origin[k]);
    }
    for (int k = 0; k < 3; ++k) sum[k] += a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
  }
  return {static_cast<float>(sum[0]), static_cast<float>(sum[1]), static_cast<float>(sum[2])};
}

void PolygonCutter::project(const Mesh& mesh, const Face& face) {
  const Axes axes = projection_axes(face_normal(mesh, face));
  points_.resize(face.count);
  for (uint32_t i = 0; i < face.count; ++i) {
    const float* p = position(mesh, face, i);
    points_[i] = {p[axes.u], p[axes.v]};
  }
}

// is_convex() of project(), without the buffers: most polygons are quadrilaterals.
bool PolygonCutter::is_convex_quadrilateral(const Mesh& mesh, const Face& face) {
  const Axes axes = projection_axes(face_normal(mesh, face));
  Point p[4];
  for (uint32_t i = 0; i < 4; ++i) {
    const float* at = position(mesh, face, i);
    p[i] = {at[axes.u], at[axes.v]};
  }
  // A product that is not a number fails its comparison.
  const auto left = [&](int a, int b, int c) {
    return (p[b].x - p[a].x) * (p[c].y - p[a].y) - (p[b].y - p[a].y) * (p[c].x - p[a].x) >= 0;
  };
  return left(0, 1, 2) && left(1, 2, 3) && left(2, 3, 0) && left(3, 0, 1) && left(0, 2, 3);
}

// > 0: a -> b -> c turns left.
double PolygonCutter::turn(uint32_t a, uint32_t b, uint32_t c) const {
  const Point &p = points_[a], &q = points_[b], &r = points_[c];
  return (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
}

// No right turn, and the corners go around once: seen from corner 0 the others turn left all the way.
bool PolygonCutter::is_convex() const {
  const auto n = static_cast<uint32_t>(points_.size());
  for (uint32_t i = 0; i < n; ++i)
    if (!(turn(i, (i + 1) % n, (i + 2) % n) >= 0)) return false;
  for (uint32_t i = 1; i + 1 < n; ++i)
    if (!(turn(0, i, i + 1) >= 0)) return false;
  return true;
}

// A left turn whose triangle holds no other reflex corner. Corners at the same place as one of the three do not count:
// they are bridges to holes.
bool PolygonCutter::is_ear(uint32_t corner, int64_t& budget) const {
  const uint32_t a = previous_[corner], c = next_[corner];
  if (!(turn(a, corner, c) > 0)) return false;
  budget -= static_cast<int64_t>(reflex_.size());
  const auto same = [&](uint32_t i, uint32_t j) {
    return points_[i].x == points_[j].x && points_[i].y == points_[j].y;
  };
  for (const uint32_t i : reflex_) {
    if (next_[i] == i || i == a || i == corner || i == c) continue;  // gone, or one of the three
    if (turn(a, corner, i) >= 0 && turn(corner, c, i) >= 0 && turn(c, a, i) >= 0 && !same(i, a) && !same(i, corner) &&
        !same(i, c))
      return false;
  }
  return true;
}

// Each step cuts one corner off: an ear, or, where a whole round found none or the work budget is spent, any.
void PolygonCutter::clip_ears() {
  const auto n = static_cast<uint32_t>(points_.size());
  next_.resize(n);
  previous_.resize(n);
  reflex_.clear();
  for (uint32_t i = 0; i < n; ++i) {
    next_[i] = (i + 1) % n;
    previous_[i] = (i + n - 1) % n;
  }
  for (uint32_t i = 0; i < n; ++i)
    if (!(turn(previous_[i], i, next_[i]) > 0)) reflex_.push_back(i);
  int64_t budget = int64_t{1} << 24;  // point-in-triangle tests: a fraction of a second
  uint32_t left = n, corner = 0, tried = 0;
  while (left > 3) {
    if (tried < left && budget > 0 && !is_ear(corner, budget)) {
      corner = next_[corner];
      ++tried;
      continue;
    }
    const uint32_t a = previous_[corner], c = next_[corner];
    triangles_.push_back({{a, corner, c}});
    next_[a] = c;
    previous_[c] = a;
    next_[corner] = corner;  // marks it as gone
    --left;
    tried = 0;
    corner = next_[c];  // not the neighbor at once: fewer slivers
  }
  triangles_.push_back({{previous_[corner], corner, next_[corner]}});
}

std::span<const CornerTriple> PolygonCutter::cut(const Mesh& mesh, const Face& face) {
  triangles_.clear();
  if (face.count == 3) {
    triangles_.push_back({{0, 1, 2}});
    return triangles_;
  }
  if (face.count == 4 && is_convex_quadrilateral(mesh, face)) {
    triangles_.push_back({{0, 1, 2}});
    triangles_.push_back({{0, 2, 3}});
    return triangles_;
  }
  project(mesh, face);
  if (face.count != 4 && is_convex()) {
    for (uint32_t i = 1; i + 1 < face.count; ++i) triangles_.push_back({{0, i, i + 1}});
  } else {
    clip_ears();
  }
  return triangles_;
}

}  // namespace pac::raster
