#include "geomcodec/frame_stream.h"

#include <bit>
#include <cmath>

#include "base/checksum.h"
#include "geomcodec/byte_io.h"

namespace pac::geomcodec {
namespace {

constexpr uint8_t kFrameMagic[3] = {'P', 'G', 'F'};
constexpr uint8_t kFrameVersion = 2;
constexpr uint8_t kOwnGrid = 1, kMotionShift = 1, kChangedShift = 3;  // flags: 1 bit, 2 bits, 4 bits, one unused

void put_long(std::vector<uint8_t>& out, int64_t value) {
  uint64_t code = static_cast<uint64_t>(value) << 1 ^ static_cast<uint64_t>(value >> 63);
  for (; code >= 0x80; code >>= 7) out.push_back(static_cast<uint8_t>(code | 0x80));
  out.push_back(static_cast<uint8_t>(code));
}

// At most 9 bytes, that is 63 bits: the entries are within 2^58.
int64_t get_long(ByteReader& reader) {
  uint64_t code = 0;
  for (int shift = 0; shift < 63; shift += 7) {
    const uint8_t byte = reader.u8();
    code |= uint64_t{byte & 0x7Fu} << shift;
    if (byte >= 0x80) continue;
    if (byte == 0 && shift > 0) break;
    return static_cast<int64_t>(code >> 1 ^ (0 - (code & 1)));
  }
  reader.fail(Error::corrupt, "malformed number in the header");
  return 0;
}

Grid get_grid(ByteReader& reader) {
  Grid grid;
  grid.bits = reader.u8();
  if (grid.bits < 1 || grid.bits > 16) reader.fail(Error::corrupt, "position bits are not in 1..16");
  for (float& origin : grid.origin) origin = std::bit_cast<float>(reader.u32());
  for (float& step : grid.step) step = std::bit_cast<float>(reader.u32());
  for (int axis = 0; axis < 3; ++axis)
    if (!std::isfinite(grid.origin[axis]) || !std::isfinite(grid.step[axis]) || !(grid.step[axis] > 0))
      reader.fail(Error::corrupt, "grid is not finite");
  return grid;
}

void get_motion(ByteReader& reader, FrameMotion& motion) {
  for (auto& row : motion.row)
    for (int64_t& entry : row) entry = get_long(reader);
  if (!within_bounds(motion)) reader.fail(Error::corrupt, "motion is out of bounds");
}

// Bytes to be summed, in pieces.
class Summed {
 public:
  void u16(uint32_t value) {
    bytes_.push_back(static_cast<uint8_t>(value));
    bytes_.push_back(static_cast<uint8_t>(value >> 8));
  }
  void u32(uint32_t value) {
    put_u32(bytes_, value);
    if (bytes_.size() >= kPiece) flush();
  }
  uint32_t result() {
    flush();
    return sum_;
  }

 private:
  static constexpr size_t kPiece = 1 << 14;
  void flush() {
    sum_ = crc32(bytes_, sum_);
    bytes_.clear();
  }
  std::vector<uint8_t> bytes_;
  uint32_t sum_ = 0;
};

}  // namespace

bool within_bounds(const FrameMotion& motion) {
  constexpr int64_t kSlope = int64_t{1} << 42, kOffset = int64_t{1} << 58;
  for (const auto& row : motion.row)
    for (int column = 0; column < 4; ++column) {
      const int64_t bound = column < 3 ? kSlope : kOffset;
      if (row[column] < -bound || row[column] > bound) return false;
    }
  return true;
}

uint32_t reference_checksum(const QuantizedMesh& reference, const FrameMotion* motion) {
  Summed sum;
  sum.u32(static_cast<uint32_t>(reference.position_bits) | static_cast<uint32_t>(reference.normal_bits) << 8 |
          static_cast<uint32_t>(reference.texcoord_bits) << 16 | static_cast<uint32_t>(reference.face_bits) << 24);
  for (const QuantizedVertex& vertex : reference.vertices) {
    for (const uint16_t coordinate : vertex.position) sum.u16(coordinate);
    sum.u32(uint32_t{vertex.color[0]} | uint32_t{vertex.color[1]} << 8 | uint32_t{vertex.color[2]} << 16 |
            uint32_t{vertex.color[3]} << 24);
    for (const uint16_t component : vertex.normal) sum.u16(component);
    for (const uint16_t component : vertex.texcoord) sum.u16(component);
  }
  for (const Face& face : reference.faces) {
    sum.u32(face.count);
    for (uint32_t k = 0; k < face.count; ++k) sum.u32(reference.indices[face.first + k]);
    sum.u32(face.material);
  }
  for (const uint16_t value : reference.face_values) sum.u16(value);
  if (motion != nullptr)
    for (const auto& row : motion->row)
      for (const int64_t entry : row) {
        sum.u32(static_cast<uint32_t>(static_cast<uint64_t>(entry)));
        sum.u32(static_cast<uint32_t>(static_cast<uint64_t>(entry) >> 32));
      }
  return sum.result();
}

std::vector<uint8_t> write_frame(const FrameHeader& header,
                                 const std::array<std::vector<uint8_t>, kFrameGroups>& sections,
                                 uint64_t& header_bytes) {
  std::vector<uint8_t> out(kFrameMagic, kFrameMagic + 3);
  out.push_back(kFrameVersion);
  uint32_t flags = (header.own_grid ? kOwnGrid : 0u) | static_cast<uint32_t>(header.motion_kind) << kMotionShift;
  for (uint32_t i = 0; i < kFrameGroups; ++i) flags |= (header.changed[i] ? 1u : 0u) << (kChangedShift + i);
  out.push_back(static_cast<uint8_t>(flags));
  if (header.own_grid) {
    out.push_back(static_cast<uint8_t>(header.grid.bits));
    for (const float origin : header.grid.origin) put_float(out, origin);
    for (const float step : header.grid.step) put_float(out, step);
  }
  if (header.motion_kind == MotionKind::in_stream)
    for (const auto& row : header.motion.row)
      for (const int64_t entry : row) put_long(out, entry);
  put_varint(out, header.n_vertices);
  put_u32(out, header.reference_checksum);
  for (uint32_t i = 0; i < kFrameGroups; ++i)
    if (header.changed[i]) put_varint(out, static_cast<uint32_t>(sections[i].size()));
  header_bytes = put_sections(out, sections);
  return out;
}

Result<ParsedFrame> parse_frame(std::span<const uint8_t> bytes) {
  ByteReader reader(bytes);
  for (const uint8_t expected : kFrameMagic)
    if (reader.u8() != expected && reader.ok()) return Failure{Error::corrupt, 0, "not a PGF geometry frame"};
  if (reader.u8() != kFrameVersion && reader.ok())
    return Failure{Error::unsupported, 3, "version of the stream is unknown"};
  const uint8_t flags = reader.u8();
  const uint32_t motion_kind = flags >> kMotionShift & 3u;
  if (flags >> 7 != 0 || motion_kind > static_cast<uint32_t>(MotionKind::callers))
    return Failure{Error::unsupported, 4, "stream uses features that are unknown"};

  ParsedFrame parsed;
  FrameHeader& header = parsed.header;
  header.motion_kind = static_cast<MotionKind>(motion_kind);
  header.own_grid = (flags & kOwnGrid) != 0;
  if (header.own_grid) header.grid = get_grid(reader);
  if (header.motion_kind == MotionKind::in_stream) get_motion(reader, header.motion);
  header.n_vertices = reader.count();
  header.reference_checksum = reader.u32();
  std::array<uint32_t, kFrameGroups> section_bytes = {};
  uint64_t end = 0;
  for (uint32_t i = 0; i < kFrameGroups; ++i) {
    header.changed[i] = (flags >> (kChangedShift + i) & 1u) != 0;
    if (header.changed[i]) end += section_bytes[i] = reader.count();
  }
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
  for (uint32_t i = 0; i < kFrameGroups; ++i) {
    parsed.section[i] = bytes.subspan(offset, section_bytes[i]);
    offset += section_bytes[i];
  }
  return parsed;
}

}  // namespace pac::geomcodec
