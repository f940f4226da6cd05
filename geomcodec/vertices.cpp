#include "geomcodec/vertices.h"

#include "geomcodec/color_coder.h"
#include "geomcodec/position_coder.h"
#include "geomcodec/table_positions.h"

namespace pac::geomcodec {
namespace {

// code_position(v, stencil): of a vertex whose stencil is given.
template <class Positions, class Colors, class CodePosition>
bool decode_both(Positions& of_positions, Colors& of_colors, const AttributeMesh& mesh, bool trained,
                 std::span<const Position> positions, bool with_twists, CodePosition code_position,
                 std::span<QuantizedVertex> vertices, VertexFailure& failure) {
  const auto failed = [&](bool in_colors, const char* text) {
    failure = {in_colors, Failure{Error::corrupt, 0, text}};
    return false;
  };
  ColorCoder<Colors> color_coder(mesh, of_colors, trained);
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

bool decode_positions_and_colors(const CodedVertices& coded, const AttributeMesh& mesh,
                                 std::span<QuantizedVertex> vertices, VertexFailure& failure) {
  std::vector<Position> positions(vertices.size());
  const auto decode_with_colors = [&](auto& of_positions, bool with_twists, auto code_position) {
    const auto decode_from = [&](auto& of_colors) {
      return decode_both(of_positions, of_colors, mesh, coded.trained, positions, with_twists, code_position, vertices,
                         failure);
    };
    if (coded.colors_by_tables) {
      SymbolTables tables;
      TableDecoder of_colors(coded.colors, kAttributeContexts, coded.expected_colors, tables);
      return decode_from(of_colors);
    }
    RangeDecoder of_colors(coded.colors);
    return decode_from(of_colors);
  };
  PositionWeights weights;
  if (coded.positions_by_tables) {
    SymbolTables tables;
    TableDecoder of_positions(coded.positions, kPositionContexts, coded.expected_positions, tables);
    code_table_weights(of_positions, weights);
    std::vector<KnownPosition> known(vertices.size());
    TablePositionCoder<TableDecoder> coder(of_positions, weights, coded.position_bits, known);
    return decode_with_colors(of_positions, false,
                              [&](uint32_t v, const Stencil& stencil) { coder.code(v, stencil, positions[v]); });
  }
  RangeDecoder of_positions(coded.positions);
  weights.chooses = coded.chooses;
  code_weights(of_positions, weights);
  PositionCoder<RangeDecoder> coder(mesh.topology, mesh.stencils, of_positions, weights, coded.position_bits,
                                    coded.trained);
  return decode_with_colors(of_positions, weights.twisted(), [&](uint32_t v, const Stencil& stencil) {
    if (weights.raw)
      coder.code(v, positions);
    else
      coder.code(v, stencil, positions);
  });
}

}  // namespace pac::geomcodec
