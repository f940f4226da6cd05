#include "geomcodec/color_coder.h"

namespace pac::geomcodec {

std::vector<uint8_t> encode_colors(const AttributeMesh& mesh, std::span<const QuantizedVertex> vertices, bool trained,
                                   bool by_tables) {
  if (by_tables) {
    TableEncoder coder(kAttributeContexts);
    ColorCoder<TableEncoder> colors(mesh, coder, trained);
    return encode_attribute(colors, coder, vertices);
  }
  RangeEncoder coder;
  ColorCoder<RangeEncoder> colors(mesh, coder, trained);
  return encode_attribute(colors, coder, vertices);
}

Result<void> decode_colors(std::span<const uint8_t> bytes, const AttributeMesh& mesh,
                           std::span<QuantizedVertex> vertices, bool trained, bool by_tables) {
  if (by_tables) {
    SymbolTables tables;
    TableDecoder coder(bytes, kAttributeContexts, tables);
    ColorCoder<TableDecoder> colors(mesh, coder, trained);
    return decode_attribute(colors, coder, vertices);
  }
  RangeDecoder coder(bytes);
  ColorCoder<RangeDecoder> colors(mesh, coder, trained);
  return decode_attribute(colors, coder, vertices);
}

}  // namespace pac::geomcodec
