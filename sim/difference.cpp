#include "sim/difference.h"

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

uint64_t fnv1a(uint64_t hash, const uint8_t* bytes, size_t count) {
  for (size_t i = 0; i < count; ++i) hash = (hash ^ bytes[i]) * 0x100000001B3u;
  return hash;
}

uint64_t fnv1a_u32(uint64_t hash, uint32_t value) {
  const uint8_t bytes[4] = {static_cast<uint8_t>(value), static_cast<uint8_t>(value >> 8),
                            static_cast<uint8_t>(value >> 16), static_cast<uint8_t>(value >> 24)};
  return fnv1a(hash, bytes, sizeof bytes);
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

uint64_t image_hash(ConstRgbView image) {
  uint64_t hash = 0xCBF29CE484222325u;
  hash = fnv1a_u32(hash, static_cast<uint32_t>(image.width));
  hash = fnv1a_u32(hash, static_cast<uint32_t>(image.height));
  for (int y = 0; y < image.height; ++y) hash = fnv1a(hash, image.row(y), static_cast<size_t>(image.width) * 3);
  return hash;
}

}  // namespace pac::sim
