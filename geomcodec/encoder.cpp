// encode() and reorder(): walk the faces, then code what hangs on them in the walk's order.
#include <algorithm>
#include <cmath>

#include "geomcodec/attributes.h"
#include "geomcodec/connectivity.h"
#include "geomcodec/container.h"
#include "geomcodec/geomcodec.h"
#include "geomcodec/materials.h"

namespace pac::geomcodec {
namespace {

Result<void> check(const QuantizedMesh& mesh) {
  if (mesh.position_bits < 1 || mesh.position_bits > 16)
    return Failure{Error::bad_argument, 0, "position bits are not in 1..16"};
  for (int axis = 0; axis < 3; ++axis)
    if (!std::isfinite(mesh.origin[axis]) || !std::isfinite(mesh.step[axis]) || !(mesh.step[axis] > 0))
      return Failure{Error::bad_argument, 0, "grid is not finite or has no step"};
  uint64_t n_corners = 0;
  for (size_t f = 0; f < mesh.faces.size(); ++f) {
    const Face& face = mesh.faces[f];
    n_corners += face.count;
    if (face.count < 3) return Failure{Error::bad_argument, f, "face with fewer than three corners"};
    if (face.first > mesh.indices.size() || face.count > mesh.indices.size() - face.first)
      return Failure{Error::bad_argument, f, "face reaches outside the index list"};
    for (uint32_t k = 0; k < face.count; ++k)
      if (mesh.indices[face.first + k] >= mesh.vertices.size())
        return Failure{Error::bad_argument, f, "face names a vertex that does not exist"};
  }
  if (mesh.vertices.size() > kMaxCount || n_corners > kMaxCount)
    return Failure{Error::bad_argument, 0, "mesh has more than 2^31 - 1 vertices or corners"};
  const uint32_t highest = (1u << mesh.position_bits) - 1;
  for (size_t v = 0; v < mesh.vertices.size(); ++v)
    for (const uint16_t coordinate : mesh.vertices[v].position)
      if (coordinate > highest) return Failure{Error::bad_argument, v, "coordinate above the grid"};
  return {};
}

// A walked mesh: its vertices and materials in coded order.
struct Walked {
  CodedConnectivity connectivity;
  uint32_t n_used_vertices = 0;
  std::vector<QuantizedVertex> vertices;
  std::vector<uint32_t> material;
};

Walked walk(const QuantizedMesh& mesh) {
  Walked walked;
  const auto n_vertices = static_cast<uint32_t>(mesh.vertices.size());
  walked.connectivity = encode_connectivity(mesh.indices, mesh.faces, n_vertices);
  WalkOrder& order = walked.connectivity.order;
  walked.n_used_vertices = static_cast<uint32_t>(order.vertex.size());
  std::vector<uint8_t> used(n_vertices);
  for (const uint32_t vertex : order.vertex) used[vertex] = 1;
  for (uint32_t v = 0; v < n_vertices; ++v)
    if (used[v] == 0) order.vertex.push_back(v);
  for (const uint32_t vertex : order.vertex) walked.vertices.push_back(mesh.vertices[vertex]);
  for (const uint32_t face : order.face) walked.material.push_back(mesh.faces[face].material);
  return walked;
}

bool has_constant_color(const QuantizedMesh& mesh) {
  return std::all_of(mesh.vertices.begin(), mesh.vertices.end(), [&](const QuantizedVertex& vertex) {
    return std::equal(vertex.color, vertex.color + 4, mesh.vertices[0].color);
  });
}

}  // namespace

Result<std::vector<uint8_t>> encode(const QuantizedMesh& mesh, const EncodeOptions& options, EncodedSize* size) {
  PAC_CHECK(check(mesh));
  Walked walked = walk(mesh);
  Header header;
  header.keeps_order = options.keep_order;
  header.constant_color = has_constant_color(mesh);
  header.position_bits = mesh.position_bits;
  std::copy(mesh.origin, mesh.origin + 3, header.origin);
  std::copy(mesh.step, mesh.step + 3, header.step);
  header.n_used_vertices = walked.n_used_vertices;
  header.n_isolated_vertices = static_cast<uint32_t>(mesh.vertices.size()) - walked.n_used_vertices;
  header.n_faces = walked.connectivity.topology.n_faces();
  header.n_corners = walked.connectivity.topology.n_corners();
  for (const uint32_t material : walked.material) header.highest_material = std::max(header.highest_material, material);
  if (header.constant_color && !mesh.vertices.empty())
    std::copy(mesh.vertices[0].color, mesh.vertices[0].color + 4, header.color);

  CodedAttributes attributes =
      encode_attributes(walked.connectivity.topology, walked.vertices, mesh.position_bits, header.constant_color);
  std::array<std::vector<uint8_t>, kSections> sections;
  sections[kConnectivity] = std::move(walked.connectivity.bytes);
  sections[kPositions] = std::move(attributes.positions);
  sections[kColors] = std::move(attributes.colors);
  sections[kMaterials] = encode_materials(walked.connectivity.topology, walked.material);
  if (options.keep_order) sections[kOrder] = encode_order(walked.connectivity.topology, walked.connectivity.order);
  uint64_t section_bytes = 0;
  for (const std::vector<uint8_t>& section : sections)
    section_bytes = std::max<uint64_t>(section_bytes, section.size());
  if (section_bytes > kMaxCount) return Failure{Error::bad_argument, 0, "mesh is too large for one stream"};

  uint64_t header_bytes = 0;
  std::vector<uint8_t> stream = write_stream(header, sections, header_bytes);
  if (size != nullptr)
    *size = {header_bytes,
             sections[kConnectivity].size(),
             sections[kPositions].size(),
             sections[kColors].size(),
             sections[kMaterials].size(),
             sections[kOrder].size()};
  return stream;
}

QuantizedMesh reorder(const QuantizedMesh& mesh) {
  QuantizedMesh result;
  if (!check(mesh)) return result;
  Walked walked = walk(mesh);
  const Topology& topology = walked.connectivity.topology;
  result.position_bits = mesh.position_bits;
  std::copy(mesh.origin, mesh.origin + 3, result.origin);
  std::copy(mesh.step, mesh.step + 3, result.step);
  result.vertices = std::move(walked.vertices);
  for (uint32_t face = 0; face < topology.n_faces(); ++face)
    result.faces.push_back({topology.face_first[face], topology.face_size(face), walked.material[face]});
  result.indices = topology.corner_vertex;
  return result;
}

}  // namespace pac::geomcodec
