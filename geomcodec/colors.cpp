#include "geomcodec/color_coder.h"

namespace pac::geomcodec {

std::vector<uint8_t> encode_colors(const AttributeMesh& mesh, std::span<const QuantizedVertex> vertices, bool trained,
                                   AttributeCoding coding) {
  return encode_attribute<ColorCoder>(mesh, vertices, trained, coding);
}

Result<void> decode_colors(std::span<const uint8_t> bytes, const AttributeMesh& mesh,
                           std::span<QuantizedVertex> vertices, bool trained, AttributeCoding coding) {
  return decode_attribute<ColorCoder>(bytes, mesh, vertices, trained, coding);
}

}  // namespace pac::geomcodec
