// 64-bit FNV-1a over the samples of images: for telling pictures apart in tests and reports, not against an adversary.
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/image.h"

namespace pac {

constexpr uint64_t kHashStart = 0xcbf29ce484222325u;

// Continues `hash` with n bytes.
inline uint64_t hash_bytes(const void* bytes, size_t n, uint64_t hash = kHashStart) {
  const auto* p = static_cast<const uint8_t*>(bytes);
  for (size_t i = 0; i < n; ++i) hash = (hash ^ p[i]) * 0x100000001b3u;
  return hash;
}

// Width and height (4 bytes each, low byte first), then the rows from top to bottom without padding; samples wider than
// a byte count as they lie in memory (little-endian everywhere this project runs).
template <class T, int kChannels>
uint64_t hash_pixels(const ImageView<T, kChannels>& view, uint64_t hash = kHashStart) {
  const uint32_t sides[2] = {static_cast<uint32_t>(view.width), static_cast<uint32_t>(view.height)};
  for (const uint32_t side : sides)
    for (int shift = 0; shift < 32; shift += 8) hash = (hash ^ (side >> shift & 255)) * 0x100000001b3u;
  if (view.empty()) return hash;
  for (int y = 0; y < view.height; ++y)
    hash = hash_bytes(view.row(y), static_cast<size_t>(view.width) * kChannels * sizeof(T), hash);
  return hash;
}

}  // namespace pac
