// Geometry streams: whatever the bytes, a mesh that encodes to a stream that decodes to it, or a Failure. The checksum
// is repaired first, so that mutations get behind it.
#include <cstdint>
#include <span>
#include <vector>

#include "base/checksum.h"
#include "geomcodec/geomcodec.h"

namespace {

// Where the checksum stands, by the header's layout (FORMAT.md section 2).
size_t checksum_offset(const std::vector<uint8_t>& bytes) {
  if (bytes.size() < 7) return bytes.size();
  const uint8_t flags = bytes[4], features = bytes[3] >= 6 ? bytes[6] : 0;
  size_t at = bytes[3] >= 6 ? 8 : bytes[3] >= 4 ? 7 : 6;  // from version 4 on there is a byte more, from 6 on two
  const auto number = [&] {
    uint64_t value = 0;
    for (int shift = 0; at < bytes.size(); shift += 7) {
      value |= shift < 35 ? uint64_t{bytes[at] & 0x7Fu} << shift : 0;
      if (bytes[at++] < 0x80) break;
    }
    return value;
  };
  if ((flags & 4) == 0) at += (flags & 8) != 0 ? 16 : 24;
  at += ((flags & 16) != 0 ? 1u : 0u) + ((flags & 32) != 0 ? 13u : 0u) + ((flags & 128) != 0 ? 2u : 0u);
  const uint64_t used = number(), split = number(), isolated = number(), faces = number();
  number();
  const bool degenerate = (features & 1) != 0;
  if (degenerate) number();
  const uint64_t highest_material = number();
  const bool constant = (flags & 2) != 0, some = used + isolated > 0;
  if (constant) at += 4;
  const bool present[] = {faces > 0,
                          split > 0,
                          some,
                          some && !constant,
                          some && (flags & 16) != 0,
                          some && (flags & 32) != 0,
                          highest_material > 0,
                          faces > 0 && (flags & 128) != 0,
                          some && (flags & 1) != 0,
                          degenerate};
  for (const bool size : present)
    if (size) number();
  return at;
}

void repair_checksum(std::vector<uint8_t>& bytes) {
  const size_t at = checksum_offset(bytes);
  if (at + 4 > bytes.size()) return;
  const std::span<const uint8_t> all(bytes);
  const uint32_t checksum = pac::crc32(all.subspan(at + 4), pac::crc32(all.first(at)));
  for (size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<uint8_t>(checksum >> 8 * i);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  std::vector<uint8_t> bytes(data, data + size);
  repair_checksum(bytes);
  pac::Limits limits;
  limits.max_triangles = 1 << 15;
  limits.max_bytes = 1 << 21;
  const auto mesh = pac::geomcodec::decode(bytes, limits);
  if (!mesh.ok()) {
    PAC_ASSERT(mesh.failure().byte_offset <= size);
    return 0;
  }
  for (const uint32_t index : mesh->indices) PAC_ASSERT(index < mesh->vertices.size());
  for (const auto effort : {pac::geomcodec::Effort::fast, pac::geomcodec::Effort::best}) {
    const auto encoded = pac::geomcodec::encode(*mesh, {.keep_order = true, .effort = effort});
    PAC_ASSERT(encoded.ok());
    const auto again = pac::geomcodec::decode(*encoded);
    PAC_ASSERT(again.ok());
    PAC_ASSERT(again->indices == mesh->indices);
    PAC_ASSERT(again->vertices == mesh->vertices);
  }
  return 0;
}
