#include "geomcodec/open_edges.h"

namespace pac::geomcodec {

// An open edge to -> from, or kNone. Edges that were closed leave the list on the way, so that only open ones count.
uint32_t OpenEdges::find_reverse(uint32_t from, uint32_t to) {
  uint32_t* link = &newest_[to].out;
  for (int i = 0; i < kSearch && *link != kNone;) {
    const uint32_t corner = *link;
    if (!is_open(corner)) {
      *link = next_[corner].out;
      continue;
    }
    if (end_of(corner) == from) return corner;
    link = &next_[corner].out;
    ++i;
  }
  return kNone;
}

void OpenEdges::add_corner(uint32_t corner) {
  const uint32_t from = topology_.corner_vertex[corner], to = end_of(corner);
  next_.emplace_back();
  if (topology_.twin[corner] != kOpen) return;  // the edge that the face was entered by
  if (from == to) return close(corner);
  if (const uint32_t reverse = find_reverse(from, to); reverse != kNone) return pair(corner, reverse);
  next_[corner] = {newest_[from].out, newest_[to].in};
  newest_[from].out = corner;
  newest_[to].in = corner;
  if (queued_[from] == 0) {
    queued_[from] = 1;
    queue_.push_back(from);
  }
}

uint32_t OpenEdges::front() {
  while (queue_front_ < queue_.size()) {
    const uint32_t vertex = queue_[queue_front_];
    if (const uint32_t corner = newest(&Links::out, vertex); corner != kNone) return corner;
    queued_[vertex] = 0;
    ++queue_front_;
  }
  return kNone;
}

}  // namespace pac::geomcodec
