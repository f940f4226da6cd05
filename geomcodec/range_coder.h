// Adaptive arithmetic coding: a range coder with a 64-bit interval that is renormalized by 32 bits, with carry
// [Martin 1979, "Range encoding"]. Bits that are as good as random lie beside it, backwards from the end of the
// section, where reading them waits for nothing. Encoder and decoder have the same member functions, so that one
// template per syntax element serves both: the encoder codes the value it is given and returns it, the decoder ignores
// the argument and returns what it read. FORMAT.md section 3.
#pragma once

#include <array>
#include <bit>
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

// Before loops over sixteen symbols: inlined into a loop over components, g++ unrolls them into scalar code before it
// could make vectors of them, which doubles a decoder's time. clang++ does not.
#if defined(__GNUC__) && !defined(__clang__)
#define PAC_KEEP_LOOP _Pragma("GCC unroll 1")
#else
#define PAC_KEEP_LOOP
#endif

// Where each of 16 symbols starts, of 65536: the first at 0, each at least 3 above the one before, the last below
// 65533.
struct Starts {
  static constexpr int kSymbols = 16;
  uint16_t at[kSymbols];
};

// The interval's length as symbols divide it: its 16 leading bits, `scale`, and how many follow, `shift`. Symbol y owns
// what lies from (at[y] * scale >> 16) << shift to where the next one starts, the last one up to scale << shift: at
// least 1 << shift, as scale is at least 2^15; what is above is lost, less than 2^-15 of the interval.
struct Division {
  int shift;
  uint16_t scale;
  explicit Division(uint64_t range)  // at least 2^16
      : shift(static_cast<int>(std::bit_width(range)) - 16), scale(static_cast<uint16_t>(range >> shift)) {}
};

class RangeEncoder {
 public:
  static constexpr bool kDecodes = false, kTables = false, kEstimates = false;

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
    raw_word_ |= uint64_t{value & ((1u << count) - 1)} << raw_count_;
    raw_count_ += count;
    if (raw_count_ >= 48) flush_raw();
    return value;
  }
  // One of sixteen symbols.
  uint32_t symbol(const Starts& starts, uint32_t symbol) {
    const Division division(range_);
    const uint32_t begin = uint32_t{starts.at[symbol]} * division.scale >> 16;
    const uint32_t end =
        symbol + 1 < Starts::kSymbols ? uint32_t{starts.at[symbol + 1]} * division.scale >> 16 : division.scale;
    add(uint64_t{begin} << division.shift);
    range_ = uint64_t{end - begin} << division.shift;
    normalize();
    return symbol;
  }
  bool failed() const { return false; }
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
  void flush_raw();  // whole bytes of raw_word_

  // The interval is [low_, low_ + range_), range_ >= 2^32 between calls; with 16-bit probabilities of at least 32 and
  // symbols of at least 2^17 (Division) it never falls below 2^16 before normalize(), which multiplies by 2^32.
  uint64_t low_ = 0, range_ = ~uint64_t{0};
  std::vector<uint8_t> bytes_;
  std::vector<uint8_t> raw_bytes_;  // the section's last byte first
  uint64_t raw_word_ = 0;           // raw_count_ bits, fewer than 48 between calls, that are in no byte yet
  int raw_count_ = 0;
};

// Sticky: past the end it reads zeros; failed() tells once more of them were needed than any encoder leaves out.
class RangeDecoder {
 public:
  static constexpr bool kDecodes = true, kTables = false, kEstimates = false;

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
    const uint64_t whole = raw_used_ >> 3;  // bytes at the end of which nothing is left
    const uint32_t word = size_ >= whole + 4 ? word_at(data_ + (size_ - whole - 4)) : first_word(data_, size_, whole);
    const uint32_t value = word >> (raw_used_ & 7) & ((1u << count) - 1);  // 7 + 16 bits at most
    raw_used_ += static_cast<uint32_t>(count);
    return value;
  }
  // All sixteen ends at once: a few vector instructions and no division. Ends ascend, so the symbol is the count of
  // those at the code or below, less one.
  [[gnu::always_inline]] uint32_t symbol(const Starts& starts, uint32_t /*unused*/ = 0) {
    const Division division(range_);
    // Below `scale`, as the code is below the range; not so in a broken stream, which then decodes to something else.
    const auto wanted = static_cast<uint16_t>(code_ >> division.shift);
    alignas(16) uint16_t begin[Starts::kSymbols + 1];
    PAC_KEEP_LOOP
    for (int i = 0; i < Starts::kSymbols; ++i)
      begin[i] = static_cast<uint16_t>(uint32_t{starts.at[i]} * division.scale >> 16);
    begin[Starts::kSymbols] = division.scale;
    uint16_t count = 0;
    PAC_KEEP_LOOP
    for (int i = 0; i < Starts::kSymbols; ++i) count = static_cast<uint16_t>(count + (begin[i] <= wanted ? 1 : 0));
    const uint32_t symbol = count - 1u;
    code_ -= uint64_t{begin[symbol]} << division.shift;
    range_ = uint64_t{static_cast<uint16_t>(begin[symbol + 1] - begin[symbol])} << division.shift;
    normalize();
    return symbol;
  }
  // More than the 8 bytes that an encoder may leave out were read past the end, of both kinds together.
  bool failed() const { return position_ + raw_bytes() > size_ + 8; }
  // Everything was read and nothing else: what finish() wrote, to the byte.
  bool ends_exactly() const { return !failed() && position_ + raw_bytes() >= size_; }

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
    return word_at(data_ + at);
  }
  static uint32_t word_at(const uint8_t* bytes) {
    return uint32_t{bytes[0]} << 24 | uint32_t{bytes[1]} << 16 | uint32_t{bytes[2]} << 8 | bytes[3];
  }
  uint64_t raw_bytes() const { return (raw_used_ + 7) >> 3; }
  // The word at `at`, zeros past the end. By value, so that a decoder's own state need not be in memory.
  static uint32_t last_word(const uint8_t* data, uint64_t size, uint64_t at);
  // The word that ends `after` bytes before the end, zeros before the beginning.
  static uint32_t first_word(const uint8_t* data, uint64_t size, uint64_t after);

  const uint8_t* data_;
  uint64_t size_;
  uint64_t position_ = 0;  // bytes delivered, those past the end included
  uint64_t raw_used_ = 0;  // bits delivered from the end
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
