// The walk over the faces, for encoder and decoder; which symbols it is told in: the two .inc files. FORMAT.md
// section 4.
#include "geomcodec/connectivity.h"

#include <algorithm>
#include <array>

#include "geomcodec/models.h"
#include "geomcodec/open_edges.h"
#include "geomcodec/table_coder.h"
#include "geomcodec/walk_source.h"

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

// The symbols of the coding by tables: at a gate a step (of the first corner beyond it, in a face of as many corners as
// the gate's), no face, or a face of another size; at other corners a step. Contexts by degrees, by whether the two
// neighbors on the boundary are different vertices, by border or place.
enum GateSymbol : uint32_t { kNoFace = 6, kOtherSize = 7 };
constexpr uint32_t kLowDegrees = 6;  // 0..4 and more
constexpr uint32_t kGateContexts = (kMaxDegree + 1) * kLowDegrees * 2 * 2 * 2;
constexpr uint32_t kCornerContexts = 3 * kLowDegrees * kLowDegrees * 2;
static_assert(kGateContexts + kCornerContexts == kWalkContexts);

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
  Walk(Coder& coder, const ConnectivityHeader& header, WalkSource* source, uint64_t expected_corners)
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
  WalkSource* source_;  // null when decoding
  Topology topology_;
  OpenEdges open_;
  uint32_t n_corners_ = 0, n_faces_ = 0;
  std::vector<uint32_t> corners_;  // vertices of the face being coded, first edge = the gate reversed
  std::vector<Models> models_;     // one element: too large for the stack
  uint32_t last_step_ = kNew;
  bool last_across_ = true;
};

#include "geomcodec/walk_adaptive.inc"
#include "geomcodec/walk_tables.inc"

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

template <class Coder>
std::vector<uint8_t> encode_walk(Coder coder, const ConnectivityHeader& header, WalkSource& source,
                                 Topology& topology) {
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

ConnectivityHeader header_of(std::span<const uint32_t> indices, std::span<const Face> faces,
                             std::span<const uint8_t> degenerate, uint32_t n_vertices) {
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
  return header;
}

}  // namespace

CodedConnectivity encode_connectivity(std::span<const uint32_t> indices, std::span<const Face> faces,
                                      std::span<const uint8_t> degenerate, uint32_t n_vertices, bool adaptively,
                                      bool by_tables, Expected expected) {
  const ConnectivityHeader header = header_of(indices, faces, degenerate, n_vertices);
  WalkSource source(indices, faces, degenerate, n_vertices);
  CodedConnectivity coded;
  if (adaptively) coded.adaptive_bytes = encode_walk(RangeEncoder(), header, source, coded.topology);
  if (adaptively && by_tables) source.restart();
  if (by_tables) coded.table_bytes = encode_walk(TableEncoder(kWalkContexts, expected), header, source, coded.topology);
  coded.order = std::move(source.order);
  return coded;
}

std::vector<SymbolCounts> count_walk_symbols(std::span<const uint32_t> indices, std::span<const Face> faces,
                                             uint32_t n_vertices) {
  WalkSource source(indices, faces, {}, n_vertices);
  TableEncoder coder(kWalkContexts, Expected::nothing);
  const ConnectivityHeader header = header_of(indices, faces, {}, n_vertices);
  Walk<TableEncoder> walk(coder, header, &source, header.n_corners);
  PAC_ASSERT(walk.run());
  return coder.counts();
}

Result<Topology> decode_connectivity(std::span<const uint8_t> bytes, const ConnectivityHeader& header, bool by_tables,
                                     Expected expected, uint64_t stream_bytes) {
  if (by_tables) {
    SymbolTables tables;
    TableDecoder coder(bytes, kWalkContexts, expected, tables);
    return decode_walk(coder, header, stream_bytes);
  }
  RangeDecoder coder(bytes);
  return decode_walk(coder, header, stream_bytes);
}

}  // namespace pac::geomcodec
