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

uint64_t word_of(const uint8_t* bytes, size_t count) {
  uint64_t word = 0;
  if constexpr (std::endian::native == std::endian::little) {
    std::memcpy(&word, bytes, count);
  } else {
    for (size_t i = 0; i < count; ++i) word |= uint64_t{bytes[i]} << 8 * i;
  }
  return word;
}

// One to one in the word: two pictures that differ in one word never collide.
uint64_t mixed_in(uint64_t lane, uint64_t word) {
  return std::rotl(lane ^ word, 29) * 0x9E3779B97F4A7C15u;
}

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

ImageHash::ImageHash(int width, int height) : row_bytes_(static_cast<size_t>(width) * 3) {
  lanes_[0] = mixed_in(lanes_[0], static_cast<uint64_t>(width) << 32 | static_cast<uint32_t>(height));
}

// Four words at a time, each in a lane of its own, so that no multiplication waits for the one before. The bytes after
// the last whole word are filled up with zeros.
void ImageHash::add_row(const uint8_t* rgb) {
  uint64_t lanes[4] = {lanes_[0], lanes_[1], lanes_[2], lanes_[3]};
  size_t at = 0;
  for (; at + 32 <= row_bytes_; at += 32)
    for (size_t lane = 0; lane < 4; ++lane) lanes[lane] = mixed_in(lanes[lane], word_of(rgb + at + 8 * lane, 8));
  for (size_t lane = 0; at < row_bytes_; at += 8, ++lane)
    lanes[lane] = mixed_in(lanes[lane], word_of(rgb + at, std::min<size_t>(8, row_bytes_ - at)));
  std::copy_n(lanes, 4, lanes_);
}

uint64_t ImageHash::finish() const {
  uint64_t hash = 0;
  for (const uint64_t lane : lanes_) {
    hash = (hash ^ lane) * 0xD6E8FEB86659FD93u;
    hash ^= hash >> 32;
  }
  hash *= 0xD6E8FEB86659FD93u;
  return hash ^ hash >> 32;
}

uint64_t image_hash(ConstRgbView image) {
  ImageHash hash(image.width, image.height);
  for (int y = 0; y < image.height; ++y) hash.add_row(image.row(y));
  return hash.finish();
}

}  // namespace pac::sim
