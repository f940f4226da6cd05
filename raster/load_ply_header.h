// The header of a PLY file: which elements follow, with which properties.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace pac::raster {

enum class PlyFormat : uint8_t { ascii, little_endian, big_endian };
enum class PlyType : uint8_t { none, int8, uint8, int16, uint16, int32, uint32, float32, float64 };

// Bytes of a value in binary files.
constexpr size_t size_of(PlyType type) {
  constexpr size_t kSize[] = {0, 1, 1, 2, 2, 4, 4, 4, 8};
  return kSize[static_cast<size_t>(type)];
}

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::none;
  PlyType count_type = PlyType::none;  // of a list's length; none = not a list
  bool is_list() const { return count_type != PlyType::none; }
};

struct PlyElement {
  std::string name;
  uint64_t count = 0;
  std::vector<PlyProperty> properties;
  // The number of the property called so, or -1.
  int find(std::string_view property_name) const;
  // The fewest bytes that one of these elements takes in the file.
  uint64_t least_bytes(PlyFormat format) const;
};

struct PlyHeader {
  PlyFormat format = PlyFormat::ascii;
  std::vector<PlyElement> elements;
  std::string texture_name;  // comment TextureFile NAME
  size_t data_offset = 0;
};

Result<PlyHeader> parse_ply_header(std::span<const uint8_t> bytes);

}  // namespace pac::raster
