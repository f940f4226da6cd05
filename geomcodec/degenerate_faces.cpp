#include "geomcodec/degenerate_faces.h"

#include <algorithm>
#include <utility>

#include "geomcodec/models.h"

namespace pac::geomcodec {
namespace {

// A triangle as the edge start -> end has it: (end, start, start), (end, start, end), or all at one of the two. Its
// first edge is the one beside the edge's own face.
enum Kind : uint32_t { kDoubleStart, kDoubleEnd, kAllStart, kAllEnd };

// Two points in ascending order.
struct PointPair {
  uint32_t low, high;
  bool operator<(const PointPair& o) const { return low != o.low ? low < o.low : high < o.high; }
};
PointPair pair_of(uint32_t a, uint32_t b) {
  return {std::min(a, b), std::max(a, b)};
}

// A triangle whose corners lie at these, by its number.
struct ThinFace {
  PointPair points;
  uint32_t face;
  bool operator<(const ThinFace& o) const {
    if (points < o.points || o.points < points) return points < o.points;
    return face < o.face;
  }
};

// The points of a triangle's corners, if they are at most two.
bool is_thin(const uint32_t* corner, PointPair& points) {
  const auto [low, high] = std::minmax({corner[0], corner[1], corner[2]});
  for (int k = 0; k < 3; ++k)
    if (corner[k] != low && corner[k] != high) return false;
  points = {low, high};
  return true;
}

// How often each edge holds degenerate triangles, and of what kind, for both directions.
template <class Coder>
class PlacementModels {
 public:
  PlacementModels(Coder& coder, uint32_t n_points) : coder_(coder), at_point_(n_points) {}
  // Whether the edge holds another one beyond the `before` ones told.
  bool another(uint32_t start, uint32_t end, uint32_t before, bool wanted) {
    const uint32_t many = std::min(before, 2u), here = at_point_[start], there = at_point_[end];
    const bool answer = coder_.bit(one_[many][here][there], two_[many][before == 0 ? last_ : 0], wanted ? 1 : 0) != 0;
    if (before == 0) last_ = answer ? 1 : 0;
    if (answer) {
      note(start);
      note(end);
    }
    return answer;
  }
  Kind kind(uint32_t wanted) {
    const uint32_t one_point = coder_.bit(one_point_, wanted >> 1);
    return static_cast<Kind>(2 * one_point + coder_.bit(end_[one_point], wanted & 1));
  }

 private:
  void note(uint32_t point) { at_point_[point] = static_cast<uint8_t>(std::min(at_point_[point] + 1, 3)); }

  Coder& coder_;
  std::vector<uint8_t> at_point_;  // degenerate triangles on edges at the point, at most 3
  AdaptiveBit one_[3][4][4], two_[3][2];
  AdaptiveBit one_point_, end_[2];
  uint32_t last_ = 0;
};

// Edges are asked at the lower one of their corners.
bool asks(const Topology& topology, uint32_t corner) {
  return topology.twin[corner] == kNone || topology.twin[corner] > corner;
}

void add_face(Kind kind, uint32_t corner, Topology& topology) {
  const uint32_t first = topology.n_corners();
  const uint32_t start = topology.corner_vertex[corner], end = topology.corner_vertex[topology.next(corner)];
  const uint32_t twin = topology.twin[corner];
  const uint32_t points[4][3] = {{end, start, start}, {end, start, end}, {start, start, start}, {end, end, end}};
  topology.corner_vertex.insert(topology.corner_vertex.end(), points[kind], points[kind] + 3);
  // These know the faces on both sides of the edge, which do not know them.
  const uint32_t twins[4][3] = {
      {corner, kNone, twin}, {corner, twin, kNone}, {kNone, kNone, kNone}, {kNone, kNone, kNone}};
  topology.twin.insert(topology.twin.end(), twins[kind], twins[kind] + 3);
  if (!topology.all_triangles) topology.corner_face.insert(topology.corner_face.end(), 3, topology.n_faces());
  topology.face_first.push_back(first + 3);
}

// Tells n triangles by the walked edges and adds them; how many it could not. next (encoder): whether the edge between
// two points has another one, and its kind.
template <class Coder, class Next>
uint32_t code_faces(Coder& coder, uint32_t n, Topology& topology, Next&& next) {
  PlacementModels<Coder> models(coder, topology.n_vertices);
  const uint32_t n_walked = topology.n_corners();
  uint32_t left = n;
  for (uint32_t corner = 0; corner < n_walked && left > 0 && !coder.failed(); ++corner) {
    if (!asks(topology, corner)) continue;
    const uint32_t from = topology.corner_vertex[corner], to = topology.corner_vertex[topology.next(corner)];
    for (uint32_t before = 0; left > 0 && !coder.failed(); ++before, --left) {
      uint32_t kind = 0;
      const bool wanted = next(from, to, kind);
      if (!models.another(from, to, before, wanted)) break;
      add_face(models.kind(kind), corner, topology);
    }
  }
  topology.n_degenerate_corners = 3 * (n - left);
  if (n > left) topology.all_quads = false;  // where it was told to be one of quadrilaterals
  return left;
}

// The degenerate triangles that are left to tell, by their points.
class FaceSource {
 public:
  FaceSource(std::span<const uint32_t> indices, std::span<const Face> faces, std::span<const uint8_t> degenerate,
             uint32_t n_points)
      : indices_(indices), faces_(faces), first_(size_t{n_points} + 1) {
    for (uint32_t f = 0; f < faces.size(); ++f) {
      PointPair points;
      if (degenerate[f] == 0 || !is_thin(&indices[faces[f].first], points)) continue;
      left_.push_back({points, f});
    }
    std::sort(left_.begin(), left_.end());
    n_taken_.resize(left_.size());
    for (const ThinFace& left : left_) ++first_[left.points.low + 1];
    for (size_t p = 0; p < n_points; ++p) first_[p + 1] += first_[p];
  }
  // The next one on the edge a - b, or at one of its ends, that was not taken: its face, or kNone.
  uint32_t take(uint32_t a, uint32_t b) {
    const PointPair edge = pair_of(a, b);
    for (const PointPair points : {edge, PointPair{edge.low, edge.low}, PointPair{edge.high, edge.high}}) {
      const auto first = left_.begin() + first_[points.low], last = left_.begin() + first_[points.low + 1];
      const auto run = std::lower_bound(first, last, ThinFace{points, 0});
      if (run == last || points < run->points) continue;
      uint32_t& n_taken = n_taken_[static_cast<size_t>(run - left_.begin())];
      const auto next = run + n_taken;
      if (next == last || points < next->points) continue;
      ++n_taken;
      return next->face;
    }
    return kNone;
  }
  const uint32_t* corners(uint32_t face) const { return &indices_[faces_[face].first]; }

 private:
  std::span<const uint32_t> indices_;
  std::span<const Face> faces_;
  std::vector<ThinFace> left_;   // ascending
  std::vector<uint32_t> first_;  // per point: those whose lower point it is are left_[first_[p]] .. [first_[p + 1] - 1]
  std::vector<uint32_t> n_taken_;  // at the first one of equal points: how many of these
};

// How the edge start -> end has it, and which of its corners is told first.
Kind kind_of(const uint32_t* corner, uint32_t start, uint32_t end, uint32_t& first_corner) {
  const auto is = [&](uint32_t k, uint32_t point) { return corner[k % 3] == point; };
  first_corner = 0;
  if (is(0, start) && is(1, start) && is(2, start)) return kAllStart;
  if (is(0, end) && is(1, end) && is(2, end)) return kAllEnd;
  for (uint32_t k = 0; k < 3; ++k) {
    first_corner = k;
    if (is(k, end) && is(k + 1, start)) return is(k + 2, start) ? kDoubleStart : kDoubleEnd;
  }
  PAC_ASSERT(false);
  return kAllStart;
}

}  // namespace

std::vector<uint8_t> find_degenerate_faces(std::span<const uint32_t> indices, std::span<const Face> faces,
                                           uint32_t n_points) {
  std::vector<ThinFace> thin;
  for (uint32_t f = 0; f < faces.size(); ++f) {
    PointPair points;
    if (faces[f].count == 3 && is_thin(&indices[faces[f].first], points)) thin.push_back({points, f});
  }
  if (thin.empty()) return {};
  std::sort(thin.begin(), thin.end());
  std::vector<uint8_t> concerned(n_points), is_thin_face(faces.size()), used(n_points), has_edge(thin.size());
  for (const ThinFace& t : thin) concerned[t.points.low] = concerned[t.points.high] = is_thin_face[t.face] = 1;
  for (uint32_t f = 0; f < faces.size(); ++f) {
    if (is_thin_face[f] != 0) continue;
    const uint32_t* corner = &indices[faces[f].first];
    for (uint32_t k = 0; k < faces[f].count; ++k) {
      const uint32_t a = corner[k], b = corner[k + 1 < faces[f].count ? k + 1 : 0];
      if (concerned[a] == 0) continue;
      used[a] = 1;
      if (concerned[b] == 0) continue;
      const auto wanted = pair_of(a, b);
      auto at = std::lower_bound(thin.begin(), thin.end(), wanted,
                                 [](const ThinFace& t, const PointPair& points) { return t.points < points; });
      if (at != thin.end() && !(wanted < at->points)) has_edge[static_cast<size_t>(at - thin.begin())] = 1;
    }
  }
  std::vector<uint8_t> degenerate(faces.size());
  bool any = false;
  for (size_t i = 0, run = 0; i < thin.size(); ++i) {
    const PointPair& points = thin[i].points;
    if (thin[run].points < points) run = i;  // the first one of equal points
    const bool is_on_face = points.low == points.high ? used[points.low] != 0 : has_edge[run] != 0;
    degenerate[thin[i].face] = is_on_face ? 1 : 0;
    any = any || is_on_face;
  }
  if (!any) degenerate.clear();
  return degenerate;
}

std::vector<uint8_t> encode_degenerate_faces(std::span<const uint32_t> indices, std::span<const Face> faces,
                                             std::span<const uint8_t> degenerate, Topology& topology,
                                             WalkOrder& order) {
  uint32_t n_points = 0;
  for (const uint32_t point : indices) n_points = std::max(n_points, point + 1);
  FaceSource source(indices, faces, degenerate, n_points);
  RangeEncoder coder;
  const auto n = static_cast<uint32_t>(std::count(degenerate.begin(), degenerate.end(), uint8_t{1}));
  const uint32_t left = code_faces(coder, n, topology, [&](uint32_t from, uint32_t to, uint32_t& kind) {
    const uint32_t start = order.vertex[from], end = order.vertex[to], face = source.take(start, end);
    if (face == kNone) return false;
    uint32_t first_corner = 0;
    kind = kind_of(source.corners(face), start, end, first_corner);
    order.face.push_back(face);
    order.first_corner.push_back(first_corner);
    return true;
  });
  PAC_ASSERT(left == 0);
  return coder.finish();
}

Result<void> decode_degenerate_faces(std::span<const uint8_t> bytes, uint32_t n_degenerate, Topology& topology) {
  RangeDecoder coder(bytes);
  const uint32_t left = code_faces(coder, n_degenerate, topology, [](uint32_t, uint32_t, uint32_t&) { return false; });
  if (left > 0 || coder.failed()) return Failure{Error::corrupt, 0, "degenerate faces are damaged"};
  if (!coder.ends_exactly()) return Failure{Error::corrupt, 0, "degenerate faces do not end where the header says"};
  return {};
}

}  // namespace pac::geomcodec
