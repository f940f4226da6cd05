// PNG reader: any bytes give a picture or a failure inside them; what decodes is written and decodes again to the same.
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "base/image_io.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  pac::Limits limits;
  limits.max_pixels = 1 << 20;
  limits.max_bytes = 1 << 24;
  const std::span<const uint8_t> bytes(data, size);
  const auto rgba = pac::decode_png_rgba(bytes, limits);
  const auto rgb = pac::decode_png_rgb(bytes, limits);
  const auto gray = pac::decode_png_gray(bytes, limits);
  PAC_ASSERT(rgba.ok() == rgb.ok());
  if (gray.ok()) PAC_ASSERT(rgb.ok());
  if (!rgba.ok()) {
    PAC_ASSERT(rgba.failure().byte_offset <= size && rgba.failure().text[0] != 0);
    return 0;
  }
  PAC_ASSERT(pac::read_image_info(bytes).ok());
  const auto again = pac::decode_png_rgba(pac::encode_png(rgba->view()), limits);
  PAC_ASSERT(again.ok() && again->width() == rgba->width() && again->height() == rgba->height());
  const auto row_bytes = static_cast<size_t>(rgba->width()) * 4;
  for (int y = 0; y < rgba->height(); ++y) PAC_ASSERT(std::memcmp(again->row(y), rgba->row(y), row_bytes) == 0);
  return 0;
}
