// The client against hostile bytes: u16 length of a session message, the message, then one frame packet. Checksums are
// made right first, so that what lies behind them is reached; the camera, model and JPEG go all the way to a picture.
#include <cstdint>
#include <cstring>
#include <vector>

#include "base/checksum.h"
#include "sim/client.h"

namespace {

std::vector<uint8_t> with_right_checksum(const uint8_t* data, size_t size) {
  std::vector<uint8_t> bytes(data, data + size);
  if (size < 4) return bytes;
  const uint32_t crc = pac::crc32(std::span(bytes).first(size - 4));
  for (size_t i = 0; i < 4; ++i) bytes[size - 4 + i] = static_cast<uint8_t>(crc >> (8 * i));
  return bytes;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size < 2) return 0;
  const size_t session_size = static_cast<size_t>(data[0]) | static_cast<size_t>(data[1]) << 8;
  if (session_size > size - 2) return 0;
  pac::sim::ClientOptions options;
  options.limits.max_pixels = 1 << 14;
  options.limits.max_triangles = 1 << 12;
  options.limits.max_bytes = 1 << 20;
  auto client = pac::sim::Client::create(with_right_checksum(data + 2, session_size), options);
  if (!client.ok()) return 0;
  const auto packet = with_right_checksum(data + 2 + session_size, size - 2 - session_size);
  (void)client->receive(packet);
  // The same bytes once more as a short packet that leans on the first.
  if (packet.size() < 16) return 0;
  std::vector<uint8_t> leaning(packet.begin() + 8, packet.end());
  leaning[0] = 0xF1;
  leaning[1] = packet[8];
  (void)client->receive(with_right_checksum(leaning.data(), leaning.size()));
  return 0;
}
