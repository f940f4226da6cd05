// Lossless compression of quantized polygon meshes: the scheme that Levoy 1995, section 3, proposes and estimates.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/mesh.h"
#include "base/result.h"

namespace pac::geomcodec {

// Three fixed-point coordinates and a color: the paper's 10-byte vertex.
struct QuantizedVertex {
  uint16_t position[3] = {0, 0, 0};
  uint8_t color[4] = {255, 255, 255, 255};
  bool operator==(const QuantizedVertex&) const = default;
};

// A mesh on an integer grid. position = origin + grid * step, per axis.
struct QuantizedMesh {
  std::vector<QuantizedVertex> vertices;
  std::vector<uint32_t> indices;
  std::vector<Face> faces;
  int position_bits = 16;  // 1..16
  float origin[3] = {0, 0, 0};
  float step[3] = {1, 1, 1};
};

// The only lossy step: rounds to the grid that `position_bits` (1..16) lays over the bounding box; drops normals and
// texture coordinates. Fails with bad_argument (bits) or corrupt (position not finite).
Result<QuantizedMesh> quantize(const Mesh& mesh, int position_bits);

// Positions back as floats (one rounding rule on every machine).
Mesh dequantize(const QuantizedMesh& mesh);

struct EncodeOptions {
  bool keep_order = false;  // vertices and faces come back in the order given, else in the order that codes best
};
struct EncodedSize {
  uint64_t header_bytes = 0, connectivity_bytes = 0, position_bytes = 0, color_bytes = 0;
};

Result<std::vector<uint8_t>> encode(const QuantizedMesh& mesh, const EncodeOptions& options = {},
                                    EncodedSize* size = nullptr);
Result<QuantizedMesh> decode(std::span<const uint8_t> bytes, const Limits& limits = {});

}  // namespace pac::geomcodec
