#include "sim/pacs.h"

#include "sim/byte_stream.h"

namespace pac::sim {

namespace {

constexpr uint32_t kMagic = 0x53434150;  // "PACS"

void append_u32(Bytes& out, uint32_t value) {
  for (int shift = 0; shift < 32; shift += 8) out.push_back(static_cast<uint8_t>(value >> shift));
}

}  // namespace

void append_pacs_message(Bytes& out, std::span<const uint8_t> message) {
  if (out.empty()) append_u32(out, kMagic);
  append_u32(out, static_cast<uint32_t>(message.size()));
  out.insert(out.end(), message.begin(), message.end());
}

Result<std::vector<std::span<const uint8_t>>> read_pacs(std::span<const uint8_t> bytes) {
  ByteReader reader(bytes);
  if (reader.u32() != kMagic) return Failure{Error::corrupt, 0, "not a PACS file"};
  std::vector<std::span<const uint8_t>> messages;
  while (reader.remaining() > 0) {
    const size_t at = reader.position();
    const uint32_t length = reader.u32();
    messages.push_back(reader.raw(length));
    if (reader.overrun()) return Failure{Error::truncated, at, "message is longer than the file"};
  }
  return messages;
}

}  // namespace pac::sim
