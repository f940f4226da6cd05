// What decode() does with streams that no encoder wrote, and encode() with meshes that are none.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "base/checksum.h"
#include "geomcodec/geomcodec.h"
#include "tests/support/mesh_zoo.h"

namespace {

using pac::Error;
using pac::Limits;
using pac::geomcodec::decode;
using pac::geomcodec::Effort;
using pac::geomcodec::encode;
using pac::geomcodec::EncodeOptions;
using pac::geomcodec::Grid;
using pac::geomcodec::quantize;
using pac::geomcodec::QuantizedMesh;
using pac::test::mesh_zoo;
using pac::test::NamedMesh;

using Bytes = std::vector<uint8_t>;

Limits small_limits() {
  Limits limits;
  limits.max_triangles = 200000;
  limits.max_bytes = 8 << 20;
  return limits;
}

// Every index of a decoded mesh is below its vertex count, every face inside the list.
void require_sound(const QuantizedMesh& mesh) {
  uint64_t next = 0;
  bool in_list = true, in_range = true;
  for (const pac::Face& face : mesh.faces) {
    in_list = in_list && face.first == next && face.count >= 3;
    next += face.count;
  }
  REQUIRE(in_list);
  REQUIRE(next == mesh.indices.size());
  for (const uint32_t index : mesh.indices) in_range = in_range && index < mesh.vertices.size();
  REQUIRE(in_range);
}

constexpr EncodeOptions kKinds[] = {{}, {.keep_order = true}, {.keep_order = true, .effort = Effort::fast}};

TEST_CASE("every strict prefix of a stream, and a stream with a byte more, is refused") {
  for (const NamedMesh& entry : mesh_zoo()) {
    if (entry.mesh.indices.size() > 2000) continue;
    CAPTURE(entry.name);
    for (const EncodeOptions& kind : kKinds) {
      Bytes bytes = encode(entry.mesh, kind).value();
      for (size_t size = 0; size < bytes.size(); ++size) {
        const Bytes prefix(bytes.begin(),
                           bytes.begin() + static_cast<ptrdiff_t>(size));  // sized exactly, for sanitizers
        REQUIRE(!decode(prefix).ok());
        REQUIRE(decode(prefix).failure().error == Error::truncated);
        REQUIRE(!pac::geomcodec::read_info(prefix).ok());
      }
      bytes.push_back(0);
      REQUIRE(decode(bytes).failure().error == Error::corrupt);
    }
  }
}

TEST_CASE("a flipped bit anywhere is noticed by the checksum or the header's rules") {
  for (const EncodeOptions& kind : kKinds) {
    const Bytes bytes = encode(pac::test::wave_mesh(5, 4, false), kind).value();
    for (size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
      Bytes damaged = bytes;
      damaged[bit / 8] = static_cast<uint8_t>(damaged[bit / 8] ^ 1 << bit % 8);
      REQUIRE(!decode(damaged, small_limits()).ok());
    }
  }
}

// Where the checksum lies: the header's end less 4.
void repair_checksum(Bytes& bytes, size_t header_bytes) {
  const std::span<const uint8_t> all(bytes);
  const uint32_t checksum = pac::crc32(all.subspan(header_bytes), pac::crc32(all.first(header_bytes - 4)));
  for (size_t i = 0; i < 4; ++i) bytes[header_bytes - 4 + i] = static_cast<uint8_t>(checksum >> 8 * i);
}

TEST_CASE("damaged streams whose checksum was repaired decode to a sound mesh or are refused, and never crash") {
  uint64_t state = 12345;
  const auto random = [&](uint64_t limit) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return static_cast<size_t>((state >> 33) % limit);
  };
  size_t n_decoded = 0, n_tried = 0;
  for (const NamedMesh& entry : mesh_zoo()) {
    if (entry.mesh.indices.size() > 4000) continue;
    for (const EncodeOptions& kind : kKinds) {
      pac::geomcodec::EncodedSize size;
      const Bytes bytes = encode(entry.mesh, kind, &size).value();
      for (int round = 0; round < 60; ++round) {
        Bytes damaged = bytes;
        const size_t n_changes = 1 + random(3);
        for (size_t i = 0; i < n_changes; ++i) {
          // A third of the changes hit the header's counts, the rest anything behind it.
          const bool in_header = random(3) == 0 || damaged.size() == size.header_bytes;
          const size_t at = in_header ? 4 + random(size.header_bytes - 8)
                                      : size.header_bytes + random(damaged.size() - size.header_bytes);
          damaged[at] = static_cast<uint8_t>(random(4) == 0 ? random(256) : damaged[at] ^ 1u << random(8));
        }
        repair_checksum(damaged, size.header_bytes);
        const auto decoded = decode(damaged, small_limits());
        ++n_tried;
        if (!decoded.ok()) continue;
        ++n_decoded;
        require_sound(*decoded);
      }
    }
  }
  REQUIRE(n_tried > 2000);
  REQUIRE(n_decoded > 0);
}

// A header from parts, with no sections: used, split, isolated, faces, extra corners, highest material, then the sizes
// of the sections that these leave.
Bytes header(uint8_t flags, uint8_t bits, std::initializer_list<uint64_t> numbers) {
  Bytes bytes = {'P', 'G', 'C', 3, flags, bits};
  for (uint64_t number : numbers) {
    for (; number >= 0x80; number >>= 7) bytes.push_back(static_cast<uint8_t>(number | 0x80));
    bytes.push_back(static_cast<uint8_t>(number));
  }
  bytes.resize(bytes.size() + 4);
  repair_checksum(bytes, bytes.size());
  return bytes;
}

TEST_CASE("each header field at its limit and one past it") {
  struct Case {
    const char* what;
    Bytes bytes;
    Error error;
    const char* message;
  };
  Bytes magic = header(4, 16, {0, 0, 0, 0, 0, 0}), version = magic, checksum = magic, padded = magic;
  REQUIRE(decode(magic).ok());
  magic[1] = 'g';
  version[3] = 2;  // of streams before this version
  checksum.back() = static_cast<uint8_t>(checksum.back() + 1);
  padded[6] = 0x80;  // the number 0 in two bytes
  Bytes normals = header(4 + 16, 16, {2, 0, 0, 0, 0, 0, 0}), texture = header(4 + 32, 16, {1, 0, 0, 0, 0, 0, 0, 0x80});
  REQUIRE(decode(normals).ok());
  REQUIRE(decode(header(128 + 4, 16, {16, 4, 0, 0, 0, 0, 0, 0})).ok());
  normals[6] = 17;
  texture[6] = 0;
  // Version 5 has one more byte: which sections tables code.
  Bytes choosing_nothing = magic, choosing_by_tables = header(4, 16, {0, 0, 1, 0, 0, 0, 0, 0});
  choosing_nothing[1] = 'G';
  for (Bytes* bytes : {&choosing_nothing, &choosing_by_tables}) {
    (*bytes)[3] = 5;
    bytes->insert(bytes->begin() + 5, bytes == &choosing_by_tables ? 4 : 0);
    repair_checksum(*bytes, bytes->size());
  }
  // Version 6 has two more, the second one features, and tells how many faces are degenerate.
  Bytes unknown_features = header(4, 16, {3, 0, 0, 2, 0, 1, 0, 0, 0, 0, 0}), all_degenerate = unknown_features;
  for (Bytes* bytes : {&unknown_features, &all_degenerate}) {
    (*bytes)[3] = 6;
    const uint8_t more[2] = {0, static_cast<uint8_t>(bytes == &all_degenerate ? 1 : 2)};
    bytes->insert(bytes->begin() + 5, more, more + 2);
  }
  all_degenerate[13] = 2;
  // Version 7 is there for expected tables, which sections by tables but connectivity have.
  Bytes nothing_expected = header(4, 16, {0, 0, 1, 0, 0, 0, 0, 0}),
        expected_by_faces = header(4, 16, {3, 0, 0, 1, 0, 0, 0, 0, 0});
  for (Bytes* bytes : {&nothing_expected, &expected_by_faces}) {
    (*bytes)[3] = 7;
    const bool by_faces = bytes == &expected_by_faces;
    const uint8_t more[2] = {static_cast<uint8_t>(by_faces ? 1 : 4), static_cast<uint8_t>(by_faces ? 16 : 0)};
    bytes->insert(bytes->begin() + 5, more, more + 2);
    repair_checksum(*bytes, bytes->size());
  }
  // Version 8 is there for those of connectivity.
  Bytes no_tables_of_faces = header(4, 16, {3, 0, 0, 1, 0, 0, 0, 0, 0}), no_feature_of_version_8 = no_tables_of_faces;
  for (Bytes* bytes : {&no_tables_of_faces, &no_feature_of_version_8}) {
    (*bytes)[3] = 8;
    const bool by_positions = bytes == &no_tables_of_faces;
    const uint8_t more[2] = {static_cast<uint8_t>(by_positions ? 4 : 1), static_cast<uint8_t>(by_positions ? 32 : 1)};
    bytes->insert(bytes->begin() + 5, more, more + 2);
    repair_checksum(*bytes, bytes->size());
  }
  repair_checksum(unknown_features, unknown_features.size());
  repair_checksum(all_degenerate, all_degenerate.size());
  const uint64_t top = 0x7FFFFFFF;
  const Case cases[] = {
      {"magic", magic, Error::corrupt, "not a PGC geometry stream"},
      {"version", version, Error::unsupported, "version of the stream is unknown"},
      {"choosing without a vertex", choosing_nothing, Error::corrupt, "positions that are not there choose"},
      {"unknown features", unknown_features, Error::corrupt, "features are unknown, or none that needs this version"},
      {"no expected tables", nothing_expected, Error::corrupt, "features are unknown, or none that needs this version"},
      {"expected tables of faces", expected_by_faces, Error::corrupt, "no section or a wrong one is coded by tables"},
      {"expected tables of faces that have none", no_tables_of_faces, Error::corrupt,
       "no section or a wrong one is coded by tables"},
      {"no expected tables of faces", no_feature_of_version_8, Error::corrupt,
       "features are unknown, or none that needs this version"},
      {"all faces degenerate", all_degenerate, Error::corrupt, "no face or all of them are degenerate"},
      {"choosing by tables", choosing_by_tables, Error::corrupt, "no section or a wrong one is coded by tables"},
      {"values of faces of 17 bits", header(128 + 4, 16, {17, 1, 0, 0, 0, 0, 0, 0}), Error::corrupt,
       "values of faces are not 1..4 of 1..16 bits"},
      {"values of faces of 0 bits", header(128 + 4, 16, {0, 1, 0, 0, 0, 0, 0, 0}), Error::corrupt,
       "values of faces are not 1..4 of 1..16 bits"},
      {"five values a face", header(128 + 4, 16, {16, 5, 0, 0, 0, 0, 0, 0}), Error::corrupt,
       "values of faces are not 1..4 of 1..16 bits"},
      {"no values a face", header(128 + 4, 16, {16, 0, 0, 0, 0, 0, 0, 0}), Error::corrupt,
       "values of faces are not 1..4 of 1..16 bits"},
      {"trained for nothing", header(64 + 4, 16, {0, 0, 0, 0, 0, 0}), Error::corrupt,
       "models are trained for no vertex"},
      {"two grids", header(12, 16, {0, 0, 0, 0, 0, 0}), Error::corrupt, "flags contradict one another"},
      {"bits 0", header(4, 0, {0, 0, 0, 0, 0, 0}), Error::corrupt, "position bits are not in 1..16"},
      {"bits 17", header(4, 17, {0, 0, 0, 0, 0, 0}), Error::corrupt, "position bits are not in 1..16"},
      {"normal bits 17", normals, Error::corrupt, "normal bits are not in 2..16"},
      {"texture bits 0", texture, Error::corrupt, "texture coordinate bits are not in 1..16"},
      {"checksum", checksum, Error::corrupt, "checksum does not match"},
      {"long number", padded, Error::corrupt, "malformed number in the header"},
      {"number of 36 bits", header(4, 16, {uint64_t{1} << 35, 0, 0, 0, 0, 0}), Error::corrupt,
       "malformed number in the header"},
      {"2^31 - 1 vertices", header(4, 16, {0, 0, top, 0, 0, 0, 0, 0}), Error::limit_exceeded,
       "decoded mesh is larger than the limit"},
      {"2^31 vertices", header(4, 16, {0, 0, top + 1, 0, 0, 0}), Error::corrupt, "count in the header is too large"},
      {"sum of vertices", header(4, 16, {3, 0, top, 1, 0, 0}), Error::corrupt,
       "counts in the header contradict one another"},
      {"more used vertices than corners", header(4, 16, {4, 0, 0, 1, 0, 0}), Error::corrupt,
       "counts in the header contradict one another"},
      {"all vertices split", header(4, 16, {3, 3, 0, 1, 0, 0}), Error::corrupt,
       "counts in the header contradict one another"},
      {"faces without vertices", header(4, 16, {0, 0, 0, 1, 0, 0}), Error::corrupt,
       "counts in the header contradict one another"},
      {"corners without faces", header(4, 16, {0, 0, 0, 0, 1, 0}), Error::corrupt,
       "counts in the header contradict one another"},
      {"corners past 2^31", header(4, 16, {3, 0, 0, top / 3, 5, 0}), Error::corrupt,
       "counts in the header contradict one another"},
      {"2^26 + 1 triangles", header(4, 16, {3, 0, 0, (1 << 26) + 1, 0, 0, 0, 0, 0}), Error::limit_exceeded,
       "mesh has more triangles than the limit"},
      {"2^31 - 1 section bytes", header(4, 16, {0, 0, 1, 0, 0, 0, top, 0}), Error::truncated, "stream ends too early"},
      {"a face that is not there", header(4, 16, {3, 0, 0, 1, 1, 0, 0, 0, 0}), Error::corrupt, ""},
      {"seams that are not there", header(4, 16, {3, 2, 0, 1, 0, 0, 0, 0, 0, 0}), Error::corrupt, ""},
      {"a million faces in no bytes", header(4, 16, {3, 0, 0, 1000000, 0, 0, 0, 0, 0}), Error::corrupt, ""},
      {"a million vertices in no bytes", header(4, 16, {0, 0, 1000000, 0, 0, 0, 0, 0}), Error::corrupt, ""},
  };
  for (const Case& bad : cases) {
    CAPTURE(bad.what);
    const auto decoded = decode(bad.bytes);
    REQUIRE(!decoded.ok());
    REQUIRE(decoded.failure().error == bad.error);
    if (bad.message[0] != 0) REQUIRE(std::string(decoded.failure().text) == bad.message);
  }
}

TEST_CASE("limits hold before anything is decoded") {
  const Bytes bytes = encode(pac::test::wave_mesh(10, 10, false)).value();  // 100 quads, 121 vertices
  Limits limits;
  limits.max_triangles = 200;
  REQUIRE(decode(bytes, limits).ok());
  limits.max_triangles = 199;
  REQUIRE(decode(bytes, limits).failure().error == Error::limit_exceeded);
  limits = {};
  limits.max_bytes = 121 * sizeof(pac::geomcodec::QuantizedVertex) + 400 * 4 + 100 * sizeof(pac::Face);
  REQUIRE(decode(bytes, limits).ok());
  --limits.max_bytes;
  REQUIRE(decode(bytes, limits).failure().error == Error::limit_exceeded);
}

TEST_CASE("encode refuses what is no mesh") {
  const QuantizedMesh good = pac::test::wave_mesh(2, 2, false);
  const auto refused = [](const QuantizedMesh& mesh) {
    const auto bytes = encode(mesh);
    return !bytes.ok() && bytes.failure().error == Error::bad_argument &&
           pac::geomcodec::reorder(mesh).vertices.empty();
  };
  QuantizedMesh mesh = good;
  mesh.position_bits = 17;
  REQUIRE(refused(mesh));
  mesh = good;
  mesh.position_bits = 15;  // coordinates reach 65535
  REQUIRE(refused(mesh));
  mesh = good;
  mesh.faces[1].count = 2;
  REQUIRE(refused(mesh));
  mesh = good;
  mesh.faces[1].first = 0xFFFFFFFE;
  REQUIRE(refused(mesh));
  mesh = good;
  mesh.indices[3] = 9;
  REQUIRE(refused(mesh));
  mesh = good;
  mesh.step[1] = 0;
  REQUIRE(refused(mesh));
  mesh = good;
  mesh.origin[2] = std::numeric_limits<float>::quiet_NaN();
  REQUIRE(refused(mesh));
  mesh = good;
  mesh.normal_bits = 1;
  REQUIRE(refused(mesh));
  mesh = good;
  mesh.vertices[1].normal[0] = 1;  // a normal where the mesh has none
  REQUIRE(refused(mesh));
  mesh = good;
  mesh.normal_bits = 8;
  mesh.vertices[1].normal[0] = 255;
  REQUIRE(refused(mesh));
  mesh = good;
  mesh.texcoord_bits = 4;
  mesh.vertices[1].texcoord[1] = 16;
  REQUIRE(refused(mesh));
  mesh = good;
  mesh.texcoord_step = -1;
  REQUIRE(refused(mesh));
  mesh = good;  // faces may share corners and leave gaps: they come back packed
  mesh.faces[1] = mesh.faces[0];
  REQUIRE(pac::test::same(decode(encode(mesh, {.keep_order = true}).value()).value(), pac::test::packed(mesh)));
}

TEST_CASE("quantize rounds to the nearest grid point, halves upwards, and clamps to the grid") {
  pac::Mesh mesh;
  const float values[] = {-1.0f, 0.0f, 0.24f, 0.25f, 0.75f, 31.5f, 31.6f, 1e30f, -1e30f};
  for (const float value : values) {
    pac::Vertex vertex;
    vertex.position[0] = value;
    mesh.vertices.push_back(vertex);
  }
  Grid grid;
  grid.bits = 6;
  grid.step[0] = 0.5f;
  const QuantizedMesh quantized = quantize(mesh, grid).value();
  const uint16_t expected[] = {0, 0, 0, 1, 2, 63, 63, 63, 0};
  for (size_t v = 0; v < std::size(values); ++v) REQUIRE(quantized.vertices[v].position[0] == expected[v]);
  REQUIRE(pac::geomcodec::dequantize(quantized).vertices[5].position[0] == 31.5f);

  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    mesh.vertices[2].position[1] = bad;
    REQUIRE(quantize(mesh, grid).failure().error == Error::corrupt);
    REQUIRE(quantize(mesh, grid).failure().byte_offset == 2);
    REQUIRE(quantize(mesh, 12).failure().error == Error::corrupt);
  }
  REQUIRE(quantize({}, 0).failure().error == Error::bad_argument);
  REQUIRE(quantize({}, 17).failure().error == Error::bad_argument);
  grid.step[0] = -1;
  REQUIRE(quantize({}, grid).failure().error == Error::bad_argument);
}

TEST_CASE("quantized normals stay within 0.3 degrees at 10 bits, texture coordinates within half a step") {
  pac::Mesh mesh;
  for (int i = 0; i < 400; ++i) {
    pac::Vertex vertex;
    const double z = (i % 20) / 9.5 - 1, r = std::sqrt(std::max(0.0, 1 - z * z));
    vertex.normal[0] = static_cast<float>(r * std::cos(i * 0.7));
    vertex.normal[1] = static_cast<float>(r * std::sin(i * 0.7));
    vertex.normal[2] = static_cast<float>(z);
    vertex.texcoord[0] = static_cast<float>(i) * 0.013f - 2;
    vertex.texcoord[1] = static_cast<float>(i % 7) * 0.3f;
    mesh.vertices.push_back(vertex);
  }
  const QuantizedMesh quantized = quantize(mesh, pac::geomcodec::AttributeBits{14, 10, 12}).value();
  const pac::Mesh back = pac::geomcodec::dequantize(quantized);
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    double dot = 0;
    for (int i = 0; i < 3; ++i) dot += double{mesh.vertices[v].normal[i]} * back.vertices[v].normal[i];
    REQUIRE(dot > std::cos(0.3 * 3.14159265 / 180));
    for (int i = 0; i < 2; ++i)
      REQUIRE(std::fabs(mesh.vertices[v].texcoord[i] - back.vertices[v].texcoord[i]) <=
              0.51f * quantized.texcoord_step);
  }
  REQUIRE(pac::test::same(decode(encode(quantized, {.keep_order = true}).value()).value(), quantized));
  REQUIRE(!quantize(mesh, pac::geomcodec::AttributeBits{14, 1, 0}).ok());
  REQUIRE(!quantize(mesh, pac::geomcodec::AttributeBits{14, 0, 17}).ok());
  mesh.vertices[3].texcoord[1] = std::numeric_limits<float>::infinity();
  REQUIRE(quantize(mesh, pac::geomcodec::AttributeBits{14, 0, 12}).failure().byte_offset == 3);
}

TEST_CASE("merging equal vertices keeps every face and loses only copies and vertices without faces") {
  for (const NamedMesh& entry : mesh_zoo()) {
    CAPTURE(entry.name);
    const QuantizedMesh merged = pac::geomcodec::merge_equal_vertices(entry.mesh);
    REQUIRE(merged.indices.size() == entry.mesh.indices.size());
    REQUIRE(merged.vertices.size() <= entry.mesh.vertices.size());
    for (size_t i = 0; i < merged.indices.size(); ++i)
      REQUIRE(merged.vertices[merged.indices[i]] == entry.mesh.vertices[entry.mesh.indices[i]]);
  }
}

TEST_CASE("the fitted grid keeps every position within half a step, with no extent on any number of axes") {
  for (int flat = 0; flat <= 3; ++flat) {
    pac::Mesh mesh;
    for (int i = 0; i < 50; ++i) {
      pac::Vertex vertex;
      for (int axis = 0; axis < 3; ++axis)
        vertex.position[axis] = axis < flat ? -2.5f : static_cast<float>((i * 29 + axis * 7) % 50) * 0.3f - 4.0f;
      mesh.vertices.push_back(vertex);
    }
    for (const int bits : {1, 8, 16}) {
      const QuantizedMesh quantized = quantize(mesh, bits).value();
      const pac::Mesh back = pac::geomcodec::dequantize(quantized);
      for (size_t v = 0; v < mesh.vertices.size(); ++v)
        for (int axis = 0; axis < 3; ++axis)
          REQUIRE(std::fabs(back.vertices[v].position[axis] - mesh.vertices[v].position[axis]) <=
                  0.5f * quantized.step[axis] + 1e-6f);
      REQUIRE(encode(quantized).ok());
    }
  }
}

}  // namespace
