#include "sim/difference.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "base/kernels/kernels.h"

namespace pac::sim {

namespace {

const PixelKernels& pixel_kernels(Isa isa) {
  const Kernels* table = kernels_for(isa);
  PAC_ASSERT(table != nullptr);
  return table->pixel;
}

template <class A, class B>
bool same_size(const A& a, const B& b) {
  return a.width == b.width && a.height == b.height;
}

// Four words at a time, each in a lane of its own, so that no multiplication waits for the one before.
class LaneHash {
 public:
  void add(uint64_t word, size_t lane) {
    // One to one in the word: two pictures that differ in one word never collide.
    lanes_[lane] = std::rotl(lanes_[lane] ^ word, 29) * 0x9E3779B97F4A7C15u;
  }

  // The bytes after the last whole word are filled up with zeros.
  void add(const uint8_t* bytes, size_t count) {
    size_t at = 0;
    for (; at + 32 <= count; at += 32)
      for (size_t lane = 0; lane < 4; ++lane) add(word_of(bytes + at + 8 * lane, 8), lane);
    for (size_t lane = 0; at < count; at += 8, ++lane) add(word_of(bytes + at, std::min<size_t>(8, count - at)), lane);
  }

  uint64_t finish() const {
    uint64_t hash = 0;
    for (const uint64_t lane : lanes_) {
      hash = (hash ^ lane) * 0xD6E8FEB86659FD93u;
      hash ^= hash >> 32;
    }
    hash *= 0xD6E8FEB86659FD93u;
    return hash ^ hash >> 32;
  }

 private:
  static uint64_t word_of(const uint8_t* bytes, size_t count) {
    uint64_t word = 0;
    if constexpr (std::endian::native == std::endian::little) {
      std::memcpy(&word, bytes, count);
    } else {
      for (size_t i = 0; i < count; ++i) word |= uint64_t{bytes[i]} << 8 * i;
    }
    return word;
  }

  uint64_t lanes_[4] = {1, 2, 3, 4};
};

}  // namespace

void difference_image(ConstRgbView high, ConstRgbView low, RgbView difference, Isa isa) {
  PAC_ASSERT(same_size(high, low) && same_size(high, difference));
  const auto difference_row = pixel_kernels(isa).difference_row;
  for (int y = 0; y < high.height; ++y)
    difference_row(high.row(y), low.row(y), difference.row(y), static_cast<size_t>(high.width) * 3);
}

void composite_image(ConstRgbView low, ConstRgbView difference, RgbView composite, Isa isa) {
  PAC_ASSERT(same_size(low, difference) && same_size(low, composite));
  const auto composite_row = pixel_kernels(isa).composite_row;
  for (int y = 0; y < low.height; ++y)
    composite_row(low.row(y), difference.row(y), composite.row(y), static_cast<size_t>(low.width) * 3);
}

uint64_t image_hash(ConstRgbView image) {
  LaneHash hash;
  hash.add(static_cast<uint64_t>(image.width) << 32 | static_cast<uint32_t>(image.height), 0);
  for (int y = 0; y < image.height; ++y) hash.add(image.row(y), static_cast<size_t>(image.width) * 3);
  return hash.finish();
}

}  // namespace pac::sim
