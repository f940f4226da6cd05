#include "geomcodec/container.h"

#include <bit>
#include <cmath>

#include "base/checksum.h"
#include "geomcodec/byte_io.h"

namespace pac::geomcodec {
namespace {

constexpr uint8_t kMagic[3] = {'P', 'G', 'C'};

enum Flag : uint8_t {
  kKeepsOrder = 1,
  kConstantColor = 2,
  kUnitGrid = 4,
  kOneStep = 8,
  kHasNormals = 16,
  kHasTexcoords = 32,
  kTrained = 64,
  kHasFaceValues = 128
};

enum Feature : uint8_t {
  kHasDegenerate = 1,
  kChooses = 2,
  kRanked = 4,
  kPartsBySize = 8,
  kExpectedTables = 16,
  kExpectedFaces = 32
};

// Version 4 is there for tables: without any it would be version 3. Version 5 says how positions are coded that tables
// do not code. Version 6 is there for degenerate faces, ranked points and parts that repeat by size, version 7
// for expected tables, version 8 for those of faces; they tell all of it.
void parse_tables(ByteReader& reader, uint8_t version, uint8_t& features, Header& header) {
  constexpr uint32_t kMayBe =
      1u << kConnectivity | 1u << kPositions | 1u << kColors | 1u << kNormals | 1u << kTexcoords;
  header.tables = reader.u8();
  if (version >= kVersionWithFeatures) {
    features = reader.u8();
    constexpr uint8_t kOfVersion6 = kHasDegenerate | kRanked | kPartsBySize;
    const uint8_t needed = version == kVersionWithFeatures       ? kOfVersion6
                           : version == kVersionOfExpectedTables ? uint8_t{kExpectedTables}
                                                                 : uint8_t{kExpectedFaces};
    const uint8_t others = version == kVersionOfExpectedFaces ? kChooses | kExpectedTables : kChooses;
    if ((features & needed) == 0 || (features & ~(kOfVersion6 | needed | others)) != 0)
      reader.fail(Error::corrupt, "features are unknown, or none that needs this version");
    header.chooses = (features & kChooses) != 0;
    header.ranked = (features & kRanked) != 0;
    header.parts_repeat_by_size = (features & kPartsBySize) != 0;
    header.expected_tables = (features & kExpectedTables) != 0;
    header.expected_faces = (features & kExpectedFaces) != 0;
  }
  if ((header.tables == 0 && version == kVersionWithTables) ||
      (header.by_tables(kPositions) && (header.chooses || header.ranked || header.parts_repeat_by_size)) ||
      (header.expected_tables && !header.may_expect_tables()) ||
      (header.expected_faces && !header.by_tables(kConnectivity)) || (header.tables & ~kMayBe) != 0)
    reader.fail(Error::corrupt, "no section or a wrong one is coded by tables");
}

void parse_grid(ByteReader& reader, uint8_t flags, Header& header) {
  header.position_bits = reader.u8();
  if (header.position_bits < 1 || header.position_bits > 16)
    reader.fail(Error::corrupt, "position bits are not in 1..16");
  if ((flags & kUnitGrid) != 0) return;
  for (float& origin : header.origin) origin = std::bit_cast<float>(reader.u32());
  const int n_steps = (flags & kOneStep) != 0 ? 1 : 3;
  for (int axis = 0; axis < n_steps; ++axis) header.step[axis] = std::bit_cast<float>(reader.u32());
  if (n_steps == 1) header.step[1] = header.step[2] = header.step[0];
  for (int axis = 0; axis < 3; ++axis)
    if (!std::isfinite(header.origin[axis]) || !std::isfinite(header.step[axis]) || !(header.step[axis] > 0))
      reader.fail(Error::corrupt, "grid is not finite");
}

void parse_face_values(ByteReader& reader, Header& header) {
  header.face_bits = reader.u8();
  header.face_components = reader.u8();
  if (header.face_bits < 1 || header.face_bits > 16 || header.face_components < 1 || header.face_components > 4)
    reader.fail(Error::corrupt, "values of faces are not 1..4 of 1..16 bits");
}

void parse_attributes(ByteReader& reader, uint8_t flags, Header& header) {
  if ((flags & kHasNormals) != 0) {
    header.normal_bits = reader.u8();
    if (header.normal_bits < 2 || header.normal_bits > 16) reader.fail(Error::corrupt, "normal bits are not in 2..16");
  }
  if ((flags & kHasTexcoords) == 0) return;
  header.texcoord_bits = reader.u8();
  if (header.texcoord_bits < 1 || header.texcoord_bits > 16)
    reader.fail(Error::corrupt, "texture coordinate bits are not in 1..16");
  for (float& origin : header.texcoord_origin) origin = std::bit_cast<float>(reader.u32());
  header.texcoord_step = std::bit_cast<float>(reader.u32());
  if (!std::isfinite(header.texcoord_origin[0]) || !std::isfinite(header.texcoord_origin[1]) ||
      !std::isfinite(header.texcoord_step) || !(header.texcoord_step > 0))
    reader.fail(Error::corrupt, "grid of the texture is not finite");
}

void parse_counts(ByteReader& reader, uint8_t features, Header& header) {
  header.n_used_vertices = reader.count();
  header.n_split_vertices = reader.count();
  header.n_isolated_vertices = reader.count();
  header.n_faces = reader.count();
  const uint64_t n_corners = uint64_t{3} * header.n_faces + reader.count();
  if ((features & kHasDegenerate) != 0) {
    header.n_degenerate = reader.count();
    if (header.n_degenerate == 0 || header.n_degenerate >= header.n_faces)
      reader.fail(Error::corrupt, "no face or all of them are degenerate");
  }
  header.highest_material = reader.varint();
  if (n_corners > kMaxCount || uint64_t{header.n_used_vertices} + header.n_isolated_vertices > kMaxCount ||
      header.n_used_vertices > n_corners || (header.n_faces > 0 && header.n_used_vertices == 0) ||
      (header.n_split_vertices > 0 && header.n_split_vertices >= header.n_used_vertices) ||
      (header.n_faces == 0 && (n_corners > 0 || header.highest_material > 0)))
    return reader.fail(Error::corrupt, "counts in the header contradict one another");
  header.n_corners = static_cast<uint32_t>(n_corners);
}

void put_grid(std::vector<uint8_t>& out, const Header& header, uint8_t flags) {
  out.push_back(static_cast<uint8_t>(header.position_bits));
  if ((flags & kUnitGrid) == 0) {
    for (const float origin : header.origin) put_float(out, origin);
    for (int axis = 0; axis < ((flags & kOneStep) != 0 ? 1 : 3); ++axis) put_float(out, header.step[axis]);
  }
  if (header.normal_bits != 0) out.push_back(static_cast<uint8_t>(header.normal_bits));
  if (header.texcoord_bits != 0) {
    out.push_back(static_cast<uint8_t>(header.texcoord_bits));
    for (const float origin : header.texcoord_origin) put_float(out, origin);
    put_float(out, header.texcoord_step);
  }
  if (header.face_bits == 0) return;
  out.push_back(static_cast<uint8_t>(header.face_bits));
  out.push_back(static_cast<uint8_t>(header.face_components));
}

uint8_t flags_of(const Header& header) {
  bool unit_grid = true;
  for (int axis = 0; axis < 3; ++axis)
    unit_grid = unit_grid && std::bit_cast<uint32_t>(header.origin[axis]) == 0 && header.step[axis] == 1.0f;
  const bool one_step = header.step[0] == header.step[1] && header.step[0] == header.step[2];
  return static_cast<uint8_t>((header.keeps_order ? kKeepsOrder : 0) | (header.constant_color ? kConstantColor : 0) |
                              (unit_grid ? kUnitGrid : 0) | (one_step && !unit_grid ? kOneStep : 0) |
                              (header.normal_bits != 0 ? kHasNormals : 0) |
                              (header.texcoord_bits != 0 ? kHasTexcoords : 0) | (header.trained ? kTrained : 0) |
                              (header.face_bits != 0 ? kHasFaceValues : 0));
}

}  // namespace

uint64_t put_sections(std::vector<uint8_t>& out, std::span<const std::vector<uint8_t>> sections) {
  uint32_t checksum = crc32(out);
  for (const std::vector<uint8_t>& section : sections) checksum = crc32(section, checksum);
  put_u32(out, checksum);
  const uint64_t header_bytes = out.size();
  for (const std::vector<uint8_t>& section : sections) out.insert(out.end(), section.begin(), section.end());
  return header_bytes;
}

bool Header::has(Section section) const {
  switch (section) {
    case kConnectivity:
      return n_faces > 0;
    case kSeams:
      return n_split_vertices > 0;
    case kPositions:
      return n_vertices() > 0;
    case kColors:
      return n_vertices() > 0 && !constant_color;
    case kNormals:
      return n_vertices() > 0 && normal_bits != 0;
    case kTexcoords:
      return n_vertices() > 0 && texcoord_bits != 0;
    case kMaterials:
      return highest_material > 0;
    case kFaceValues:
      return n_faces > 0 && face_bits != 0;
    case kOrder:
      return keeps_order && n_vertices() > 0;
    case kDegenerate:
      return n_degenerate > 0;
    case kSections:
      break;
  }
  return false;
}

std::vector<uint8_t> write_stream(const Header& header, const std::array<std::vector<uint8_t>, kSections>& sections,
                                  uint64_t& header_bytes) {
  const uint8_t flags = flags_of(header);
  std::vector<uint8_t> out(kMagic, kMagic + 3);
  out.push_back(header.version());
  out.push_back(flags);
  if (header.version() != kVersion) out.push_back(header.tables);
  if (header.version() >= kVersionWithFeatures)
    out.push_back(static_cast<uint8_t>(
        (header.n_degenerate > 0 ? kHasDegenerate : 0) | (header.chooses ? kChooses : 0) |
        (header.ranked ? kRanked : 0) | (header.parts_repeat_by_size ? kPartsBySize : 0) |
        (header.expected_tables ? kExpectedTables : 0) | (header.expected_faces ? kExpectedFaces : 0)));
  put_grid(out, header, flags);
  put_varint(out, header.n_used_vertices);
  put_varint(out, header.n_split_vertices);
  put_varint(out, header.n_isolated_vertices);
  put_varint(out, header.n_faces);
  put_varint(out, header.n_corners - 3 * header.n_faces);
  if (header.n_degenerate > 0) put_varint(out, header.n_degenerate);
  put_varint(out, header.highest_material);
  if (header.constant_color) out.insert(out.end(), header.color, header.color + 4);
  for (uint32_t i = 0; i < kSections; ++i)
    if (header.has(static_cast<Section>(i))) put_varint(out, static_cast<uint32_t>(sections[i].size()));
  header_bytes = put_sections(out, sections);
  return out;
}

Result<ParsedStream> parse_stream(std::span<const uint8_t> bytes) {
  ByteReader reader(bytes);
  for (const uint8_t expected : kMagic)
    if (reader.u8() != expected && reader.ok()) return Failure{Error::corrupt, 0, "not a PGC geometry stream"};
  const uint8_t version = reader.u8();
  if ((version < kVersion || version > kVersionOfExpectedFaces) && reader.ok())
    return Failure{Error::unsupported, 3, "version of the stream is unknown"};
  const uint8_t flags = reader.u8();
  if ((flags & kUnitGrid) != 0 && (flags & kOneStep) != 0)
    return Failure{Error::corrupt, 4, "flags contradict one another"};

  ParsedStream parsed;
  Header& header = parsed.header;
  header.keeps_order = (flags & kKeepsOrder) != 0;
  header.constant_color = (flags & kConstantColor) != 0;
  header.trained = (flags & kTrained) != 0;
  header.chooses = version == kVersionThatChooses;
  uint8_t features = 0;
  if (version != kVersion) parse_tables(reader, version, features, header);
  parse_grid(reader, flags, header);
  parse_attributes(reader, flags, header);
  if ((flags & kHasFaceValues) != 0) parse_face_values(reader, header);
  parse_counts(reader, features, header);
  if (header.trained && header.n_vertices() == 0) reader.fail(Error::corrupt, "models are trained for no vertex");
  if (header.chooses && !header.has(kPositions)) reader.fail(Error::corrupt, "positions that are not there choose");
  if ((header.ranked || header.parts_repeat_by_size) && !header.has(kConnectivity))
    reader.fail(Error::corrupt, "points without faces are ranked or repeat");
  if (header.constant_color)
    for (uint8_t& channel : header.color) channel = reader.u8();
  uint64_t end = 0;
  for (uint32_t i = 0; i < kSections; ++i)
    if (header.by_tables(static_cast<Section>(i)) && !header.has(static_cast<Section>(i)))
      reader.fail(Error::corrupt, "a section that is not there is coded by tables");
  for (uint32_t i = 0; i < kSections; ++i)
    if (header.has(static_cast<Section>(i))) end += header.section_bytes[i] = reader.count();
  const uint64_t checksum_offset = reader.position();
  const uint32_t checksum = reader.u32();
  if (!reader.ok()) return reader.failure();

  parsed.header_bytes = reader.position();
  end += parsed.header_bytes;
  if (end > bytes.size()) return Failure{Error::truncated, bytes.size(), "stream ends too early"};
  if (end < bytes.size()) return Failure{Error::corrupt, end, "bytes after the end of the stream"};
  if (crc32(bytes.subspan(parsed.header_bytes), crc32(bytes.first(checksum_offset))) != checksum)
    return Failure{Error::corrupt, checksum_offset, "checksum does not match"};
  uint64_t offset = parsed.header_bytes;
  for (uint32_t i = 0; i < kSections; ++i) {
    parsed.section[i] = bytes.subspan(offset, header.section_bytes[i]);
    offset += header.section_bytes[i];
  }
  return parsed;
}

Result<StreamInfo> read_info(std::span<const uint8_t> bytes) {
  PAC_TRY(const ParsedStream parsed, parse_stream(bytes));
  const Header& header = parsed.header;
  StreamInfo info;
  info.version = header.version();
  info.n_vertices = header.n_vertices();
  info.n_faces = header.n_faces;
  info.n_corners = header.n_corners;
  info.n_materials = header.n_faces == 0 ? 0 : header.highest_material + 1;
  info.position_bits = header.position_bits;
  for (int axis = 0; axis < 3; ++axis) {
    info.origin[axis] = header.origin[axis];
    info.step[axis] = header.step[axis];
  }
  info.constant_color = header.constant_color;
  info.keeps_order = header.keeps_order;
  info.normal_bits = header.normal_bits;
  info.texcoord_bits = header.texcoord_bits;
  info.face_bits = header.face_bits;
  info.face_components = header.face_components;
  info.n_points = header.n_points();
  const auto& size = header.section_bytes;
  info.size = {parsed.header_bytes, uint64_t{size[kConnectivity]} + size[kDegenerate],
               size[kSeams],        size[kPositions],
               size[kColors],       size[kNormals],
               size[kTexcoords],    size[kMaterials],
               size[kFaceValues],   size[kOrder]};
  return info;
}

}  // namespace pac::geomcodec
