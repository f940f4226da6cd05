// PFM reader: any bytes give a plane or a failure inside them; what decodes is written and decodes to the same bits.
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "base/pfm.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  pac::Limits limits;
  limits.max_pixels = 1 << 20;
  const auto plane = pac::decode_pfm({data, size}, limits);
  if (!plane.ok()) {
    PAC_ASSERT(plane.failure().byte_offset <= size && plane.failure().text[0] != 0);
    return 0;
  }
  const auto again = pac::decode_pfm(pac::encode_pfm(plane->view()), limits);
  PAC_ASSERT(again.ok() && again->width() == plane->width() && again->height() == plane->height());
  const auto row_bytes = static_cast<size_t>(plane->width()) * sizeof(float);
  for (int y = 0; y < plane->height(); ++y) PAC_ASSERT(std::memcmp(again->row(y), plane->row(y), row_bytes) == 0);
  return 0;
}
