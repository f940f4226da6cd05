#include "jpeg/exif.h"

namespace pac::jpeg {
namespace {

constexpr int kTagOrientation = 0x0112;
constexpr int kTypeShort = 3;

struct Tiff {
  std::span<const uint8_t> bytes;
  bool little_endian;
  bool holds(uint64_t at, uint64_t n) const { return at <= bytes.size() && bytes.size() - at >= n; }
  uint32_t u16(uint64_t at) const {
    const uint32_t a = bytes[at], b = bytes[at + 1];
    return little_endian ? b << 8 | a : a << 8 | b;
  }
  uint32_t u32(uint64_t at) const {
    const uint32_t a = u16(at), b = u16(at + 2);
    return little_endian ? b << 16 | a : a << 16 | b;
  }
};

}  // namespace

int exif_orientation(std::span<const uint8_t> bytes) {
  if (bytes.size() < 8 || bytes[0] != bytes[1] || (bytes[0] != 'I' && bytes[0] != 'M')) return 0;
  const Tiff tiff{bytes, bytes[0] == 'I'};
  if (tiff.u16(2) != 42) return 0;
  const uint64_t directory = tiff.u32(4);
  if (!tiff.holds(directory, 2)) return 0;
  const uint32_t n_entries = tiff.u16(directory);
  for (uint32_t i = 0; i < n_entries; ++i) {
    const uint64_t entry = directory + 2 + uint64_t{12} * i;
    if (!tiff.holds(entry, 12)) return 0;
    if (tiff.u16(entry) != kTagOrientation) continue;
    const auto value = static_cast<int>(tiff.u16(entry + 8));
    return tiff.u16(entry + 2) == kTypeShort && value >= 1 && value <= 8 ? value : 0;
  }
  return 0;
}

}  // namespace pac::jpeg
