// Pictures from bytes by their content, to bytes by a file name's extension. Includes all still-image formats.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "base/image.h"
#include "base/pfm.h"
#include "base/png.h"
#include "base/pnm.h"
#include "base/result.h"

namespace pac {

// What a picture's header says, whatever its format.
struct ImageInfo {
  int width = 0, height = 0;  // pixels
  bool is_gray = false;       // without color, by its type (not by looking at the samples)
  bool has_alpha = false;     // an alpha channel (a PNG's tRNS does not count)
};
Result<ImageInfo> read_image_info(std::span<const uint8_t> bytes);

// PNG, PPM or PGM, told apart by the first bytes (unsupported: none of them). See png.h and pnm.h for what becomes of
// depth, gray and alpha. The offset of a failure counts from the first byte.
Result<RgbImage> decode_rgb(std::span<const uint8_t> bytes, const Limits& limits = {});
Result<RgbaImage> decode_rgba(std::span<const uint8_t> bytes, const Limits& limits = {});
// Gray files only (else unsupported).
Result<GrayImage> decode_gray(std::span<const uint8_t> bytes, const Limits& limits = {});

// A file in the format that the name's extension says, in any case: .png, .ppm, or .pgm for gray. Fails with
// bad_argument for any other name or an empty image.
Result<std::vector<uint8_t>> encode_image(ConstRgbView image, std::string_view name);
Result<std::vector<uint8_t>> encode_image(PlaneView<const uint8_t> image, std::string_view name);

// True if the name ends with `extension` (given with its dot, in lower case), in any case.
bool has_extension(std::string_view name, std::string_view extension);

}  // namespace pac
