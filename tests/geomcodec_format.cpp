// The stream's bytes: FORMAT.md's example, one hash for all platforms, a second decoder, and how small streams are.
#include <doctest/doctest.h>

#include <set>
#include <string>

#include "geomcodec/geomcodec.h"
#include "tests/support/mesh_zoo.h"
#include "tests/support/peer.h"
#include "tests/support/reference_decoder.h"

namespace {

using pac::geomcodec::decode;
using pac::geomcodec::Effort;
using pac::geomcodec::encode;
using pac::geomcodec::EncodedSize;
using pac::geomcodec::EncodeOptions;
using pac::geomcodec::QuantizedMesh;
using pac::test::Fnv;
using pac::test::mesh_zoo;
using pac::test::NamedMesh;
using pac::test::summary;
using pac::test::TempDir;

TEST_CASE("the worked example of FORMAT.md is what encode writes") {
  QuantizedMesh mesh;
  const uint16_t corners[4][2] = {{10, 20}, {50, 20}, {50, 60}, {10, 60}};
  for (const auto& corner : corners) mesh.vertices.push_back({{corner[0], corner[1], 30}, {200, 100, 50, 255}});
  mesh.indices = {0, 1, 2, 0, 2, 3};
  mesh.faces = {{0, 3, 0}, {3, 3, 0}};
  mesh.position_bits = 8;
  for (float& step : mesh.step) step = 0.5f;
  const std::vector<uint8_t> expected = {0x50, 0x47, 0x43, 0x03, 0x0A, 0x08, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
                                         0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x3F, 0x04, 0x00, 0x00, 0x02,
                                         0x00, 0x00, 0xC8, 0x64, 0x32, 0xFF, 0x01, 0x0C, 0x26, 0x44, 0x89, 0xE8, 0x50,
                                         0x7B, 0xE8, 0x42, 0x70, 0xD8, 0x60, 0x04, 0x24, 0xFB, 0x75, 0x02, 0x04};
  REQUIRE(encode(mesh, {.trained_priors = false}).value() == expected);
  REQUIRE(pac::test::same(decode(expected).value(), mesh));
}

TEST_CASE("streams are the same bytes on every platform and compiler") {
  Fnv fnv, trained, balanced, tables;
  for (const NamedMesh& entry : mesh_zoo()) {
    for (const bool keep_order : {false, true}) {
      const std::vector<uint8_t> bytes = encode(entry.mesh, {keep_order, false, Effort::best}).value();
      for (const uint8_t byte : bytes) fnv.add(byte);
      const std::vector<uint8_t> from_trained = encode(entry.mesh, {keep_order, true, Effort::best}).value();
      for (const uint8_t byte : from_trained) trained.add(byte);
      const std::vector<uint8_t> by_estimates = encode(entry.mesh, {.keep_order = keep_order}).value();
      for (const uint8_t byte : by_estimates) balanced.add(byte);
      const std::vector<uint8_t> by_tables =
          encode(entry.mesh, {.keep_order = keep_order, .effort = Effort::fast}).value();
      for (const uint8_t byte : by_tables) tables.add(byte);
    }
  }
  REQUIRE(fnv.hash() == 0xddb743f6e66ab055u);
  REQUIRE(trained.hash() == 0xddb437a6b892893bu);
  REQUIRE(balanced.hash() == 0x2f85613f8e16d669u);
  REQUIRE(tables.hash() == 0xdf1a1141188fec6au);
}

bool positions_by_tables(const std::vector<uint8_t>& bytes) {
  return bytes[3] >= 4 && (bytes[5] & 4) != 0;
}

bool is_ranked(const std::vector<uint8_t>& bytes) {
  return bytes[3] >= 6 && (bytes[6] & 4) != 0;
}

TEST_CASE("choosing predictions by estimates costs next to nothing") {
  for (const NamedMesh& entry : mesh_zoo()) {
    EncodedSize by_estimates, by_coding;
    const std::vector<uint8_t> bytes = encode(entry.mesh, {}, &by_estimates).value();
    if (positions_by_tables(bytes)) continue;
    const std::vector<uint8_t> best = encode(entry.mesh, {.effort = Effort::best}, &by_coding).value();
    // The default tries another order of points only where it is likely to gain.
    const size_t allowed = is_ranked(bytes) == is_ranked(best) ? 500 : 3;
    CAPTURE(entry.name);
    REQUIRE(allowed * by_estimates.position_bytes <= (allowed + 1) * by_coding.position_bytes);
  }
}

TEST_CASE("speed costs small meshes a twentieth of their bytes, none a third, and nothing where these are few") {
  int n_faster = 0;
  size_t sum_balanced = 0, sum_best = 0;
  for (const NamedMesh& entry : mesh_zoo()) {
    if (entry.mesh.vertices.size() >= 16384) continue;
    const std::vector<uint8_t> balanced = encode(entry.mesh).value();
    const std::vector<uint8_t> best = encode(entry.mesh, {.effort = Effort::best}).value();
    if (is_ranked(best) && !is_ranked(balanced)) continue;  // which is not for speed
    const bool by_tables = balanced[3] >= 4 && balanced[5] != 0;
    n_faster += by_tables ? 1 : 0;
    sum_balanced += balanced.size();
    sum_best += best.size();
    CAPTURE(entry.name);
    REQUIRE(3 * balanced.size() <= 4 * best.size());
    if (best.size() < 1024) REQUIRE(!by_tables);
  }
  REQUIRE(n_faster > 0);
  REQUIRE(20 * sum_balanced < 21 * sum_best);
}

TEST_CASE("streams whose models start untrained are still written and read") {
  for (const NamedMesh& entry : mesh_zoo()) {
    CAPTURE(entry.name);
    const std::vector<uint8_t> bytes = encode(entry.mesh, {.keep_order = true, .trained_priors = false}).value();
    REQUIRE(pac::test::same(decode(bytes).value(), entry.mesh));
  }
}

TEST_CASE("a decoder written from FORMAT.md alone, in another language, reads our streams") {
  if (!pac::test::have_peer("python3")) return;
  const TempDir folder;
  std::string arguments, expected;
  int n_files = 0;
  std::set<int> versions;
  for (const NamedMesh& entry : mesh_zoo()) {
    if (entry.mesh.indices.size() > 1200 || entry.mesh.vertices.size() > 1200) continue;
    const EncodeOptions kinds[] = {{.keep_order = true, .trained_priors = false},
                                   {},
                                   {.keep_order = n_files % 2 == 0, .effort = Effort::fast},
                                   {.trained_priors = false, .effort = Effort::fast}};
    for (const EncodeOptions& kind : kinds) {
      const std::vector<uint8_t> bytes = encode(entry.mesh, kind).value();
      versions.insert(pac::geomcodec::read_info(bytes)->version);
      const std::string file = folder.file(std::to_string(n_files++));
      pac::test::write_bytes(file, bytes);
      arguments += " " + file;
      expected += summary(decode(bytes).value());
    }
  }
  // Of a version that such meshes no longer lead to.
  for (const char* name : {"expected_positions.pgc", "expected_seams.pgc"}) {
    const std::string file = PAC_SOURCE_DIR "/tests/fuzz/corpus/geom_decode/" + std::string(name);
    const std::vector<uint8_t> bytes = pac::test::read_bytes(file);
    versions.insert(pac::geomcodec::read_info(bytes)->version);
    arguments += " " + file;
    expected += summary(decode(bytes).value());
  }
  REQUIRE(n_files >= 20);
  REQUIRE(versions == std::set<int>{3, 4, 5, 6, 7, 8});
  pac::test::require_decoded("pgc_reference_decoder.py", arguments, expected);
}

TEST_CASE("a large mesh is coded by tables unless its encoder is asked for the fewest bytes") {
  const QuantizedMesh pin = pac::test::pin_mesh(160, 120, 14);
  const std::vector<uint8_t> balanced = encode(pin).value(), best = encode(pin, {.effort = Effort::best}).value();
  const auto version = [](const std::vector<uint8_t>& bytes) { return pac::geomcodec::read_info(bytes)->version; };
  REQUIRE(version(balanced) == 8);
  REQUIRE(version(best) == 3);
  REQUIRE(encode(pin, {.effort = Effort::fast}).value() == balanced);
  REQUIRE(best.size() < balanced.size());
  REQUIRE(pac::test::same(decode(balanced).value(), decode(best).value()));
  REQUIRE(version(encode(pac::test::pin_mesh(32, 47, 16)).value()) == 8);
  REQUIRE(version(encode(pac::test::pin_mesh(32, 47, 11)).value()) == 3);  // a coarse grid: bytes are scarce
}

TEST_CASE("a large scan, whose triangles cut a grid either way, is not coded by tables") {
  constexpr uint32_t kSide = 140;
  QuantizedMesh scan;
  scan.position_bits = 14;
  uint32_t random = 1;
  const auto next = [&random] { return (random = random * 1664525 + 1013904223) >> 24; };
  for (uint32_t y = 0; y < kSide; ++y) {
    for (uint32_t x = 0; x < kSide; ++x) {
      pac::geomcodec::QuantizedVertex vertex;
      vertex.position[0] = static_cast<uint16_t>(100 * x);
      vertex.position[1] = static_cast<uint16_t>(100 * y);
      vertex.position[2] = static_cast<uint16_t>(2000 + (x * x + y * y) / 30 + next() % 8);
      scan.vertices.push_back(vertex);
    }
  }
  const auto add = [&](uint32_t a, uint32_t b, uint32_t c) {
    scan.faces.push_back({static_cast<uint32_t>(scan.indices.size()), 3, 0});
    scan.indices.insert(scan.indices.end(), {a, b, c});
  };
  for (uint32_t y = 0; y + 1 < kSide; ++y) {
    for (uint32_t x = 0; x + 1 < kSide; ++x) {
      const uint32_t a = y * kSide + x, b = a + 1, c = b + kSide, d = a + kSide;
      const bool other = next() % 2 != 0;
      add(a, b, other ? d : c);
      add(other ? b : a, c, d);
    }
  }
  const std::vector<uint8_t> balanced = encode(scan).value(), fast = encode(scan, {.effort = Effort::fast}).value();
  REQUIRE(!positions_by_tables(balanced));
  REQUIRE(positions_by_tables(fast));
  REQUIRE(10 * balanced.size() < 9 * fast.size());
  REQUIRE(pac::test::same(decode(balanced).value(), decode(fast).value()));
}

// Neighbors tell little and choosing helps little; the order of the points does.
TEST_CASE("a large mesh is not coded by tables that take more than a coder without contexts") {
  QuantizedMesh rough = pac::test::irregular_mesh(140);
  rough.position_bits = 16;
  uint32_t random = 1;
  for (pac::geomcodec::QuantizedVertex& vertex : rough.vertices) {
    for (uint16_t& coordinate : vertex.position) {
      random = random * 1664525 + 1013904223;
      coordinate = static_cast<uint16_t>(coordinate + (random >> 16) % 32);
    }
  }
  const std::vector<uint8_t> balanced = encode(rough).value(), fast = encode(rough, {.effort = Effort::fast}).value();
  REQUIRE(!positions_by_tables(balanced));
  REQUIRE(positions_by_tables(fast));
  REQUIRE(balanced.size() < fast.size());
}

TEST_CASE("copies of a thing among other things cost less than half of it, moved by whole steps or not") {
  const QuantizedMesh two = pac::test::copies_mesh(2), many = pac::test::copies_mesh(42);
  EncodedSize size_of_two, size;
  REQUIRE(encode(two, {}, &size_of_two).ok());
  const std::vector<uint8_t> bytes = encode(many, {}, &size).value();
  REQUIRE(bytes[3] == 6);
  REQUIRE((bytes[6] & 8) != 0);
  REQUIRE(2 * size.position_bytes * two.vertices.size() < size_of_two.position_bytes * many.vertices.size());
}

// Ten steps of one length or the other recur sooner by chance than with their row.
TEST_CASE("rows that repeat are found where shorter runs of their steps do, too") {
  QuantizedMesh rows;
  rows.position_bits = 14;
  for (uint32_t row = 0; row < 60; ++row) {
    uint32_t random = 1, x = 0;
    for (uint32_t i = 0; i < 60; ++i) {
      random = random * 1664525 + 1013904223;
      x += 100 + (random >> 31);
      rows.vertices.push_back({{static_cast<uint16_t>(x), static_cast<uint16_t>(100 * row), 0}});
    }
  }
  EncodedSize size;
  REQUIRE(encode(rows, {}, &size).ok());
  REQUIRE(size.position_bytes < 200);
}

TEST_CASE("faces of a large mesh whose tables take a byte each are coded without") {
  QuantizedMesh tangle;
  tangle.position_bits = 14;
  uint32_t random = 1;
  const auto next = [&random] { return (random = random * 1664525 + 1013904223) >> 16; };
  for (uint32_t v = 0; v < 18000; ++v)
    tangle.vertices.push_back({{static_cast<uint16_t>(v % 128 * 100), static_cast<uint16_t>(v / 128 * 100), 5}});
  for (uint32_t face = 0; face < 12000; ++face) {
    const uint32_t a = next() % 18000, b = (a + 1) % 18000, c = (a + 2 + next() % 300) % 18000;
    tangle.faces.push_back({3 * face, 3, 0});
    tangle.indices.insert(tangle.indices.end(), {a, b, c});
  }
  EncodedSize balanced, fast;
  const std::vector<uint8_t> bytes = encode(tangle, {}, &balanced).value();
  REQUIRE((bytes[3] == 3 || (bytes[5] & 1) == 0));
  REQUIRE(encode(tangle, {.effort = Effort::fast}, &fast).ok());
  REQUIRE(balanced.connectivity_bytes < fast.connectivity_bytes);
  REQUIRE(pac::test::same(decode(bytes).value(), pac::geomcodec::reorder(tangle)));
}

// A surface that rounding leaves few equal steps of, whose triangles were decimated: points of any valence.
TEST_CASE("an irregular mesh has its points coded in the order of what predicts them") {
  const QuantizedMesh mesh = pac::test::irregular_mesh(40);
  const std::vector<uint8_t> best = encode(mesh, {.effort = Effort::best}).value();
  REQUIRE(pac::geomcodec::read_info(best)->version == 6);
  REQUIRE(pac::test::same(decode(best).value(), pac::geomcodec::reorder(mesh)));
}

// A guard against silent loss of compression; FORMAT.md's version must change before these may.
TEST_CASE("regular shaded meshes take less than the 3.3 bytes a polygon that Levoy estimated, connectivity included") {
  EncodedSize size;
  const QuantizedMesh pin = pac::test::pin_mesh(32, 47, 16);  // 3008 triangles
  const std::vector<uint8_t> bytes = encode(pin, {}, &size).value();
  REQUIRE(static_cast<double>(bytes.size()) < 0.5 * pac::geomcodec::levoy95_estimated_bytes(pin.faces.size()));
  REQUIRE(bytes.size() <= 4800);
  REQUIRE(encode(pin, {.effort = Effort::best}, &size).ok());
  REQUIRE(size.connectivity_bytes < 64);
  REQUIRE(encode(pac::test::pin_mesh(32, 47, 11)).value().size() < 2700);
}

}  // namespace
