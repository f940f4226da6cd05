#include "geomcodec/color_coder.h"

namespace pac::geomcodec {

std::vector<uint8_t> encode_colors(const AttributeMesh& mesh, std::span<const QuantizedVertex> vertices, bool trained,
                                   bool by_tables) {
  return encode_attribute<ColorCoder>(mesh, vertices, trained, by_tables);
}

Result<void> decode_colors(std::span<const uint8_t> bytes, const AttributeMesh& mesh,
                           std::span<QuantizedVertex> vertices, bool trained, bool by_tables) {
  return decode_attribute<ColorCoder>(bytes, mesh, vertices, trained, by_tables);
}

}  // namespace pac::geomcodec
