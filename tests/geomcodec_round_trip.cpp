#include <doctest/doctest.h>

#include <algorithm>

#include "geomcodec/geomcodec.h"
#include "tests/support/mesh_zoo.h"

namespace {

using pac::geomcodec::decode;
using pac::geomcodec::Effort;
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
  const auto n_values = static_cast<size_t>(mesh.face_components);
  for (size_t f = 0; f < mesh.faces.size(); ++f) {
    const pac::Face& face = mesh.faces[f];
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
    for (size_t i = 0; i < n_values; ++i) best.push_back(mesh.face_values[f * n_values + i]);
    faces.push_back(best);
  }
  std::sort(faces.begin(), faces.end());
  return faces;
}

TEST_CASE("with keep_order every mesh of the zoo comes back bit for bit") {
  for (const NamedMesh& entry : mesh_zoo()) {
    CAPTURE(entry.name);
    for (const Effort effort : {Effort::fast, Effort::balanced, Effort::best}) {
      const auto bytes = encode(entry.mesh, {.keep_order = true, .effort = effort});
      REQUIRE(bytes.ok());
      const auto decoded = decode(*bytes);
      REQUIRE(decoded.ok());
      REQUIRE(same(*decoded, entry.mesh));
    }
  }
}

TEST_CASE("without it every mesh comes back as reorder() says, which keeps vertices, faces and their orientation") {
  for (const NamedMesh& entry : mesh_zoo()) {
    CAPTURE(entry.name);
    const QuantizedMesh expected = reorder(entry.mesh);
    for (const Effort effort : {Effort::fast, Effort::balanced}) {
      const auto bytes = encode(entry.mesh, {.effort = effort});
      REQUIRE(bytes.ok());
      const auto decoded = decode(*bytes);
      REQUIRE(decoded.ok());
      REQUIRE(same(*decoded, expected));
    }
    REQUIRE(expected.vertices.size() == entry.mesh.vertices.size());
    REQUIRE((entry.mesh.faces.size() > 2000 || face_set(expected) == face_set(entry.mesh)));
    REQUIRE(same(reorder(expected), expected));
  }
}

TEST_CASE("triangles that rounding has closed on edges cost next to nothing and leave the rest as it was") {
  const QuantizedMesh smooth = pac::test::wave_mesh(60, 50, true);  // 6000 triangles
  QuantizedMesh mesh = smooth;
  for (uint32_t f = 0; f < smooth.faces.size(); f += 4) {
    const uint32_t* corner = &smooth.indices[smooth.faces[f].first];
    mesh.faces.push_back({static_cast<uint32_t>(mesh.indices.size()), 3, 0});
    mesh.indices.insert(mesh.indices.end(), {corner[0], corner[f / 4 % 2], corner[1]});
  }
  const size_t n_closed = mesh.faces.size() - smooth.faces.size();
  for (const Effort effort : {Effort::fast, Effort::balanced}) {
    EncodedSize size, without;
    REQUIRE(encode(mesh, {.effort = effort}, &size).ok());
    REQUIRE(encode(smooth, {.effort = effort}, &without).ok());
    REQUIRE(size.connectivity_bytes < without.connectivity_bytes + n_closed / 2);
    REQUIRE(size.position_bytes == without.position_bytes);
  }
}

TEST_CASE("values of faces must be as many and as small as the mesh says") {
  QuantizedMesh mesh = pac::test::wave_mesh(3, 2, false);
  mesh.face_bits = 8;
  mesh.face_components = 2;
  mesh.face_values.assign(12, 255);
  REQUIRE(encode(mesh).ok());
  QuantizedMesh bad = mesh;
  bad.face_values.pop_back();
  REQUIRE(encode(bad).failure().error == pac::Error::bad_argument);
  bad = mesh;
  bad.face_values[3] = 256;
  REQUIRE(encode(bad).failure().byte_offset == 3);
  bad = mesh;
  bad.face_components = 0;
  REQUIRE(encode(bad).failure().error == pac::Error::bad_argument);
  bad = mesh;
  bad.face_bits = 17;
  REQUIRE(encode(bad).failure().error == pac::Error::bad_argument);
}

TEST_CASE("a color per face that changes with the surface takes less than a quarter of its bytes") {
  QuantizedMesh mesh = pac::test::wave_mesh(40, 30, true);
  mesh.face_bits = 8;
  mesh.face_components = 3;
  for (const pac::Face& face : mesh.faces)
    for (const int shift : {8, 7, 9})
      mesh.face_values.push_back(
          static_cast<uint16_t>(mesh.vertices[mesh.indices[face.first]].position[2] >> shift & 255));
  EncodedSize size;
  REQUIRE(encode(mesh, {}, &size).ok());
  REQUIRE(size.face_value_bytes > 0);
  REQUIRE(4 * size.face_value_bytes < mesh.face_values.size());
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
