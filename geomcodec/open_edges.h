// The boundary of the part of a mesh that is coded so far: directed edges that one face uses and that a second face may
// still use the other way round. Operations take constant time on average whatever the mesh: searches look at kSearch
// open edges.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "geomcodec/topology.h"

namespace pac::geomcodec {

class OpenEdges {
 public:
  static constexpr int kSearch = 32;

  explicit OpenEdges(Topology& topology) : topology_(topology) {}

  // What is known of a vertex: all of it in one place, since each step asks for most of it.
  struct Vertex {
    uint32_t out = kNone, in = kNone;  // where its lists of edges that leave and enter it begin: newest corner
    uint32_t n_faces = 0;              // around it so far
    uint16_t has_border = 0;           // an edge at it has no second face
    uint16_t queued = 0;               // it is in queue_
  };

  // Corners below n_corners may be added.
  void resize(size_t n_corners) {
    if (n_corners <= room_) return;
    auto grown = std::make_unique_for_overwrite<Links[]>(n_corners);  // an edge's links are written when it opens
    std::copy_n(next_.get(), room_, grown.get());
    next_ = std::move(grown);
    room_ = n_corners;
  }
  void reserve(size_t n_vertices) {
    vertex_.reserve(n_vertices);
    queue_.reserve(n_vertices);
  }
  void add_vertex() { vertex_.emplace_back(); }
  Vertex& at(uint32_t vertex) { return vertex_[vertex]; }
  // Call for each corner of a new face in turn, once all of its corners are in the topology; the edge from -> to starts
  // there. Pairs it with the most recent open one that runs the other way, among the kSearch newest at that end; else
  // opens it.
  void add_edge(uint32_t corner, uint32_t from, uint32_t to) {
    if (topology_.twin[corner] != kOpen) return;  // the edge that the face was entered by
    if (from == to) return close(corner);
    // The other way round it would be among those that leave `to` and among those that enter `from`.
    if (const uint32_t newest = vertex_[to].out; newest != kNone && vertex_[from].in != kNone) {
      const bool first = is_open(newest) && end_of(newest) == from;
      if (const uint32_t reverse = first ? newest : find_reverse(from, to); reverse != kNone)
        return drop(reverse, to, from), pair(corner, reverse);
    }
    Vertex& start = vertex_[from];
    next_[corner] = {start.out, vertex_[to].in};
    start.out = corner;
    vertex_[to].in = corner;
    if (start.queued == 0) {
      start.queued = 1;
      queue_.push_back(from);
    }
  }
  // The same for the edges to and from a vertex that has no others: from -> added at `corner`, added -> to at the next
  // one. `from` is in the queue.
  void add_tip(uint32_t corner, uint32_t from, uint32_t added, uint32_t to) {
    Vertex &start = vertex_[from], &tip = vertex_[added], &end = vertex_[to];
    next_[corner] = {start.out, kNone};
    next_[corner + 1] = {kNone, end.in};
    start.out = tip.in = corner;
    tip.out = end.in = corner + 1;
    tip.queued = 1;
    queue_.push_back(added);
  }
  // The next edge to build on: the newest one out of the vertex that has waited longest. kNone when none is open.
  uint32_t front() {
    for (; queue_front_ < queue_.size(); ++queue_front_) {
      const uint32_t vertex = queue_[queue_front_];
      if (const uint32_t corner = newest_out(vertex); corner != kNone) return corner;
      vertex_[vertex].queued = 0;
    }
    return kNone;
  }
  // No face will use it: gone from the boundary.
  void close(uint32_t corner) { topology_.twin[corner] = kNone; }
  void pair(uint32_t one, uint32_t other) {
    topology_.twin[one] = other;
    topology_.twin[other] = one;
  }
  // An edge from -> to that is no longer open leaves the lists that it heads. Others it leaves when they come to it.
  void drop(uint32_t corner, uint32_t from, uint32_t to) {
    uint32_t &out = vertex_[from].out, &in = vertex_[to].in;
    const Links links = next_[corner];
    out = out == corner ? links.out : out;
    in = in == corner ? links.in : in;
  }

  // The vertex before `vertex` (after it) on the boundary: where its newest open edge comes from (goes to), or kNone.
  uint32_t before(uint32_t vertex) {
    const uint32_t corner = newest_in(vertex);
    return corner == kNone ? kNone : topology_.corner_vertex[corner];
  }
  uint32_t after(uint32_t vertex) {
    const uint32_t corner = newest_out(vertex);
    return corner == kNone ? kNone : end_of(corner);
  }

 private:
  bool is_open(uint32_t corner) const { return topology_.twin[corner] == kOpen; }
  uint32_t end_of(uint32_t corner) const { return topology_.corner_vertex[topology_.next(corner)]; }
  // The corner before one in the lists of its edge's ends: lists are newest first.
  struct Links {
    uint32_t out, in;
  };
  // Edges that are no longer open leave the lists when they come to the front.
  uint32_t newest_out(uint32_t vertex) {
    uint32_t& corner = vertex_[vertex].out;
    while (corner != kNone && !is_open(corner)) corner = next_[corner].out;
    return corner;
  }
  uint32_t newest_in(uint32_t vertex) {
    uint32_t& corner = vertex_[vertex].in;
    while (corner != kNone && !is_open(corner)) corner = next_[corner].in;
    return corner;
  }
  uint32_t find_reverse(uint32_t from, uint32_t to);

  Topology& topology_;
  std::vector<Vertex> vertex_;
  std::unique_ptr<Links[]> next_;  // per corner, of edges that were open
  size_t room_ = 0;                // of next_
  std::vector<uint32_t> queue_;    // vertices with edges to build on, oldest at queue_front_
  size_t queue_front_ = 0;
};

}  // namespace pac::geomcodec
