// Geometry frames: the bytes as they are but for both checksums, which are repaired so that mutations get behind them,
// and as the sections of a frame whose header fits its reference. Whatever they are, a mesh that encodes to a frame
// that decodes to it, or a Failure.
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "base/checksum.h"
#include "geomcodec/frame_stream.h"

namespace {

using namespace pac::geomcodec;

// A bent grid of 8 x 8 quads with every attribute.
QuantizedMesh reference_mesh() {
  constexpr uint32_t kSide = 9;
  QuantizedMesh mesh;
  mesh.position_bits = 12;
  mesh.normal_bits = 8;
  mesh.texcoord_bits = 10;
  for (uint32_t i = 0; i < kSide * kSide; ++i) {
    const uint32_t x = i % kSide, y = i / kSide;
    QuantizedVertex vertex;
    vertex.position[0] = static_cast<uint16_t>(400 * x);
    vertex.position[1] = static_cast<uint16_t>(400 * y);
    vertex.position[2] = static_cast<uint16_t>(20 * x * y);
    vertex.color[0] = static_cast<uint8_t>(25 * x);
    vertex.normal[0] = static_cast<uint16_t>(20 * y);
    vertex.texcoord[1] = static_cast<uint16_t>(100 * y);
    mesh.vertices.push_back(vertex);
  }
  for (uint32_t y = 0; y + 1 < kSide; ++y) {
    for (uint32_t x = 0; x + 1 < kSide; ++x) {
      const uint32_t a = y * kSide + x;
      mesh.faces.push_back({static_cast<uint32_t>(mesh.indices.size()), 4, 0});
      mesh.indices.insert(mesh.indices.end(), {a, a + 1, a + 1 + kSide, a + kSide});
    }
  }
  return mesh;
}

// Byte 0: motion and changed groups; 1: position bits of a grid of its own, 0 for none; then the sections, of one size.
std::vector<uint8_t> framed(const QuantizedMesh& reference, const uint8_t* data, size_t size) {
  FrameHeader header;
  header.motion_kind = (data[0] & 1) != 0 ? MotionKind::in_stream : MotionKind::still;
  header.motion.row[0][3] = int64_t{data[0]} << 28;
  header.motion.row[3][1] = int64_t{data[1]} << 12;
  header.own_grid = data[1] % 17 != 0;
  header.grid.bits = data[1] % 17;
  header.n_vertices = static_cast<uint32_t>(reference.vertices.size());
  header.reference_checksum = reference_checksum(reference, nullptr);
  std::array<std::vector<uint8_t>, kFrameGroups> sections;
  const size_t each = (size - 2) / kFrameGroups;
  for (uint32_t i = 0; i < kFrameGroups; ++i) {
    header.changed[i] = (data[0] >> (1 + i) & 1) != 0;
    if (header.changed[i]) sections[i].assign(data + 2 + i * each, data + 2 + (i + 1) * each);
  }
  uint64_t header_bytes = 0;
  return write_frame(header, sections, header_bytes);
}

// The stream of a frame, whose checksums the header's layout (FORMAT.md section 14) locates; as it is if it is shorter.
std::vector<uint8_t> repaired(const QuantizedMesh& reference, std::vector<uint8_t> bytes) {
  size_t at = 5;
  if (bytes.size() < at) return bytes;
  const uint8_t flags = bytes[4];
  const auto skip_number = [&] {
    while (at < bytes.size() && bytes[at] >= 0x80) ++at;
    ++at;
  };
  const auto put = [&](uint32_t value) {
    for (size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<uint8_t>(value >> 8 * i);
    at += 4;
  };
  if ((flags & 1) != 0) at += 1 + 6 * 4;
  if ((flags >> 1 & 3) == static_cast<int>(MotionKind::in_stream))
    for (int entry = 0; entry < 16; ++entry) skip_number();
  skip_number();  // vertices
  if (at + 4 > bytes.size()) return bytes;
  put(reference_checksum(reference, nullptr));
  for (uint32_t i = 0; i < kFrameGroups; ++i)
    if ((flags >> (3 + i) & 1) != 0) skip_number();
  if (at + 4 > bytes.size()) return bytes;
  const std::span<const uint8_t> all(bytes);
  put(pac::crc32(all.subspan(at + 4), pac::crc32(all.first(at))));
  return bytes;
}

void decode_and_back(const std::vector<uint8_t>& bytes, const QuantizedMesh& reference) {
  const auto frame = decode_frame(bytes, reference);
  if (!frame.ok()) {
    PAC_ASSERT(frame.failure().byte_offset <= bytes.size());
    return;
  }
  const auto encoded = encode_frame(*frame, reference);
  PAC_ASSERT(encoded.ok());
  const auto again = decode_frame(*encoded, reference);
  PAC_ASSERT(again.ok());
  PAC_ASSERT(again->vertices == frame->vertices);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const QuantizedMesh reference = reference_mesh();
  decode_and_back(repaired(reference, std::vector<uint8_t>(data, data + size)), reference);
  if (size >= 2) decode_and_back(framed(reference, data, size), reference);
  return 0;
}
