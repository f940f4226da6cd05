#include "sim/cli/image_files.h"

#include "base/image_io.h"
#include "base/metrics.h"
#include "jpeg/jpeg.h"
#include "sim/cli/command.h"

namespace pac::cli {

bool is_jpeg(std::span<const uint8_t> bytes) {
  return bytes.size() >= 2 && bytes[0] == 0xFF && bytes[1] == 0xD8;
}

Result<RgbImage> decode_picture(std::span<const uint8_t> bytes, Isa isa) {
  if (is_jpeg(bytes)) return jpeg::decode(bytes, {}, isa);
  return decode_rgb(bytes);
}

Result<RgbaImage> decode_picture_rgba(std::span<const uint8_t> bytes, Isa isa) {
  if (!is_jpeg(bytes)) return decode_rgba(bytes);
  PAC_TRY(const RgbImage opaque, jpeg::decode(bytes, {}, isa));
  RgbaImage image(opaque.width(), opaque.height());
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      for (int c = 0; c < 3; ++c) image.pixel(x, y)[c] = opaque.pixel(x, y)[c];
      image.pixel(x, y)[3] = 255;
    }
  return image;
}

std::optional<RgbImage> read_picture(const std::string& path, Isa isa) {
  const auto bytes = read_file(path);
  if (!bytes.ok()) {
    data_error(path, bytes.failure());
    return std::nullopt;
  }
  auto image = decode_picture(*bytes, isa);
  if (!image.ok()) {
    data_error(path, image.failure());
    return std::nullopt;
  }
  return std::move(image).value();
}

std::string picture_name_problem(const std::string& path) {
  for (const char* known : {".png", ".ppm", ".pgm"})
    if (extension(path) == known) return "";
  if (path == "-") return "";
  return "'" + path + "' is not a picture that can be written: .png, .ppm or .pgm";
}

int write_picture(const std::string& path, ConstRgbView image) {
  if (image.empty()) return data_error(path, "the picture has no pixels");
  const std::string name = path == "-" ? ".png" : path;
  const auto bytes = extension(name) == ".pgm" ? encode_image(luma_of(image).view(), name) : encode_image(image, name);
  if (!bytes.ok()) return data_error(path, bytes.failure());
  return write_output(path, *bytes);
}

}  // namespace pac::cli
