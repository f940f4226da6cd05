// The statements of an OBJ file as written, before vertices are joined and materials looked up.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "raster/load_obj.h"

namespace pac::raster {

// Corner of a face: zero-based numbers, kAbsent where the statement gives none.
struct ObjCorner {
  static constexpr uint32_t kAbsent = 0xFFFFFFFFu;
  uint32_t position = 0, texcoord = kAbsent, normal = kAbsent;
};

struct ObjFace {
  uint32_t first = 0, count = 0;  // corners
  uint32_t material = 0;          // into ObjFile::materials
  uint32_t smoothing_group = 0;   // 0 = flat
  uint64_t byte_offset = 0;       // of its line
};

struct ObjFile {
  std::vector<float> positions;    // 3 each, finite
  std::vector<uint8_t> colors;     // RGBA each, parallel to positions once any vertex has a color; else empty
  std::vector<float> texcoords;    // 2 each, as written (v up)
  std::vector<float> normals;      // 3 each, as written
  std::vector<ObjCorner> corners;  // all inside the arrays above
  std::vector<ObjFace> faces;      // count >= 3
  std::vector<std::string> materials = {""};  // usemtl names; 0 = faces before any usemtl
  std::vector<std::string> libraries;         // mtllib statements
  bool has_smoothing = false;                 // the file has `s` statements: they rule, not the crease angle
};

// Adds to `warnings` what it skips. Failures as load_obj().
Result<ObjFile> parse_obj(std::span<const uint8_t> bytes, const Limits& limits, std::vector<Warning>& warnings);

}  // namespace pac::raster
