// PNG files [ISO/IEC 15948; W3C PNG 3rd edition]: reader of every color type and depth, writer of 8-bit images.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/image.h"
#include "base/result.h"

namespace pac {

// What IHDR says [PNG 11.2.2].
struct PngHeader {
  enum ColorType : uint8_t { gray = 0, rgb = 2, palette = 3, gray_alpha = 4, rgba = 6 };
  int width = 0, height = 0;  // pixels, >= 1
  int bit_depth = 0;          // 1, 2, 4, 8 or 16 bits a sample
  ColorType color_type = gray;
  bool interlaced = false;  // Adam7
};

// True if the bytes begin with the PNG signature.
bool is_png(std::span<const uint8_t> bytes);

// IHDR only; the rest of the file may be missing.
Result<PngHeader> read_png_header(std::span<const uint8_t> bytes);

// The picture; 16-bit samples are reduced by v * 255 / 65535, rounded. Gray is spread to three channels. decode_png_rgb
// drops alpha (colors are not premultiplied: nothing is blended); decode_png_rgba has alpha 255 where the file has
// neither alpha nor tRNS; decode_png_gray takes gray files only (else unsupported). CRC and Adler-32 are verified,
// ancillary chunks other than tRNS skipped, bytes after IEND ignored. gAMA, sRGB and iCCP change nothing: samples
// are taken as display-referred. Fails with truncated, corrupt, unsupported (unknown critical chunk) or limit_exceeded;
// the offset is that of the chunk or byte at fault.
Result<RgbImage> decode_png_rgb(std::span<const uint8_t> bytes, const Limits& limits = {});
Result<RgbaImage> decode_png_rgba(std::span<const uint8_t> bytes, const Limits& limits = {});
Result<GrayImage> decode_png_gray(std::span<const uint8_t> bytes, const Limits& limits = {});

// A complete file: 8 bits a sample, not interlaced, each row's filter chosen by the least sum of absolute values. Sides
// >= 1 (a PNG cannot be empty: PAC_ASSERT). The bytes depend on nothing but the pixels.
std::vector<uint8_t> encode_png(ConstRgbView image);
std::vector<uint8_t> encode_png(ConstRgbaView image);
std::vector<uint8_t> encode_png(PlaneView<const uint8_t> image);

}  // namespace pac
