// Wavefront OBJ + MTL with PNG, JPEG and PPM textures.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/file_io.h"
#include "base/image.h"
#include "base/result.h"
#include "raster/scene.h"

namespace pac::raster {

// How the loader reaches the outside world; the caller decides (raster/ never includes jpeg/).
struct AssetSource {
  // The bytes of the file that a MTL or texture statement names, relative to the OBJ. Backslashes are already slashes.
  std::function<Result<Bytes>(const std::string& name)> read;
  // Decodes an image file by its content.
  std::function<Result<RgbaImage>(std::span<const uint8_t> bytes)> decode_image;
};

// Something wrong that did not stop the loading: a missing texture, an unknown statement, a degenerate face.
struct Warning {
  const char* text = "";
  std::string name;          // the file or statement it is about
  uint64_t byte_offset = 0;  // in the OBJ or MTL
};

struct LoadedScene {
  Scene scene;
  std::vector<Warning> warnings;
};

// Failure::byte_offset is the first byte of the offending line.
Result<LoadedScene> load_obj(std::span<const uint8_t> bytes, const AssetSource& assets, const Limits& limits = {});

}  // namespace pac::raster
