#include "raster/load_texture.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pac::raster {
namespace {

bool is_grey(ConstRgbaView image) {
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const uint8_t* p = image.pixel(x, y);
      if (std::max({p[0], p[1], p[2]}) - std::min({p[0], p[1], p[2]}) > 8) return false;
    }
  return true;
}

uint8_t encoded_component(double value) {
  return static_cast<uint8_t>(std::clamp(128 + 127 * value, 1.0, 255.0) + 0.5);
}

// Central differences; the image repeats. A texel is 1 / width of the texture wide.
RgbaImage normals_of_heights(ConstRgbaView heights, float scale) {
  RgbaImage out(heights.width, heights.height);
  const double slope = static_cast<double>(scale) / 64 * heights.width / (2 * 255.0);
  const auto at = [&](int x, int y) {
    return int{heights.pixel((x + heights.width) % heights.width, (y + heights.height) % heights.height)[0]};
  };
  for (int y = 0; y < out.height(); ++y)
    for (int x = 0; x < out.width(); ++x) {
      const double right = -slope * (at(x + 1, y) - at(x - 1, y)), up = -slope * (at(x, y - 1) - at(x, y + 1));
      const double length = std::sqrt(right * right + up * up + 1);
      uint8_t* p = out.pixel(x, y);
      p[0] = encoded_component(right / length);
      p[1] = encoded_component(up / length);
      p[2] = encoded_component(1 / length);
      p[3] = 255;
    }
  return out;
}

}  // namespace

bool is_mask(const Texture& texture) {
  if (texture.empty()) return false;
  const ConstRgbaView image = texture.level(0);
  int64_t between = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const uint8_t alpha = image.pixel(x, y)[3];
      between += alpha >= 32 && alpha < 224 ? 1 : 0;
    }
  return between * 8 <= int64_t{image.width} * image.height;
}

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

int32_t TextureLoader::add(const std::string& key, const RgbaImage& image) {
  const auto number = static_cast<int32_t>(scene_.textures.size());
  scene_.textures.push_back(make_texture(key, image));
  loaded_.emplace(key, number);
  return number;
}

int32_t TextureLoader::load_bump(const std::string& name, float scale, uint64_t byte_offset) {
  const int32_t source = load(name, byte_offset);
  if (source == missing_) return -1;
  const ConstRgbaView image = scene_.textures[static_cast<size_t>(source)].level(0);
  if (!is_grey(image)) return source;
  const std::string key = name + " as normals, scale " + std::to_string(scale);
  if (const auto known = loaded_.find(key); known != loaded_.end()) return known->second;
  return add(key, normals_of_heights(image, scale));
}

int32_t TextureLoader::load_opacity(int32_t base, const std::string& name, uint64_t byte_offset) {
  const int32_t source = load(name, byte_offset);
  if (source == missing_) return base;
  const std::string key = name + " as alpha of " + std::to_string(base);
  if (const auto known = loaded_.find(key); known != loaded_.end()) return known->second;
  const ConstRgbaView mask = scene_.textures[static_cast<size_t>(source)].level(0);
  const ConstRgbaView colors = base >= 0 ? scene_.textures[static_cast<size_t>(base)].level(0) : mask;
  bool has_alpha = false;
  for (int y = 0; y < mask.height; ++y)
    for (int x = 0; x < mask.width; ++x) has_alpha = has_alpha || mask.pixel(x, y)[3] != 255;
  RgbaImage out(std::max(mask.width, colors.width), std::max(mask.height, colors.height));
  for (int y = 0; y < out.height(); ++y)
    for (int x = 0; x < out.width(); ++x) {
      const auto nearest = [&](ConstRgbaView image) {
        return image.pixel(static_cast<int>(int64_t{x} * image.width / out.width()),
                           static_cast<int>(int64_t{y} * image.height / out.height()));
      };
      uint8_t* p = out.pixel(x, y);
      if (base >= 0)
        std::copy_n(nearest(colors), 3, p);
      else
        std::fill_n(p, 3, uint8_t{255});
      const uint8_t* m = nearest(mask);
      p[3] = has_alpha ? m[3] : static_cast<uint8_t>((m[0] + m[1] + m[2]) / 3);
    }
  return add(key, out);
}

}  // namespace pac::raster
