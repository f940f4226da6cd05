// Any bytes as MPEG-1 video or a system stream of it: strict and lenient, whole and in pieces.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "mpeg1/mpeg1.h"
#include "mpeg1/system.h"

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

// The number of pictures, with a bound on work: small limits, few pictures.
size_t decode(std::span<const uint8_t> bytes, bool strict, size_t step) {
  pac::mpeg1::DecoderOptions options;
  options.strict = strict;
  options.limits.max_pixels = 1 << 14;
  pac::mpeg1::Decoder decoder(options);
  size_t pictures = 0;
  const auto drain = [&] {
    for (;;) {
      const auto picture = decoder.next();
      if (!picture.ok()) {
        require(picture.failure().text[0] != 0);
        return false;
      }
      if (*picture == nullptr) return true;
      uint32_t sum = 0;  // every sample is looked at
      const auto& view = (*picture)->view;
      for (int y = 0; y < view.height(); ++y)
        for (int x = 0; x < view.width(); ++x) sum += view.y.row(y)[x];
      require(sum <= 255u * (1u << 14));
      ++pictures;
    }
  };
  for (size_t at = 0; at < bytes.size(); at += step) {
    decoder.feed(bytes.subspan(at, std::min(step, bytes.size() - at)));
    if (step < bytes.size() && !drain()) return pictures;
  }
  decoder.finish();
  drain();
  return pictures;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::span<const uint8_t> bytes(data, size);
  const size_t whole = decode(bytes, false, std::max<size_t>(size, 1));
  require(decode(bytes, false, 61) == whole);
  require(decode(bytes, true, std::max<size_t>(size, 1)) <= whole + 1);
  (void)pac::mpeg1::read_info(bytes);
  const auto system = pac::mpeg1::demultiplex(bytes);
  if (system.ok()) require(system->video.size() <= size);
  (void)pac::mpeg1::multiplex(bytes);
  return 0;
}
