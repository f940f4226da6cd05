#include "geomcodec/open_edges.h"

namespace pac::geomcodec {

// An open edge to -> from, or kNone. Edges that were closed leave the list on the way, so that only open ones count.
uint32_t OpenEdges::find_reverse(uint32_t from, uint32_t to) {
  uint32_t* link = &out_head_[to];
  for (int i = 0; i < kSearch && *link != kNone;) {
    const uint32_t corner = *link;
    if (!is_open(corner)) {
      *link = out_next_[corner];
      continue;
    }
    if (end_of(corner) == from) return corner;
    link = &out_next_[corner];
    ++i;
  }
  return kNone;
}

void OpenEdges::add_corner(uint32_t corner) {
  const uint32_t from = topology_.corner_vertex[corner], to = end_of(corner);
  out_next_.push_back(kNone);
  in_next_.push_back(kNone);
  if (topology_.twin[corner] != kOpen) return;  // the edge that the face was entered by
  if (from == to) return close(corner);
  if (const uint32_t reverse = find_reverse(from, to); reverse != kNone) return pair(corner, reverse);
  out_next_[corner] = out_head_[from];
  out_head_[from] = corner;
  in_next_[corner] = in_head_[to];
  in_head_[to] = corner;
  if (queued_[from] == 0) {
    queued_[from] = 1;
    queue_.push_back(from);
  }
}

uint32_t OpenEdges::front() {
  while (queue_front_ < queue_.size()) {
    const uint32_t vertex = queue_[queue_front_];
    if (const uint32_t corner = newest(out_head_, out_next_, vertex); corner != kNone) return corner;
    queued_[vertex] = 0;
    ++queue_front_;
  }
  return kNone;
}

}  // namespace pac::geomcodec
