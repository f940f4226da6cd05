// encode() and reorder(): walk the faces, then code what hangs on them in the walk's order.
#include <algorithm>

#include "geomcodec/attributes.h"
#include "geomcodec/connectivity.h"
#include "geomcodec/container.h"
#include "geomcodec/degenerate_faces.h"
#include "geomcodec/face_values.h"
#include "geomcodec/geomcodec.h"
#include "geomcodec/materials.h"
#include "geomcodec/mesh_check.h"
#include "geomcodec/point_order.h"
#include "geomcodec/position_coder.h"
#include "geomcodec/position_weights.h"
#include "geomcodec/positions.h"
#include "geomcodec/seams.h"
#include "geomcodec/table_positions.h"

namespace pac::geomcodec {
namespace {

// A walked mesh: its vertices and materials in coded order.
struct Walked {
  Topology points;  // over points, as the walk numbers them
  Seams seams;
  WalkOrder order;  // vertex: all vertices of the mesh, isolated ones last
  std::vector<uint8_t> connectivity_bytes, degenerate_bytes, seam_bytes;
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

Walked walk(const QuantizedMesh& mesh, bool by_tables) {
  Walked walked;
  const auto n_vertices = static_cast<uint32_t>(mesh.vertices.size());
  const Points points = find_points(mesh.vertices);
  std::vector<uint32_t> point_indices;
  point_indices.reserve(mesh.indices.size());
  for (const uint32_t vertex : mesh.indices) point_indices.push_back(points.of_vertex[vertex]);
  const std::vector<uint8_t> degenerate = find_degenerate_faces(point_indices, mesh.faces, points.count);
  CodedConnectivity connectivity = encode_connectivity(point_indices, mesh.faces, degenerate, points.count, by_tables);
  walked.points = std::move(connectivity.topology);
  walked.connectivity_bytes = std::move(connectivity.bytes);
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
  header.trained = options.trained_priors && !mesh.vertices.empty();
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

// From so many vertices on a decoder's time shows, and what tables take is little beside the rest.
constexpr size_t kManyVertices = 16384;

bool wants_tables(const QuantizedMesh& mesh, Effort effort) {
  if (mesh.faces.empty() || effort == Effort::best) return false;
  return effort == Effort::fast || mesh.vertices.size() >= kManyVertices;
}

// Whether positions repeat, by rows or by parts, which only the other coding predicts: many vertices of small parts
// that are where the part before has them.
bool repeats(const Walked& walked) {
  const std::vector<Position> positions = positions_of(walked);
  PositionParts parts(walked.points);
  uint64_t n_repeated = 0;
  for (uint32_t v = 1; v < walked.points.n_vertices; ++v) {
    const uint32_t lag = parts.lag(v);
    if (lag == 0 || lag >= v) continue;
    bool repeated = true;
    for (size_t axis = 0; axis < 3; ++axis)
      repeated &=
          positions[v][axis] - positions[v - 1][axis] == positions[v - lag][axis] - positions[v - lag - 1][axis];
    n_repeated += repeated ? 1 : 0;
  }
  return 8 * n_repeated > walked.points.n_vertices || find_period(positions) != 0;
}

void choose_tables(const Walked& walked, Effort effort, Header& header) {
  for (const Section section : {kConnectivity, kPositions, kColors, kNormals, kTexcoords})
    if (header.has(section)) header.tables = static_cast<uint8_t>(header.tables | 1u << section);
  if (effort == Effort::balanced && repeats(walked))
    header.tables = static_cast<uint8_t>(header.tables & ~(1u << kPositions));
  header.trained = header.trained && !header.by_tables(kPositions);
}

using Sections = std::array<std::vector<uint8_t>, kSections>;

void encode_attributes(const Header& header, const AttributeMesh& mesh, const Walked& walked, Sections& sections) {
  if (header.has(kColors))
    sections[kColors] = encode_colors(mesh, walked.vertices, header.trained, header.by_tables(kColors));
  if (header.has(kNormals))
    sections[kNormals] = encode_normals(mesh, walked.vertices, header.normal_bits, header.by_tables(kNormals));
  if (header.has(kTexcoords))
    sections[kTexcoords] = encode_texcoords(mesh, walked.vertices, header.texcoord_bits, header.by_tables(kTexcoords));
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
};

// Whether it pays to code positions adaptively and ranked that tables code in so many bytes: where residuals that
// choose what they start from take a twentieth less, as on scans, and a twentieth less than by tables.
bool choosing_pays(const Walked& walked, const Stencils& stencils, std::span<const Position> positions,
                   const Ranked& ranked, int bits, bool trained, size_t bytes_by_tables) {
  const uint64_t choosing = estimate_positions(ranked.topology, ranked.stencils, ranked.positions, bits, trained, true);
  return 20 * choosing < 19 * 8 * uint64_t{bytes_by_tables} &&
         20 * choosing < 19 * estimate_positions(walked.points, stencils, positions, bits, trained, false);
}

void take_positions(PositionSection coded, bool ranked, Header& header, std::vector<uint8_t>& section) {
  section = std::move(coded.bytes);
  header.chooses = coded.chooses;
  header.ranked = ranked;
}

// What telling it takes in the header, and a decoder some time: it should gain a little more.
constexpr size_t kRankedBytes = 8;

void encode_positions_of(const Walked& walked, const Stencils& stencils, const EncodeOptions& options,
                         size_t connectivity_bytes, Header& header, std::vector<uint8_t>& section) {
  const std::vector<Position> positions = positions_of(walked);
  const int bits = header.position_bits;
  if (header.by_tables(kPositions)) {
    section = encode_positions_by_tables(stencils, positions, bits);
    if (options.effort == Effort::fast) return;
    const Ranked ranked(walked.points, stencils, positions);
    if (!choosing_pays(walked, stencils, positions, ranked, bits, options.trained_priors, section.size())) return;
    header.tables = static_cast<uint8_t>(header.tables & ~(1u << kPositions));
    header.trained = options.trained_priors;
    return take_positions(
        encode_positions(ranked.topology, ranked.stencils, ranked.positions, bits, header.trained, false), true, header,
        section);
  }
  const bool thorough = options.effort == Effort::best;
  PositionSection coded = encode_positions(walked.points, stencils, positions, bits, header.trained, thorough);
  // Where the walk has little to tell and choosing takes hardly less, as on regular meshes, the other order seldom
  // gains.
  const bool irregular = 8 * connectivity_bytes > walked.points.n_vertices;
  if (header.n_faces > 0 && (thorough || (irregular && coded.choosing_bits > 0))) {
    const Ranked ranked(walked.points, stencils, positions);
    if (!thorough &&
        50 * estimate_choosing(ranked.topology, ranked.stencils, ranked.positions, bits) > 49 * coded.choosing_bits)
      return take_positions(std::move(coded), false, header, section);
    PositionSection other =
        encode_positions(ranked.topology, ranked.stencils, ranked.positions, bits, header.trained, thorough);
    if (other.bytes.size() + kRankedBytes < coded.bytes.size())
      return take_positions(std::move(other), true, header, section);
  }
  take_positions(std::move(coded), false, header, section);
}

// Positions over points, all else over vertices; without seams these are the same mesh.
void encode_vertices(const EncodeOptions& options, Header& header, const Walked& walked, Sections& sections) {
  if (!header.has(kPositions)) return;
  {
    const Stencils stencils(walked.points);
    encode_positions_of(walked, stencils, options, sections[kConnectivity].size(), header, sections[kPositions]);
    if (header.n_split_vertices == 0)
      return encode_attributes(header, {walked.points, stencils, walked.seams.sibling}, walked, sections);
  }
  if (!header.has(kColors) && !header.has(kNormals) && !header.has(kTexcoords)) return;
  const Topology topology = cut_at_seams(walked.points, walked.seams);
  const Stencils stencils(topology);
  encode_attributes(header, {topology, stencils, walked.seams.sibling}, walked, sections);
}

}  // namespace

Result<std::vector<uint8_t>> encode(const QuantizedMesh& mesh, const EncodeOptions& options, EncodedSize* size) {
  PAC_CHECK(check_mesh(mesh));
  const bool by_tables = wants_tables(mesh, options.effort);
  Walked walked = walk(mesh, by_tables);
  Header header = header_of(mesh, walked, options);
  if (by_tables) choose_tables(walked, options.effort, header);
  Sections sections;
  sections[kConnectivity] = std::move(walked.connectivity_bytes);
  sections[kDegenerate] = std::move(walked.degenerate_bytes);
  sections[kSeams] = std::move(walked.seam_bytes);
  encode_vertices(options, header, walked, sections);
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
  Walked walked = walk(mesh, false);
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
