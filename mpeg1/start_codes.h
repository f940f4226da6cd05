// Where units begin.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace pac::mpeg1 {

constexpr size_t kNotFound = ~size_t{0};

// The next 00 00 01 xx at or after `from`, of which all four bytes are there.
inline size_t find_start_code(std::span<const uint8_t> bytes, size_t from) {
  for (size_t at = from + 2; at + 1 < bytes.size(); ++at) {
    const void* one = std::memchr(bytes.data() + at, 1, bytes.size() - 1 - at);
    if (one == nullptr) return kNotFound;
    at = static_cast<size_t>(static_cast<const uint8_t*>(one) - bytes.data());
    if (bytes[at - 1] == 0 && bytes[at - 2] == 0) return at - 2;
  }
  return kNotFound;
}

}  // namespace pac::mpeg1
