#include "base/checksum.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace pac {
namespace {

// kCrc[0] advances the register by one byte; kCrc[k] by one byte followed by k zero bytes, so that eight look-ups
// take eight bytes at once.
using CrcTables = std::array<std::array<uint32_t, 256>, 8>;

constexpr CrcTables make_crc_tables() {
  CrcTables tables{};
  for (uint32_t byte = 0; byte < 256; ++byte) {
    uint32_t crc = byte;
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ ((crc & 1) != 0 ? 0xEDB88320u : 0u);
    tables[0][byte] = crc;
  }
  for (size_t k = 1; k < 8; ++k)
    for (size_t byte = 0; byte < 256; ++byte)
      tables[k][byte] = tables[k - 1][byte] >> 8 ^ tables[0][tables[k - 1][byte] & 255];
  return tables;
}

constexpr CrcTables kCrc = make_crc_tables();

}  // namespace

uint32_t crc32(std::span<const uint8_t> bytes, uint32_t previous) {
  uint32_t crc = ~previous;
  const uint8_t* p = bytes.data();
  size_t n = bytes.size();
  for (; n >= 8; n -= 8, p += 8) {
    crc ^= uint32_t{p[0]} | uint32_t{p[1]} << 8 | uint32_t{p[2]} << 16 | uint32_t{p[3]} << 24;
    crc = kCrc[7][crc & 255] ^ kCrc[6][crc >> 8 & 255] ^ kCrc[5][crc >> 16 & 255] ^ kCrc[4][crc >> 24] ^ kCrc[3][p[4]] ^
          kCrc[2][p[5]] ^ kCrc[1][p[6]] ^ kCrc[0][p[7]];
  }
  for (; n > 0; --n, ++p) crc = crc >> 8 ^ kCrc[0][(crc ^ *p) & 255];
  return ~crc;
}

uint32_t adler32(std::span<const uint8_t> bytes, uint32_t previous) {
  constexpr uint32_t kModulus = 65521;
  // 5552 is the largest n with 255 n (n+1) / 2 + (n+1)(kModulus-1) < 2^32: no overflow between reductions.
  constexpr size_t kRun = 5552;
  uint32_t a = previous & 0xFFFF, b = previous >> 16;
  for (size_t at = 0; at < bytes.size();) {
    const size_t end = std::min(bytes.size(), at + kRun);
    for (; at < end; ++at) {
      a += bytes[at];
      b += a;
    }
    a %= kModulus;
    b %= kModulus;
  }
  return b << 16 | a;
}

}  // namespace pac
