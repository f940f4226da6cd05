// The header of a stream and where its sections lie. FORMAT.md section 2.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "geomcodec/attributes.h"
#include "geomcodec/geomcodec.h"

namespace pac::geomcodec {

inline constexpr uint8_t kVersion = 3, kVersionWithTables = 4, kVersionThatChooses = 5, kVersionWithFeatures = 6,
                         kVersionOfExpectedTables = 7, kVersionOfExpectedFaces = 8;

enum Section : uint32_t {
  kConnectivity,
  kSeams,
  kPositions,
  kColors,
  kNormals,
  kTexcoords,
  kMaterials,
  kFaceValues,
  kOrder,
  kDegenerate,
  kSections
};

struct Header {
  bool keeps_order = false;
  bool constant_color = false;
  bool trained = false;  // models of positions and colors start as training left them
  int position_bits = 16;
  float origin[3] = {0, 0, 0};
  float step[3] = {1, 1, 1};
  int normal_bits = 0, texcoord_bits = 0;  // 0: none
  float texcoord_origin[2] = {0, 0};
  float texcoord_step = 1;
  int face_bits = 0, face_components = 0;  // 0: faces have no values
  uint32_t n_used_vertices = 0;            // those that faces use
  uint32_t n_split_vertices = 0;           // of them: those at a position that one before them has
  uint32_t n_isolated_vertices = 0;        // the rest
  uint32_t n_faces = 0;
  uint32_t n_corners = 0;
  uint32_t n_degenerate = 0;  // of the faces, those that are degenerate
  uint32_t highest_material = 0;
  uint8_t color[4] = {255, 255, 255, 255};  // with constant_color: everyone's
  std::array<uint32_t, kSections> section_bytes = {};
  uint8_t tables = 0;                 // bit s: section s is coded by tables; only the first six but seams may be
  bool chooses = false;               // positions, not coded by tables: a symbol tells what residuals start from
  bool ranked = false;                // positions, not coded by tables: in the order of point_order.h
  bool parts_repeat_by_size = false;  // positions, not coded by tables: as Topology::parts_repeat_by_size
  bool expected_tables = false;       // in sections by tables but connectivity contexts have expected_tables.h's
  bool expected_faces = false;        // in connectivity, by tables, likewise

  uint32_t n_vertices() const { return n_used_vertices + n_isolated_vertices; }
  uint32_t n_points() const { return n_used_vertices - n_split_vertices; }
  uint8_t version() const {
    return expected_faces                                       ? kVersionOfExpectedFaces
           : expected_tables                                    ? kVersionOfExpectedTables
           : n_degenerate > 0 || ranked || parts_repeat_by_size ? kVersionWithFeatures
           : chooses                                            ? kVersionThatChooses
           : tables != 0                                        ? kVersionWithTables
                                                                : kVersion;
  }
  bool by_tables(Section section) const { return (tables >> section & 1) != 0; }
  bool may_expect_tables() const {
    return (tables & (1u << kPositions | 1u << kColors | 1u << kNormals | 1u << kTexcoords)) != 0;
  }
  // What contexts of connectivity, positions, colors, normals, texture have that no table is told of.
  Expected expected_of(Section section) const {
    if (section == kConnectivity) return expected_faces ? Expected::faces : Expected::nothing;
    if (!expected_tables) return Expected::nothing;
    return section == kPositions ? Expected::positions : section == kColors ? Expected::colors : Expected::others;
  }
  // Of colors, normals, texture.
  AttributeCoding coding_of(Section section) const { return {by_tables(section), expected_of(section)}; }
  // Whether the fields above leave anything for a section to say.
  bool has(Section section) const;
};

// Counts of vertices, faces, corners and section bytes may not exceed this.
inline constexpr uint32_t kMaxCount = 0x7FFFFFFF;

// Header, checksum, sections. `header_bytes` receives the size of the first two.
std::vector<uint8_t> write_stream(const Header& header, const std::array<std::vector<uint8_t>, kSections>& sections,
                                  uint64_t& header_bytes);

struct ParsedStream {
  Header header;
  uint64_t header_bytes = 0;
  std::array<std::span<const uint8_t>, kSections> section;  // into the caller's bytes
  uint64_t section_offset(Section which) const {
    uint64_t offset = header_bytes;
    for (uint32_t i = 0; i < which; ++i) offset += section[i].size();
    return offset;
  }
};
// Fails with truncated, unsupported (version), corrupt (magic, a field out of range, checksum, trailing bytes).
Result<ParsedStream> parse_stream(std::span<const uint8_t> bytes);

}  // namespace pac::geomcodec
