// Where the restart intervals of a scan begin, found without decoding.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace pac::jpeg {

// Offset of the next 0xFF that starts a marker, at or after `at`; the end of the file if there is none.
uint64_t find_marker(std::span<const uint8_t> bytes, uint64_t at);

// The offsets of the next `n` markers at or after `at`, if they are RST0, RST1, ... in order; else false, and those
// before the first that is not. The data between them are not looked into.
bool find_restarts(std::span<const uint8_t> bytes, uint64_t at, uint64_t n, std::vector<uint64_t>& offsets);

}  // namespace pac::jpeg
