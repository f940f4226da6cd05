// encode() and reorder(): walk the faces, then code what hangs on them in the walk's order.
#include <algorithm>
#include <cstdlib>
#include <optional>

#include "geomcodec/attributes.h"
#include "geomcodec/connectivity.h"
#include "geomcodec/container.h"
#include "geomcodec/degenerate_faces.h"
#include "geomcodec/face_values.h"
#include "geomcodec/geomcodec.h"
#include "geomcodec/materials.h"
#include "geomcodec/mesh_check.h"
#include "geomcodec/plain_estimate.h"
#include "geomcodec/point_order.h"
#include "geomcodec/position_coder.h"
#include "geomcodec/position_weights.h"
#include "geomcodec/positions.h"
#include "geomcodec/seams.h"
#include "geomcodec/table_choice.h"
#include "geomcodec/table_positions.h"

namespace pac::geomcodec {
namespace {

// A walked mesh: its vertices and materials in coded order.
struct Walked {
  Topology points;  // over points, as the walk numbers them
  Seams seams;
  WalkOrder order;  // vertex: all vertices of the mesh, isolated ones last
  std::vector<uint8_t> connectivity_bytes, connectivity_by_tables, degenerate_bytes, seam_bytes;
  std::vector<QuantizedVertex> vertices;
  std::vector<uint32_t> material;
};

// The mesh's vertex of each corner, in coded order.
std::vector<uint32_t> corners_in_order(const QuantizedMesh& mesh, const WalkOrder& order) {
  std::vector<uint32_t> corners;
  corners.reserve(mesh.indices.size());
  for (size_t i = 0; i < order.face.size(); ++i) {
    const Face& face = mesh.faces[order.face[i]];
    for (uint32_t k = 0; k < face.count; ++k)
      corners.push_back(mesh.indices[face.first + (order.first_corner[i] + k) % face.count]);
  }
  return corners;
}

// What an encoder makes of the sections that tables may code. either: both, and keeps one of them.
enum class Coding { adaptive, tables, either };

std::vector<uint32_t> indices_of_points(const QuantizedMesh& mesh, const Points& points) {
  std::vector<uint32_t> indices;
  indices.reserve(mesh.indices.size());
  for (const uint32_t vertex : mesh.indices) indices.push_back(points.of_vertex[vertex]);
  return indices;
}

// expected: of the faces, by tables.
Walked walk(const QuantizedMesh& mesh, Coding coding, Expected expected) {
  Walked walked;
  const auto n_vertices = static_cast<uint32_t>(mesh.vertices.size());
  const Points points = find_points(mesh.vertices);
  std::vector<uint32_t> point_indices = indices_of_points(mesh, points);
  const std::vector<uint8_t> degenerate = find_degenerate_faces(point_indices, mesh.faces, points.count);
  CodedConnectivity connectivity = encode_connectivity(point_indices, mesh.faces, degenerate, points.count,
                                                       coding != Coding::tables, coding != Coding::adaptive, expected);
  walked.points = std::move(connectivity.topology);
  walked.connectivity_bytes = std::move(connectivity.adaptive_bytes);
  walked.connectivity_by_tables = std::move(connectivity.table_bytes);
  walked.order = std::move(connectivity.order);
  if (!degenerate.empty())
    walked.degenerate_bytes =
        encode_degenerate_faces(point_indices, mesh.faces, degenerate, walked.points, walked.order);
  point_indices = {};  // memory is scarce: 12 bytes a triangle

  CodedSeams seams = encode_seams(walked.points, corners_in_order(mesh, walked.order), n_vertices);
  walked.seams = std::move(seams.seams);
  walked.seam_bytes = std::move(seams.bytes);
  WalkOrder& order = walked.order;
  order.vertex = std::move(seams.mesh_vertex);
  std::vector<uint8_t> used(n_vertices);
  for (const uint32_t vertex : order.vertex) used[vertex] = 1;
  for (uint32_t v = 0; v < n_vertices; ++v)
    if (used[v] == 0) order.vertex.push_back(v);
  walked.vertices.reserve(n_vertices);
  for (const uint32_t vertex : order.vertex) walked.vertices.push_back(mesh.vertices[vertex]);
  for (const uint32_t face : order.face) walked.material.push_back(mesh.faces[face].material);
  return walked;
}

std::vector<uint16_t> face_values_in_order(const QuantizedMesh& mesh, const WalkOrder& order) {
  const auto n = static_cast<size_t>(mesh.face_components);
  std::vector<uint16_t> values;
  values.reserve(mesh.face_values.size());
  if (n > 0)
    for (const uint32_t face : order.face)
      values.insert(values.end(), mesh.face_values.begin() + static_cast<ptrdiff_t>(face * n),
                    mesh.face_values.begin() + static_cast<ptrdiff_t>((face + 1) * n));
  return values;
}

// Of the points, then of the isolated vertices.
std::vector<Position> positions_of(const Walked& walked) {
  const uint32_t n_used = walked.seams.n_vertices(), n_points = walked.points.n_vertices;
  std::vector<Position> positions(n_points + walked.vertices.size() - n_used);
  for (uint32_t v = 0; v < walked.vertices.size(); ++v)
    std::copy_n(walked.vertices[v].position, 3,
                positions[v < n_used ? walked.seams.vertex_point[v] : n_points + v - n_used].begin());
  return positions;
}

bool has_constant_color(const QuantizedMesh& mesh) {
  return std::all_of(mesh.vertices.begin(), mesh.vertices.end(), [&](const QuantizedVertex& vertex) {
    return std::equal(vertex.color, vertex.color + 4, mesh.vertices[0].color);
  });
}

Header header_of(const QuantizedMesh& mesh, const Walked& walked, const EncodeOptions& options) {
  Header header;
  header.keeps_order = options.keep_order;
  header.trained = header.expected_tables = options.trained_priors && !mesh.vertices.empty();
  header.constant_color = has_constant_color(mesh);
  header.position_bits = mesh.position_bits;
  std::copy(mesh.origin, mesh.origin + 3, header.origin);
  std::copy(mesh.step, mesh.step + 3, header.step);
  header.normal_bits = mesh.normal_bits;
  header.texcoord_bits = mesh.texcoord_bits;
  std::copy(mesh.texcoord_origin, mesh.texcoord_origin + 2, header.texcoord_origin);
  header.texcoord_step = mesh.texcoord_step;
  header.face_bits = mesh.face_bits;
  header.face_components = mesh.face_components;
  header.n_used_vertices = walked.seams.n_vertices();
  header.n_split_vertices = header.n_used_vertices - walked.points.n_vertices;
  header.n_isolated_vertices = static_cast<uint32_t>(mesh.vertices.size()) - header.n_used_vertices;
  header.n_faces = walked.points.n_faces();
  header.n_corners = walked.points.n_corners();
  header.n_degenerate = walked.points.n_degenerate_corners / 3;
  for (const uint32_t material : walked.material) header.highest_material = std::max(header.highest_material, material);
  if (header.constant_color && !mesh.vertices.empty())
    std::copy(mesh.vertices[0].color, mesh.vertices[0].color + 4, header.color);
  return header;
}

// From so many vertices on what tables take is little beside the rest.
constexpr size_t kManyVertices = 16384;
// Below so many vertices a decoder takes less than 0.2 ms however sections are coded; below so many bits a coordinate
// a grid is chosen where bytes are scarce.
constexpr size_t kFewVertices = 512, kFewPlainVertices = 1024;
constexpr int kFineBits = 13;

// Normals and texture coordinates take about what other coders' do: with them positions have to make the difference.
bool has_more_than_colors(const Header& header) {
  return header.normal_bits != 0 || header.texcoord_bits != 0;
}

Coding coding_for(const QuantizedMesh& mesh, Effort effort) {
  if (mesh.faces.empty() || effort == Effort::best) return Coding::adaptive;
  if (effort == Effort::fast || mesh.vertices.size() >= kManyVertices) return Coding::tables;
  // Making both takes time, which for positions alone has to be worth more.
  const bool is_plain = mesh.normal_bits == 0 && mesh.texcoord_bits == 0 && has_constant_color(mesh);
  const size_t few = is_plain ? kFewPlainVertices : kFewVertices;
  return mesh.vertices.size() < few || mesh.position_bits < kFineBits ? Coding::adaptive : Coding::either;
}

// How many points are, within so many steps, where parts repeat.
uint64_t count_repeated(const Topology& points, std::span<const Position> positions, int steps) {
  PositionParts parts(points);
  uint64_t n_repeated = 0;
  for (uint32_t v = 1; v < points.n_vertices; ++v) {
    const uint32_t lag = parts.lag(v);
    if (lag == 0 || lag >= v) continue;
    const uint32_t anchor = parts.anchor(v);
    bool repeated = true;
    for (size_t axis = 0; axis < 3; ++axis) {
      const int expected = positions[anchor][axis] + positions[v - lag][axis] - positions[anchor - lag][axis];
      repeated &= std::abs(positions[v][axis] - expected) <= steps;
    }
    n_repeated += repeated ? 1 : 0;
  }
  return n_repeated;
}

// Parts that are where the last one of as many points has them, moved, more than where the part before has: copies of a
// thing among others.
void find_copies(Walked& walked) {
  if (PositionParts(walked.points).count() < 3) return;
  const std::vector<Position> positions = positions_of(walked);
  const uint64_t by_order = count_repeated(walked.points, positions, 1);
  walked.points.parts_repeat_by_size = true;
  const uint64_t by_size = count_repeated(walked.points, positions, 1);
  walked.points.parts_repeat_by_size = 8 * by_size > walked.points.n_vertices && 8 * by_size > 9 * by_order;
}

// Whether positions repeat, by rows or by parts, which only the other coding predicts: many vertices of small parts
// that are where the part before has them.
bool repeats(const Walked& walked) {
  if (walked.points.parts_repeat_by_size) return true;
  const std::vector<Position> positions = positions_of(walked);
  const uint64_t n_repeated = count_repeated(walked.points, positions, 0);
  return 8 * n_repeated > walked.points.n_vertices || !find_periods(positions).empty();
}

void choose_tables(const Walked& walked, Effort effort, Header& header) {
  for (const Section section : {kConnectivity, kPositions, kColors, kNormals, kTexcoords})
    if (header.has(section)) header.tables = static_cast<uint8_t>(header.tables | 1u << section);
  if (effort == Effort::balanced && repeats(walked))
    header.tables = static_cast<uint8_t>(header.tables & ~(1u << kPositions));
  header.trained = header.trained && !header.by_tables(kPositions);
}

// The sections of vertices that the header has, as it says they are coded; `by_tables`, if given, receives them coded
// by tables as well.
struct VertexSections {
  const Walked& walked;
  const EncodeOptions& options;
  Header& header;
  Sections& sections;
  Sections* by_tables;
  struct Speed {
    PlainBytes plain;
    int64_t grown = 0;  // positions by tables, beyond the other coding
  } & speed;
};

void encode_attributes(const AttributeMesh& mesh, const VertexSections& out) {
  const Header& header = out.header;
  const auto encode_section = [&](Section section, auto encode_as) {
    if (!header.has(section)) return;
    AttributeCoding coding = header.coding_of(section);
    out.sections[section] = encode_as(coding);
    coding.by_tables = true;
    if (out.by_tables != nullptr) (*out.by_tables)[section] = encode_as(coding);
  };
  const std::span<const QuantizedVertex> vertices = out.walked.vertices;
  encode_section(kColors,
                 [&](AttributeCoding coding) { return encode_colors(mesh, vertices, header.trained, coding); });
  encode_section(kNormals,
                 [&](AttributeCoding coding) { return encode_normals(mesh, vertices, header.normal_bits, coding); });
  encode_section(kTexcoords, [&](AttributeCoding coding) {
    return encode_texcoords(mesh, vertices, header.texcoord_bits, coding);
  });
}

// The mesh with its points in the other order.
struct Ranked {
  std::vector<uint32_t> rank;
  Topology topology;
  Stencils stencils;
  std::vector<Position> positions;

  Ranked(const Topology& walked, const Stencils& walked_stencils, std::span<const Position> given)
      : rank(rank_points(walked, walked_stencils)),
        topology(renumbered(walked, rank)),
        stencils(topology),
        positions(given.begin(), given.end()) {
    for (size_t point = 0; point < rank.size(); ++point) positions[rank[point]] = given[point];
  }
  Ranked(const Ranked&) = delete;  // stencils refer to the topology
};

// Whether it pays to code positions adaptively and ranked that tables code in so many bytes: where residuals that
// choose what they start from take a twentieth less, as on scans, and a twentieth less than by tables.
bool choosing_pays(const Walked& walked, const Stencils& stencils, std::span<const Position> positions,
                   const Ranked& ranked, int bits, bool trained, size_t bytes_by_tables) {
  const uint64_t choosing = estimate_positions(ranked.topology, ranked.stencils, ranked.positions, bits, trained, true);
  return 20 * choosing < 19 * 8 * uint64_t{bytes_by_tables} &&
         20 * choosing < 19 * estimate_positions(walked.points, stencils, positions, bits, trained, false);
}

void take_positions(PositionSection coded, bool ranked, const VertexSections& out) {
  out.sections[kPositions] = std::move(coded.bytes);
  out.header.chooses = coded.chooses;
  out.header.ranked = ranked;
  out.header.parts_repeat_by_size = out.walked.points.parts_repeat_by_size;
}

// What telling it takes in the header, and a decoder some time: it should gain a little more.
constexpr size_t kRankedBytes = 8;

// In whichever order of the points takes fewer bytes; `ranked`, if there, is the other one, and nothing else is tried
// where plain coding takes clearly less by it.
void encode_positions_adaptively(const Stencils& stencils, std::span<const Position> positions,
                                 const VertexSections& out, std::optional<Ranked>& ranked, bool ranked_is_better) {
  const Topology& walked = out.walked.points;
  const Header& header = out.header;
  const int bits = header.position_bits;
  const bool thorough = out.options.effort == Effort::best;
  const auto encode_ranked = [&] {
    return encode_positions(ranked->topology, ranked->stencils, ranked->positions, bits, header.trained, thorough);
  };
  if (ranked_is_better) return take_positions(encode_ranked(), true, out);
  PositionSection coded = encode_positions(walked, stencils, positions, bits, header.trained, thorough);
  if (header.n_faces == 0) return take_positions(std::move(coded), false, out);
  // Where the walk has little to tell and choosing takes hardly less, as on regular meshes, the other order seldom
  // gains: only a coarse grid's bytes are worth a look. And what makes the difference where attributes do not.
  const size_t face_bytes = out.sections[kConnectivity].size();
  const bool irregular = bits < kFineBits ? 12 * face_bytes > walked.n_vertices && coded.chooses
                                          : 8 * face_bytes > walked.n_vertices && coded.choosing_bits > 0;
  const bool is_tight = has_more_than_colors(header) && out.speed.plain.is_tight(coded.bytes.size());
  if (!thorough && !irregular && !is_tight) return take_positions(std::move(coded), false, out);
  if (!ranked) ranked.emplace(walked, stencils, positions);
  // Whether plain coding takes at most so many hundredths by the other order.
  const auto is_plainly_less = [&](uint64_t hundredths) {
    const uint64_t plain = out.speed.plain.positions > 0 ? static_cast<uint64_t>(out.speed.plain.positions)
                                                         : estimate_plainly(stencils, positions);
    return 100 * estimate_plainly(ranked->stencils, ranked->positions) < hundredths * plain;
  };
  const bool gains =
      thorough || (is_tight && is_plainly_less(99)) ||
      (irregular && (50 * estimate_choosing(ranked->topology, ranked->stencils, ranked->positions, bits) <=
                         49 * coded.choosing_bits ||
                     (bits < kFineBits && is_plainly_less(96))));
  if (!gains) return take_positions(std::move(coded), false, out);
  PositionSection other = encode_ranked();
  const bool is_less = other.bytes.size() + kRankedBytes < coded.bytes.size();
  take_positions(std::move(is_less ? other : coded), is_less, out);
}

// Codes positions by tables unless those cannot be what speed asks for, and tells whether they are few enough without
// knowing more than estimates of what the other coding takes; these are mostly a little low, and of no use where
// positions repeat. `ranked` becomes the points' other order where plain coding by that one has to be known too.
bool tables_suffice(const Stencils& stencils, std::span<const Position> positions, const VertexSections& out,
                    std::optional<Ranked>& ranked, bool& ranked_is_better) {
  const int bits = out.header.position_bits;
  if (repeats(out.walked)) return false;
  PlainBytes& plain = out.speed.plain;
  const size_t faces = out.sections[kConnectivity].size();
  plain = PlainBytes(faces, estimate_plainly(stencils, positions));
  if (plain.are_raw(out.header)) return false;
  std::vector<uint8_t>& by_tables = (*out.by_tables)[kPositions];
  by_tables = encode_positions_by_tables(stencils, positions, bits, out.header.expected_of(kPositions));
  if (!plain.tables_may_suffice(by_tables.size())) return false;
  // The other order helps plain coding most where the walk has little to tell.
  if (5 * faces < out.walked.points.n_vertices && plain.is_tight(by_tables.size())) {
    ranked.emplace(out.walked.points, stencils, positions);
    const PlainBytes other(faces, estimate_plainly(ranked->stencils, ranked->positions));
    ranked_is_better = 50 * other.positions < 49 * plain.positions;
    if (ranked_is_better) plain = other;
    if (!plain.tables_may_suffice(by_tables.size())) return false;
  }
  const uint64_t adaptive_bytes = estimate_choosing(out.walked.points, stencils, positions, bits) * 33 / (8 * 32);
  if (!plain.tables_suffice(by_tables.size(), adaptive_bytes)) return false;
  out.speed.grown = static_cast<int64_t>(by_tables.size()) - static_cast<int64_t>(adaptive_bytes);
  return true;
}

// Of many points by tables, unless these take about what a coder without contexts takes, or choosing pays.
void encode_many_positions(const Stencils& stencils, std::span<const Position> positions, const VertexSections& out) {
  const Walked& walked = out.walked;
  Header& header = out.header;
  const int bits = header.position_bits;
  std::vector<uint8_t>& section = out.sections[kPositions];
  section = encode_positions_by_tables(stencils, positions, bits, header.expected_of(kPositions));
  if (out.options.effort == Effort::fast) return;
  const Ranked ranked(walked.points, stencils, positions);
  const bool trained = out.options.trained_priors;
  out.speed.plain = PlainBytes::beside_tables(out.sections[kConnectivity].size(),
                                              estimate_plainly(ranked.stencils, ranked.positions));
  if (!choosing_pays(walked, stencils, positions, ranked, bits, trained, section.size()) &&
      !out.speed.plain.is_tight(section.size()))
    return;
  PositionSection adaptive = encode_positions(ranked.topology, ranked.stencils, ranked.positions, bits, trained, false);
  if (adaptive.bytes.size() >= section.size()) return;
  header.tables = static_cast<uint8_t>(header.tables & ~(1u << kPositions));
  header.trained = trained;
  take_positions(std::move(adaptive), true, out);
}

void encode_positions_of(const Stencils& stencils, const VertexSections& out) {
  Header& header = out.header;
  const std::vector<Position> positions = positions_of(out.walked);
  if (header.by_tables(kPositions)) return encode_many_positions(stencils, positions, out);
  std::optional<Ranked> ranked;
  bool ranked_is_better = false;
  if (out.by_tables != nullptr && tables_suffice(stencils, positions, out, ranked, ranked_is_better)) {
    out.sections[kPositions] = std::move((*out.by_tables)[kPositions]);
    header.tables = static_cast<uint8_t>(header.tables | 1u << kPositions);
    return;
  }
  encode_positions_adaptively(stencils, positions, out, ranked, ranked_is_better);
}

// Positions over points, all else over vertices; without seams these are the same mesh.
void encode_vertices(const VertexSections& out) {
  const Header& header = out.header;
  const Walked& walked = out.walked;
  if (!header.has(kPositions)) return;
  {
    const Stencils stencils(walked.points);
    encode_positions_of(stencils, out);
    if (header.n_split_vertices == 0) return encode_attributes({walked.points, stencils, walked.seams.sibling}, out);
  }
  if (!header.has(kColors) && !header.has(kNormals) && !header.has(kTexcoords)) return;
  const Topology topology = cut_at_seams(walked.points, walked.seams);
  const Stencils stencils(topology);
  encode_attributes({topology, stencils, walked.seams.sibling}, out);
}

// The faces of a large mesh are worth coding again, adaptively, where tables take a byte for each, or where residuals
// choose, which takes a decoder longer, and faces are a sixth of the geometry. Kept where that takes clearly less.
void keep_fewer_faces(const QuantizedMesh& mesh, Header& header, Sections& sections) {
  std::vector<uint8_t>& by_tables = sections[kConnectivity];
  const bool choosing = header.chooses && 6 * by_tables.size() > by_tables.size() + sections[kPositions].size();
  if (by_tables.size() <= header.n_faces && !choosing) return;
  const Points points = find_points(mesh.vertices);
  const std::vector<uint32_t> indices = indices_of_points(mesh, points);
  const std::vector<uint8_t> degenerate = find_degenerate_faces(indices, mesh.faces, points.count);
  std::vector<uint8_t> adaptive =
      encode_connectivity(indices, mesh.faces, degenerate, points.count, true, false, Expected::nothing).adaptive_bytes;
  const size_t growth = by_tables.size() - std::min(by_tables.size(), adaptive.size());
  const size_t bytes = adaptive.size() + sections[kPositions].size() + sections[kDegenerate].size();
  if (growth * kGrowthBesideChoosing <= bytes) return;
  by_tables = std::move(adaptive);
  header.tables = static_cast<uint8_t>(header.tables & ~(1u << kConnectivity));
}

}  // namespace

Result<std::vector<uint8_t>> encode(const QuantizedMesh& mesh, const EncodeOptions& options, EncodedSize* size) {
  PAC_CHECK(check_mesh(mesh));
  const Coding coding = coding_for(mesh, options.effort);
  Walked walked = walk(mesh, coding, options.trained_priors ? Expected::faces : Expected::nothing);
  Header header = header_of(mesh, walked, options);
  if (options.effort != Effort::fast) find_copies(walked);
  if (coding == Coding::tables) choose_tables(walked, options.effort, header);
  Sections sections, by_tables;
  by_tables[kConnectivity] = std::move(walked.connectivity_by_tables);
  sections[kConnectivity] = std::move(coding == Coding::tables ? by_tables[kConnectivity] : walked.connectivity_bytes);
  sections[kDegenerate] = std::move(walked.degenerate_bytes);
  sections[kSeams] = std::move(walked.seam_bytes);
  VertexSections::Speed speed;
  encode_vertices({walked, options, header, sections, coding == Coding::either ? &by_tables : nullptr, speed});
  if (coding == Coding::tables && options.effort == Effort::balanced) keep_fewer_faces(mesh, header, sections);
  if (coding == Coding::either) keep_fastest(header, speed.plain, speed.grown, sections, by_tables);
  header.expected_tables = header.expected_tables && header.may_expect_tables();
  header.expected_faces = options.trained_priors && header.by_tables(kConnectivity);
  sections[kMaterials] = encode_materials(walked.points, walked.material);
  if (header.has(kFaceValues))
    sections[kFaceValues] = encode_face_values(walked.points, face_values_in_order(mesh, walked.order),
                                               header.face_components, header.face_bits);
  if (header.has(kOrder)) sections[kOrder] = encode_order(walked.points, walked.order);
  for (const std::vector<uint8_t>& section : sections)
    if (section.size() > kMaxCount) return Failure{Error::bad_argument, 0, "mesh is too large for one stream"};

  uint64_t header_bytes = 0;
  std::vector<uint8_t> stream = write_stream(header, sections, header_bytes);
  if (size != nullptr)
    *size = {header_bytes,
             sections[kConnectivity].size() + sections[kDegenerate].size(),
             sections[kSeams].size(),
             sections[kPositions].size(),
             sections[kColors].size(),
             sections[kNormals].size(),
             sections[kTexcoords].size(),
             sections[kMaterials].size(),
             sections[kFaceValues].size(),
             sections[kOrder].size()};
  return stream;
}

QuantizedMesh reorder(const QuantizedMesh& mesh) {
  QuantizedMesh result;
  if (!check_mesh(mesh)) return result;
  Walked walked = walk(mesh, Coding::adaptive, Expected::nothing);
  result.position_bits = mesh.position_bits;
  std::copy(mesh.origin, mesh.origin + 3, result.origin);
  std::copy(mesh.step, mesh.step + 3, result.step);
  result.normal_bits = mesh.normal_bits;
  result.texcoord_bits = mesh.texcoord_bits;
  std::copy(mesh.texcoord_origin, mesh.texcoord_origin + 2, result.texcoord_origin);
  result.texcoord_step = mesh.texcoord_step;
  result.face_bits = mesh.face_bits;
  result.face_components = mesh.face_components;
  result.face_values = face_values_in_order(mesh, walked.order);
  result.vertices = std::move(walked.vertices);
  for (uint32_t face = 0; face < walked.points.n_faces(); ++face)
    result.faces.push_back({walked.points.face_first[face], walked.points.face_size(face), walked.material[face]});
  const bool split = walked.seams.n_vertices() > walked.points.n_vertices;
  result.indices = std::move(split ? walked.seams.corner_vertex : walked.points.corner_vertex);
  return result;
}

}  // namespace pac::geomcodec
