#include <doctest/doctest.h>

#include <algorithm>

#include "geomcodec/geomcodec.h"
#include "tests/support/mesh_zoo.h"

namespace {

using pac::geomcodec::decode;
using pac::geomcodec::encode;
using pac::geomcodec::EncodedSize;
using pac::geomcodec::QuantizedMesh;
using pac::geomcodec::reorder;
using pac::test::mesh_zoo;
using pac::test::NamedMesh;
using pac::test::same;

// Each face as its corners' vertex *values*, rotated to the smallest form: what reorder() must keep.
std::vector<std::vector<uint32_t>> face_set(const QuantizedMesh& mesh) {
  std::vector<std::vector<uint32_t>> faces;
  for (const pac::Face& face : mesh.faces) {
    std::vector<uint32_t> corners, best;
    for (uint32_t k = 0; k < face.count; ++k) {
      const auto& vertex = mesh.vertices[mesh.indices[face.first + k]];
      corners.insert(corners.end(), {static_cast<uint32_t>(vertex.position[0]) << 16 | vertex.position[1],
                                     static_cast<uint32_t>(vertex.position[2]) << 16 | vertex.color[0]});
    }
    for (uint32_t k = 0; k < face.count; ++k) {
      if (best.empty() || corners < best) best = corners;
      std::rotate(corners.begin(), corners.begin() + 2, corners.end());
    }
    best.push_back(face.material);
    faces.push_back(best);
  }
  std::sort(faces.begin(), faces.end());
  return faces;
}

TEST_CASE("with keep_order every mesh of the zoo comes back bit for bit") {
  for (const NamedMesh& entry : mesh_zoo()) {
    CAPTURE(entry.name);
    const auto bytes = encode(entry.mesh, {.keep_order = true});
    REQUIRE(bytes.ok());
    const auto decoded = decode(*bytes);
    REQUIRE(decoded.ok());
    REQUIRE(same(*decoded, entry.mesh));
  }
}

TEST_CASE("without it every mesh comes back as reorder() says, which keeps vertices, faces and their orientation") {
  for (const NamedMesh& entry : mesh_zoo()) {
    CAPTURE(entry.name);
    const QuantizedMesh expected = reorder(entry.mesh);
    const auto bytes = encode(entry.mesh);
    REQUIRE(bytes.ok());
    const auto decoded = decode(*bytes);
    REQUIRE(decoded.ok());
    REQUIRE(same(*decoded, expected));
    REQUIRE(expected.vertices.size() == entry.mesh.vertices.size());
    REQUIRE((entry.mesh.faces.size() > 2000 || face_set(expected) == face_set(entry.mesh)));
    REQUIRE(same(reorder(expected), expected));
  }
}

TEST_CASE("the parts add up to the stream, and read_info tells them without decoding") {
  for (const NamedMesh& entry : mesh_zoo()) {
    CAPTURE(entry.name);
    for (const bool keep_order : {false, true}) {
      EncodedSize size;
      const auto bytes = encode(entry.mesh, {keep_order}, &size);
      REQUIRE(bytes.ok());
      REQUIRE(size.total_bytes() == bytes->size());
      const auto info = pac::geomcodec::read_info(*bytes);
      REQUIRE(info.ok());
      REQUIRE(info->n_vertices == entry.mesh.vertices.size());
      REQUIRE(info->n_faces == entry.mesh.faces.size());
      REQUIRE(info->n_corners == entry.mesh.indices.size());
      REQUIRE(info->position_bits == entry.mesh.position_bits);
      REQUIRE(info->keeps_order == keep_order);
      REQUIRE(info->size.total_bytes() == bytes->size());
      REQUIRE(info->size.connectivity_bytes == size.connectivity_bytes);
    }
  }
}

}  // namespace
