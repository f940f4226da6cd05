// The two checksums of PNG files: CRC-32 of chunks [PNG 5.5], Adler-32 of zlib streams [RFC 1950 8.2].
#pragma once

#include <cstdint>
#include <span>

namespace pac {

// CRC-32 with the reflected polynomial 0xEDB88320, over `bytes`; `previous` continues an earlier call's result.
uint32_t crc32(std::span<const uint8_t> bytes, uint32_t previous = 0);

// Adler-32 over `bytes`; `previous` continues an earlier call's result.
uint32_t adler32(std::span<const uint8_t> bytes, uint32_t previous = 1);

}  // namespace pac
