#include "raster/load_texture.h"

#include <utility>

namespace pac::raster {

RgbaImage missing_texture_image() {
  constexpr int kSide = 64, kSquare = 8;
  RgbaImage image(kSide, kSide);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      uint8_t* pixel = image.pixel(x, y);
      pixel[0] = pixel[2] = pixel[3] = 255;
      pixel[1] = (x / kSquare + y / kSquare) % 2 == 0 ? 0 : 255;
    }
  }
  return image;
}

int32_t TextureLoader::missing() {
  if (missing_ < 0) {
    missing_ = static_cast<int32_t>(scene_.textures.size());
    scene_.textures.push_back(make_texture("missing", missing_texture_image()));
  }
  return missing_;
}

int32_t TextureLoader::load(const std::string& name, uint64_t byte_offset) {
  if (const auto known = loaded_.find(name); known != loaded_.end()) return known->second;
  int32_t number = -1;
  if (!assets_.read || !assets_.decode_image) {
    warnings_.push_back({"textures cannot be read here: checker instead", name, byte_offset});
  } else if (const auto bytes = assets_.read(name); !bytes) {
    warnings_.push_back({"texture is missing: checker instead", name, byte_offset});
  } else if (auto image = assets_.decode_image(*bytes); !image) {
    warnings_.push_back({image.failure().text, name, image.failure().byte_offset});
  } else if (image->empty()) {
    warnings_.push_back({"texture has no pixels: checker instead", name, byte_offset});
  } else {
    number = static_cast<int32_t>(scene_.textures.size());
    scene_.textures.push_back(make_texture(name, std::move(*image)));
  }
  if (number < 0) number = missing();
  loaded_.emplace(name, number);
  return number;
}

}  // namespace pac::raster
