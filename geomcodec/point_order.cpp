#include "geomcodec/point_order.h"

#include <algorithm>
#include <array>

namespace pac::geomcodec {
namespace {

class PointRanker {
 public:
  PointRanker(const Topology& topology, const Stencils& stencils)
      : topology_(topology), stencils_(stencils), rank_(topology.n_vertices, kNone), support_(topology.n_vertices) {}

  std::vector<uint32_t> run() {
    for (uint32_t point = 0; point < topology_.n_vertices; ++point) {
      if (rank_[point] != kNone) continue;
      take(point);
      for (uint32_t next = best(); next != kNone; next = best()) take(next);
    }
    return std::move(rank_);
  }

 private:
  // How a point that is not known is predicted: not at all, by neighbors, by one parallelogram, by more.
  enum Support : uint8_t { kNothing, kNeighbor, kOne, kMore, kSupports };

  struct Waiting {
    std::vector<uint32_t> points;
    size_t first = 0;
  };

  bool known(uint32_t point) const { return rank_[point] != kNone; }
  uint32_t at(uint32_t corner) const { return topology_.corner_vertex[corner]; }
  void raise(uint32_t point, uint8_t support) {
    support_[point] = support;
    waiting_[support].points.push_back(point);
  }
  void meet(uint32_t point) {
    if (!known(point) && support_[point] == kNothing) raise(point, kNeighbor);
  }
  // One more parallelogram of three known points predicts it.
  void support(uint32_t point) {
    if (!known(point) && support_[point] < kMore) raise(point, support_[point] < kOne ? uint8_t{kOne} : uint8_t{kMore});
  }

  void take(uint32_t point) {
    rank_[point] = n_known_++;
    for (const uint32_t* corner = stencils_.begin(point); corner != stencils_.end(point); ++corner) {
      const uint32_t next = topology_.next(*corner), previous = topology_.previous(*corner);
      meet(at(next));
      meet(at(previous));
      if (topology_.size_of_face_at(*corner) == 3) {
        across(next);     // the point is opposite to the edge
        across(*corner);  // it is where the edge starts; the one where it ends is another corner's
      } else {
        inside(topology_.previous(previous));
        inside(previous);
        inside(next);
      }
    }
  }
  // The two triangles at an edge: the tip of either is predicted from the other three points.
  void across(uint32_t edge) {
    const uint32_t twin = topology_.twin[edge];
    if (twin == kNone || topology_.size_of_face_at(twin) != 3) return;
    const uint32_t start = at(edge), end = at(twin);
    const uint32_t here = at(topology_.previous(edge)), there = at(topology_.previous(twin));
    if (!known(start) || !known(end)) return;
    if (known(here)) support(there);
    if (known(there)) support(here);
  }
  // The corner of a larger polygon, from its neighbors and the corner two after it.
  void inside(uint32_t corner) {
    const uint32_t next = topology_.next(corner);
    if (known(at(next)) && known(at(topology_.previous(corner))) && known(at(topology_.next(next))))
      support(at(corner));
  }

  uint32_t best() {
    for (size_t support = kMore; support > kNothing; --support) {
      Waiting& waiting = waiting_[support];
      while (waiting.first < waiting.points.size()) {
        const uint32_t point = waiting.points[waiting.first++];
        if (!known(point) && support_[point] == support) return point;
      }
    }
    return kNone;
  }

  const Topology& topology_;
  const Stencils& stencils_;
  std::vector<uint32_t> rank_;  // kNone: not known
  std::vector<uint8_t> support_;
  std::array<Waiting, kSupports> waiting_;
  uint32_t n_known_ = 0;
};

}  // namespace

std::vector<uint32_t> rank_points(const Topology& topology, const Stencils& stencils) {
  return PointRanker(topology, stencils).run();
}

Topology renumbered(const Topology& topology, const std::vector<uint32_t>& rank) {
  Topology result = topology;
  for (uint32_t& point : result.corner_vertex) point = rank[point];
  return result;
}

}  // namespace pac::geomcodec
