#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <unordered_map>

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

// Octahedral: the point where the direction meets |x| + |y| + |z| = 1, the lower half folded outwards.
void quantize_normal(const float (&normal)[3], int bits, uint16_t (&out)[2]) {
  const double m = (1 << (bits - 1)) - 1;
  double n[3] = {normal[0], normal[1], normal[2]};
  const double length = std::abs(n[0]) + std::abs(n[1]) + std::abs(n[2]);
  if (!std::isfinite(length) || !(length > 0)) n[0] = n[1] = 0, n[2] = 1;
  const double scale = std::isfinite(length) && length > 0 ? m / length : m;
  double u = n[0] * scale, v = n[1] * scale;
  if (n[2] < 0) {
    const double outer_u = m - std::abs(v), outer_v = m - std::abs(u);
    u = u < 0 ? -outer_u : outer_u;
    v = v < 0 ? -outer_v : outer_v;
  }
  out[0] = static_cast<uint16_t>(std::clamp(std::floor(u + m + 0.5), 0.0, 2 * m));
  out[1] = static_cast<uint16_t>(std::clamp(std::floor(v + m + 0.5), 0.0, 2 * m));
}

void dequantize_normal(const uint16_t (&in)[2], int bits, float (&normal)[3]) {
  const double m = (1 << (bits - 1)) - 1;
  double u = in[0] - m, v = in[1] - m;
  const double z = m - std::abs(u) - std::abs(v);
  if (z < 0) {
    const double inner_u = m - std::abs(v), inner_v = m - std::abs(u);
    u = u < 0 ? -inner_u : inner_u;
    v = v < 0 ? -inner_v : inner_v;
  }
  const double length = std::sqrt(u * u + v * v + z * z);
  normal[0] = static_cast<float>(u / length);
  normal[1] = static_cast<float>(v / length);
  normal[2] = static_cast<float>(z / length);
}

Result<void> quantize_texcoords(const Mesh& mesh, QuantizedMesh& result) {
  double low[2] = {0, 0}, high[2] = {0, 0};
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    for (int i = 0; i < 2; ++i) {
      const float t = mesh.vertices[v].texcoord[i];
      if (!std::isfinite(t)) return Failure{Error::corrupt, v, "texture coordinate is not finite"};
      low[i] = v == 0 ? double{t} : std::min(low[i], double{t});
      high[i] = v == 0 ? double{t} : std::max(high[i], double{t});
    }
  }
  const double highest = (1 << result.texcoord_bits) - 1;
  result.texcoord_step = static_cast<float>(std::max(high[0] - low[0], high[1] - low[1]) / highest);
  if (!(result.texcoord_step > 0)) result.texcoord_step = 1;
  for (int i = 0; i < 2; ++i) result.texcoord_origin[i] = static_cast<float>(low[i]);
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    for (int i = 0; i < 2; ++i) {
      const double steps =
          (double{mesh.vertices[v].texcoord[i]} - double{result.texcoord_origin[i]}) / double{result.texcoord_step};
      result.vertices[v].texcoord[i] = static_cast<uint16_t>(std::clamp(std::floor(steps + 0.5), 0.0, highest));
    }
  }
  return {};
}

struct HashVertex {
  size_t operator()(const QuantizedVertex& vertex) const {
    uint64_t hash = 0xCBF29CE484222325u;
    const auto add = [&](uint64_t value) { hash = (hash ^ value) * 0x9E3779B97F4A7C15u, hash ^= hash >> 29; };
    for (const uint16_t p : vertex.position) add(p);
    for (const uint8_t c : vertex.color) add(c);
    for (int i = 0; i < 2; ++i) add(uint64_t{vertex.normal[i]} << 16 | vertex.texcoord[i]);
    return static_cast<size_t>(hash);
  }
};

}  // namespace

QuantizedMesh merge_equal_vertices(const QuantizedMesh& mesh) {
  QuantizedMesh result = mesh;
  result.vertices.clear();
  std::unordered_map<QuantizedVertex, uint32_t, HashVertex> number;
  for (uint32_t& index : result.indices) {
    const QuantizedVertex& vertex = mesh.vertices[index];
    const auto [entry, added] = number.try_emplace(vertex, static_cast<uint32_t>(result.vertices.size()));
    if (added) result.vertices.push_back(vertex);
    index = entry->second;
  }
  return result;
}

Result<QuantizedMesh> quantize(const Mesh& mesh, const AttributeBits& bits) {
  if (bits.normal != 0 && (bits.normal < 2 || bits.normal > 16))
    return Failure{Error::bad_argument, 0, "normal bits are not 0 or in 2..16"};
  if (bits.texcoord < 0 || bits.texcoord > 16)
    return Failure{Error::bad_argument, 0, "texture coordinate bits are not in 0..16"};
  PAC_TRY(QuantizedMesh result, quantize(mesh, bits.position));
  result.normal_bits = bits.normal;
  result.texcoord_bits = bits.texcoord;
  if (bits.normal != 0)
    for (size_t v = 0; v < mesh.vertices.size(); ++v)
      quantize_normal(mesh.vertices[v].normal, bits.normal, result.vertices[v].normal);
  if (bits.texcoord != 0) PAC_CHECK(quantize_texcoords(mesh, result));
  return result;
}

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
    if (mesh.normal_bits != 0) dequantize_normal(mesh.vertices[v].normal, mesh.normal_bits, result.vertices[v].normal);
    if (mesh.texcoord_bits == 0) continue;
    for (int i = 0; i < 2; ++i)
      result.vertices[v].texcoord[i] = static_cast<float>(double{mesh.texcoord_origin[i]} +
                                                          mesh.vertices[v].texcoord[i] * double{mesh.texcoord_step});
  }
  return result;
}

}  // namespace pac::geomcodec
