// The boundary of the part of a mesh that is coded so far: directed edges that one face uses and that a second face may
// still use the other way round. Operations take constant time on average whatever the mesh: searches look at kSearch
// open edges.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "geomcodec/topology.h"

namespace pac::geomcodec {

class OpenEdges {
 public:
  static constexpr int kSearch = 32;

  explicit OpenEdges(Topology& topology) : topology_(topology) {}

  void add_vertex() {
    out_head_.push_back(kNone);
    in_head_.push_back(kNone);
    queued_.push_back(0);
  }
  // Call for each corner of a new face in turn, once all of its corners are in the topology. Pairs the corner's edge
  // with the most recent open one that runs the other way, among the kSearch newest at that end; else opens it.
  void add_corner(uint32_t corner);
  // The next edge to build on: the newest one out of the vertex that has waited longest. kNone when none is open.
  uint32_t front();
  // No face will use it: gone from the boundary.
  void close(uint32_t corner) { topology_.twin[corner] = kNone; }
  void pair(uint32_t one, uint32_t other) {
    topology_.twin[one] = other;
    topology_.twin[other] = one;
  }

  // The vertex before `vertex` (after it) on the boundary: where its newest open edge comes from (goes to), or kNone.
  uint32_t before(uint32_t vertex) {
    const uint32_t corner = newest(in_head_, in_next_, vertex);
    return corner == kNone ? kNone : topology_.corner_vertex[corner];
  }
  uint32_t after(uint32_t vertex) {
    const uint32_t corner = newest(out_head_, out_next_, vertex);
    return corner == kNone ? kNone : end_of(corner);
  }

 private:
  bool is_open(uint32_t corner) const { return topology_.twin[corner] == kOpen; }
  uint32_t end_of(uint32_t corner) const { return topology_.corner_vertex[topology_.next(corner)]; }
  // Edges that are no longer open leave the lists when they come to the front.
  uint32_t newest(std::vector<uint32_t>& head, const std::vector<uint32_t>& next, uint32_t vertex) {
    while (head[vertex] != kNone && !is_open(head[vertex])) head[vertex] = next[head[vertex]];
    return head[vertex];
  }
  uint32_t find_reverse(uint32_t from, uint32_t to);

  Topology& topology_;
  std::vector<uint32_t> out_head_, in_head_;  // per vertex: newest corner whose edge leaves (enters) it, or kNone
  std::vector<uint32_t> out_next_, in_next_;  // per corner: the one before it in that list
  std::vector<uint8_t> queued_;               // per vertex: it is in queue_
  std::vector<uint32_t> queue_;               // vertices with edges to build on, oldest at queue_front_
  size_t queue_front_ = 0;
};

}  // namespace pac::geomcodec
