#include "geomcodec/walk_source.h"

#include <algorithm>

namespace pac::geomcodec {

EdgeIndex::EdgeIndex(std::span<const uint32_t> indices, std::span<const Face> faces, std::span<const uint8_t> left_out,
                     uint32_t n_vertices)
    : first_(size_t{n_vertices} + 1), left_out_(left_out), taken_(left_out.begin(), left_out.end()) {
  taken_.resize(faces.size());
  uint32_t n_edges = 0;
  for (uint32_t f = 0; f < faces.size(); ++f) {
    if (taken_[f] != 0) continue;
    const Face& face = faces[f];
    n_edges += face.count;
    for (uint32_t k = 0; k < face.count; ++k) ++first_[indices[face.first + k] + 1];
  }
  for (uint32_t v = 0; v < n_vertices; ++v) first_[v + 1] += first_[v];
  edges_.resize(n_edges);
  free_offset_.assign(n_edges, 0);
  std::vector<uint32_t> end(first_.begin(), first_.end() - 1);
  for (uint32_t f = 0; f < faces.size(); ++f) {
    if (taken_[f] != 0) continue;
    const uint32_t* corner = indices.data() + faces[f].first;
    const uint32_t count = faces[f].count;
    for (uint32_t k = 0; k < count; ++k) edges_[end[corner[k]]++] = {corner[k + 1 < count ? k + 1 : 0], f, k};
  }
  for (uint32_t v = 0; v < n_vertices; ++v) std::sort(edges_.begin() + first_[v], edges_.begin() + first_[v + 1]);
}

bool EdgeIndex::find(uint32_t from, uint32_t to, uint32_t& face, uint32_t& corner) {
  const size_t end = first_[from + 1];
  const size_t run = static_cast<size_t>(
      std::lower_bound(edges_.begin() + first_[from], edges_.begin() + first_[from + 1], Edge{to, 0, 0}) -
      edges_.begin());
  if (run == end) return false;
  for (size_t i = run + free_offset_[run]; i < end && edges_[i].to == to; ++i) {
    if (taken_[edges_[i].face] == 0) {
      face = edges_[i].face;
      corner = edges_[i].corner;
      return true;
    }
    ++free_offset_[run];
  }
  return false;
}

void EdgeIndex::restart() {
  std::fill(taken_.begin(), taken_.end(), uint8_t{0});
  std::copy(left_out_.begin(), left_out_.end(), taken_.begin());
  std::fill(free_offset_.begin(), free_offset_.end(), 0);
  lowest_free_ = 0;
}

void WalkSource::restart() {
  edges.restart();
  std::fill(coded_vertex.begin(), coded_vertex.end(), kNone);
  order.vertex.clear();
  order.face.clear();
  order.first_corner.clear();
}

}  // namespace pac::geomcodec
