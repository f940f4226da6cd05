// What is known of a block's levels where each of them is coded, and the contexts that it makes (sim/picture_coder.h):
// levels of the blocks around, of this block's lower frequencies, of the same surface elsewhere.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "base/kernels/block_kernels.h"
#include "sim/packing_contexts.h"

namespace pac::sim::packing {

// What is known of a block's levels before they are coded.
struct Expected {
  const BlockTrace* left;
  const BlockTrace* above;
  const BlockTrace* other;  // of Cr: Cb's
  const SurfaceMeans* surface;
  uint32_t near[64];    // of left and above, by zigzag position
  uint32_t rest[64];    // near of all positions behind
  uint32_t counts = 0;  // theirs
};

// Cr also knows Cb's block; the others' `other` is `left`.
inline Expected expect(const BlockTrace& left, const BlockTrace& above, const BlockTrace& other,
                       const SurfaceMeans& surface) {
  Expected e;
  e.left = &left;
  e.above = &above;
  e.other = &other;
  e.surface = &surface;
  e.counts = e.left->count + e.above->count;
  uint32_t sum[64];
  for (size_t k = 0; k < 64; ++k) sum[kNaturalFromZigzag[k]] = e.left->size[k] + e.above->size[k];
  for (size_t k = 0; k < 64; ++k) {
    const size_t n = kNaturalFromZigzag[k], u = n % 8, v = n / 8;
    e.near[k] = 2 * sum[n] + (u > 0 ? sum[n - 1] : 0) + (u < 7 ? sum[n + 1] : 0) + (v > 0 ? sum[n - 8] : 0) +
                (v < 7 ? sum[n + 8] : 0);
  }
  uint32_t rest = 0;
  for (size_t k = 64; k-- > 0; rest += e.near[k]) e.rest[k] = rest;
  return e;
}

// |levels| around a position in this block, those already coded.
inline uint32_t inside(const uint8_t* natural, size_t n) {
  const size_t u = n % 8, v = n / 8;
  uint32_t sum = 0;
  if (u > 0) sum += 2u * natural[n - 1];
  if (v > 0) sum += 2u * natural[n - 8];
  if (u > 0 && v > 0) sum += natural[n - 9];
  if (u > 1) sum += natural[n - 2];
  if (v > 1) sum += natural[n - 16];
  if (u > 0 && v < 7) sum += natural[n + 7];
  if (u < 7 && v > 0) sum += natural[n - 7];
  return sum;
}

// A position of a block, and what is known there.
struct Spot {
  uint32_t plane, kind, k, pk;
  uint32_t near, in, mean;
  uint32_t count = 0, run = 0, last_size = 0;  // of the levels before
};

inline Spot spot_at(const Expected& e, int block, uint32_t k, const uint8_t* natural) {
  Spot s;
  s.plane = block < 4 ? 0 : 1;
  s.kind = static_cast<uint32_t>(plane_of(block));
  s.k = k;
  s.pk = s.plane * 64 + k;
  s.near = level_of(e.near[k], 13);
  s.in = level_of(inside(natural, kNaturalFromZigzag[k]), 13);
  s.mean = level_of(e.surface->mean[k] / 4, 13) + (e.surface->seen > 3 ? 2 : 0);
  return s;
}

// Contexts: of whether there is a level here; whether it is the last, `count` with it; whether it is above `found`.
inline std::array<uint32_t, 7> found_at(const Expected& e, const Spot& s) {
  return {kLayout.found[0] + s.pk * kLevelsSeen + s.near,
          kLayout.found[1] + s.pk * kLevelsSeen + s.in,
          kLayout.found[2] + ((s.plane * kLevelsSeen + s.near) * kLevelsSeen + s.in) * 8 + std::min(s.k / 4, 7u),
          kLayout.found[3] + s.pk * 16 + s.mean,
          kLayout.found[4] + ((s.plane * 16 + std::min(s.k, 30u) / 2) * 8 + std::min(s.count, 7u)) * 8 +
              std::min(s.run, 7u),
          kLayout.found[5] + s.pk * kLevelsSeen + level_of(e.counts, 13),
          kLayout.found[6] + (s.kind * 64 + s.k) * 16 + std::min<uint32_t>(e.other->size[s.k], 3) * 4 +
              std::min<uint32_t>(e.above->size[s.k], 3)};
}
inline std::array<uint32_t, 5> last_at(const Expected& e, const Spot& s, uint32_t count) {
  const uint32_t around = level_of(e.counts, 13);
  return {kLayout.last[0] + s.pk * 8 + std::min(count, 7u), kLayout.last[1] + s.pk * kLevelsSeen + around,
          kLayout.last[2] + (s.plane * 32 + std::min(count, 31u)) * kLevelsSeen + around,
          kLayout.last[3] + s.pk * 16 + s.mean, kLayout.last[4] + s.pk * kLevelsSeen + level_of(e.rest[s.k] / 8, 13)};
}
inline std::array<uint32_t, 6> size_at(const Spot& s, uint32_t found) {
  const uint32_t pj = s.plane * 16 + found;
  return {
      kLayout.size[0] + pj * kLevelsSeen + s.near,
      kLayout.size[1] + pj * kLevelsSeen + s.in,
      kLayout.size[2] + pj * 64 + s.k,
      kLayout.size[3] + pj * 16 + s.mean,
      kLayout.size[4] + (pj * 16 + std::min(s.k / 2, 15u)) * 8 + std::min(s.last_size, 3u) * 2 + (s.count > 2 ? 1 : 0),
      kLayout.size[5] + (pj * kLevelsSeen + s.near) * kLevelsSeen + s.in};
}
inline size_t last_set(const Spot& s) {
  return kSetLast + s.plane * 16 + std::min(s.k, 15u);
}
inline size_t size_set(const Spot& s, uint32_t found) {
  return kSetSize + s.plane * 4 + std::min(found - 1, 3u);
}

// A block of the surface was coded.
inline void learn_from(const BlockTrace& block, SurfaceMeans& s) {
  const int step = 65536 / (s.seen + 2);
  s.coded = static_cast<uint16_t>(s.coded + (((block.count > 0 ? 65535 : 0) - s.coded) * int64_t{step} >> 16));
  for (size_t k = 0; k < 64; ++k)
    s.mean[k] =
        static_cast<uint16_t>(s.mean[k] + ((64 * std::min<int>(block.size[k], 200) - s.mean[k]) * int64_t{step} >> 16));
  if (s.seen < 40) ++s.seen;
}

}  // namespace pac::sim::packing
