#include "jpeg/restart_markers.h"

#include <cstring>

#include "jpeg/markers.h"

namespace pac::jpeg {

uint64_t find_marker(std::span<const uint8_t> bytes, uint64_t at) {
  const uint8_t* const begin = bytes.data();
  const uint64_t size = bytes.size();
  while (at + 1 < size) {
    const void* found = std::memchr(begin + at, 0xFF, static_cast<size_t>(size - 1 - at));
    if (found == nullptr) return size;
    at = static_cast<uint64_t>(static_cast<const uint8_t*>(found) - begin);
    if (begin[at + 1] != 0 && begin[at + 1] != 0xFF) return at;
    at += begin[at + 1] == 0 ? 2 : 1;
  }
  return size;
}

bool find_restarts(std::span<const uint8_t> bytes, uint64_t at, uint64_t n, std::vector<uint64_t>& offsets) {
  offsets.clear();
  while (offsets.size() < n) {
    at = find_marker(bytes, at);
    if (at == bytes.size() || bytes[at + 1] != (kRst0 | (offsets.size() & 7))) return false;
    offsets.push_back(at);
    at += 2;
  }
  return true;
}

}  // namespace pac::jpeg
