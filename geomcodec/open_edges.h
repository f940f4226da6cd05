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

  void reserve(size_t n_corners) { next_.reserve(n_corners); }
  void add_vertex() {
    newest_.emplace_back();
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
    const uint32_t corner = newest(&Links::in, vertex);
    return corner == kNone ? kNone : topology_.corner_vertex[corner];
  }
  uint32_t after(uint32_t vertex) {
    const uint32_t corner = newest(&Links::out, vertex);
    return corner == kNone ? kNone : end_of(corner);
  }

 private:
  bool is_open(uint32_t corner) const { return topology_.twin[corner] == kOpen; }
  uint32_t end_of(uint32_t corner) const { return topology_.corner_vertex[topology_.next(corner)]; }
  // Corners whose edges leave (out) and enter (in) one vertex: lists, newest first.
  struct Links {
    uint32_t out = kNone, in = kNone;
  };
  // Edges that are no longer open leave the lists when they come to the front.
  uint32_t newest(uint32_t Links::*list, uint32_t vertex) {
    uint32_t& corner = newest_[vertex].*list;
    while (corner != kNone && !is_open(corner)) corner = next_[corner].*list;
    return corner;
  }
  uint32_t find_reverse(uint32_t from, uint32_t to);

  Topology& topology_;
  std::vector<Links> newest_;    // per vertex: where its lists begin
  std::vector<Links> next_;      // per corner: the one before it in either list
  std::vector<uint8_t> queued_;  // per vertex: it is in queue_
  std::vector<uint32_t> queue_;  // vertices with edges to build on, oldest at queue_front_
  size_t queue_front_ = 0;
};

}  // namespace pac::geomcodec
