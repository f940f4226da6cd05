#include "geomcodec/frame_coder.h"

#include "geomcodec/seams.h"

namespace pac::geomcodec {
namespace {

// neighbor(vertex, other): for each corner, its vertex and those of the next and the previous corner.
template <class Neighbor>
void for_each_neighbor(const QuantizedMesh& mesh, Neighbor neighbor) {
  for (const Face& face : mesh.faces) {
    const uint32_t* corner = mesh.indices.data() + face.first;
    for (uint32_t k = 0; k < face.count; ++k) {
      const uint32_t next = corner[k + 1 < face.count ? k + 1 : 0], previous = corner[k > 0 ? k - 1 : face.count - 1];
      if (next < corner[k]) neighbor(corner[k], next);
      if (previous < corner[k]) neighbor(corner[k], previous);
    }
  }
}

}  // namespace

FrameNeighbors::FrameNeighbors(const QuantizedMesh& mesh) : first_(mesh.vertices.size() + 1) {
  for_each_neighbor(mesh, [&](uint32_t vertex, uint32_t) {
    if (first_[vertex + 1] < kMost) ++first_[vertex + 1];
  });
  for (size_t v = 0; v + 1 < first_.size(); ++v) first_[v + 1] += first_[v];
  list_.resize(first_.back());
  std::vector<uint32_t> end(first_.begin(), first_.end() - 1);
  for_each_neighbor(mesh, [&](uint32_t vertex, uint32_t other) {
    if (end[vertex] < first_[vertex + 1]) list_[end[vertex]++] = other;
  });
}

FrameShape frame_shape(FrameGroup group, const QuantizedMesh& mesh) {
  switch (group) {
    case kFramePositions:
      return {3, mesh.position_bits, (1 << mesh.position_bits) - 1};
    case kFrameColors:
      return {4, 8, 255};
    case kFrameNormals:
      return {2, mesh.normal_bits, (1 << mesh.normal_bits) - 2};
    case kFrameTexcoords:
    case kFrameGroups:
      break;
  }
  return {2, mesh.texcoord_bits, (1 << mesh.texcoord_bits) - 1};
}

FrameValues frame_values(FrameGroup group, std::span<const QuantizedVertex> vertices) {
  FrameValues values;
  values.reserve(vertices.size());
  for (const QuantizedVertex& vertex : vertices) {
    const uint16_t* p = vertex.position;
    const uint16_t* n = vertex.normal;
    const uint16_t* t = vertex.texcoord;
    const uint8_t* c = vertex.color;
    values.push_back(group == kFramePositions ? FrameValue{p[0], p[1], p[2], 0}
                     : group == kFrameColors  ? FrameValue{c[1], c[0], c[2], c[3]}
                     : group == kFrameNormals ? FrameValue{n[0], n[1], 0, 0}
                                              : FrameValue{t[0], t[1], 0, 0});
  }
  return values;
}

void set_frame_values(FrameGroup group, const FrameValues& values, std::span<QuantizedVertex> vertices) {
  constexpr size_t kChannel[4] = {1, 0, 2, 3};
  for (size_t v = 0; v < vertices.size(); ++v) {
    const FrameValue& value = values[v];
    if (group == kFramePositions) std::copy_n(value.begin(), 3, vertices[v].position);
    if (group == kFrameNormals) std::copy_n(value.begin(), 2, vertices[v].normal);
    if (group == kFrameTexcoords) std::copy_n(value.begin(), 2, vertices[v].texcoord);
    if (group != kFrameColors) continue;
    for (size_t c = 0; c < 4; ++c) vertices[v].color[kChannel[c]] = static_cast<uint8_t>(value[c]);
  }
}

std::vector<uint32_t> frame_siblings(std::span<const QuantizedVertex> reference) {
  const Points points = find_points(reference);
  std::vector<uint32_t> newest(points.count, kNone), sibling;
  sibling.reserve(reference.size());
  for (uint32_t v = 0; v < reference.size(); ++v) {
    uint32_t& last = newest[points.of_vertex[v]];
    sibling.push_back(last);
    last = v;
  }
  return sibling;
}

}  // namespace pac::geomcodec
