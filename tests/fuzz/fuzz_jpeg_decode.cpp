// Any bytes as a JPEG file: information, strict, lenient, reused and threaded decoding. Small pictures, and larger ones
// of few rows: from 2^18 pixels on the decoder reads symbols two at a time.
#include <cstdint>
#include <cstdlib>
#include <span>

#include "base/hash.h"
#include "jpeg/jpeg.h"

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::span<const uint8_t> bytes(data, size);
  pac::Limits limits;
  limits.max_pixels = (1 << 18) + (1 << 14);
  limits.max_bytes = 1 << 22;
  const auto info = pac::jpeg::read_info(bytes, limits);
  constexpr int kSmallPixels = 1 << 16, kFewRows = 16;
  if (info.ok() && info->height > kFewRows && int64_t{info->width} * info->height > kSmallPixels) return 0;
  const auto strict = pac::jpeg::decode(bytes, limits);
  const auto lenient = pac::jpeg::decode_lenient(bytes, limits);
  if (!info.ok()) require(!strict.ok() && !lenient.ok());
  if (!strict.ok()) {
    require(strict.failure().byte_offset <= size && strict.failure().text[0] != 0);
    if (lenient.ok()) require(lenient->failure.has_value());
  }
  // Every pixel is looked at: uninitialized ones show under MemorySanitizer, lost ones under the comparison.
  const uint64_t lenient_hash = lenient.ok() ? pac::hash_pixels(lenient->image.view()) : 0;
  // Two threads: the same pixels and the same complaints.
  pac::jpeg::DecodeOptions two_threads;
  two_threads.limits = limits;
  two_threads.threads = 2;
  const auto shared = pac::jpeg::decode_lenient(bytes, two_threads);
  require(shared.ok() == lenient.ok());
  if (shared.ok()) {
    require(pac::hash_pixels(shared->image.view()) == lenient_hash && shared->warnings == lenient->warnings &&
            shared->errors == lenient->errors);
    require(shared->failure.has_value() == lenient->failure.has_value());
  }
  if (strict.ok()) {
    require(lenient.ok() && !lenient->failure.has_value() && pac::hash_pixels(strict->view()) == lenient_hash);
    require(strict->width() == info->width && strict->height() == info->height);
    pac::jpeg::Decoder decoder(limits, pac::Isa::scalar);
    pac::RgbImage again(info->width, info->height);
    for (int i = 0; i < 2; ++i) {
      require(decoder.decode_into(bytes, again.view()).ok());
      require(pac::hash_pixels(again.view()) == lenient_hash);
    }
  }
  return 0;
}
