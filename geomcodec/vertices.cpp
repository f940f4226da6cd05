#include "geomcodec/vertices.h"

#include "geomcodec/color_coder.h"
#include "geomcodec/position_coder.h"
#include "geomcodec/table_positions.h"

namespace pac::geomcodec {
namespace {

// code_position(v, stencil): of a vertex whose stencil is given.
template <class Coder, class CodePosition>
bool decode_both(Coder& of_positions, Coder& of_colors, const AttributeMesh& mesh, bool trained,
                 std::span<const Position> positions, bool with_twists, CodePosition code_position,
                 std::span<QuantizedVertex> vertices, VertexFailure& failure) {
  const auto failed = [&](bool in_colors, const char* text) {
    failure = {in_colors, Failure{Error::corrupt, 0, text}};
    return false;
  };
  ColorCoder<Coder> color_coder(mesh, of_colors, trained);
  color_coder.begin(vertices);
  Stencil stencil;
  for (uint32_t v = 0; v < vertices.size(); ++v) {
    mesh.stencils.get(v, with_twists, stencil);
    code_position(v, stencil);
    color_coder.code(v, stencil, vertices);
    if (of_positions.failed()) return failed(false, "positions end too early");
    if (of_colors.failed()) return failed(true, "vertex attributes end too early");
    std::copy(positions[v].begin(), positions[v].end(), vertices[v].position);
  }
  if (!of_positions.ends_exactly()) return failed(false, "positions do not end where the header says");
  if (!of_colors.ends_exactly()) return failed(true, "vertex attributes do not end where the header says");
  return true;
}

}  // namespace

bool decode_positions_and_colors(std::span<const uint8_t> position_bytes, std::span<const uint8_t> color_bytes,
                                 const AttributeMesh& mesh, int position_bits, bool trained, bool chooses,
                                 std::span<QuantizedVertex> vertices, VertexFailure& failure) {
  RangeDecoder of_positions(position_bytes), of_colors(color_bytes);
  PositionWeights weights;
  weights.chooses = chooses;
  code_weights(of_positions, weights);
  PositionCoder<RangeDecoder> coder(mesh.topology, mesh.stencils, of_positions, weights, position_bits, trained);
  std::vector<Position> positions(vertices.size());
  const auto code_position = [&](uint32_t v, const Stencil& stencil) {
    if (weights.raw)
      coder.code(v, positions);
    else
      coder.code(v, stencil, positions);
  };
  return decode_both(of_positions, of_colors, mesh, trained, positions, weights.twisted(), code_position, vertices,
                     failure);
}

bool decode_positions_and_colors_by_tables(std::span<const uint8_t> position_bytes,
                                           std::span<const uint8_t> color_bytes, const AttributeMesh& mesh,
                                           int position_bits, std::span<QuantizedVertex> vertices,
                                           VertexFailure& failure) {
  SymbolTables position_tables, color_tables;
  TableDecoder of_positions(position_bytes, kPositionContexts, position_tables);
  TableDecoder of_colors(color_bytes, kAttributeContexts, color_tables);
  PositionWeights weights;
  code_table_weights(of_positions, weights);
  std::vector<KnownPosition> known(vertices.size());
  std::vector<Position> positions(vertices.size());
  TablePositionCoder<TableDecoder> coder(of_positions, weights, position_bits, known);
  const auto code_position = [&](uint32_t v, const Stencil& stencil) { coder.code(v, stencil, positions[v]); };
  return decode_both(of_positions, of_colors, mesh, false, positions, false, code_position, vertices, failure);
}

}  // namespace pac::geomcodec
