#include "base/image_io.h"

#include <cstddef>

namespace pac {
namespace {

constexpr Failure kUnknownFormat{Error::unsupported, 0, "neither PNG nor PPM nor PGM"};
constexpr Failure kEmptyImage{Error::bad_argument, 0, "an empty image cannot be written"};

// A file that is cut inside its signature is truncated, not unknown.
bool may_be_pnm(std::span<const uint8_t> bytes) {
  return is_pnm(bytes) || (!bytes.empty() && bytes[0] == 'P');
}
bool may_be_png(std::span<const uint8_t> bytes) {
  return is_png(bytes) || (!bytes.empty() && bytes[0] == 0x89);
}

RgbaImage with_alpha(const RgbImage& rgb) {
  RgbaImage image(rgb.width(), rgb.height());
  for (int y = 0; y < rgb.height(); ++y) {
    const uint8_t* from = rgb.row(y);
    uint8_t* to = image.row(y);
    for (int x = 0; x < rgb.width(); ++x, from += 3, to += 4) {
      to[0] = from[0];
      to[1] = from[1];
      to[2] = from[2];
      to[3] = 255;
    }
  }
  return image;
}

}  // namespace

Result<ImageInfo> read_image_info(std::span<const uint8_t> bytes) {
  if (may_be_png(bytes)) {
    PAC_TRY(const PngHeader header, read_png_header(bytes));
    const bool has_alpha = header.color_type == PngHeader::gray_alpha || header.color_type == PngHeader::rgba;
    const bool is_gray = header.color_type == PngHeader::gray || header.color_type == PngHeader::gray_alpha;
    return ImageInfo{header.width, header.height, is_gray, has_alpha};
  }
  if (!may_be_pnm(bytes)) return kUnknownFormat;
  PAC_TRY(const PnmHeader header, read_pnm_header(bytes));
  return ImageInfo{header.width, header.height, !header.is_rgb, false};
}

Result<RgbImage> decode_rgb(std::span<const uint8_t> bytes, const Limits& limits) {
  if (may_be_png(bytes)) return decode_png_rgb(bytes, limits);
  if (may_be_pnm(bytes)) return decode_pnm_rgb(bytes, limits);
  return kUnknownFormat;
}

Result<RgbaImage> decode_rgba(std::span<const uint8_t> bytes, const Limits& limits) {
  if (may_be_png(bytes)) return decode_png_rgba(bytes, limits);
  if (!may_be_pnm(bytes)) return kUnknownFormat;
  PAC_TRY(const RgbImage rgb, decode_pnm_rgb(bytes, limits));
  return with_alpha(rgb);
}

Result<GrayImage> decode_gray(std::span<const uint8_t> bytes, const Limits& limits) {
  if (may_be_png(bytes)) return decode_png_gray(bytes, limits);
  if (may_be_pnm(bytes)) return decode_pgm(bytes, limits);
  return kUnknownFormat;
}

bool has_extension(std::string_view name, std::string_view extension) {
  if (name.size() < extension.size()) return false;
  const std::string_view end = name.substr(name.size() - extension.size());
  for (size_t i = 0; i < end.size(); ++i) {
    const char lower = end[i] >= 'A' && end[i] <= 'Z' ? static_cast<char>(end[i] - 'A' + 'a') : end[i];
    if (lower != extension[i]) return false;
  }
  return true;
}

Result<std::vector<uint8_t>> encode_image(ConstRgbView image, std::string_view name) {
  if (image.empty()) return kEmptyImage;
  if (has_extension(name, ".png")) return encode_png(image);
  if (has_extension(name, ".ppm")) return encode_ppm(image);
  return Failure{Error::bad_argument, 0, "output name ends in neither .png nor .ppm"};
}

Result<std::vector<uint8_t>> encode_image(PlaneView<const uint8_t> image, std::string_view name) {
  if (image.empty()) return kEmptyImage;
  if (has_extension(name, ".png")) return encode_png(image);
  if (has_extension(name, ".pgm")) return encode_pgm(image);
  return Failure{Error::bad_argument, 0, "output name ends in neither .png nor .pgm"};
}

}  // namespace pac
