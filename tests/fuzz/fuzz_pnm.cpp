// PPM and PGM reader: any bytes give a picture or a failure inside them; what decodes is written and decodes to the
// same.
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "base/image_io.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  pac::Limits limits;
  limits.max_pixels = 1 << 20;
  const std::span<const uint8_t> bytes(data, size);
  const auto rgb = pac::decode_pnm_rgb(bytes, limits);
  const auto gray = pac::decode_pgm(bytes, limits);
  if (gray.ok()) PAC_ASSERT(rgb.ok());
  if (!rgb.ok()) {
    PAC_ASSERT(rgb.failure().byte_offset <= size && rgb.failure().text[0] != 0);
    return 0;
  }
  PAC_ASSERT(pac::read_image_info(bytes).ok());
  const auto again = pac::decode_rgb(pac::encode_ppm(rgb->view()), limits);
  PAC_ASSERT(again.ok() && again->width() == rgb->width() && again->height() == rgb->height());
  const auto row_bytes = static_cast<size_t>(rgb->width()) * 3;
  for (int y = 0; y < rgb->height(); ++y) PAC_ASSERT(std::memcmp(again->row(y), rgb->row(y), row_bytes) == 0);
  return 0;
}
