#include "raster/load_ply.h"

#include <doctest/doctest.h>

#include <cstring>
#include <string>

#include "tests/support/model_files.h"

namespace {

using pac::Error;
using pac::Mesh;
using pac::raster::LoadedScene;
using pac::test::assets_from;
using pac::test::bytes_of;

pac::Result<LoadedScene> load(std::string_view text) {
  return pac::raster::load_ply(bytes_of(text), assets_from({{"wood.png", "image"}}));
}

const std::string kXyz = "property float x\nproperty float y\nproperty float z\n";
const std::string kVertices = "ply\nformat ascii 1.0\nelement vertex 3\n" + kXyz;
const std::string kFace = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
const std::string kPoints = "0 0 0\n1 0 0\n0 1 0\n";

TEST_CASE("each malformed PLY gets its named error") {
  struct Case {
    std::string text;
    Error error;
    const char* message;
  };
  const Case cases[] = {
      {"", Error::corrupt, "not a PLY file"},
      {"plyx\n", Error::corrupt, "not a PLY file"},
      {"ply\nformat ascii 1.0\n", Error::truncated, "header ends too early"},
      {"ply\nformat ascii 2.0\nend_header\n", Error::unsupported, "version of the PLY file is unknown"},
      {"ply\nformat base64 1.0\nend_header\n", Error::corrupt, "malformed header line"},
      {"ply\nend_header\n", Error::corrupt, "header without a format"},
      {"ply\nformat ascii 1.0\nelement vertex -3\nend_header\n", Error::corrupt, "malformed header line"},
      {"ply\nformat ascii 1.0\nelement vertex x\nend_header\n", Error::corrupt, "malformed header line"},
      {"ply\nformat ascii 1.0\nproperty float x\nend_header\n", Error::corrupt, "malformed header line"},
      {"ply\nformat ascii 1.0\nelement vertex 0\nproperty real x\n", Error::corrupt,
       "element or property of an unknown type"},
      {"ply\nformat ascii 1.0\nelement vertex 0\nproperty list float int x\n", Error::corrupt,
       "element or property of an unknown type"},
      {"ply\nformat ascii 1.0\nelement vertex 0\nproperty int x\nproperty int x\n", Error::corrupt,
       "property appears twice"},
      {"ply\nformat ascii 1.0\nelement vertex 0\nelement vertex 0\n", Error::corrupt, "element appears twice"},
      {"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n" + kFace + "1 3 0 0 0\n", Error::corrupt,
       "header without x, y and z"},
      {kVertices + kFace, Error::truncated, "data ends too early"},
      {kVertices + kFace + kPoints, Error::truncated, "data ends too early"},
      {kVertices + kFace + kPoints + "3 0 1\n", Error::truncated, "data ends too early"},
      {kVertices + kFace + kPoints + "3 0 1 3\n", Error::corrupt, "index out of range"},
      {kVertices + kFace + kPoints + "3 0 1 -1\n", Error::corrupt, "index out of range"},
      {kVertices + kFace + kPoints + "3 0 1 nan\n", Error::corrupt, "index out of range"},
      {kVertices + kFace + kPoints + "-3 0 1 2\n", Error::corrupt, "list with a negative length"},
      {kVertices + kFace + kPoints + "4000000000 0 1 2\n", Error::truncated, "data ends too early"},
      {kVertices + kFace + "0 0 0\n1 0 inf\n0 1 0\n3 0 1 2\n", Error::corrupt, "number is not finite"},
      {kVertices + kFace + "0 0 0\n1 0 zero\n0 1 0\n3 0 1 2\n", Error::corrupt, "malformed number"},
      {kVertices + "end_header\n" + kPoints, Error::unsupported, "no faces: point clouds are not drawn"},
      {kVertices + "element face 0\nproperty list uchar int vertex_index\nend_header\n" + kPoints, Error::unsupported,
       "no faces: point clouds are not drawn"},
      {kVertices + "element face 4000000000\nproperty list uchar int vertex_index\nend_header\n" + kPoints +
           "3 0 1 2\n",
       Error::truncated, "data ends too early"},
      {"ply\nformat binary_little_endian 1.0\nelement vertex 9223372036854775807\n" + kXyz + kFace, Error::truncated,
       "data ends too early"},
  };
  for (const Case& bad : cases) {
    CAPTURE(bad.text);
    const auto loaded = load(bad.text);
    REQUIRE(!loaded.ok());
    REQUIRE(std::string(loaded.failure().text) == bad.message);
    REQUIRE(loaded.failure().error == bad.error);
  }
}

TEST_CASE("limits stop a model before it is built") {
  const std::string text = kVertices + "element face 3\nproperty list uchar int vertex_indices\nend_header\n" +
                           kPoints + "3 0 1 2\n3 0 1 2\n3 0 1 2\n";
  pac::Limits limits;
  limits.max_triangles = 2;
  REQUIRE(pac::raster::load_ply(bytes_of(text), {}, limits).failure().error == Error::limit_exceeded);
  limits.max_triangles = 3;
  REQUIRE(pac::raster::load_ply(bytes_of(text), {}, limits).ok());
  limits.max_bytes = text.size() - 1;
  REQUIRE(pac::raster::load_ply(bytes_of(text), {}, limits).failure().error == Error::limit_exceeded);
}

TEST_CASE("colors of any type, other elements and lists in between are understood or skipped") {
  const auto loaded = load(
      "ply\r\nformat ascii 1.0\r\ncomment TextureFile wood.png\r\nobj_info x\r\nelement material 2\r\nproperty int "
      "a\r\n"
      "property list uchar float b\r\nelement vertex 3\r\nproperty double y\r\nproperty double x\r\nproperty list "
      "uchar int "
      "w\r\nproperty double z\r\nproperty ushort red\r\nproperty float green\r\nproperty int blue\r\nproperty float "
      "s\r\n"
      "property float t\r\nelement edge 1\r\nproperty int q\r\nelement face 2\r\nproperty uchar flags\r\nproperty list "
      "uchar uint vertex_index\r\nproperty list uchar float texcoord\r\nend_header\r\n"
      "1 0\r\n2 3 1 2 3\r\n"
      "1 2 1 9 3 65535 0.5 300 0.25 1\r\n0 0 0 0 0 1 -4 0 0\r\n0 1 2 5 5 0 0 0 0 0 0\r\n77\r\n1 3 0 1 2 1 .5\r\n0 2 0 "
      "1 0\r\n");
  REQUIRE(loaded.ok());
  const Mesh& mesh = loaded->scene.mesh;
  REQUIRE(mesh.faces.size() == 1);
  const pac::Vertex& first = mesh.vertices[mesh.indices[0]];
  REQUIRE(first.position[0] == 2);
  REQUIRE(first.position[1] == 1);
  REQUIRE(first.position[2] == 3);
  REQUIRE(first.color[0] == 255);
  REQUIRE(first.color[1] == 128);
  REQUIRE(first.color[2] == 255);
  REQUIRE(first.color[3] == 255);
  REQUIRE(first.texcoord[0] == 0.25f);
  REQUIRE(first.texcoord[1] == 0);
  REQUIRE(mesh.vertices[mesh.indices[1]].color[1] == 255);
  REQUIRE(mesh.vertices[mesh.indices[1]].color[2] == 0);
  REQUIRE(loaded->scene.materials[0].texture == 0);
  REQUIRE(loaded->warnings.size() == 1);
}

Mesh sample_mesh(bool everything) {
  Mesh mesh;
  for (int i = 0; i < 300; ++i) {
    pac::Vertex vertex;
    for (int axis = 0; axis < 3; ++axis)
      vertex.position[axis] = static_cast<float>((i * 37 + axis * 11) % 100) * 0.125f;
    vertex.color[0] = static_cast<uint8_t>(i);
    if (everything) {
      vertex.normal[i % 3] = 1;
      vertex.texcoord[0] = 0.5f;
    }
    mesh.vertices.push_back(vertex);
  }
  mesh.indices = {0, 1, 2, 3, 4, 5, 6, 299, 298};
  mesh.faces = {{0, 4, 0}, {4, 5, everything ? 7u : 0u}};
  if (everything) {
    mesh.faces.push_back({9, 300, 1});
    for (uint32_t i = 0; i < 300; ++i) mesh.indices.push_back(299 - i);
  }
  return mesh;
}

TEST_CASE("what write_ply wrote is read back, in either byte order") {
  const Mesh mesh = sample_mesh(true);
  const auto loaded = pac::raster::load_model(pac::raster::write_ply(mesh), {});
  REQUIRE(loaded.ok());
  REQUIRE(loaded->scene.mesh.indices == mesh.indices);
  REQUIRE(loaded->scene.mesh.faces.size() == mesh.faces.size());
  REQUIRE(loaded->scene.mesh.faces[2].count == 300);
  for (size_t v = 0; v < mesh.vertices.size(); ++v)
    REQUIRE(std::memcmp(&loaded->scene.mesh.vertices[v], &mesh.vertices[v], sizeof(pac::Vertex)) == 0);

  const std::string big = std::string("ply\nformat binary_big_endian 1.0\nelement vertex 3\n") + kXyz +
                          "element face 1\nproperty list short ushort vertex_indices\nend_header\n" +
                          std::string("\x40\x00\x00\x00\x00\x00\x00\x00\xBF\x80\x00\x00", 12) + std::string(12, '\0') +
                          std::string("\0\0\0\0\x3F\x80\0\0\0\0\0\0", 12) + std::string("\0\3\0\1\0\2\0\0", 8);
  const auto scene = load(big);
  REQUIRE(scene.ok());
  const Mesh& read = scene->scene.mesh;
  REQUIRE(read.vertices[read.indices[2]].position[0] == 2.0f);
  REQUIRE(read.vertices[read.indices[2]].position[2] == -1.0f);
}

TEST_CASE("generated normals split vertices at creases") {
  Mesh mesh;
  for (const float x : {0.0f, 1.0f, -1.0f})
    for (const float y : {0.0f, 1.0f}) {
      pac::Vertex vertex;
      vertex.position[0] = x;
      vertex.position[1] = y;
      vertex.position[2] = x == 0 ? 0.0f : -2.0f;
      mesh.vertices.push_back(vertex);
    }
  mesh.indices = {0, 2, 3, 1, 0, 1, 5, 4};
  mesh.faces = {{0, 4, 0}, {4, 4, 0}};
  const auto loaded = pac::raster::load_ply(pac::raster::write_ply(mesh), {});
  REQUIRE(loaded.ok());
  REQUIRE(loaded->scene.mesh.vertices.size() == 8);
  for (const pac::Vertex& vertex : loaded->scene.mesh.vertices) REQUIRE(vertex.normal[2] > 0.3f);
}

TEST_CASE("every strict prefix of a PLY file is refused") {
  for (const bool everything : {false, true}) {
    const std::vector<uint8_t> bytes = pac::raster::write_ply(sample_mesh(everything));
    for (size_t size = 0; size < bytes.size(); ++size) {
      const std::vector<uint8_t> prefix(bytes.begin(), bytes.begin() + static_cast<ptrdiff_t>(size));
      REQUIRE(!pac::raster::load_ply(prefix, {}).ok());
    }
  }
}

}  // namespace
