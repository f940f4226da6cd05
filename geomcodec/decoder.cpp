// decode(): the sections in order, each trusted no further than its own checks.
#include <algorithm>

#include "geomcodec/attributes.h"
#include "geomcodec/connectivity.h"
#include "geomcodec/container.h"
#include "geomcodec/geomcodec.h"
#include "geomcodec/materials.h"

namespace pac::geomcodec {
namespace {

// Before anything is allocated. The arrays then grow with what is read, never past these counts.
Result<void> check_limits(const Header& header, const Limits& limits) {
  const uint64_t n_triangles = uint64_t{header.n_corners} - uint64_t{2} * header.n_faces;
  if (n_triangles > limits.max_triangles)
    return Failure{Error::limit_exceeded, 0, "mesh has more triangles than the limit"};
  const uint64_t decoded_bytes = uint64_t{header.n_vertices()} * sizeof(QuantizedVertex) +
                                 uint64_t{header.n_corners} * sizeof(uint32_t) +
                                 uint64_t{header.n_faces} * sizeof(Face);
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
  mesh.vertices = std::move(vertices);
  mesh.faces = std::move(faces);
  mesh.indices = std::move(indices);
}

Failure at(Failure failure, uint64_t offset) {
  failure.byte_offset += offset;
  return failure;
}

}  // namespace

Result<QuantizedMesh> decode(std::span<const uint8_t> bytes, const Limits& limits) {
  PAC_TRY(const ParsedStream stream, parse_stream(bytes));
  const Header& header = stream.header;
  PAC_CHECK(check_limits(header, limits));

  auto topology =
      decode_connectivity(stream.section[kConnectivity], {header.n_used_vertices, header.n_faces, header.n_corners});
  if (!topology) return at(topology.failure(), stream.section_offset(kConnectivity));
  auto material = decode_materials(stream.section[kMaterials], *topology, header.highest_material);
  if (!material) return at(material.failure(), stream.section_offset(kMaterials));

  QuantizedMesh mesh;
  mesh.position_bits = header.position_bits;
  std::copy(header.origin, header.origin + 3, mesh.origin);
  std::copy(header.step, header.step + 3, mesh.step);
  QuantizedVertex fill;
  std::copy(header.color, header.color + 4, fill.color);
  auto vertices = decode_attributes(*topology, stream.section[kPositions], stream.section[kColors], header.n_vertices(),
                                    header.position_bits, header.constant_color, fill, mesh.vertices);
  if (!vertices) return at(vertices.failure(), stream.section_offset(kPositions));
  for (uint32_t face = 0; face < topology->n_faces(); ++face)
    mesh.faces.push_back({topology->face_first[face], topology->face_size(face), (*material)[face]});

  WalkOrder order;
  if (header.keeps_order) {
    auto decoded = decode_order(stream.section[kOrder], *topology, header.n_vertices());
    if (!decoded) return at(decoded.failure(), stream.section_offset(kOrder));
    order = std::move(*decoded);
  }
  mesh.indices = std::move(topology->corner_vertex);
  if (header.keeps_order) restore_order(order, mesh);
  return mesh;
}

}  // namespace pac::geomcodec
