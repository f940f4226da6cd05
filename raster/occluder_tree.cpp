#include "raster/occluder_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pac::raster {
namespace {

constexpr float kLargest = 0x1p40f;  // products of three differences stay finite
constexpr uint32_t kLeafSize = 4;
constexpr int kBins = 16;
constexpr int kMedianDepth = 64;  // from here on halves of equal count: at most 32 levels more
static_assert(kMedianDepth + 32 < kMaxRayDepth);

struct Box {
  float low[3] = {kLargest, kLargest, kLargest}, high[3] = {-kLargest, -kLargest, -kLargest};
  void add(const Box& other) {
    for (int c = 0; c < 3; ++c) {
      low[c] = std::min(low[c], other.low[c]);
      high[c] = std::max(high[c], other.high[c]);
    }
  }
  void add(const float p[3]) {
    for (int c = 0; c < 3; ++c) {
      low[c] = std::min(low[c], p[c]);
      high[c] = std::max(high[c], p[c]);
    }
  }
  float half_area() const {
    const float x = high[0] - low[0], y = high[1] - low[1], z = high[2] - low[2];
    return x < 0 ? 0.0f : (x * y + y * z) + z * x;
  }
};

bool is_usable(const float p[3]) {
  return std::fabs(p[0]) <= kLargest && std::fabs(p[1]) <= kLargest && std::fabs(p[2]) <= kLargest;
}

}  // namespace

struct OccluderTree::Item {
  Box box;
  float center[3];
  RayTriangle triangle;
};

bool OccluderTree::is_same(const Mesh& mesh) const {
  if (positions_.size() != 3 * mesh.vertices.size() || indices_ != mesh.indices || faces_.size() != mesh.faces.size())
    return false;
  for (size_t i = 0; i < mesh.vertices.size(); ++i)
    for (size_t c = 0; c < 3; ++c)
      if (positions_[3 * i + c] != mesh.vertices[i].position[c]) return false;  // a NaN is never the same
  for (size_t i = 0; i < faces_.size(); ++i)
    if (faces_[i].first != mesh.faces[i].first || faces_[i].count != mesh.faces[i].count) return false;
  return true;
}

void OccluderTree::remember(const Mesh& mesh) {
  positions_.resize(3 * mesh.vertices.size());
  for (size_t i = 0; i < mesh.vertices.size(); ++i)
    std::copy_n(mesh.vertices[i].position, 3, positions_.data() + 3 * i);
  indices_ = mesh.indices;
  faces_ = mesh.faces;
}

void OccluderTree::update(const Mesh& mesh) {
  if (is_same(mesh)) return;
  remember(mesh);
  nodes_.clear();
  triangles_.clear();
  diagonal_ = 0;
  std::vector<Item> items;
  for (const Face& face : faces_) {
    if (face.first > indices_.size() || face.count > indices_.size() - face.first) continue;
    for (uint32_t k = 1; k + 1 < face.count; ++k) {
      const uint32_t corners[3] = {indices_[face.first], indices_[face.first + k], indices_[face.first + k + 1]};
      Item item;
      bool usable = true;
      const float* p[3];
      for (int i = 0; i < 3; ++i) {
        usable = usable && corners[i] < mesh.vertices.size();
        p[i] = positions_.data() + 3 * (usable ? size_t{corners[i]} : 0);
        usable = usable && is_usable(p[i]);
      }
      if (!usable) continue;
      for (int i = 0; i < 3; ++i) item.box.add(p[i]);
      for (int c = 0; c < 3; ++c) {
        item.triangle.corner[c] = p[0][c];
        item.triangle.edge1[c] = p[1][c] - p[0][c];
        item.triangle.edge2[c] = p[2][c] - p[0][c];
        item.center[c] = 0.5f * item.box.low[c] + 0.5f * item.box.high[c];
      }
      items.push_back(item);
    }
  }
  if (items.empty() || items.size() > std::numeric_limits<uint32_t>::max() / 2) return;
  nodes_.reserve(items.size());
  triangles_.reserve(items.size());
  split(items, 0, static_cast<uint32_t>(items.size()), 0);
  float squared = 0;
  for (int c = 0; c < 3; ++c) {
    const float side = nodes_[0].high[c] - nodes_[0].low[c];
    squared = squared + side * side;
  }
  diagonal_ = std::sqrt(squared);
}

// Splits at the best of kBins planes of the widest axis by the surface area heuristic.
void OccluderTree::split(std::vector<Item>& items, uint32_t first, uint32_t count, int depth) {
  Box bounds, centers;
  for (uint32_t i = first; i < first + count; ++i) {
    bounds.add(items[i].box);
    centers.add(items[i].center);
  }
  const size_t at = nodes_.size();
  nodes_.emplace_back();
  RayNode node{};
  for (int c = 0; c < 3; ++c) {  // a little larger: the test of a ray against a box rounds
    const float slack = 1e-5f * (bounds.high[c] - bounds.low[c]) +
                        4e-7f * std::max(std::fabs(bounds.low[c]), std::fabs(bounds.high[c]));
    node.low[c] = bounds.low[c] - slack;
    node.high[c] = bounds.high[c] + slack;
  }
  int axis = 0;
  for (int c = 1; c < 3; ++c)
    if (centers.high[c] - centers.low[c] > centers.high[axis] - centers.low[axis]) axis = c;
  const float size = centers.high[axis] - centers.low[axis];
  if (count <= kLeafSize || (!(size > 0) && count <= 0xFFFF)) {
    node.first = static_cast<uint32_t>(triangles_.size());
    node.count = static_cast<uint16_t>(count);
    for (uint32_t i = first; i < first + count; ++i) triangles_.push_back(items[i].triangle);
    nodes_[at] = node;
    return;
  }

  const auto begin = items.begin() + first;
  uint32_t n_left = count / 2;
  if (depth < kMedianDepth && size > 0) {
    const auto bin_of = [&](const Item& item) {
      const auto bin = static_cast<int>((item.center[axis] - centers.low[axis]) / size * static_cast<float>(kBins));
      return std::min(bin, kBins - 1);
    };
    Box boxes[kBins];
    uint32_t counts[kBins] = {};
    for (uint32_t i = first; i < first + count; ++i) {
      const int bin = bin_of(items[i]);
      ++counts[bin];
      boxes[bin].add(items[i].box);
    }
    Box right[kBins];  // of the bins from here on
    right[kBins - 1] = boxes[kBins - 1];
    for (int b = kBins - 2; b > 0; --b) {
      right[b] = boxes[b];
      right[b].add(right[b + 1]);
    }
    float best_cost = 0;
    int best = 0;
    Box left;
    for (uint32_t b = 1, n = 0; b < kBins; ++b) {
      left.add(boxes[b - 1]);
      n += counts[b - 1];
      if (n == 0 || n == count) continue;
      const float cost =
          left.half_area() * static_cast<float>(n) + right[b].half_area() * static_cast<float>(count - n);
      if (best != 0 && !(cost < best_cost)) continue;
      best_cost = cost;
      best = static_cast<int>(b);
    }
    // The first and the last bin hold the extreme centers, so a split exists. Stable: the same order everywhere.
    const auto middle =
        std::stable_partition(begin, begin + count, [&](const Item& item) { return bin_of(item) < best; });
    n_left = static_cast<uint32_t>(middle - begin);
  }
  node.axis = static_cast<uint16_t>(axis);
  split(items, first, n_left, depth + 1);
  node.first = static_cast<uint32_t>(nodes_.size());
  split(items, first + n_left, count - n_left, depth + 1);
  nodes_[at] = node;
}

RayTree OccluderTree::view() const {
  // A hundredth of the model: farther than the facets of a reasonably fine surface reach.
  return {nodes_.empty() ? nullptr : nodes_.data(), triangles_.data(), 0.01f * diagonal_};
}

}  // namespace pac::raster
