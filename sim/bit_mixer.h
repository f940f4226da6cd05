// The probability of a bit from several contexts at once: each context's own estimate in the logistic domain, weighted
// by weights that learn [Mahoney 2005, "Adaptive weighing of context models for lossless data compression"]. Integers
// throughout: equal on every machine. The bits go through geomcodec's range coder.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/fixed_log2.h"
#include "geomcodec/range_coder.h"

namespace pac::sim {

namespace bit_mixer {

constexpr int kLimit = 2047;  // of logits, in 1/256
constexpr int kWeightOne = 1 << 16;

// e^x, -8 <= x <= 8, by halving and squaring: the compiler's IEEE arithmetic, the same everywhere.
constexpr double exponential(double x) {
  const double reduced = x / 256;
  double term = 1, sum = 1;
  for (int k = 1; k < 8; ++k) {
    term *= reduced / k;
    sum += term;
  }
  for (int k = 0; k < 8; ++k) sum *= sum;
  return sum;
}

// Probability of 1 in 1/65536 of each logit.
inline constexpr auto kSquash = [] {
  std::array<uint16_t, 2 * kLimit + 1> table{};
  for (int d = -kLimit; d <= kLimit; ++d)
    table[static_cast<size_t>(d + kLimit)] = static_cast<uint16_t>(65536 / (1 + exponential(-d / 256.0)));
  return table;
}();

// The inverse, of probabilities in 1/4096.
inline constexpr auto kStretch = [] {
  std::array<int16_t, 4096> table{};
  int d = -kLimit;
  for (int p = 0; p < 4096; ++p) {
    while (d < kLimit && kSquash[static_cast<size_t>(d + kLimit)] < 16 * p + 8) ++d;
    table[static_cast<size_t>(p)] = static_cast<int16_t>(d);
  }
  return table;
}();

// What a bit costs, in 1/256 bit, by the probability of its value in 1/4096.
inline constexpr auto kBitCost = [] {
  std::array<uint16_t, 4096> table{};
  table[0] = 12 * 256;
  for (uint32_t p = 1; p < 4096; ++p) table[p] = static_cast<uint16_t>((12 * 512 - fixed_log2(p, 9) + 1) / 2);
  return table;
}();

}  // namespace bit_mixer

// One object holds what was learned; copies of it go on from there.
class BitMixer {
 public:
  static constexpr size_t kMaxContexts = 8;

  // n_contexts slots in all; n_sets of weights.
  BitMixer(size_t n_contexts, size_t n_sets) : slots_(n_contexts), weights_(n_sets) {
    for (auto& set : weights_) set.fill(kFirstWeight);
  }

  // Codes (or, with a RangeDecoder, reads) one bit that n contexts predict, slots contexts[0..n); `set`: whose weights.
  template <class Coder>
  uint32_t code(Coder& coder, const uint32_t* contexts, size_t n, size_t set, uint32_t bit) {
    int32_t logits[kMaxContexts];
    const uint32_t squashed = mix(contexts, n, set, logits);
    geomcodec::AdaptiveBit model;
    model.probability_of_one = within_limits(squashed);
    bit = coder.bit(model, bit);
    const int32_t error = (static_cast<int32_t>(bit << 16) - static_cast<int32_t>(squashed)) >> 4;
    std::array<int32_t, kMaxContexts>& weights = weights_[set];
    for (size_t i = 0; i < n; ++i) {
      weights[i] = std::clamp(weights[i] + ((logits[i] * error * kLearning) >> 16), -kGreatestWeight, kGreatestWeight);
      slots_[contexts[i]].update(bit);
    }
    return bit;
  }

  // What code() would spend on a 0 and on a 1, in 1/256 bit; nothing is learned.
  struct Price {
    uint32_t of[2];
  };
  Price price(const uint32_t* contexts, size_t n, size_t set) const {
    int32_t logits[kMaxContexts];
    const uint32_t one = within_limits(mix(contexts, n, set, logits));
    return {{bit_mixer::kBitCost[(65536 - one) >> 4], bit_mixer::kBitCost[one >> 4]}};
  }

  // What was learned counts for `trusted` bits a context at most: the next ones teach faster.
  void loosen(uint8_t trusted) {
    for (Slot& slot : slots_) slot.seen = std::min(slot.seen, trusted);
  }

 private:
  static constexpr int kSlowest = 80;  // a slot moves by 1/(seen + 1.5) of the error
  static constexpr int32_t kFirstWeight = 12000, kLearning = 28, kGreatestWeight = 1 << 22;

  static uint16_t within_limits(uint32_t probability) {
    constexpr uint32_t kLeast = geomcodec::AdaptiveBit::kCertain;
    return static_cast<uint16_t>(std::clamp(probability, kLeast, 65536 - kLeast));
  }

  // Probability of 1 in 1/65536, and the logits it was mixed of.
  uint32_t mix(const uint32_t* contexts, size_t n, size_t set, int32_t* logits) const {
    const std::array<int32_t, kMaxContexts>& weights = weights_[set];
    int64_t sum = 0;
    for (size_t i = 0; i < n; ++i) {
      const Slot& slot = slots_[contexts[i]];
      logits[i] = bit_mixer::kStretch[slot.probability >> 4] * kConfidence[slot.seen] / 256;
      sum += int64_t{weights[i]} * logits[i];
    }
    const int64_t logit = sum / bit_mixer::kWeightOne;
    const int within = static_cast<int>(logit < -bit_mixer::kLimit  ? -bit_mixer::kLimit
                                        : logit > bit_mixer::kLimit ? bit_mixer::kLimit
                                                                    : logit);
    return bit_mixer::kSquash[static_cast<size_t>(within + bit_mixer::kLimit)];
  }

  // What a slot's estimate is worth after so many bits, /256.
  static constexpr auto kConfidence = [] {
    std::array<int32_t, kSlowest + 1> table{};
    for (int n = 0; n <= kSlowest; ++n) table[static_cast<size_t>(n)] = 256 * n * 10 / (10 * n + 8);
    return table;
  }();
  static constexpr auto kStep = [] {
    std::array<int32_t, kSlowest + 1> table{};
    for (int n = 0; n <= kSlowest; ++n) table[static_cast<size_t>(n)] = 131072 / (2 * n + 3);
    return table;
  }();

  struct Slot {
    uint16_t probability = 1u << 15;  // of 1, / 65536
    uint8_t seen = 0;

    void update(uint32_t bit) {
      const int64_t target = bit != 0 ? 65535 : 0;
      probability = static_cast<uint16_t>(probability + ((target - probability) * kStep[seen] >> 16));
      if (seen < kSlowest) ++seen;
    }
  };

  std::vector<Slot> slots_;
  std::vector<std::array<int32_t, kMaxContexts>> weights_;
};

}  // namespace pac::sim
