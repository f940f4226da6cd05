#include "geomcodec/open_edges.h"

namespace pac::geomcodec {

// An open edge to -> from, or kNone. Edges that were closed leave the list on the way, so that only open ones count.
uint32_t OpenEdges::find_reverse(uint32_t from, uint32_t to) {
  uint32_t* link = &vertex_[to].out;
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

}  // namespace pac::geomcodec
