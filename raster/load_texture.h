// Textures of loaded models: read once each, replaced visibly where they are missing.
#pragma once

#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "raster/load_obj.h"
#include "raster/scene.h"

namespace pac::raster {

// 64x64, magenta and white squares of 8 pixels: nobody takes it for the artist's.
RgbaImage missing_texture_image();

// Whether nearly all of a texture is either opaque or transparent.
bool is_mask(const Texture& texture);

// Adds textures to `scene` and warnings to `warnings`.
class TextureLoader {
 public:
  TextureLoader(const AssetSource& assets, Scene& scene, std::vector<Warning>& warnings)
      : assets_(assets), scene_(scene), warnings_(warnings) {}
  // The number of the texture with that file name: loaded now, loaded before, or the checker.
  int32_t load(const std::string& name, uint64_t byte_offset);
  // The checker's.
  int32_t missing();
  // The same, or -1 where nobody needed it so far.
  int32_t known_missing() const { return missing_; }
  // A normal map of the image: itself if it is colored, else slopes of its heights, white being scale / 64 of the
  // texture's width high.
  int32_t load_bump(const std::string& name, float scale, uint64_t byte_offset);
  // The colors of `base` (-1: white) with the brightness of the image as alpha, or its own alpha where it has some.
  int32_t load_opacity(int32_t base, const std::string& name, uint64_t byte_offset);

 private:
  int32_t add(const std::string& key, const RgbaImage& image);

  const AssetSource& assets_;
  Scene& scene_;
  std::vector<Warning>& warnings_;
  std::unordered_map<std::string, int32_t> loaded_;
  int32_t missing_ = -1;
};

}  // namespace pac::raster
