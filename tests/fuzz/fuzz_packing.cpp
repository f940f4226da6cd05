// Packed pictures against hostile bytes: the first byte says what they are taken for. What unpacks is a picture, which
// comes back after packing; what packs comes back after unpacking.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "sim/picture_packing.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size < 1) return 0;
  constexpr int kWidth = 100, kHeight = 60;
  const bool packs = (data[0] & 1) != 0, alone = (data[0] & 2) != 0;
  std::vector<uint8_t> bytes(data + 1, data + size), out, back;
  pac::sim::PicturePacker one(kWidth, kHeight), other(kWidth, kHeight);
  if (!packs) {
    if (!one.unpack(bytes, alone, {}, out).ok()) return 0;
    bytes = out;
  }
  const auto packed = one.pack(bytes, true, {});
  if (packed.empty()) return 0;
  if (!other.unpack(packed, true, {}, back).ok() || back != bytes) std::abort();
  return 0;
}
