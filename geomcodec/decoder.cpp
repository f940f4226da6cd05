// decode(): the sections in order, each trusted no further than its own checks.
#include <algorithm>

#include "geomcodec/attributes.h"
#include "geomcodec/connectivity.h"
#include "geomcodec/container.h"
#include "geomcodec/degenerate_faces.h"
#include "geomcodec/face_values.h"
#include "geomcodec/geomcodec.h"
#include "geomcodec/materials.h"
#include "geomcodec/point_order.h"
#include "geomcodec/positions.h"
#include "geomcodec/seams.h"
#include "geomcodec/table_positions.h"
#include "geomcodec/vertices.h"

namespace pac::geomcodec {
namespace {

// Before anything is allocated. The arrays then grow with what is read, never past these counts.
Result<void> check_limits(const Header& header, const Limits& limits) {
  const uint64_t n_triangles = uint64_t{header.n_corners} - uint64_t{2} * header.n_faces;
  if (n_triangles > limits.max_triangles)
    return Failure{Error::limit_exceeded, 0, "mesh has more triangles than the limit"};
  const uint64_t decoded_bytes =
      uint64_t{header.n_vertices()} * sizeof(QuantizedVertex) + uint64_t{header.n_corners} * sizeof(uint32_t) +
      uint64_t{header.n_faces} * sizeof(Face) +
      uint64_t{header.n_faces} * static_cast<uint32_t>(header.face_components) * sizeof(uint16_t);
  if (decoded_bytes > limits.max_bytes)
    return Failure{Error::limit_exceeded, 0, "decoded mesh is larger than the limit"};
  return {};
}

// The mesh in the order that it had before the walk.
void restore_order(const WalkOrder& order, QuantizedMesh& mesh) {
  std::vector<QuantizedVertex> vertices(mesh.vertices.size());
  for (size_t v = 0; v < vertices.size(); ++v) vertices[order.vertex[v]] = mesh.vertices[v];
  std::vector<Face> faces(mesh.faces.size());
  for (size_t f = 0; f < faces.size(); ++f) faces[order.face[f]] = mesh.faces[f];
  uint32_t first = 0;
  for (Face& face : faces) {
    face.first = first;
    first += face.count;
  }
  std::vector<uint32_t> indices(mesh.indices.size());
  for (size_t f = 0; f < mesh.faces.size(); ++f) {
    const Face& coded = mesh.faces[f];
    for (uint32_t k = 0; k < coded.count; ++k)
      indices[faces[order.face[f]].first + (order.first_corner[f] + k) % coded.count] =
          order.vertex[mesh.indices[coded.first + k]];
  }
  std::vector<uint16_t> face_values(mesh.face_values.size());
  const auto n = static_cast<size_t>(mesh.face_components);
  for (size_t i = 0; i < face_values.size(); ++i) face_values[order.face[i / n] * n + i % n] = mesh.face_values[i];
  mesh.vertices = std::move(vertices);
  mesh.face_values = std::move(face_values);
  mesh.faces = std::move(faces);
  mesh.indices = std::move(indices);
}

Failure at(Failure failure, uint64_t offset) {
  failure.byte_offset += offset;
  return failure;
}

QuantizedMesh empty_mesh(const Header& header) {
  QuantizedMesh mesh;
  mesh.position_bits = header.position_bits;
  std::copy(header.origin, header.origin + 3, mesh.origin);
  std::copy(header.step, header.step + 3, mesh.step);
  mesh.normal_bits = header.normal_bits;
  mesh.texcoord_bits = header.texcoord_bits;
  std::copy(header.texcoord_origin, header.texcoord_origin + 2, mesh.texcoord_origin);
  mesh.texcoord_step = header.texcoord_step;
  mesh.face_bits = header.face_bits;
  mesh.face_components = header.face_components;
  return mesh;
}

// A vertex of which nothing but the constant color is known.
QuantizedVertex blank_vertex(const Header& header) {
  QuantizedVertex blank;
  if (header.constant_color) std::copy(header.color, header.color + 4, blank.color);
  return blank;
}

// All vertices with their positions, the other attributes not yet coded.
Result<void> decode_vertices(const ParsedStream& stream, const Topology& points, const Stencils& stencils,
                             const Seams& seams, QuantizedMesh& mesh) {
  const Header& header = stream.header;
  const uint32_t n_positions = header.n_points() + header.n_isolated_vertices;
  const auto adaptive = [&](const Topology& topology, const Stencils& its_stencils) {
    return decode_positions(stream.section[kPositions], topology, its_stencils, n_positions, header.position_bits,
                            header.trained, header.chooses);
  };
  const std::vector<uint32_t> rank = header.ranked ? rank_points(points, stencils) : std::vector<uint32_t>{};
  const auto decode_ranked = [&] {
    const Topology topology = renumbered(points, rank);
    return adaptive(topology, Stencils(topology));
  };
  auto positions = header.by_tables(kPositions)
                       ? decode_positions_by_tables(stream.section[kPositions], stencils, n_positions,
                                                    header.position_bits, header.expected_of(kPositions))
                   : header.ranked ? decode_ranked()
                                   : adaptive(points, stencils);
  if (!positions) return at(positions.failure(), stream.section_offset(kPositions));
  mesh.vertices.assign(header.n_vertices(), blank_vertex(header));
  if (header.n_split_vertices == 0 && !header.ranked) {
    for (uint32_t v = 0; v < header.n_vertices(); ++v)
      std::copy_n((*positions)[v].begin(), 3, mesh.vertices[v].position);
    return {};
  }
  for (uint32_t v = 0; v < header.n_vertices(); ++v) {
    uint32_t point = v < header.n_used_vertices ? seams.vertex_point[v] : v - header.n_split_vertices;
    if (point < rank.size()) point = rank[point];
    const Position& position = (*positions)[point];
    std::copy(position.begin(), position.end(), mesh.vertices[v].position);
  }
  return {};
}

Result<void> decode_attributes(const ParsedStream& stream, const AttributeMesh& attributes, bool with_colors,
                               QuantizedMesh& mesh) {
  const Header& header = stream.header;
  if (with_colors && header.has(kColors)) {
    const auto done =
        decode_colors(stream.section[kColors], attributes, mesh.vertices, header.trained, header.coding_of(kColors));
    if (!done) return at(done.failure(), stream.section_offset(kColors));
  }
  if (header.has(kNormals)) {
    const auto done = decode_normals(stream.section[kNormals], attributes, mesh.vertices, header.normal_bits,
                                     header.coding_of(kNormals));
    if (!done) return at(done.failure(), stream.section_offset(kNormals));
  }
  if (header.has(kTexcoords)) {
    const auto done = decode_texcoords(stream.section[kTexcoords], attributes, mesh.vertices, header.texcoord_bits,
                                       header.coding_of(kTexcoords));
    if (!done) return at(done.failure(), stream.section_offset(kTexcoords));
  }
  return {};
}

// Vertices are points: the attributes see the same mesh as the positions, and colors are decoded beside these.
Result<void> decode_without_seams(const ParsedStream& stream, const Topology& points, const Stencils& stencils,
                                  const Seams& seams, QuantizedMesh& mesh) {
  const Header& header = stream.header;
  const AttributeMesh attributes{points, stencils, seams.sibling};
  // Isolated vertices are a claim of the header until their positions are read: only as many as the faces have shown.
  const bool together = header.has(kColors) && !header.ranked && header.n_isolated_vertices <= header.n_used_vertices;
  if (together) {
    mesh.vertices.assign(header.n_vertices(), blank_vertex(header));
    VertexFailure failure;
    const CodedVertices coded{stream.section[kPositions],
                              stream.section[kColors],
                              header.by_tables(kPositions),
                              header.by_tables(kColors),
                              header.position_bits,
                              header.trained,
                              header.chooses,
                              header.expected_of(kPositions),
                              header.expected_of(kColors)};
    const bool done = decode_positions_and_colors(coded, attributes, mesh.vertices, failure);
    if (!done) return at(failure.failure, stream.section_offset(failure.in_colors ? kColors : kPositions));
  } else {
    PAC_CHECK(decode_vertices(stream, points, stencils, seams, mesh));
  }
  return decode_attributes(stream, attributes, !together, mesh);
}

Result<void> decode_with_seams(const ParsedStream& stream, const Topology& points, const Seams& seams,
                               QuantizedMesh& mesh) {
  const Header& header = stream.header;
  PAC_CHECK(decode_vertices(stream, points, Stencils(points), seams, mesh));
  if (!header.has(kColors) && !header.has(kNormals) && !header.has(kTexcoords)) return {};
  const Topology topology = cut_at_seams(points, seams);
  const Stencils stencils(topology);
  return decode_attributes(stream, {topology, stencils, seams.sibling}, true, mesh);
}

std::vector<Face> faces_of(const Topology& topology, const std::vector<uint32_t>& material) {
  std::vector<Face> faces;
  faces.reserve(topology.n_faces());
  for (uint32_t face = 0; face < topology.n_faces(); ++face)
    faces.push_back({topology.face_first[face], topology.face_size(face), material.empty() ? 0 : material[face]});
  return faces;
}

}  // namespace

Result<QuantizedMesh> decode(std::span<const uint8_t> bytes, const Limits& limits) {
  PAC_TRY(const ParsedStream stream, parse_stream(bytes));
  const Header& header = stream.header;
  PAC_CHECK(check_limits(header, limits));

  Topology points;
  if (header.has(kConnectivity)) {
    auto decoded = decode_connectivity(
        stream.section[kConnectivity],
        {header.n_points(), header.n_faces - header.n_degenerate, header.n_corners - 3 * header.n_degenerate},
        header.by_tables(kConnectivity), header.expected_of(kConnectivity), bytes.size());
    if (!decoded) return at(decoded.failure(), stream.section_offset(kConnectivity));
    points = std::move(*decoded);
    points.parts_repeat_by_size = header.parts_repeat_by_size;
  }
  if (header.has(kDegenerate)) {
    const auto done = decode_degenerate_faces(stream.section[kDegenerate], header.n_degenerate, points);
    if (!done) return at(done.failure(), stream.section_offset(kDegenerate));
  }
  auto seams = decode_seams(stream.section[kSeams], points, header.n_used_vertices);
  if (!seams) return at(seams.failure(), stream.section_offset(kSeams));
  std::vector<uint32_t> material;
  if (header.has(kMaterials)) {
    auto decoded = decode_materials(stream.section[kMaterials], points, header.highest_material);
    if (!decoded) return at(decoded.failure(), stream.section_offset(kMaterials));
    material = std::move(*decoded);
  }

  QuantizedMesh mesh = empty_mesh(header);
  if (header.has(kPositions)) {
    if (header.n_split_vertices > 0)
      PAC_CHECK(decode_with_seams(stream, points, *seams, mesh));
    else
      PAC_CHECK(decode_without_seams(stream, points, Stencils(points), *seams, mesh));
  }
  mesh.faces = faces_of(points, material);
  if (header.has(kFaceValues)) {
    auto values = decode_face_values(stream.section[kFaceValues], points, header.face_components, header.face_bits);
    if (!values) return at(values.failure(), stream.section_offset(kFaceValues));
    mesh.face_values = std::move(*values);
  }
  mesh.indices = std::move(header.n_split_vertices == 0 ? points.corner_vertex : seams->corner_vertex);
  if (header.has(kOrder)) {
    auto order = decode_order(stream.section[kOrder], points, header.n_vertices());
    if (!order) return at(order.failure(), stream.section_offset(kOrder));
    restore_order(*order, mesh);
  }
  return mesh;
}

}  // namespace pac::geomcodec
