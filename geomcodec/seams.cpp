#include "geomcodec/seams.h"

#include <bit>

#include "geomcodec/models.h"

namespace pac::geomcodec {
namespace {

// What is known of the far end of an edge: whether its two faces use the same vertex there.
enum FarEnd : uint32_t { kUnknown, kJoined, kSplit, kFarEnds };

// A vertex that a face beside the corner's uses at the corner's point.
struct Candidate {
  uint32_t vertex = kNone;
  FarEnd far_end = kUnknown;
};

template <class Coder>
class SeamCoder {
 public:
  SeamCoder(Coder& coder, const Topology& points, uint32_t n_vertices)
      : coder_(coder), points_(points), total_(n_vertices), newest_(points.n_vertices, kNone) {}

  // The vertex of the next corner; kNone if the data is corrupt. wanted (encoder): it, or kNone for a new one.
  uint32_t code(uint32_t wanted);
  Seams take() { return std::move(seams_); }

 private:
  Candidate across_entering(uint32_t corner) const;
  Candidate across_leaving(uint32_t corner) const;
  uint32_t choose(uint32_t corner, uint32_t point, uint32_t wanted);
  uint32_t add(uint32_t point) {
    seams_.vertex_point.push_back(point);
    seams_.sibling.push_back(newest_[point]);
    return newest_[point] = seams_.n_vertices() - 1;
  }
  FarEnd compare(uint32_t one, uint32_t other, uint32_t corner) const {
    if (one >= corner || other >= corner) return kUnknown;
    return seams_.corner_vertex[one] == seams_.corner_vertex[other] ? kJoined : kSplit;
  }

  Coder& coder_;
  const Topology& points_;
  const uint32_t total_;
  std::vector<uint32_t> newest_;  // per point: its newest vertex
  Seams seams_;
  uint32_t last_answer_ = 0;
  AdaptiveBit entering_one_[kFarEnds][kFarEnds][3], entering_two_[kFarEnds][3][2];
  AdaptiveBit leaving_one_[kFarEnds][kFarEnds], leaving_two_[kFarEnds][3];
  AdaptiveBit new_one_[3][kFarEnds][kFarEnds], new_two_[3][3];
  NumberModel age_;
};

// Across the edge that enters the corner.
template <class Coder>
Candidate SeamCoder<Coder>::across_entering(uint32_t corner) const {
  const uint32_t edge = points_.previous(corner), twin = points_.twin[edge];
  if (twin == kNone || twin >= corner) return {};
  return {seams_.corner_vertex[twin], compare(edge, points_.next(twin), corner)};
}

template <class Coder>
Candidate SeamCoder<Coder>::across_leaving(uint32_t corner) const {
  const uint32_t twin = points_.twin[corner];
  if (twin == kNone) return {};
  const uint32_t here = points_.next(twin);
  if (here >= corner) return {};
  return {seams_.corner_vertex[here], compare(points_.next(corner), twin, corner)};
}

template <class Coder>
uint32_t SeamCoder<Coder>::choose(uint32_t corner, uint32_t point, uint32_t wanted) {
  const Candidate entering = across_entering(corner), leaving = across_leaving(corner);
  const uint32_t relation = leaving.vertex == kNone ? 0 : leaving.vertex == entering.vertex ? 1 : 2;
  uint32_t n_asked = 0;
  if (entering.vertex != kNone) {
    ++n_asked;
    if (coder_.bit(entering_one_[entering.far_end][leaving.far_end][relation],
                   entering_two_[entering.far_end][last_answer_][relation == 2 ? 1 : 0],
                   wanted == entering.vertex ? 1 : 0) != 0)
      return last_answer_ = 0, entering.vertex;
  }
  if (leaving.vertex != kNone && relation == 2) {
    ++n_asked;
    if (coder_.bit(leaving_one_[leaving.far_end][entering.far_end], leaving_two_[leaving.far_end][last_answer_],
                   wanted == leaving.vertex ? 1 : 0) != 0)
      return last_answer_ = 0, leaving.vertex;
  }
  if (seams_.n_vertices() < total_ && coder_.bit(new_one_[n_asked][entering.far_end][leaving.far_end],
                                                 new_two_[n_asked][last_answer_], wanted == kNone ? 1 : 0) != 0)
    return last_answer_ = 1, add(point);
  last_answer_ = 2;
  const uint32_t newest = seams_.n_vertices() - 1;
  const uint32_t age = code_number(coder_, age_, newest - wanted);
  if (age > newest || seams_.vertex_point[newest - age] != point) return kNone;
  return newest - age;
}

template <class Coder>
uint32_t SeamCoder<Coder>::code(uint32_t wanted) {
  const auto corner = static_cast<uint32_t>(seams_.corner_vertex.size());
  const uint32_t point = points_.corner_vertex[corner];
  uint32_t vertex = kNone;
  if (newest_[point] != kNone)
    vertex = choose(corner, point, wanted);
  else if (seams_.n_vertices() < total_)
    vertex = add(point);
  seams_.corner_vertex.push_back(vertex);
  return vertex;
}

uint64_t key_of(const QuantizedVertex& vertex) {
  return uint64_t{vertex.position[0]} | uint64_t{vertex.position[1]} << 16 | uint64_t{vertex.position[2]} << 32;
}

Seams one_vertex_a_point(const Topology& points) {
  Seams seams;
  seams.vertex_point.resize(points.n_vertices);
  for (uint32_t v = 0; v < points.n_vertices; ++v) seams.vertex_point[v] = v;
  seams.sibling.assign(points.n_vertices, kNone);
  return seams;
}

}  // namespace

Points find_points(std::span<const QuantizedVertex> vertices) {
  Points points;
  points.of_vertex.reserve(vertices.size());
  // Open addressing, at most half full; slots hold point numbers.
  const int bits = std::max(4, static_cast<int>(std::bit_width(2 * vertices.size())));
  std::vector<uint32_t> slots(size_t{1} << bits, kNone);
  std::vector<uint64_t> key;
  for (const QuantizedVertex& vertex : vertices) {
    const uint64_t wanted = key_of(vertex);
    auto slot = static_cast<size_t>(wanted * 0x9E3779B97F4A7C15u >> (64 - bits));
    while (slots[slot] != kNone && key[slots[slot]] != wanted) slot = (slot + 1) & (slots.size() - 1);
    if (slots[slot] == kNone) {
      slots[slot] = points.count++;
      key.push_back(wanted);
    }
    points.of_vertex.push_back(slots[slot]);
  }
  return points;
}

CodedSeams encode_seams(const Topology& points, std::span<const uint32_t> mesh_corner_vertex,
                        uint32_t n_mesh_vertices) {
  CodedSeams coded;
  std::vector<uint32_t> number(n_mesh_vertices, kNone);
  uint32_t n_vertices = 0;
  for (const uint32_t vertex : mesh_corner_vertex) {
    if (number[vertex] != kNone) continue;
    number[vertex] = n_vertices++;
    coded.mesh_vertex.push_back(vertex);
  }
  if (n_vertices == points.n_vertices) {
    coded.seams = one_vertex_a_point(points);
    return coded;
  }
  RangeEncoder coder;
  SeamCoder<RangeEncoder> seams(coder, points, n_vertices);
  uint32_t n_coded = 0;
  for (const uint32_t vertex : mesh_corner_vertex) {
    const bool is_new = number[vertex] >= n_coded;
    seams.code(is_new ? kNone : number[vertex]);
    n_coded += is_new ? 1 : 0;
  }
  coded.seams = seams.take();
  coded.bytes = coder.finish();
  return coded;
}

Result<Seams> decode_seams(std::span<const uint8_t> bytes, const Topology& points, uint32_t n_vertices) {
  if (n_vertices == points.n_vertices) return one_vertex_a_point(points);
  RangeDecoder coder(bytes);
  SeamCoder<RangeDecoder> seams(coder, points, n_vertices);
  for (uint32_t corner = 0; corner < points.n_corners(); ++corner)
    if (seams.code(kNone) == kNone || coder.failed()) return Failure{Error::corrupt, 0, "seams are damaged"};
  Seams result = seams.take();
  if (result.n_vertices() != n_vertices) return Failure{Error::corrupt, 0, "seams leave vertices unused"};
  if (!coder.ends_exactly()) return Failure{Error::corrupt, 0, "seams do not end where the header says"};
  return result;
}

Topology cut_at_seams(const Topology& points, const Seams& seams) {
  Topology result = points;
  result.n_vertices = seams.n_vertices();
  result.corner_vertex = seams.corner_vertex;
  if (seams.n_vertices() == points.n_vertices) return result;
  for (uint32_t corner = 0; corner < points.n_corners(); ++corner) {
    const uint32_t twin = points.twin[corner];
    if (twin == kNone) continue;
    const bool joined = result.corner_vertex[corner] == result.corner_vertex[points.next(twin)] &&
                        result.corner_vertex[points.next(corner)] == result.corner_vertex[twin];
    if (!joined) result.twin[corner] = kNone;
  }
  return result;
}

}  // namespace pac::geomcodec
