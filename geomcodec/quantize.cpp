#include <algorithm>
#include <cmath>

#include "geomcodec/geomcodec.h"

namespace pac::geomcodec {
namespace {

bool is_finite(const Vertex& vertex) {
  return std::isfinite(vertex.position[0]) && std::isfinite(vertex.position[1]) && std::isfinite(vertex.position[2]);
}

// One step for the three axes: what the longest side of the bounding box needs. All positions are finite.
Grid fit_grid(const std::vector<Vertex>& vertices, int bits) {
  Grid grid;
  grid.bits = bits;
  if (vertices.empty()) return grid;
  double longest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    float low = vertices[0].position[axis], high = low;
    for (const Vertex& vertex : vertices) {
      low = std::min(low, vertex.position[axis]);
      high = std::max(high, vertex.position[axis]);
    }
    grid.origin[axis] = low;
    longest = std::max(longest, double{high} - double{low});
  }
  auto step = static_cast<float>(longest / ((1 << bits) - 1));
  if (!(step > 0)) step = 1;  // no extent, or one below the smallest float
  std::fill(grid.step, grid.step + 3, step);
  return grid;
}

}  // namespace

Result<QuantizedMesh> quantize(const Mesh& mesh, int position_bits) {
  if (position_bits < 1 || position_bits > 16) return Failure{Error::bad_argument, 0, "position bits are not in 1..16"};
  for (size_t v = 0; v < mesh.vertices.size(); ++v)
    if (!is_finite(mesh.vertices[v])) return Failure{Error::corrupt, v, "vertex position is not finite"};
  return quantize(mesh, fit_grid(mesh.vertices, position_bits));
}

Result<QuantizedMesh> quantize(const Mesh& mesh, const Grid& grid) {
  if (grid.bits < 1 || grid.bits > 16) return Failure{Error::bad_argument, 0, "position bits are not in 1..16"};
  for (int axis = 0; axis < 3; ++axis)
    if (!std::isfinite(grid.origin[axis]) || !std::isfinite(grid.step[axis]) || !(grid.step[axis] > 0))
      return Failure{Error::bad_argument, 0, "grid is not finite or has no step"};

  QuantizedMesh result;
  result.position_bits = grid.bits;
  std::copy(grid.origin, grid.origin + 3, result.origin);
  std::copy(grid.step, grid.step + 3, result.step);
  result.indices = mesh.indices;
  result.faces = mesh.faces;
  result.vertices.resize(mesh.vertices.size());
  const double highest = (1 << grid.bits) - 1;
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Vertex& vertex = mesh.vertices[v];
    if (!is_finite(vertex)) return Failure{Error::corrupt, v, "vertex position is not finite"};
    for (int axis = 0; axis < 3; ++axis) {
      const double steps = (double{vertex.position[axis]} - double{grid.origin[axis]}) / double{grid.step[axis]};
      result.vertices[v].position[axis] = static_cast<uint16_t>(std::clamp(std::floor(steps + 0.5), 0.0, highest));
    }
    std::copy(vertex.color, vertex.color + 4, result.vertices[v].color);
  }
  return result;
}

Mesh dequantize(const QuantizedMesh& mesh) {
  Mesh result;
  result.indices = mesh.indices;
  result.faces = mesh.faces;
  result.vertices.resize(mesh.vertices.size());
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    for (int axis = 0; axis < 3; ++axis)
      result.vertices[v].position[axis] =
          static_cast<float>(double{mesh.origin[axis]} + mesh.vertices[v].position[axis] * double{mesh.step[axis]});
    std::copy(mesh.vertices[v].color, mesh.vertices[v].color + 4, result.vertices[v].color);
  }
  return result;
}

}  // namespace pac::geomcodec
