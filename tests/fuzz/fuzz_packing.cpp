// Packed pictures against hostile bytes: the first byte says what they are taken for (1: a picture to pack, 2: it
// stands alone, 4: surfaces are known). What unpacks is a picture, which comes back after packing; what packs comes
// back after unpacking; a picture that goes on from it does, too.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "sim/picture_packing.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size < 1) return 0;
  using pac::PlaneView;
  constexpr int kWidth = 100, kHeight = 60;
  const bool packs = (data[0] & 1) != 0, alone = (data[0] & 2) != 0;
  pac::IdImage stripes(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) stripes.row(y)[x] = static_cast<uint32_t>(x / 9) * 0x10000001u;
  const PlaneView<const uint32_t> surface =
      (data[0] & 4) != 0 ? PlaneView<const uint32_t>(stripes.view()) : PlaneView<const uint32_t>{};
  std::vector<uint8_t> bytes(data + 1, data + size), out, back;
  pac::sim::PicturePacker one(kWidth, kHeight), other(kWidth, kHeight);
  if (!packs) {
    if (!one.unpack(bytes, alone, surface, out).ok()) return 0;
    bytes = out;
  }
  const auto packed = one.pack(bytes, true, surface);
  if (packed.empty()) return 0;
  if (!other.unpack(packed, true, surface, back).ok() || back != bytes) std::abort();
  const auto next = one.pack(bytes, false, surface);
  back.clear();
  if (!next.empty() && (!other.unpack(next, false, surface, back).ok() || back != bytes)) std::abort();
  return 0;
}
