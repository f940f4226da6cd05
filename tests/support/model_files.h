// Text and files for the loaders' tests.
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>

#include "raster/load_obj.h"

namespace pac::test {

inline std::span<const uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
}

// Files in memory. An image is any file that starts with "image": 2x2 red pixels.
inline raster::AssetSource assets_from(std::map<std::string, std::string> files) {
  raster::AssetSource assets;
  assets.read = [files = std::move(files)](const std::string& name) -> Result<Bytes> {
    const auto file = files.find(name);
    if (file == files.end()) return Failure{Error::io, 0, "no such file"};
    return Bytes(file->second.begin(), file->second.end());
  };
  assets.decode_image = [](std::span<const uint8_t> bytes) -> Result<RgbaImage> {
    if (bytes.size() < 5 || bytes[0] != 'i') return Failure{Error::corrupt, 0, "not an image"};
    RgbaImage image(2, 2);
    for (int y = 0; y < 2; ++y)
      for (int x = 0; x < 2; ++x) image.pixel(x, y)[0] = image.pixel(x, y)[3] = 255;
    return image;
  };
  return assets;
}

// For fuzzing: every file whose name has an even length holds `bytes`; two images of three are 3x5 pixels, the others
// broken. `bytes` must outlive the source.
inline raster::AssetSource assets_of_bytes(std::span<const uint8_t> bytes) {
  raster::AssetSource assets;
  assets.read = [bytes](const std::string& name) -> Result<Bytes> {
    if (name.size() % 2 == 1) return Failure{Error::io, 0, "no such file"};
    return Bytes(bytes.begin(), bytes.end());
  };
  assets.decode_image = [](std::span<const uint8_t> image) -> Result<RgbaImage> {
    if (image.size() % 3 == 0) return Failure{Error::corrupt, 0, "not an image"};
    return RgbaImage(3, 5);
  };
  return assets;
}

}  // namespace pac::test
