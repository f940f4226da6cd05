// What a glTF file consists of before it means anything: the JSON, the buffers and the accessors' numbers.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/file_io.h"
#include "base/result.h"
#include "raster/load_gltf_json.h"
#include "raster/load_obj.h"

namespace pac::raster {

inline constexpr uint32_t kNoIndex = 0xFFFFFFFFu;

struct GltfFile {
  std::unique_ptr<const JsonTree> json;  // stays where it is when the file is moved: every Json points into it
  uint64_t json_offset = 0;              // of the JSON in the file
  std::span<const uint8_t> binary;       // the GLB's second chunk
  std::vector<Bytes> loaded;             // buffers that are not the GLB's
  std::vector<std::span<const uint8_t>> buffers;
  // The top-level arrays, so that a number finds its object at once.
  std::vector<Json> accessors, views, meshes, nodes, materials, textures, images, samplers, cameras;

  Json root() const { return Json(*json, 0); }
  Failure failure(Error error, const Json& where, const char* text) const {
    return {error, json_offset + where.offset(), text};
  }
};

// A whole number of `object` in [0, 2^53], or `otherwise` where it is absent. Fails with corrupt.
Result<uint64_t> get_integer(const GltfFile& file, const Json& object, std::string_view key, uint64_t otherwise);
// A number of an array that has `count` entries, or kNoIndex where it is absent.
Result<uint32_t> get_index(const GltfFile& file, const Json& object, std::string_view key, size_t count);
// `count` finite numbers into `values`, which keeps what it has where the array is absent.
Result<void> get_numbers(const GltfFile& file, const Json& object, std::string_view key, double* values, size_t count);

// The bytes behind "data:...;base64,...". Empty where the text is no such URI or not base64.
Bytes decode_data_uri(std::string_view uri);
// %20 and the like undone.
std::string decode_uri(std::string_view uri);

// Container, JSON, version, extensions, buffers. `bytes` must outlive the file.
Result<GltfFile> read_gltf_file(std::span<const uint8_t> bytes, const AssetSource& assets, const Limits& limits);

// The bytes of a buffer view.
struct GltfView {
  std::span<const uint8_t> bytes;
  size_t stride = 0;  // 0 = tightly packed
};
Result<GltfView> get_view(const GltfFile& file, uint32_t number);

// An accessor's elements as floats: `width` (1..4) a element; normalized integers are scaled [s.3.6.2.2]. Fails with
// corrupt where it does not fit its view, has another number of components than [least, most] or holds NaN or infinity.
struct GltfFloats {
  size_t width = 0, count = 0;
  std::vector<float> values;
};
Result<GltfFloats> read_floats(const GltfFile& file, uint32_t accessor, size_t least, size_t most,
                               const Limits& limits);
// The same as unsigned integers of one component; fails where it holds signed numbers or floats.
Result<std::vector<uint32_t>> read_indices(const GltfFile& file, uint32_t accessor, const Limits& limits);

}  // namespace pac::raster
