// What packed pictures are coded by (sim/picture_coder.h): contexts of their syntax elements, and what was learned of
// each surface.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "sim/bit_mixer.h"

namespace pac::sim::packing {

constexpr uint32_t kSurfaces = 64;  // told apart; others share

// 0, 1, 2, 3-4, 5-6, 7-9, ...: 0..limit.
inline uint32_t level_of(uint32_t value, uint32_t limit) {
  constexpr uint8_t kLevels[32] = {0, 1, 2, 3, 3, 4, 4, 5, 5, 5, 6, 6, 6, 6, 7, 7,
                                   7, 7, 7, 8, 8, 8, 8, 8, 8, 9, 9, 9, 9, 9, 9, 9};
  const uint32_t level = value < 32 ? kLevels[value] : value < 48 ? 10 : value < 80 ? 11 : value < 128 ? 12 : 13;
  return std::min(level, limit);
}

// Slots of a family of contexts: handed out once, indexed by digits of mixed radix.
struct Families {
  uint32_t size = 0;
  constexpr uint32_t add(uint32_t slots) { return std::exchange(size, size + slots); }
};

constexpr uint32_t kPlanes = 2, kLevelsSeen = 14;

// Where each family begins.
struct Layout {
  Families f;
  uint32_t skipped = f.add(27), kind = f.add(10), moves = f.add(9), quantizer = f.add(5), motion = f.add(2 * 40);
  uint32_t pattern[4] = {f.add(3 * 9), f.add(6 * 64), f.add(3 * 16), f.add(3 * 4 * 14)};
  uint32_t found[7] = {f.add(kPlanes * 64 * kLevelsSeen),
                       f.add(kPlanes * 64 * kLevelsSeen),
                       f.add(kPlanes* kLevelsSeen* kLevelsSeen * 8),
                       f.add(kPlanes * 64 * 16),
                       f.add(kPlanes * 16 * 8 * 8),
                       f.add(kPlanes * 64 * kLevelsSeen),
                       f.add(3 * 64 * 16)};
  uint32_t last[5] = {f.add(kPlanes * 64 * 8), f.add(kPlanes * 64 * kLevelsSeen), f.add(kPlanes * 32 * kLevelsSeen),
                      f.add(kPlanes * 64 * 16), f.add(kPlanes * 64 * kLevelsSeen)};
  uint32_t size[6] = {f.add(kPlanes * 16 * kLevelsSeen), f.add(kPlanes * 16 * kLevelsSeen),
                      f.add(kPlanes * 16 * 64),          f.add(kPlanes * 16 * 16),
                      f.add(kPlanes * 16 * 16 * 8),      f.add(kPlanes * 16 * kLevelsSeen * kLevelsSeen)};
  uint32_t dc = f.add(3 * 32);
  uint32_t quantizer_sign = f.add(1), quantizer_step = f.add(16);
};
inline constexpr Layout kLayout;

// Weight sets.
constexpr size_t kSetOther = 0, kSetPattern = 1, kSetFound = 2, kSetLast = kSetFound + 2 * 64,
                 kSetSize = kSetLast + 2 * 16, kSets = kSetSize + 2 * 4;

// Mean of |level| of the blocks of one surface at each zigzag position, in 1/64, and how often it has blocks.
struct SurfaceMeans {
  std::array<uint16_t, 64> mean{};
  uint16_t coded = 32768;  // / 65536
  uint8_t seen = 0;
};

struct Learned {
  BitMixer mixer{kLayout.f.size, kSets};
  std::vector<SurfaceMeans> surfaces = std::vector<SurfaceMeans>(kSurfaces * kPlanes);
};

// A block that was coded: what its neighbors' contexts need.
struct BlockTrace {
  std::array<uint8_t, 64> size{};  // |level| by zigzag position, at most 255
  uint8_t count = 0;
};

inline int plane_of(int block) {
  return block < 4 ? 0 : block - 3;
}

}  // namespace pac::sim::packing
