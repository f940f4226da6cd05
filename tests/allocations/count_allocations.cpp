// A reused Encoder allocates nothing from its second picture on, and neither encoder nor decoder of a baseline file
// holds much more than some rows of MCUs. Returns 0 if all of that is so.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <vector>

#include "jpeg/jpeg.h"

namespace {

size_t n_allocations = 0, n_bytes = 0;

void* allocate(size_t size, size_t alignment) {
  ++n_allocations;
  n_bytes += size;
  return std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
}

}  // namespace

// Libraries are built without exceptions: what does not fit in memory ends the program.
void* operator new(size_t size) {
  void* p = allocate(size, alignof(std::max_align_t));
  if (p == nullptr) std::abort();
  return p;
}
void* operator new(size_t size, std::align_val_t alignment) {
  void* p = allocate(size, static_cast<size_t>(alignment));
  if (p == nullptr) std::abort();
  return p;
}
void* operator new(size_t size, std::align_val_t alignment, const std::nothrow_t&) noexcept {
  return allocate(size, static_cast<size_t>(alignment));
}
void operator delete(void* p) noexcept {
  std::free(p);
}
void operator delete(void* p, size_t) noexcept {
  std::free(p);
}
void operator delete(void* p, std::align_val_t) noexcept {
  std::free(p);
}
void operator delete(void* p, size_t, std::align_val_t) noexcept {
  std::free(p);
}

namespace {

using namespace pac;

RgbImage noise(int width, int height, uint32_t seed) {
  RgbImage image(width, height);
  for (int y = 0; y < height; ++y)
    for (int i = 0; i < 3 * width; ++i) {
      seed = seed * 1664525 + 1013904223;
      image.row(y)[i] = static_cast<uint8_t>((seed >> 26) + static_cast<uint32_t>(i + y) / 8 % 190);
    }
  return image;
}

bool check(bool holds, const char* claim, size_t count) {
  if (!holds) std::printf("not so: %s (%zu)\n", claim, count);
  return holds;
}

bool second_picture_is_free(const RgbImage& first, const RgbImage& second, const jpeg::EncodeOptions& options) {
  std::vector<uint8_t> out(jpeg::encode_bound(first.width(), first.height(), options.subsampling));
  jpeg::Encoder encoder;
  if (!encoder.encode_into(first.view(), options, out).ok()) return check(false, "the picture is encoded", 0);
  const size_t before = n_allocations;
  if (!encoder.encode_into(second.view(), options, out).ok()) return check(false, "the picture is encoded", 0);
  return check(n_allocations == before, "encode_into of a reused encoder allocates nothing", n_allocations - before);
}

// The bytes that one use of a new object takes.
template <class Fn>
size_t bytes_of(Fn&& fn) {
  const size_t before = n_bytes;
  fn();
  return n_bytes - before;
}

}  // namespace

int main() {
  const RgbImage large = noise(1000, 2000, 1), small = noise(1000, 2000, 2);
  bool good = true;
  for (const auto effort : {jpeg::Effort::fast, jpeg::Effort::normal, jpeg::Effort::best})
    for (const auto subsampling : {jpeg::Subsampling::yuv420, jpeg::Subsampling::yuv422, jpeg::Subsampling::yuv444}) {
      jpeg::EncodeOptions options = jpeg::options_for(effort, jpeg::Tune::visual, 60);
      options.subsampling = subsampling;
      // The first picture has at least as many tokens as the second: the same one.
      good &= second_picture_is_free(large, large, options);
      if (effort == jpeg::Effort::fast) good &= second_picture_is_free(large, small, options);
    }
  // 16 rows of 1000 pixels are 48 KB of RGB; levels take twice that, samples half; 2000 rows would be 6 MB.
  constexpr size_t kFewRows = 700 * 1024;
  std::vector<uint8_t> out(jpeg::encode_bound(1000, 2000, jpeg::Subsampling::yuv420));
  size_t size = 0;
  const size_t encoding = bytes_of([&] {
    const auto options = jpeg::options_for(jpeg::Effort::fast, jpeg::Tune::visual, 60);
    size = jpeg::Encoder().encode_into(large.view(), options, out).value();
  });
  good &= check(encoding < kFewRows, "encoding with known tables takes the memory of a few rows", encoding);
  RgbImage decoded(1000, 2000);
  const size_t decoding = bytes_of([&] {
    if (!jpeg::Decoder().decode_into({out.data(), size}, decoded.view()).ok()) std::abort();
  });
  good &= check(decoding < kFewRows, "decoding takes the memory of a few rows", decoding);
  std::printf("encoding took %zu bytes, decoding %zu\n", encoding, decoding);
  return good ? 0 : 1;
}
