// Adaptive binary arithmetic coding: a range coder with a 64-bit interval that is renormalized by 32 bits, with carry
// [Martin 1979, "Range encoding"]. Encoder and decoder have the same member functions, so that one template per syntax
// element serves both: the encoder codes the value it is given and returns it, the decoder ignores the argument and
// returns what it read. FORMAT.md section 3.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace pac::geomcodec {

// The probability that a bit is 1, learned from the bits seen. The step towards each new bit is 1/(n + 1.5) at the n-th
// bit and never below 1/kSlowest: running mean first (small meshes live on it), exponential forgetting later.
struct AdaptiveBit {
  static constexpr int kSlowest = 24;      // measured: 16 suits meshes below 1,000 faces, 60 those above 50,000
  static constexpr int kCertain = 32;      // probabilities stay in [kCertain, 65536 - kCertain] / 65536
  uint16_t probability_of_one = 1u << 15;  // / 65536
  uint16_t step_index = 0;  // not a byte: stores through bytes may alias anything, the coder's state included

  void update(uint32_t bit);
};

// kStep[n] = round(65536 / (n + 1.5)), the last one standing for all later bits.
inline constexpr std::array<uint16_t, AdaptiveBit::kSlowest> kStep = [] {
  std::array<uint16_t, AdaptiveBit::kSlowest> steps{};
  for (uint32_t n = 0; n < steps.size(); ++n)
    steps[n] = static_cast<uint16_t>((2 * 131072 + (2 * n + 3)) / (2 * (2 * n + 3)));
  return steps;
}();

inline void AdaptiveBit::update(uint32_t bit) {
  const int32_t target = bit != 0 ? 65536 - kCertain : kCertain;
  // |target - p| < 2^16 and the step is below 2^16: the product needs 33 bits. >> rounds towards minus infinity.
  const int64_t change = (int64_t{target} - probability_of_one) * kStep[step_index] >> 16;
  probability_of_one = static_cast<uint16_t>(probability_of_one + change);
  step_index = static_cast<uint16_t>(step_index + (step_index + 1 < kSlowest ? 1 : 0));
}

// The probability of 1 where two contexts predict the same bit: their mean, each weighted by its certainty, that is by
// the reciprocal of its distance from 0 or 1 (here: by the other's distance), so that a context that knows outvotes
// one that is new. Between the two, so at least kCertain.
inline uint32_t mixed_probability(const AdaptiveBit& first, const AdaptiveBit& second) {
  constexpr uint32_t kSoftening = 256;
  const uint32_t p = first.probability_of_one, q = second.probability_of_one;
  const uint32_t weight_p = (q < 32768 ? q : 65536 - q) + kSoftening;
  const uint32_t weight_q = (p < 32768 ? p : 65536 - p) + kSoftening;
  // Below 2^32: where p > 2^15, weight_q falls as p rises.
  return (p * weight_p + q * weight_q) / (weight_p + weight_q);
}

inline constexpr int kSymbolBits = 20;  // probabilities of symbols are in 2^-20

class RangeEncoder {
 public:
  static constexpr bool kDecodes = false;

  uint32_t bit(AdaptiveBit& model, uint32_t bit) {
    narrow(model.probability_of_one, bit);
    model.update(bit);
    return bit;
  }
  // One bit that two contexts predict; both learn.
  uint32_t bit(AdaptiveBit& first, AdaptiveBit& second, uint32_t bit) {
    narrow(mixed_probability(first, second), bit);
    first.update(bit);
    second.update(bit);
    return bit;
  }
  // The low `count` (0..16) bits of value, equally probable.
  uint32_t raw(int count, uint32_t value) {
    range_ >>= count;
    add(range_ * value);
    normalize();
    return value;
  }
  // One of several symbols: it owns [start, start + size) of 0 .. 2^kSymbolBits - 1; size > 0.
  void symbol(uint32_t start, uint32_t size) {
    range_ >>= kSymbolBits;
    add(range_ * start);
    range_ *= size;
    normalize();
  }
  bool failed() const { return false; }
  uint64_t bytes_so_far() const { return bytes_.size(); }
  // The shortest byte string that decodes to what was coded. Leaves the encoder unusable.
  std::vector<uint8_t> finish();

 private:
  void narrow(uint32_t probability_of_one, uint32_t bit) {
    const uint64_t ones = (range_ >> 16) * probability_of_one;  // the lower part of the interval stands for 1
    if (bit != 0) {
      range_ = ones;
    } else {
      add(ones);
      range_ -= ones;
    }
    normalize();
  }
  void add(uint64_t offset) {
    low_ += offset;
    if (low_ < offset) carry();
  }
  void normalize() {
    if (range_ >> 32 == 0) emit_word();
  }
  void carry();
  void emit_word();

  // The interval is [low_, low_ + range_), range_ >= 2^32 between calls; with 16-bit probabilities of at least 32,
  // raw() of at most 16 bits and symbols of at least 2^6 it never falls below 2^16 before normalize(), which multiplies
  // by 2^32.
  uint64_t low_ = 0, range_ = ~uint64_t{0};
  std::vector<uint8_t> bytes_;
};

// Sticky: past the end it reads zeros; failed() tells once more of them were needed than any encoder leaves out.
class RangeDecoder {
 public:
  static constexpr bool kDecodes = true;

  explicit RangeDecoder(std::span<const uint8_t> bytes) : data_(bytes.data()), size_(bytes.size()) {
    code_ = uint64_t{next_word()} << 32;
    code_ |= next_word();
  }
  uint32_t bit(AdaptiveBit& model, uint32_t /*unused*/ = 0) {
    const uint32_t bit = narrow(model.probability_of_one);
    model.update(bit);
    return bit;
  }
  uint32_t bit(AdaptiveBit& first, AdaptiveBit& second, uint32_t /*unused*/ = 0) {
    const uint32_t bit = narrow(mixed_probability(first, second));
    first.update(bit);
    second.update(bit);
    return bit;
  }
  uint32_t raw(int count, uint32_t /*unused*/ = 0) {
    range_ >>= count;
    const uint64_t limit = (uint64_t{1} << count) - 1;
    const uint64_t value = code_ / range_ < limit ? code_ / range_ : limit;
    code_ -= value * range_;
    normalize();
    return static_cast<uint32_t>(value);
  }
  // Where in 0 .. 2^kSymbolBits - 1 the next symbol lies; symbol() with what this symbol owns must follow.
  uint32_t symbol_position() {
    range_ >>= kSymbolBits;
    constexpr uint64_t kLimit = (uint64_t{1} << kSymbolBits) - 1;
    const uint64_t position = code_ / range_;
    return static_cast<uint32_t>(position < kLimit ? position : kLimit);
  }
  void symbol(uint32_t start, uint32_t size) {
    code_ -= range_ * start;
    range_ *= size;
    normalize();
  }
  // More than the 8 bytes that an encoder may leave out were read past the end.
  bool failed() const { return position_ > size_ + 8; }
  // Everything was read and nothing else: what finish() wrote, to the byte.
  bool ends_exactly() const { return !failed() && position_ >= size_; }

 private:
  uint32_t narrow(uint32_t probability_of_one) {
    const uint64_t ones = (range_ >> 16) * probability_of_one;
    const uint32_t bit = code_ < ones ? 1 : 0;
    if (bit != 0) {
      range_ = ones;
    } else {
      code_ -= ones;
      range_ -= ones;
    }
    normalize();
    return bit;
  }
  void normalize() {
    if (range_ >> 32 != 0) return;
    range_ <<= 32;
    code_ = code_ << 32 | next_word();
  }
  uint32_t next_word() {
    const uint64_t at = position_;
    position_ += 4;
    if (size_ < 4 || at > size_ - 4) return last_word(data_, size_, at);
    const uint8_t* bytes = data_ + at;
    return uint32_t{bytes[0]} << 24 | uint32_t{bytes[1]} << 16 | uint32_t{bytes[2]} << 8 | bytes[3];
  }
  // The word at `at`, zeros past the end. By value, so that a decoder's own state need not be in memory.
  static uint32_t last_word(const uint8_t* data, uint64_t size, uint64_t at);

  const uint8_t* data_;
  uint64_t size_;
  uint64_t position_ = 0;  // bytes delivered, those past the end included
  uint64_t code_ = 0, range_ = ~uint64_t{0};
};

// What a loop codes with: a decoder as a copy of its own, which compilers keep in registers, an encoder in place.
//   HeldCoder<Coder> held = coder; ... release(coder, held);
template <class Coder>
using HeldCoder = std::conditional_t<Coder::kDecodes, Coder, Coder&>;
inline void release(RangeDecoder& coder, const RangeDecoder& held) {
  coder = held;
}
inline void release(RangeEncoder& /*coder*/, const RangeEncoder& /*held*/) {}

}  // namespace pac::geomcodec
