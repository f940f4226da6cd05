#include "geomcodec/positions.h"

#include <algorithm>

#include "geomcodec/position_coder.h"
#include "geomcodec/size_estimator.h"

namespace pac::geomcodec {
namespace {

// Choices are made on the whole of a small mesh, else on windows of so many vertices, spread over it: the same choices
// on all of bench/peers/geom_peers as with three times as many.
constexpr size_t kWindow = 128, kWindows = 16, kSmall = 2048;
// From so many positions on estimates are good enough to choose by.
constexpr size_t kEstimated = 256;

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

// What all trials on one mesh share.
struct Trials {
  const Topology& topology;
  const Stencils& stencils;
  std::vector<Position> positions;
  int bits;
  bool trained;
  PositionParts parts;
  size_t n_windows;
  std::vector<Stencil> sampled;
  bool codes_all;  // nothing is told by estimates alone

  Trials(const Topology& topology_given, const Stencils& stencils_given, std::span<const Position> given,
         int bits_given, bool trained_given, bool all)
      : topology(topology_given),
        stencils(stencils_given),
        positions(given.begin(), given.end()),
        bits(bits_given),
        trained(trained_given),
        parts(topology_given),
        n_windows(windows_for(given.size())),
        sampled(stencils_of_windows(stencils_given, given.size(), n_windows)),
        codes_all(all || given.size() < kEstimated) {}

  // The sampled vertices, by a RangeEncoder or a SizeEstimator.
  template <class Coder>
  void code_sample(Coder& coder, const PositionWeights& weights) {
    PositionCoder<Coder> position_coder(parts, stencils, coder, weights, bits, trained);
    size_t v = 0, n_coded = 0;
    for (size_t i = 0; i < n_windows; ++i) {
      const Window window(positions.size(), i, n_windows);
      for (; v < window.begin; ++v) position_coder.skip(positions[v]);
      for (; v < window.end; ++v) position_coder.code(static_cast<uint32_t>(v), sampled[n_coded++], positions);
    }
  }
  std::vector<uint8_t> encode_sample(PositionWeights weights) {
    RangeEncoder coder;
    code_weights(coder, weights);
    code_sample(coder, weights);
    return coder.finish();
  }
  std::vector<uint8_t> encode_all(PositionWeights weights) {
    RangeEncoder coder;
    code_weights(coder, weights);
    PositionCoder<RangeEncoder> position_coder(parts, stencils, coder, weights, bits, trained);
    for (uint32_t v = 0; v < positions.size(); ++v) position_coder.code(v, positions);
    return coder.finish();
  }
  // What all positions would take, in bits, by what the sample of them takes; weights are paid once.
  uint64_t extrapolated(uint64_t sample_bits) const {
    return sample_bits * positions.size() / std::max<size_t>(sampled.size(), 1);
  }
  // By the sample's bytes.
  uint64_t bits_of(const std::vector<uint8_t>& bytes, const PositionWeights& weights) const {
    const uint64_t all = 8 * bytes.size(), once = std::min<uint64_t>(weights_bits(weights), all);
    return once + extrapolated(all - once);
  }
  uint64_t estimate(const PositionWeights& weights) {
    SizeEstimator estimator;
    code_sample(estimator, weights);
    return weights_bits(weights) + extrapolated(estimator.bits());
  }
};

struct Choice {
  PositionWeights weights;
  uint64_t estimate = 0;        // bits of all positions
  std::vector<uint8_t> sample;  // coded; empty: not yet
};

Choice estimated(Trials& trials, const PositionWeights& weights) {
  return {weights, trials.estimate(weights), {}};
}

// Bits of all positions by coding the sample, once.
uint64_t coded_bits(Trials& trials, Choice& choice) {
  if (choice.sample.empty()) choice.sample = trials.encode_sample(choice.weights);
  return trials.bits_of(choice.sample, choice.weights);
}

// Replaces `best` where `other` takes fewer bits: by estimates where they are farther apart than 1/256, else as coded.
void prefer(Trials& trials, Choice& best, Choice other) {
  const uint64_t lower = std::min(best.estimate, other.estimate), higher = std::max(best.estimate, other.estimate);
  const bool told = !trials.codes_all && (lower == higher || 256 * (higher - lower) > higher);
  const bool is_less = told ? other.estimate < best.estimate : coded_bits(trials, other) < coded_bits(trials, best);
  if (is_less) best = std::move(other);
}

// The parallelograms' corrections, and lifting.
Choice choose_prediction(Trials& trials) {
  Choice best = estimated(trials, {});
  const std::span<const Stencil> first(trials.sampled.data(), trials.n_windows == 1 ? trials.sampled.size() : 0);
  const PositionWeights fitted = fit_weights(trials.topology, trials.stencils, first, trials.positions);
  if (fitted.customized) prefer(trials, best, estimated(trials, fitted));
  PositionWeights lifted = best.weights;
  lifted.lifted = true;
  prefer(trials, best, estimated(trials, lifted));
  return best;
}

// Exact candidates, repetition, choosing. Estimates tell where choosing is better by far and where the others cannot
// pay; else they are coded, as positions that repeat or are hit exactly take other sums than estimates say. Returns
// the bits that choosing is estimated to take if that is a twenty-fifth less, else 0.
uint64_t choose_candidates(Trials& trials, Choice& best) {
  PositionWeights with_exact = best.weights, choosing = best.weights;
  with_exact.exact = choosing.exact = choosing.chooses = true;
  const std::vector<uint32_t> periods = find_periods(trials.positions);
  const bool codes_all = !periods.empty() || trials.codes_all;
  Choice chooses = estimated(trials, choosing);
  const bool gains = periods.empty() && 25 * chooses.estimate < 24 * best.estimate;
  if (gains && (choosing.customized || choosing.lifted)) {  // single parallelograms may be better without
    Choice plainly = estimated(trials, {.exact = true, .chooses = true});
    if (plainly.estimate < chooses.estimate) chooses = std::move(plainly);
    choosing = chooses.weights;
  }
  const uint64_t choosing_bits = gains ? chooses.estimate : 0;
  if (!codes_all && 50 * chooses.estimate < 49 * best.estimate) {
    best = std::move(chooses);
    return choosing_bits;
  }
  const auto try_weights = [&](const PositionWeights& weights) {
    Choice other{weights, 0, {}};
    if (coded_bits(trials, other) < coded_bits(trials, best)) best = std::move(other);
  };
  const bool tries_exact = codes_all || 100 * trials.estimate(with_exact) < 99 * best.estimate;
  const bool tries_choosing = codes_all || 1000 * chooses.estimate < 1003 * best.estimate;
  if (tries_exact) try_weights(with_exact);
  for (const uint32_t period : periods) {
    PositionWeights repeating = best.weights;
    repeating.period = period;
    try_weights(repeating);
  }
  choosing.period = best.weights.period;
  if (tries_choosing) try_weights(choosing);
  return choosing_bits;
}

}  // namespace

PositionSection encode_positions(const Topology& topology, const Stencils& stencils, std::span<const Position> given,
                                 int bits, bool trained, bool codes_all) {
  Trials trials(topology, stencils, given, bits, trained, codes_all);
  Choice best = choose_prediction(trials);
  const uint64_t choosing_bits = choose_candidates(trials, best);
  const uint64_t raw_bits = uint64_t{3} * static_cast<uint64_t>(bits) * given.size();
  const bool raw = (trials.n_windows == 1 || !best.sample.empty() || 10 * best.estimate > 9 * raw_bits) &&
                   coded_bits(trials, best) > raw_bits;
  if (raw) best.weights = {.raw = true};
  const bool is_whole = trials.n_windows == 1 && !raw;
  return {is_whole ? std::move(best.sample) : trials.encode_all(best.weights), best.weights.chooses,
          best.weights.chooses ? choosing_bits : 0};
}

uint64_t estimate_choosing(const Topology& topology, const Stencils& stencils, std::span<const Position> given,
                           int bits) {
  Trials trials(topology, stencils, given, bits, false, false);
  return trials.estimate({.exact = true, .chooses = true});
}

uint64_t estimate_positions(const Topology& topology, const Stencils& stencils, std::span<const Position> given,
                            int bits, bool trained, bool chooses) {
  Trials trials(topology, stencils, given, bits, trained, true);
  const PositionWeights weights{.exact = chooses, .chooses = chooses};
  return trials.bits_of(trials.encode_sample(weights), weights);
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
