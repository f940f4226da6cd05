#include "geomcodec/connectivity.h"

#include <algorithm>
#include <array>

#include "geomcodec/models.h"
#include "geomcodec/open_edges.h"
#include "geomcodec/table_coder.h"

namespace pac::geomcodec {
namespace {

// How a corner is named, in the order in which the code asks.
enum Step : uint32_t { kNew, kBefore, kAfter, kAfterAfter, kBeforeBefore, kOld, kSteps };

// Where in its face a corner stands: the contexts differ.
enum Place : uint32_t { kOnlyCorner, kFirstOfSeveral, kMiddle, kLastOfSeveral, kSeed, kPlaces };

constexpr uint32_t kMaxDegree = 9;  // faces around a vertex, as contexts count them

struct Models {
  AdaptiveBit face_across_left[kMaxDegree + 1][2][2];
  AdaptiveBit face_across_right[kMaxDegree + 1][2][2];
  AdaptiveBit same_size[3];  // as the gate's face, by its size: 3, 4, more
  NumberModel face_size[4];
  AdaptiveBit step_left[kPlaces][8][kMaxDegree + 1][kSteps];
  AdaptiveBit step_right[kPlaces][8][kMaxDegree + 1][kSteps][kSteps];
  NumberModel old_vertex;
};

// The faces of the encoder's mesh by directed edge.
class EdgeIndex {
 public:
  EdgeIndex(std::span<const uint32_t> indices, std::span<const Face> faces, std::span<const uint8_t> left_out,
            uint32_t n_vertices);
  // A face that is not taken and has an edge from -> to: the lowest one. Its number and the corner at `from`.
  bool find(uint32_t from, uint32_t to, uint32_t& face, uint32_t& corner);
  // The lowest face that is not taken; there must be one.
  uint32_t lowest_free() {
    while (taken_[lowest_free_] != 0) ++lowest_free_;
    return lowest_free_;
  }
  void take(uint32_t face) { taken_[face] = 1; }
  // As before any face was taken.
  void restart(std::span<const uint8_t> left_out) {
    std::fill(taken_.begin(), taken_.end(), uint8_t{0});
    std::copy(left_out.begin(), left_out.end(), taken_.begin());
    std::fill(free_offset_.begin(), free_offset_.end(), 0);
    lowest_free_ = 0;
  }

 private:
  struct Edge {
    uint32_t to, face, corner;
    bool operator<(const Edge& o) const {
      if (to != o.to) return to < o.to;
      return face != o.face ? face < o.face : corner < o.corner;
    }
  };
  std::vector<uint32_t> first_;  // per vertex: its edges are edges_[first_[v]] .. edges_[first_[v + 1] - 1], sorted
  std::vector<Edge> edges_;
  std::vector<uint32_t> free_offset_;  // at the first edge of each run of equal (from, to): edges known to be taken
  std::vector<uint8_t> taken_;
  uint32_t lowest_free_ = 0;
};

EdgeIndex::EdgeIndex(std::span<const uint32_t> indices, std::span<const Face> faces, std::span<const uint8_t> left_out,
                     uint32_t n_vertices)
    : first_(size_t{n_vertices} + 1), taken_(left_out.begin(), left_out.end()) {
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

// What only the encoder has.
struct Source {
  Source(std::span<const uint32_t> mesh_indices, std::span<const Face> mesh_faces, std::span<const uint8_t> left_out,
         uint32_t n_vertices)
      : indices(mesh_indices),
        faces(mesh_faces),
        edges(mesh_indices, mesh_faces, left_out, n_vertices),
        coded_vertex(n_vertices, kNone) {
    order.vertex.reserve(n_vertices);
    order.face.reserve(mesh_faces.size());
    order.first_corner.reserve(mesh_faces.size());
  }
  // For a second walk.
  void restart(std::span<const uint8_t> left_out) {
    edges.restart(left_out);
    std::fill(coded_vertex.begin(), coded_vertex.end(), kNone);
    order.vertex.clear();
    order.face.clear();
    order.first_corner.clear();
  }
  std::span<const uint32_t> indices;
  std::span<const Face> faces;
  EdgeIndex edges;
  std::vector<uint32_t> coded_vertex;  // per mesh vertex: its coded number, or kNone
  WalkOrder order;
  uint32_t face = 0, first_corner = 0;  // the face being coded

  uint32_t mesh_vertex(uint32_t k) const {
    const Face& f = faces[face];
    return indices[f.first + (first_corner + k) % f.count];
  }
};

// The symbols of the coding by tables: at a gate a step (of the first corner beyond it, in a face of as many corners as
// the gate's), no face, or a face of another size; at other corners a step. Contexts by degrees, by whether the two
// neighbors on the boundary are different vertices, by border or place.
enum GateSymbol : uint32_t { kNoFace = 6, kOtherSize = 7 };
constexpr uint32_t kLowDegrees = 6;  // 0..4 and more
constexpr uint32_t kGateContexts = (kMaxDegree + 1) * kLowDegrees * 2 * 2 * 2;
constexpr uint32_t kCornerContexts = 3 * kLowDegrees * kLowDegrees * 2;
constexpr size_t kWalkContexts = kGateContexts + kCornerContexts;

inline uint32_t gate_context(uint32_t degree_a, uint32_t degree_b, bool between, bool border, bool triangle) {
  const uint32_t low = degree_b < kLowDegrees ? degree_b : kLowDegrees - 1;
  return (((degree_a * kLowDegrees + low) * 2 + (between ? 1 : 0)) * 2 + (border ? 1 : 0)) * 2 + (triangle ? 1 : 0);
}
inline uint32_t corner_context(uint32_t place, uint32_t degree_left, uint32_t degree_right, bool between) {
  const uint32_t left = degree_left < kLowDegrees ? degree_left : kLowDegrees - 1;
  const uint32_t right = degree_right < kLowDegrees ? degree_right : kLowDegrees - 1;
  return kGateContexts + ((place * kLowDegrees + left) * kLowDegrees + right) * 2 + (between ? 1 : 0);
}

template <class Coder>
class Walk {
 public:
  Walk(Coder& coder, const ConnectivityHeader& header, Source* source, uint64_t expected_corners)
      : coder_(coder), header_(header), source_(source), open_(topology_), models_(Coder::kTables ? 0 : 1) {
    topology_.all_triangles = header.n_corners == uint64_t{3} * header.n_faces;
    topology_.all_quads = header.n_corners == uint64_t{4} * header.n_faces;  // until another face comes
    open_.reserve(static_cast<uint32_t>(std::min<uint64_t>(header.n_vertices, expected_corners)));
    if (!topology_.all_triangles)
      topology_.face_first.reserve(1 + std::min<uint64_t>(header.n_faces, expected_corners));
    // What so many bytes usually hold; a regular mesh grows beyond it.
    resize(static_cast<uint32_t>(std::min<uint64_t>(header.n_corners, expected_corners)));
  }

  // False: the data cannot come from an encoder.
  bool run() {
    while (n_faces_ < header_.n_faces) {
      const uint32_t gate = open_.front();
      if (gate == kNone) {
        if (!code_seed()) return false;
      } else if constexpr (Coder::kTables) {
        if (!code_gate(gate)) return false;
      } else if (face_across(gate)) {
        if (!code_face(gate)) return false;
      }
      if (coder_.failed()) return false;
    }
    resize(n_corners_);
    static_assert(kOpen + 1 == kNone);
    for (uint32_t& twin : topology_.twin) twin += twin == kOpen ? 1 : 0;
    if (topology_.all_triangles) number_triangles();
    return topology_.n_vertices == header_.n_vertices && n_corners_ == header_.n_corners;
  }
  Topology take() { return std::move(topology_); }

 private:
  // Arrays by corner are longer than what is coded, so that adding a face need not ask each of them.
  void resize(uint32_t n_corners) {
    topology_.corner_vertex.resize(n_corners);
    topology_.twin.resize(n_corners, kOpen);
    if (!topology_.all_triangles) topology_.corner_face.resize(n_corners);
    open_.resize(n_corners);
  }
  void make_room(uint32_t n_corners) {
    if (n_corners <= topology_.twin.size()) return;
    resize(static_cast<uint32_t>(std::min<uint64_t>(header_.n_corners, uint64_t{2} * n_corners)));
  }
  void number_triangles() {
    topology_.face_first.resize(size_t{n_faces_} + 1);
    for (uint32_t face = 0; face < n_faces_; ++face) topology_.face_first[face + 1] = 3 * face + 3;
  }
  static uint32_t clamped(uint32_t value, uint32_t limit) { return value < limit ? value : limit; }
  uint32_t start_of(uint32_t corner) const { return topology_.corner_vertex[corner]; }
  uint32_t end_of(uint32_t corner) const { return start_of(topology_.next(corner)); }
  uint32_t degree(uint32_t vertex) { return clamped(open_.at(vertex).n_faces, kMaxDegree); }

  bool face_across(uint32_t gate);
  bool code_seed();
  bool code_face(uint32_t gate);
  bool code_gate(uint32_t gate);
  bool code_table_corner(uint32_t k, uint32_t place);
  Step find_step(std::array<uint32_t, kOld>& candidate, uint32_t wanted);
  uint32_t find_corner(Step step, std::array<uint32_t, kOld>& candidate, uint32_t mesh_vertex);
  uint32_t code_plain_number(uint32_t number);
  uint32_t code_size(uint32_t context);
  uint32_t code_size_across(uint32_t gate_size);
  bool code_corner(uint32_t k, Place place);
  uint32_t add_vertex(uint32_t mesh_vertex);
  Step code_step(Place place, std::array<uint32_t, kOld>& candidate, uint32_t wanted);
  Step code_far_step(AdaptiveBit* one, AdaptiveBit* two, std::array<uint32_t, kOld>& candidate, uint32_t wanted);
  uint32_t code_old_vertex(uint32_t wanted);
  void finish_face(uint32_t gate);
  void finish_triangle(uint32_t gate, uint32_t a, uint32_t b, uint32_t tip, bool is_new);
  void note_face();

  Coder& coder_;
  const ConnectivityHeader header_;
  Source* source_;  // null when decoding
  Topology topology_;
  OpenEdges open_;
  uint32_t n_corners_ = 0, n_faces_ = 0;
  std::vector<uint32_t> corners_;  // vertices of the face being coded, first edge = the gate reversed
  std::vector<Models> models_;     // one element: too large for the stack
  uint32_t last_step_ = kNew;
  bool last_across_ = true;
};

template <class Coder>
bool Walk<Coder>::face_across(uint32_t gate) {
  const uint32_t a = start_of(gate), b = end_of(gate);
  uint32_t wanted = 0;
  if constexpr (!Coder::kDecodes)
    wanted =
        source_->edges.find(source_->order.vertex[b], source_->order.vertex[a], source_->face, source_->first_corner);
  const uint32_t border_a = open_.at(a).has_border, border_b = open_.at(b).has_border;
  const bool across = coder_.bit(models_[0].face_across_left[degree(a)][border_a][last_across_],
                                 models_[0].face_across_right[degree(b)][border_b][border_a], wanted) != 0;
  last_across_ = across;
  if (!across) {
    open_.close(gate);
    open_.at(a).has_border = open_.at(b).has_border = 1;
  }
  return across;
}

template <class Coder>
uint32_t Walk<Coder>::code_size(uint32_t context) {
  if (topology_.all_triangles) return 0;
  uint32_t wanted = 0;
  if constexpr (!Coder::kDecodes) wanted = source_->faces[source_->face].count - 3;
  if constexpr (Coder::kTables)
    return code_plain_number(wanted);
  else
    return code_number(coder_, models_[0].face_size[context], wanted);
}

// Corners less 3 of the face across a gate: mostly those of the gate's own face.
template <class Coder>
uint32_t Walk<Coder>::code_size_across(uint32_t gate_size) {
  if (topology_.all_triangles) return 0;
  const uint32_t context = gate_size == 3 ? 0 : gate_size == 4 ? 1 : 2;
  uint32_t same = 0;
  if constexpr (!Coder::kDecodes) same = source_->faces[source_->face].count == gate_size ? 1 : 0;
  if (coder_.bit(models_[0].same_size[context], same) != 0) return gate_size - 3;
  return code_size(context);
}

// The first face of a part that shares no edge with what was walked.
template <class Coder>
bool Walk<Coder>::code_seed() {
  if constexpr (!Coder::kDecodes) {
    source_->face = source_->edges.lowest_free();
    source_->first_corner = 0;
  }
  const uint32_t size_less_3 = code_size(3);
  const uint64_t room = header_.n_corners - n_corners_;
  if (size_less_3 > room || size_less_3 + uint64_t{3} > room) return false;
  corners_.clear();
  for (uint32_t k = 0; k < size_less_3 + 3; ++k) {
    if constexpr (Coder::kTables) {
      if (!code_table_corner(k, 0)) return false;
    } else {
      if (!code_corner(k, kSeed)) return false;
    }
  }
  finish_face(kNone);
  return true;
}

// The face across the gate a -> b: its corners are b, a, then those that are coded.
template <class Coder>
bool Walk<Coder>::code_face(uint32_t gate) {
  const uint32_t gate_size = topology_.size_of_face_at(gate);
  const uint32_t size_less_3 = code_size_across(gate_size);
  const uint64_t room = header_.n_corners - n_corners_;
  if (size_less_3 > room || size_less_3 + uint64_t{3} > room) return false;
  corners_.clear();
  corners_.push_back(end_of(gate));
  corners_.push_back(start_of(gate));
  topology_.twin[gate] = n_corners_;  // no longer open: finish_face() adds the other side
  open_.drop(gate, start_of(gate), end_of(gate));
  const uint32_t size = size_less_3 + 3;
  if (topology_.all_triangles) {
    const uint32_t n_before = topology_.n_vertices;
    if (!code_corner(2, kOnlyCorner)) return false;
    finish_triangle(gate, start_of(gate), end_of(gate), corners_.back(), topology_.n_vertices > n_before);
    return true;
  }
  for (uint32_t k = 2; k < size; ++k) {
    const Place place = size == 3 ? kOnlyCorner : k == 2 ? kFirstOfSeveral : k + 1 < size ? kMiddle : kLastOfSeveral;
    if (!code_corner(k, place)) return false;
  }
  finish_face(gate);
  return true;
}

// Which of the ways to name a corner applies; `candidate` holds the vertices that kBefore and kAfter stand for (kNone:
// not available) and receives the others as far as they are asked for, `wanted` (encoder) is the vertex or kNone for a
// new one.
template <class Coder>
Step Walk<Coder>::code_step(Place place, std::array<uint32_t, kOld>& candidate, uint32_t wanted) {
  const uint32_t before = candidate[kBefore], after = candidate[kAfter];
  const uint32_t available = (before != kNone ? 1u : 0u) | (after != kNone ? 2u : 0u) | (before == after ? 4u : 0u);
  const uint32_t left = corners_.empty() ? 0 : degree(corners_.back());
  const uint32_t right = corners_.empty() ? 0 : degree(corners_.front());
  AdaptiveBit* one = models_[0].step_left[place][available][left];
  AdaptiveBit* two = models_[0].step_right[place][available][right][last_step_];
  if (topology_.n_vertices == 0) return kNew;
  if (topology_.n_vertices < header_.n_vertices && coder_.bit(one[kNew], two[kNew], wanted == kNone ? 1 : 0) != 0)
    return kNew;
  if (before != kNone && coder_.bit(one[kBefore], two[kBefore], wanted == before ? 1 : 0) != 0) return kBefore;
  if (after != kNone && after != before && coder_.bit(one[kAfter], two[kAfter], wanted == after ? 1 : 0) != 0)
    return kAfter;
  return code_far_step(one, two, candidate, wanted);
}

// The candidates one further, which few corners come to.
template <class Coder>
Step Walk<Coder>::code_far_step(AdaptiveBit* one, AdaptiveBit* two, std::array<uint32_t, kOld>& candidate,
                                uint32_t wanted) {
  if (candidate[kAfter] != kNone) candidate[kAfterAfter] = open_.after(candidate[kAfter]);
  if (candidate[kBefore] != kNone) candidate[kBeforeBefore] = open_.before(candidate[kBefore]);
  for (uint32_t step = kAfterAfter; step < kOld; ++step) {
    if (candidate[step] == kNone) continue;
    if (std::find(&candidate[kBefore], &candidate[step], candidate[step]) != &candidate[step])
      continue;  // asked already
    if (coder_.bit(one[step], two[step], wanted == candidate[step] ? 1 : 0) != 0) return static_cast<Step>(step);
  }
  return kOld;
}

// Any vertex, by how many were added after it.
template <class Coder>
uint32_t Walk<Coder>::code_old_vertex(uint32_t wanted) {
  const uint32_t newest = topology_.n_vertices - 1;
  const uint32_t age = code_number(coder_, models_[0].old_vertex, newest - wanted);
  return age <= newest ? newest - age : kNone;
}

// Corner k of the face, corners_ holding those before it. False: corrupt.
template <class Coder>
bool Walk<Coder>::code_corner(uint32_t k, Place place) {
  if (coder_.failed()) return false;
  std::array<uint32_t, kOld> candidate;
  candidate.fill(kNone);
  if (!corners_.empty()) {
    candidate[kBefore] = open_.before(corners_.back());
    candidate[kAfter] = open_.after(corners_.front());
  }
  uint32_t wanted = kNone, mesh_vertex = kNone;
  if constexpr (!Coder::kDecodes) {
    mesh_vertex = source_->mesh_vertex(k);
    wanted = source_->coded_vertex[mesh_vertex];
  }
  const Step step = code_step(place, candidate, wanted);
  last_step_ = step;
  const uint32_t vertex = step == kNew   ? add_vertex(mesh_vertex)
                          : step == kOld ? code_old_vertex(wanted)
                                         : candidate[step];
  if (vertex == kNone) return false;
  corners_.push_back(vertex);
  return true;
}

// The next vertex, of the encoder's mesh that one. kNone: there are no more.
template <class Coder>
uint32_t Walk<Coder>::add_vertex(uint32_t mesh_vertex) {
  if (topology_.n_vertices == header_.n_vertices) return kNone;
  const uint32_t vertex = topology_.n_vertices++;
  open_.add_vertex();
  if constexpr (!Coder::kDecodes) {
    source_->coded_vertex[mesh_vertex] = vertex;
    source_->order.vertex.push_back(mesh_vertex);
  }
  return vertex;
}

// A number as its length and bits, all raw.
template <class Coder>
uint32_t Walk<Coder>::code_plain_number(uint32_t number) {
  const auto length = static_cast<int>(coder_.raw(6, static_cast<uint32_t>(std::bit_width(number))));
  if (length < 2) return static_cast<uint32_t>(length);
  uint32_t result = 1;
  for (int left = std::min(length, 32) - 1; left > 0;) {
    const int count = std::min(left, 16);
    left -= count;
    result = result << count | coder_.raw(count, number >> left & ((1u << count) - 1));
  }
  return result;
}

// The encoder's step to `wanted` (kNone: a new vertex), of which `candidate` holds the first two and receives the rest.
template <class Coder>
Step Walk<Coder>::find_step(std::array<uint32_t, kOld>& candidate, uint32_t wanted) {
  if (wanted == kNone) return kNew;
  if (wanted == candidate[kBefore]) return kBefore;
  if (wanted == candidate[kAfter]) return kAfter;
  if (candidate[kAfter] != kNone && open_.after(candidate[kAfter]) == wanted) return kAfterAfter;
  if (candidate[kBefore] != kNone && open_.before(candidate[kBefore]) == wanted) return kBeforeBefore;
  return kOld;
}

// The vertex that a step leads to. kNone: corrupt.
template <class Coder>
[[gnu::always_inline]] inline uint32_t Walk<Coder>::find_corner(Step step, std::array<uint32_t, kOld>& candidate,
                                                                uint32_t mesh_vertex) {
  if (step == kNew) return add_vertex(mesh_vertex);
  if (step <= kAfter) return candidate[step];
  if (step == kAfterAfter) return candidate[kAfter] == kNone ? kNone : open_.after(candidate[kAfter]);
  if (step == kBeforeBefore) return candidate[kBefore] == kNone ? kNone : open_.before(candidate[kBefore]);
  if (topology_.n_vertices == 0) return kNone;
  uint32_t wanted = 0;
  if constexpr (!Coder::kDecodes) wanted = source_->coded_vertex[mesh_vertex];
  const uint32_t newest = topology_.n_vertices - 1, age = code_plain_number(newest - wanted);
  return age <= newest ? newest - age : kNone;
}

// A corner that is not the first beyond a gate in a face of the gate's size. place: first, middle, last.
template <class Coder>
bool Walk<Coder>::code_table_corner(uint32_t k, uint32_t place) {
  if (coder_.failed()) return false;
  std::array<uint32_t, kOld> candidate;
  candidate.fill(kNone);
  uint32_t left = 0, right = 0;
  if (!corners_.empty()) {
    candidate[kBefore] = open_.before(corners_.back());
    candidate[kAfter] = open_.after(corners_.front());
    left = degree(corners_.back());
    right = degree(corners_.front());
  }
  uint32_t mesh_vertex = kNone, symbol = kNew;
  if constexpr (!Coder::kDecodes) {
    mesh_vertex = source_->mesh_vertex(k);
    symbol = find_step(candidate, source_->coded_vertex[mesh_vertex]);
  }
  if (topology_.n_vertices > 0)
    symbol = coder_.symbol(0, corner_context(place, left, right, candidate[kBefore] != candidate[kAfter]), symbol);
  if (symbol > kOld) return false;
  corners_.push_back(find_corner(static_cast<Step>(symbol), candidate, mesh_vertex));
  return corners_.back() != kNone;
}

// What lies across a gate, and the face if there is one.
template <class Coder>
bool Walk<Coder>::code_gate(uint32_t gate) {
  const uint32_t a = start_of(gate), b = end_of(gate);
  std::array<uint32_t, kOld> candidate;
  candidate.fill(kNone);
  candidate[kBefore] = open_.before(a);
  candidate[kAfter] = open_.after(b);
  const uint32_t gate_size = topology_.size_of_face_at(gate);
  uint32_t symbol = kNoFace;
  if constexpr (!Coder::kDecodes) {
    EdgeIndex& edges = source_->edges;
    if (edges.find(source_->order.vertex[b], source_->order.vertex[a], source_->face, source_->first_corner)) {
      topology_.twin[gate] = n_corners_;
      symbol = source_->faces[source_->face].count != gate_size
                   ? uint32_t{kOtherSize}
                   : find_step(candidate, source_->coded_vertex[source_->mesh_vertex(2)]);
    }
  }
  symbol = coder_.symbol(0,
                         gate_context(degree(a), degree(b), candidate[kBefore] != candidate[kAfter],
                                      open_.at(a).has_border != 0, gate_size == 3),
                         symbol);
  if (symbol == kNoFace) {
    open_.close(gate);
    open_.at(a).has_border = open_.at(b).has_border = 1;
    return true;
  }
  if (symbol > kOtherSize) return false;
  topology_.twin[gate] = n_corners_;  // no longer open: the face adds the other side
  open_.drop(gate, a, b);
  if (topology_.all_triangles && symbol <= kOld) {
    if (n_corners_ == header_.n_corners) return false;
    uint32_t mesh_vertex = kNone;
    if constexpr (!Coder::kDecodes) mesh_vertex = source_->mesh_vertex(2);
    const uint32_t tip = find_corner(static_cast<Step>(symbol), candidate, mesh_vertex);
    if (tip != kNone) finish_triangle(gate, a, b, tip, symbol == kNew);
    return tip != kNone;
  }
  const uint32_t size_less_3 = symbol == kOtherSize ? code_size(0) : gate_size - 3;
  const uint64_t room = header_.n_corners - n_corners_;
  if (size_less_3 > room || size_less_3 + uint64_t{3} > room) return false;
  corners_.clear();
  corners_.push_back(b);
  corners_.push_back(a);
  uint32_t k = 2;
  if (symbol != kOtherSize) {
    uint32_t mesh_vertex = kNone;
    if constexpr (!Coder::kDecodes) mesh_vertex = source_->mesh_vertex(2);
    corners_.push_back(find_corner(static_cast<Step>(symbol), candidate, mesh_vertex));
    if (corners_.back() == kNone) return false;
    ++k;
  }
  const uint32_t size = size_less_3 + 3;
  for (; k < size; ++k)
    if (!code_table_corner(k, k == 2 ? 0 : k + 1 < size ? 1 : 2)) return false;
  finish_face(gate);
  return true;
}

// corners_ becomes a face; its first edge is paired with the gate (kNone: a seed).
template <class Coder>
void Walk<Coder>::finish_face(uint32_t gate) {
  const uint32_t first = n_corners_, size = static_cast<uint32_t>(corners_.size());
  if (size != 4) topology_.all_quads = false;
  make_room(first + size);
  std::copy_n(corners_.data(), size, topology_.corner_vertex.data() + first);
  n_corners_ += size;
  if (!topology_.all_triangles) {
    std::fill_n(topology_.corner_face.data() + first, size, n_faces_);
    topology_.face_first.push_back(n_corners_);
  }
  ++n_faces_;
  if (gate != kNone) open_.pair(gate, first);
  for (uint32_t k = 0; k < size; ++k) {
    const uint32_t from = corners_[k], to = corners_[k + 1 < size ? k + 1 : 0];
    open_.add_edge(first + k, from, to);
    ++open_.at(from).n_faces;
  }
  note_face();
}

// The triangle across the gate a -> b, with that third corner.
template <class Coder>
void Walk<Coder>::finish_triangle(uint32_t gate, uint32_t a, uint32_t b, uint32_t tip, bool is_new) {
  const uint32_t first = n_corners_;
  make_room(first + 3);
  uint32_t* corner_vertex = topology_.corner_vertex.data() + first;
  corner_vertex[0] = b;
  corner_vertex[1] = a;
  corner_vertex[2] = tip;
  n_corners_ += 3;
  ++n_faces_;
  open_.pair(gate, first);
  if (is_new) {
    open_.add_tip(first + 1, a, tip, b);
  } else {
    open_.add_edge(first + 1, a, tip);
    open_.add_edge(first + 2, tip, b);
  }
  for (const uint32_t corner : {a, b, tip}) ++open_.at(corner).n_faces;
  note_face();
}

// For the encoder: it is coded.
template <class Coder>
void Walk<Coder>::note_face() {
  if constexpr (!Coder::kDecodes) {
    source_->edges.take(source_->face);
    source_->order.face.push_back(source_->face);
    source_->order.first_corner.push_back(source_->first_corner);
  }
}

}  // namespace

namespace {

template <class Coder>
std::vector<uint8_t> encode_walk(Coder coder, const ConnectivityHeader& header, Source& source, Topology& topology) {
  Walk<Coder> walk(coder, header, &source, header.n_corners);
  PAC_ASSERT(walk.run());
  topology = walk.take();
  return coder.finish();
}

template <class Coder>
Result<Topology> decode_walk(Coder& coder, const ConnectivityHeader& header, uint64_t n_bytes) {
  Walk<Coder> walk(coder, header, nullptr, 4096 + 64 * n_bytes);
  if (!walk.run()) return Failure{Error::corrupt, 0, "connectivity is damaged"};
  if (!coder.ends_exactly()) return Failure{Error::corrupt, 0, "connectivity does not end where the header says"};
  return walk.take();
}

}  // namespace

CodedConnectivity encode_connectivity(std::span<const uint32_t> indices, std::span<const Face> faces,
                                      std::span<const uint8_t> degenerate, uint32_t n_vertices, bool adaptively,
                                      bool by_tables) {
  ConnectivityHeader header;
  std::vector<uint8_t> used(n_vertices);
  for (uint32_t f = 0; f < faces.size(); ++f) {
    if (!degenerate.empty() && degenerate[f] != 0) continue;
    const Face& face = faces[f];
    ++header.n_faces;
    header.n_corners += face.count;
    for (uint32_t k = 0; k < face.count; ++k) used[indices[face.first + k]] = 1;
  }
  header.n_vertices = static_cast<uint32_t>(std::count(used.begin(), used.end(), uint8_t{1}));

  Source source(indices, faces, degenerate, n_vertices);
  CodedConnectivity coded;
  if (adaptively) coded.adaptive_bytes = encode_walk(RangeEncoder(), header, source, coded.topology);
  if (adaptively && by_tables) source.restart(degenerate);
  if (by_tables) coded.table_bytes = encode_walk(TableEncoder(kWalkContexts), header, source, coded.topology);
  coded.order = std::move(source.order);
  return coded;
}

Result<Topology> decode_connectivity(std::span<const uint8_t> bytes, const ConnectivityHeader& header, bool by_tables,
                                     uint64_t stream_bytes) {
  if (by_tables) {
    SymbolTables tables;
    TableDecoder coder(bytes, kWalkContexts, tables);
    return decode_walk(coder, header, stream_bytes);
  }
  RangeDecoder coder(bytes);
  return decode_walk(coder, header, stream_bytes);
}

}  // namespace pac::geomcodec
