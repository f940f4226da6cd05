// Symbols of 16 values with adaptive probabilities, and signed residuals made of them: a magnitude class (its bit
// length), the sign with the bits below the leading one, the rest raw. FORMAT.md section 3.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "geomcodec/range_coder.h"

namespace pac::geomcodec {

// How probable each of 16 symbols is, learned from those seen: all starts move towards where the new symbol would
// put them, at first by 1/2, then 1/(n + 1.6), never less than a slowest step. Each symbol keeps kFloor: two
// neighboring starts move by the same rule, so their distance falls only towards kFloor and stops there.
struct SymbolModel {
  static constexpr int kSymbols = 16;
  static constexpr int kTotal = 1 << 15;
  static constexpr int kFloor = 2;
  // The slowest steps: of the first and of the second of two models that predict a symbol, of one that does so alone.
  // One slow and one fast model did better than any one speed (measured on the meshes of bench/peers/geom_peers).
  static constexpr int16_t kSlow = 128, kFast = 18, kAlone = 64;
  static constexpr int kTrusted = 31;  // counts of symbols seen, as weights use them

  int16_t start[kSymbols];  // of kTotal: probability of a lower symbol
  int16_t seen;             // symbols, at most the slowest step's; not a byte, as in AdaptiveBit

  // Equal probabilities for the lowest n_used symbols; the others have kFloor.
  explicit constexpr SymbolModel(int n_used) : start{}, seen(0) {
    const int spare = kTotal - kFloor * kSymbols;
    for (int i = 0; i < kSymbols; ++i)
      start[i] = static_cast<int16_t>(kFloor * i + spare * std::min(i, n_used) / n_used);
  }
  constexpr SymbolModel();
  void update(uint32_t symbol, int16_t slowest);
};

inline constexpr SymbolModel kEqualSymbols(SymbolModel::kSymbols);
constexpr SymbolModel::SymbolModel() : SymbolModel(kEqualSymbols) {}

// kTargetStart[s]: the starts that give symbol s all but the floors.
inline constexpr auto kTargetStart = [] {
  std::array<std::array<int16_t, SymbolModel::kSymbols>, SymbolModel::kSymbols> target{};
  for (int s = 0; s < SymbolModel::kSymbols; ++s)
    for (int i = 0; i < SymbolModel::kSymbols; ++i)
      target[static_cast<size_t>(s)][static_cast<size_t>(i)] = static_cast<int16_t>(
          i <= s ? SymbolModel::kFloor * i : SymbolModel::kTotal - SymbolModel::kFloor * (SymbolModel::kSymbols - i));
  return target;
}();

// In 1/65536; below 1/2, so that it fits an int16_t: products then vectorize.
inline constexpr auto kSymbolStep = [] {
  std::array<int16_t, SymbolModel::kSlow + 1> step{};
  for (int n = 0; n <= SymbolModel::kSlow; ++n) {
    const int value = 655360 / (10 * n + 16);
    step[static_cast<size_t>(n)] = static_cast<int16_t>(value < 32767 ? value : 32767);
  }
  return step;
}();

inline void SymbolModel::update(uint32_t symbol, int16_t slowest) {
  const int16_t step = kSymbolStep[static_cast<size_t>(seen)];
  const int16_t* target = kTargetStart[symbol].data();
  PAC_KEEP_LOOP
  for (int i = 0; i < kSymbols; ++i) {
    const auto distance = static_cast<int16_t>(target[i] - start[i]);  // within +-32767
    start[i] = static_cast<int16_t>(start[i] + (distance * step >> 16));
  }
  seen = static_cast<int16_t>(seen + (seen < slowest ? 1 : 0));
}

// [a][b]: the weight, of 32, of a model that has seen a symbols where the other has seen b: clamp(round(32 (a + 1),
// a + b + 2), 1, 31). A table: no division where symbols are coded.
inline constexpr auto kSymbolWeight = [] {
  constexpr int kCounts = SymbolModel::kTrusted + 1;
  std::array<std::array<uint8_t, kCounts>, kCounts> weight{};
  for (int a = 1; a <= kCounts; ++a)
    for (int b = 1; b <= kCounts; ++b)
      weight[static_cast<size_t>(a - 1)][static_cast<size_t>(b - 1)] =
          static_cast<uint8_t>(std::clamp((32 * a + (a + b) / 2) / (a + b), 1, 31));
  return weight;
}();

// Where symbols start by one model, or by two that are weighted by how many symbols each has seen. Sixteen bits each,
// which vector instructions multiply eight at a time; before the coder's own state is needed.
inline Starts starts_of(const SymbolModel& model) {
  Starts starts;
  PAC_KEEP_LOOP
  for (int i = 0; i < SymbolModel::kSymbols; ++i) starts.at[i] = static_cast<uint16_t>(model.start[i] * 2);
  return starts;
}
// Each share is rounded down. Neighboring starts differ by 4 / 65536 at least in either model, so by
// floor(w / 8) + floor((32 - w) / 8) >= 3 here.
inline Starts starts_of(const SymbolModel& one, const SymbolModel& two) {
  const auto a = static_cast<size_t>(std::min<int16_t>(one.seen, SymbolModel::kTrusted));
  const auto b = static_cast<size_t>(std::min<int16_t>(two.seen, SymbolModel::kTrusted));
  const uint32_t weight = kSymbolWeight[a][b];
  const auto weight_one = static_cast<uint16_t>(weight << 11), weight_two = static_cast<uint16_t>((32 - weight) << 11);
  Starts starts;
  PAC_KEEP_LOOP
  for (int i = 0; i < SymbolModel::kSymbols; ++i) {
    const auto from_one = static_cast<uint16_t>(one.start[i] * 2), from_two = static_cast<uint16_t>(two.start[i] * 2);
    starts.at[i] = static_cast<uint16_t>(static_cast<uint16_t>(uint32_t{from_one} * weight_one >> 16) +
                                         static_cast<uint16_t>(uint32_t{from_two} * weight_two >> 16));
  }
  return starts;
}

// A symbol that two contexts predict; both learn. Inlined wherever residuals are coded, so that a decoder's state stays
// in registers (HeldCoder).
template <class Coder>
[[gnu::always_inline]] inline uint32_t code_symbol(Coder& coder, SymbolModel& one, SymbolModel& two,
                                                   uint32_t symbol = 0) {
  symbol = coder.symbol(starts_of(one, two), symbol);
  one.update(symbol, SymbolModel::kSlow);
  two.update(symbol, SymbolModel::kFast);
  return symbol;
}

template <class Coder>
[[gnu::always_inline]] inline uint32_t code_symbol(Coder& coder, SymbolModel& model, uint32_t symbol = 0) {
  symbol = coder.symbol(starts_of(model), symbol);
  model.update(symbol, SymbolModel::kAlone);
  return symbol;
}

// Magnitude class of a residual: 0 for 0, else the bit length of its absolute value; at most 16.
inline uint32_t class_of(int32_t residual) {
  return static_cast<uint32_t>(std::bit_width(static_cast<uint32_t>(residual < 0 ? -residual : residual)));
}
inline constexpr uint32_t kClasses = 17;

// What a magnitude class is like where the classes around have a mean of `halves` / 2: what the first residuals of a
// context meet. Weights by the distance of twice the class from `halves`.
inline constexpr int kExpectedHalves = 2 * kClasses + 2;
inline constexpr auto kExpecting = [] {
  constexpr int kWeight[12] = {1024, 920, 640, 380, 210, 115, 62, 33, 18, 10, 6, 4};
  constexpr int16_t kTrust = 3;  // as if so many symbols had been seen
  std::array<SymbolModel, kExpectedHalves> models = {};
  for (int halves = 0; halves < kExpectedHalves; ++halves) {
    int sum[SymbolModel::kSymbols + 1] = {};
    for (int c = 0; c < SymbolModel::kSymbols; ++c) {
      const int distance = 2 * c > halves ? 2 * c - halves : halves - 2 * c;
      sum[c + 1] = sum[c] + kWeight[distance < 11 ? distance : 11];
    }
    SymbolModel& model = models[static_cast<size_t>(halves)];
    for (int c = 0; c < SymbolModel::kSymbols; ++c)
      model.start[c] = static_cast<int16_t>(SymbolModel::kFloor * c +
                                            (SymbolModel::kTotal - SymbolModel::kFloor * SymbolModel::kSymbols) *
                                                int64_t{sum[c]} / sum[SymbolModel::kSymbols]);
    model.seen = kTrust;
  }
  return models;
}();

// The two sets of models of the magnitude classes of one component in one basis, by what was met before.
template <size_t kOthers>
struct ClassModels {
  SymbolModel by_scale[2 * kClasses];  // mean class of the neighbors' residuals in halves
  SymbolModel by_other[kOthers];       // a class of this vertex
  ClassModels() {
    for (size_t i = 0; i < 2 * kClasses; ++i) by_scale[i] = kExpecting[i];
    for (size_t i = 0; i < kOthers; ++i) by_other[i] = kExpecting[2 * i];
  }
  // What training found instead: 2 * kClasses models by scale, then those by other.
  template <size_t kCount>
  void start_from(const std::array<SymbolModel, kCount>& trained) {
    static_assert(kCount >= 2 * kClasses + kOthers);
    std::copy_n(trained.begin(), 2 * kClasses, by_scale);
    std::copy_n(trained.begin() + 2 * kClasses, kOthers, by_other);
  }
};

// The sign and at most three bits below the leading one, by class.
struct DetailModel {
  SymbolModel of_class[kClasses];
  constexpr DetailModel() {
    for (int c = 1; c < static_cast<int>(kClasses); ++c) of_class[c] = SymbolModel(c >= 4 ? 16 : 1 << c);
  }
};

// residual within -2^15 .. 2^15. The two `classes` models predict the class (15 stands for 15 and 16), `details` the
// rest.
template <class Coder>
[[gnu::always_inline]] inline int32_t code_residual(Coder& coder, SymbolModel& classes_one, SymbolModel& classes_two,
                                                    DetailModel& details, int32_t residual = 0) {
  if constexpr (Coder::kDecodes) residual = 0;  // whatever the caller had: a class of 16 would count below
  uint32_t length = class_of(residual);
  length = code_symbol(coder, classes_one, classes_two, std::min(length, 15u)) + (length == 16 ? 1 : 0);
  if (length == 0) return 0;
  if (length >= 15) length = 15 + coder.raw(1, length - 15);
  const int below = static_cast<int>(length) - 1, modeled = std::min(below, 3), left = below - modeled;
  const auto magnitude = static_cast<uint32_t>(residual < 0 ? -residual : residual);
  const uint32_t mask = (1u << modeled) - 1;
  uint32_t detail = (residual < 0 ? 1u << modeled : 0) | (magnitude >> left & mask);
  detail = code_symbol(coder, details.of_class[length], detail) & ((2u << modeled) - 1);
  uint32_t result = 1u << modeled | (detail & mask);
  if (left > 0) result = result << left | coder.raw(left, magnitude & ((1u << left) - 1));
  return detail >> modeled != 0 ? -static_cast<int32_t>(result) : static_cast<int32_t>(result);
}

}  // namespace pac::geomcodec
