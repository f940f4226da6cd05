#include "geomcodec/positions.h"

#include <algorithm>

#include "geomcodec/position_coder.h"

namespace pac::geomcodec {
namespace {

// Choices are made on the whole of a small mesh, else on windows of so many vertices, spread over it: the same choices
// on all of bench/peers/geom_peers as with three times as many.
constexpr size_t kWindow = 128, kWindows = 16, kSmall = 2048;

size_t windows_for(size_t n_positions) {
  return n_positions <= kSmall ? 1 : kWindows;
}

// Where window `window` of `n_windows` begins and ends; the only one holds everything.
struct Window {
  size_t begin, end;
  Window(size_t n_positions, size_t window, size_t n_windows)
      : begin(n_positions * window / n_windows),
        end(n_windows == 1 ? n_positions : std::min(begin + kWindow, n_positions)) {}
};

// The stencils of all vertices in the windows, in order: at most kSmall, which every trial then reads.
std::vector<Stencil> stencils_of_windows(const Stencils& stencils, size_t n_positions, size_t n_windows) {
  std::vector<Stencil> sampled;
  sampled.reserve(kSmall);
  for (size_t i = 0; i < n_windows; ++i) {
    const Window window(n_positions, i, n_windows);
    for (size_t v = window.begin; v < window.end; ++v)
      stencils.get(static_cast<uint32_t>(v), true, sampled.emplace_back());
  }
  return sampled;
}

// The vertices of `n_windows` windows, or all of them as one. sampled: their stencils, or none where the coder is to
// find them.
std::vector<uint8_t> encode_windows(const Topology& topology, const Stencils& stencils,
                                    std::span<const Stencil> sampled, std::vector<Position>& positions,
                                    size_t n_windows, PositionWeights weights, int bits, bool trained) {
  RangeEncoder coder;
  code_weights(coder, weights);
  PositionCoder<RangeEncoder> position_coder(topology, stencils, coder, weights, bits, trained);
  size_t v = 0, n_coded = 0;
  for (size_t i = 0; i < n_windows; ++i) {
    const Window window(positions.size(), i, n_windows);
    for (; v < window.begin; ++v) position_coder.skip(positions[v]);
    for (; v < window.end; ++v) {
      if (sampled.empty())
        position_coder.code(static_cast<uint32_t>(v), positions);
      else
        position_coder.code(static_cast<uint32_t>(v), sampled[n_coded++], positions);
    }
  }
  return coder.finish();
}

// What all positions would take, in bits, by the bytes of `sample` of them: what weights take is paid once.
uint64_t estimate_of(size_t n_bytes, const PositionWeights& weights, size_t n_positions, size_t sample) {
  const uint64_t once = std::min<uint64_t>(weights_bits(weights), 8 * n_bytes);
  return once + (8 * n_bytes - once) * n_positions / std::max<size_t>(sample, 1);
}

}  // namespace

PositionSection encode_positions(const Topology& topology, const Stencils& stencils, std::span<const Position> given,
                                 int bits, bool trained) {
  std::vector<Position> positions(given.begin(), given.end());
  const size_t n_windows = windows_for(positions.size());
  const size_t sample = n_windows == 1 ? positions.size() : n_windows * kWindow;
  const std::vector<Stencil> sampled = stencils_of_windows(stencils, positions.size(), n_windows);
  const auto encode_sample = [&](const PositionWeights& weights) {
    return encode_windows(topology, stencils, sampled, positions, n_windows, weights, bits, trained);
  };
  const auto estimate = [&](const std::vector<uint8_t>& bytes, const PositionWeights& weights) {
    return estimate_of(bytes.size(), weights, positions.size(), sample);
  };
  PositionWeights best;
  std::vector<uint8_t> best_bytes = encode_sample(best);
  uint64_t best_bits = estimate(best_bytes, best);
  const auto try_weights = [&](const PositionWeights& weights) {
    std::vector<uint8_t> bytes = encode_sample(weights);
    const uint64_t size = estimate(bytes, weights);
    if (size >= best_bits) return;
    best_bits = size;
    best_bytes = std::move(bytes);
    best = weights;
  };
  const std::span<const Stencil> first(sampled.data(), n_windows == 1 ? sampled.size() : 0);
  if (const PositionWeights fitted = fit_weights(topology, stencils, first, positions); fitted.customized)
    try_weights(fitted);
  PositionWeights changed = best;
  changed.lifted = true;
  try_weights(changed);
  changed = best;
  changed.exact = true;
  try_weights(changed);
  changed = best;
  changed.period = find_period(positions);
  if (changed.period != 0) try_weights(changed);
  changed = best;
  changed.exact = changed.chooses = true;
  try_weights(changed);
  if (best_bits > uint64_t{3} * static_cast<uint64_t>(bits) * positions.size()) best = {.raw = true};
  if (n_windows > 1 || best.raw) best_bytes = encode_windows(topology, stencils, {}, positions, 1, best, bits, trained);
  return {std::move(best_bytes), best.chooses};
}

uint64_t estimate_positions(const Topology& topology, const Stencils& stencils, std::span<const Position> given,
                            int bits, bool trained, bool chooses) {
  std::vector<Position> positions(given.begin(), given.end());
  const size_t n_windows = windows_for(positions.size());
  const std::vector<Stencil> sampled = stencils_of_windows(stencils, positions.size(), n_windows);
  const PositionWeights weights{.exact = chooses, .chooses = chooses};
  const size_t n_bytes =
      encode_windows(topology, stencils, sampled, positions, n_windows, weights, bits, trained).size();
  return estimate_of(n_bytes, weights, positions.size(), sampled.size());
}

Result<std::vector<Position>> decode_positions(std::span<const uint8_t> bytes, const Topology& topology,
                                               const Stencils& stencils, uint32_t n_positions, int bits, bool trained,
                                               bool chooses) {
  RangeDecoder coder(bytes);
  PositionWeights weights;
  weights.chooses = chooses;
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
