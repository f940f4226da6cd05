#include "sim/ray_caster.h"

#include <algorithm>
#include <glm/glm.hpp>

namespace pac::sim {

namespace {

constexpr uint32_t kLeafSize = 4;
constexpr int kBins = 12;
constexpr int kMaxDepth = 64;

glm::vec3 position(const Mesh& mesh, uint32_t corner) {
  const float* p = mesh.vertices[mesh.indices[corner]].position;
  return {p[0], p[1], p[2]};
}

struct Box {
  glm::vec3 low{1e30f}, high{-1e30f};
  void add(const glm::vec3& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  float half_area() const {
    const glm::vec3 d = high - low;
    return d.x < 0.0f ? 0.0f : d.x * d.y + d.y * d.z + d.z * d.x;
  }
};

// 1 / d, with a huge number instead of infinity, so that 0 * inf cannot occur in the slab test.
float safe_inverse(float d) {
  constexpr float kTiny = 1e-12f;
  return 1.0f / (d < 0.0f ? (d > -kTiny ? -kTiny : d) : (d < kTiny ? kTiny : d));
}

}  // namespace

RayCaster::RayCaster(const Mesh& mesh) {
  for (uint32_t f = 0; f < mesh.faces.size(); ++f) {
    const Face& face = mesh.faces[f];
    const glm::vec3 corner = position(mesh, face.first);
    for (uint32_t k = 1; k + 1 < face.count; ++k)
      triangles_.push_back(
          {corner, position(mesh, face.first + k) - corner, position(mesh, face.first + k + 1) - corner, f});
  }
  nodes_.reserve(triangles_.size());
  nodes_.push_back({});
  build(0, 0, static_cast<uint32_t>(triangles_.size()));
}

// Splits at the best of kBins planes of the longest axis by the surface area heuristic, in the middle if there is none.
void RayCaster::build(uint32_t node, uint32_t first, uint32_t count) {
  Box bounds, centers;
  const auto center = [](const Triangle& t) { return t.corner + (t.edge1 + t.edge2) * (1.0f / 3.0f); };
  for (uint32_t i = first; i < first + count; ++i) {
    const Triangle& t = triangles_[i];
    bounds.add(t.corner);
    bounds.add(t.corner + t.edge1);
    bounds.add(t.corner + t.edge2);
    centers.add(center(t));
  }
  nodes_[node].low = bounds.low - glm::vec3(1e-5f);
  nodes_[node].high = bounds.high + glm::vec3(1e-5f);
  nodes_[node].first = first;
  nodes_[node].count = count;
  const glm::vec3 size = centers.high - centers.low;
  const int axis = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
  if (count <= kLeafSize || !(size[axis] > 0.0f)) return;

  const auto bin_of = [&](const Triangle& t) {
    const auto bin = static_cast<int>((center(t)[axis] - centers.low[axis]) / size[axis] * static_cast<float>(kBins));
    return bin < kBins ? bin : kBins - 1;
  };
  Box boxes[kBins];
  uint32_t counts[kBins] = {};
  for (uint32_t i = first; i < first + count; ++i) {
    const Triangle& t = triangles_[i];
    const int bin = bin_of(t);
    ++counts[bin];
    boxes[bin].add(t.corner);
    boxes[bin].add(t.corner + t.edge1);
    boxes[bin].add(t.corner + t.edge2);
  }
  float best_cost = 1e30f;
  int best_split = 0;
  for (int split = 1; split < kBins; ++split) {
    Box left, right;
    uint32_t n_left = 0, n_right = 0;
    for (int b = 0; b < kBins; ++b) {
      if (counts[b] == 0) continue;
      Box& side = b < split ? left : right;
      (b < split ? n_left : n_right) += counts[b];
      side.add(boxes[b].low);
      side.add(boxes[b].high);
    }
    if (n_left == 0 || n_right == 0) continue;
    const float cost = left.half_area() * static_cast<float>(n_left) + right.half_area() * static_cast<float>(n_right);
    if (cost < best_cost) {
      best_cost = cost;
      best_split = split;
    }
  }
  // The extreme bins are never empty, so a split exists. stable_partition: the same order from every library.
  const auto begin = triangles_.begin() + first;
  const auto middle =
      std::stable_partition(begin, begin + count, [&](const Triangle& t) { return bin_of(t) < best_split; });
  const auto n_left = static_cast<uint32_t>(middle - begin);
  const auto left = static_cast<uint32_t>(nodes_.size());
  nodes_.push_back({});
  build(left, first, n_left);
  const auto right = static_cast<uint32_t>(nodes_.size());
  nodes_.push_back({});
  build(right, first + n_left, count - n_left);
  nodes_[node].count = 0;
  nodes_[node].first = left;
  nodes_[node].right = right;
  nodes_[node].axis = axis;
}

template <bool kAny>
bool RayCaster::trace(const glm::vec3& origin, const glm::vec3& direction, float limit, Hit* hit) const {
  const glm::vec3 inverse(safe_inverse(direction.x), safe_inverse(direction.y), safe_inverse(direction.z));
  uint32_t stack[kMaxDepth * 2];
  int depth = 0;
  stack[depth++] = 0;
  bool found = false;
  while (depth > 0) {
    const Node& node = nodes_[stack[--depth]];
    const glm::vec3 t0 = (node.low - origin) * inverse, t1 = (node.high - origin) * inverse;
    const glm::vec3 near = glm::min(t0, t1), far = glm::max(t0, t1);
    const float enter = std::max(std::max(near.x, near.y), std::max(near.z, 0.0f));
    const float leave = std::min(std::min(far.x, far.y), std::min(far.z, limit));
    if (!(enter <= leave)) continue;
    if (node.count == 0) {
      if (depth + 2 > kMaxDepth * 2) return found;       // cannot happen below 2^64 triangles
      const bool upwards = direction[node.axis] > 0.0f;  // the nearer child on top
      stack[depth++] = upwards ? node.right : node.first;
      stack[depth++] = upwards ? node.first : node.right;
      continue;
    }
    for (uint32_t i = node.first; i < node.first + node.count; ++i) {
      // Moeller-Trumbore, both sides.
      const Triangle& triangle = triangles_[i];
      const glm::vec3 p = glm::cross(direction, triangle.edge2);
      const float determinant = glm::dot(triangle.edge1, p);
      if (determinant == 0.0f) continue;
      const float scale = 1.0f / determinant;
      const glm::vec3 s = origin - triangle.corner;
      const float u = glm::dot(s, p) * scale;
      constexpr float kSlack = 1e-6f;  // neighbours overlap a little: no ray slips between them
      if (!(u >= -kSlack && u <= 1.0f + kSlack)) continue;
      const glm::vec3 q = glm::cross(s, triangle.edge1);
      const float v = glm::dot(direction, q) * scale;
      if (!(v >= -kSlack && u + v <= 1.0f + kSlack)) continue;
      const float t = glm::dot(triangle.edge2, q) * scale;
      if (!(t > 0.0f && t < limit)) continue;
      if (kAny) return true;
      limit = t;
      *hit = {t, triangle.face, determinant < 0.0f};
      found = true;
    }
  }
  return found;
}

bool RayCaster::closest(const glm::vec3& origin, const glm::vec3& direction, float limit, Hit* hit) const {
  return trace<false>(origin, direction, limit, hit);
}

bool RayCaster::occluded(const glm::vec3& origin, const glm::vec3& direction, float limit) const {
  return trace<true>(origin, direction, limit, nullptr);
}

}  // namespace pac::sim
