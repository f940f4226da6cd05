#include "geomcodec/positions.h"

#include <algorithm>

#include "geomcodec/position_coder.h"

namespace pac::geomcodec {
namespace {

std::vector<uint8_t> encode_first(const Topology& topology, const Stencils& stencils, std::vector<Position>& positions,
                                  size_t count, PositionWeights weights, int bits, bool trained) {
  RangeEncoder coder;
  code_weights(coder, weights);
  PositionCoder<RangeEncoder> position_coder(topology, stencils, coder, weights, bits, trained);
  for (uint32_t v = 0; v < count; ++v) position_coder.code(v, positions);
  return coder.finish();
}

}  // namespace

std::vector<uint8_t> encode_positions(const Topology& topology, const Stencils& stencils,
                                      std::span<const Position> given, int bits, bool trained) {
  constexpr size_t kSample = 4096;  // choices are made on that many, one after the other
  std::vector<Position> positions(given.begin(), given.end());
  const size_t sample = std::min(kSample, positions.size());
  PositionWeights best;
  std::vector<uint8_t> best_bytes = encode_first(topology, stencils, positions, sample, best, bits, trained);
  const auto try_weights = [&](const PositionWeights& weights) {
    std::vector<uint8_t> bytes = encode_first(topology, stencils, positions, sample, weights, bits, trained);
    if (bytes.size() >= best_bytes.size()) return;
    best_bytes = std::move(bytes);
    best = weights;
  };
  try_weights(fit_weights(topology, stencils, positions));
  PositionWeights changed = best;
  changed.lifted = true;
  try_weights(changed);
  changed = best;
  changed.exact = true;
  try_weights(changed);
  changed = best;
  changed.period = find_period(positions);
  if (changed.period != 0) try_weights(changed);
  if (8 * best_bytes.size() > 3 * static_cast<size_t>(bits) * sample) best.raw = true, best_bytes.clear();
  if (sample == positions.size() && !best.raw) return best_bytes;
  return encode_first(topology, stencils, positions, positions.size(), best, bits, trained);
}

Result<std::vector<Position>> decode_positions(std::span<const uint8_t> bytes, const Topology& topology,
                                               const Stencils& stencils, uint32_t n_positions, int bits, bool trained) {
  RangeDecoder coder(bytes);
  PositionWeights weights;
  code_weights(coder, weights);
  PositionCoder<RangeDecoder> position_coder(topology, stencils, coder, weights, bits, trained);
  std::vector<Position> positions;
  positions.reserve(std::min<size_t>(n_positions, 4096 + 8 * bytes.size()));
  for (uint32_t v = 0; v < n_positions; ++v) {
    positions.emplace_back();
    position_coder.code(v, positions);
    if (coder.failed()) return Failure{Error::corrupt, 0, "positions end too early"};
  }
  if (!coder.ends_exactly()) return Failure{Error::corrupt, 0, "positions do not end where the header says"};
  return positions;
}

}  // namespace pac::geomcodec
