#include "geomcodec/vertices.h"

#include "geomcodec/color_coder.h"
#include "geomcodec/position_coder.h"

namespace pac::geomcodec {

bool decode_positions_and_colors(std::span<const uint8_t> position_bytes, std::span<const uint8_t> color_bytes,
                                 const AttributeMesh& mesh, int position_bits, bool trained,
                                 std::span<QuantizedVertex> vertices, VertexFailure& failure) {
  const auto failed = [&](bool in_colors, const char* text) {
    failure = {in_colors, Failure{Error::corrupt, 0, text}};
    return false;
  };
  RangeDecoder of_positions(position_bytes), of_colors(color_bytes);
  PositionWeights weights;
  code_weights(of_positions, weights);
  PositionCoder<RangeDecoder> position_coder(mesh.topology, mesh.stencils, of_positions, weights, position_bits,
                                             trained);
  ColorCoder<RangeDecoder> color_coder(mesh, of_colors, trained);
  color_coder.begin(vertices);
  std::vector<Position> positions(vertices.size());
  Stencil stencil;
  for (uint32_t v = 0; v < vertices.size(); ++v) {
    mesh.stencils.get(v, true, stencil);
    if (weights.raw)
      position_coder.code(v, positions);
    else
      position_coder.code(v, stencil, positions);
    color_coder.code(v, stencil, vertices);
    if (of_positions.failed()) return failed(false, "positions end too early");
    if (of_colors.failed()) return failed(true, "vertex attributes end too early");
    std::copy(positions[v].begin(), positions[v].end(), vertices[v].position);
  }
  if (!of_positions.ends_exactly()) return failed(false, "positions do not end where the header says");
  if (!of_colors.ends_exactly()) return failed(true, "vertex attributes do not end where the header says");
  return true;
}

}  // namespace pac::geomcodec
