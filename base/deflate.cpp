#include "base/deflate.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>

#include "base/checksum.h"
#include "base/deflate_tables.h"
#include "base/huffman_lengths.h"
#include "base/result.h"

namespace pac {
namespace {

// Appends bits, least significant first [RFC 1951 3.1.1].
class LsbWriter {
 public:
  explicit LsbWriter(std::vector<uint8_t>& bytes) : bytes_(bytes) {}

  void put(uint32_t value, int count) {
    window_ |= uint64_t{value} << n_bits_;
    n_bits_ += count;
    while (n_bits_ >= 8) {
      bytes_.push_back(static_cast<uint8_t>(window_));
      window_ >>= 8;
      n_bits_ -= 8;
    }
  }
  void align_to_byte() {
    if (n_bits_ > 0) put(0, 8 - n_bits_);
  }
  int bit_position() const { return n_bits_; }  // in the current byte, 0..7
  void put_bytes(std::span<const uint8_t> bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }

 private:
  std::vector<uint8_t>& bytes_;
  uint64_t window_ = 0;
  int n_bits_ = 0;
};

struct Match {
  size_t length = 0;  // 0 = none
  size_t distance = 0;
};

// Earlier occurrences of the next four bytes: a chain of positions for each hash value, newest first. Deflate's
// matches of three bytes are left out: they seldom pay, and chains over three bytes are several times longer.
class MatchFinder {
 public:
  explicit MatchFinder(std::span<const uint8_t> in) : in_(in), head_(kHashSize, 0), previous_(kWindowSize, 0) {}

  static constexpr size_t kMinLength = 4;

  // Makes `at` findable. Positions are stored plus one, so that 0 ends a chain.
  void insert(size_t at) {
    if (at + kMinLength > in_.size()) return;
    uint32_t& head = head_[hash(at)];
    previous_[at % kWindowSize] = head;
    head = static_cast<uint32_t>(at + 1);
  }

  // The longest match for `at` (nearest first among equals) that is longer than `longer_than`.
  Match find(size_t at, size_t longer_than, int n_tries) const {
    Match best{0, 0};
    const size_t max_length = std::min(kMaxMatch, in_.size() - at);
    size_t best_length = std::max(longer_than, kMinLength - 1);
    if (max_length <= best_length) return best;
    const uint8_t* here = in_.data() + at;
    for (size_t link = head_[hash(at)]; link != 0 && n_tries > 0; --n_tries) {
      const size_t candidate = link - 1;
      if (at - candidate > kWindowSize - 1) break;  // the slot of an older position has been used again
      const uint8_t* there = in_.data() + candidate;
      if (there[best_length] == here[best_length] && there[best_length - 1] == here[best_length - 1]) {
        const size_t length = common_length(here, there, max_length);
        if (length > best_length) {
          best_length = length;
          best = {length, at - candidate};
          if (length == max_length || length >= kNiceLength) break;
        }
      }
      link = previous_[candidate % kWindowSize];
    }
    return best;
  }

 private:
  static constexpr int kHashBits = 15;
  static constexpr size_t kHashSize = size_t{1} << kHashBits;
  static constexpr size_t kNiceLength = 128;

  size_t hash(size_t at) const {
    const uint32_t word =
        uint32_t{in_[at]} | uint32_t{in_[at + 1]} << 8 | uint32_t{in_[at + 2]} << 16 | uint32_t{in_[at + 3]} << 24;
    return word * 0x9E3779B1u >> (32 - kHashBits);  // multiplicative, by 2^32 / golden ratio
  }

  static size_t common_length(const uint8_t* a, const uint8_t* b, size_t max_length) {
    size_t length = 0;
    if constexpr (std::endian::native == std::endian::little) {
      for (; length + 8 <= max_length; length += 8) {
        uint64_t x, y;
        std::memcpy(&x, a + length, 8);
        std::memcpy(&y, b + length, 8);
        if (x != y) return length + static_cast<size_t>(std::countr_zero(x ^ y)) / 8;
      }
    }
    while (length < max_length && a[length] == b[length]) ++length;
    return length;
  }

  std::span<const uint8_t> in_;
  std::vector<uint32_t> head_;      // by hash: newest position + 1
  std::vector<uint32_t> previous_;  // by position mod window: the next older position + 1 of its chain
};

// A literal (distance 0, value in `length`) or a match.
struct Token {
  uint16_t length;
  uint16_t distance;  // 1..32767; 0 = literal
};

struct PrefixCode {
  std::array<uint8_t, 288> lengths{};
  std::array<uint16_t, 288> codes{};
};

PrefixCode make_code(std::span<const uint32_t> frequencies, int max_length) {
  PrefixCode code;
  optimal_code_lengths(frequencies, max_length, std::span(code.lengths).first(frequencies.size()));
  assign_deflate_codes(code.lengths, code.codes);
  return code;
}

PrefixCode make_fixed_code(std::span<const uint8_t> lengths) {
  PrefixCode code;
  std::copy(lengths.begin(), lengths.end(), code.lengths.begin());
  assign_deflate_codes(code.lengths, code.codes);
  return code;
}

// The code lengths of a dynamic block as the symbols of the code-length code [RFC 1951 3.2.7].
struct LengthRun {
  uint8_t symbol;
  uint8_t extra;  // value of the extra bits
};
constexpr int kRunExtraBits[3] = {2, 3, 7};  // of symbols 16, 17, 18

std::vector<LengthRun> run_length_code(std::span<const uint8_t> lengths) {
  std::vector<LengthRun> runs;
  for (size_t i = 0; i < lengths.size();) {
    size_t n = 1;
    while (i + n < lengths.size() && lengths[i + n] == lengths[i]) ++n;
    i += n;
    const uint8_t value = lengths[i - 1];
    if (value != 0) {
      runs.push_back({value, 0});
      --n;
    }
    while (n >= 3) {
      const size_t max_run = value != 0 ? 6 : 138;
      const size_t run = std::min(n, max_run);
      const uint8_t symbol = value != 0 ? 16 : run <= 10 ? 17 : 18;
      runs.push_back({symbol, static_cast<uint8_t>(run - (symbol == 18 ? 11 : 3))});
      n -= run;
    }
    for (; n > 0; --n) runs.push_back({value, 0});
  }
  return runs;
}

// Everything that the header of a dynamic block says.
struct DynamicHeader {
  PrefixCode literals, distances, code_lengths;
  std::vector<LengthRun> runs;
  size_t n_literals = 257, n_distances = 1, n_code_lengths = 4;
  uint64_t size_bits = 0;
};

DynamicHeader make_dynamic_header(std::span<const uint32_t> literal_counts, std::span<const uint32_t> distance_counts) {
  DynamicHeader header;
  header.literals = make_code(literal_counts, kDeflateMaxBits);
  header.distances = make_code(distance_counts, kDeflateMaxBits);
  for (size_t s = 0; s < kLiteralSymbols; ++s)
    if (header.literals.lengths[s] != 0) header.n_literals = std::max(header.n_literals, s + 1);
  for (size_t s = 0; s < kDistanceSymbols; ++s)
    if (header.distances.lengths[s] != 0) header.n_distances = s + 1;
  std::vector<uint8_t> lengths(header.literals.lengths.begin(),
                               header.literals.lengths.begin() + static_cast<ptrdiff_t>(header.n_literals));
  lengths.insert(lengths.end(), header.distances.lengths.begin(),
                 header.distances.lengths.begin() + static_cast<ptrdiff_t>(header.n_distances));
  header.runs = run_length_code(lengths);
  std::array<uint32_t, 19> counts{};
  for (const LengthRun& run : header.runs) ++counts[run.symbol];
  // A code-length code of one symbol would be incomplete, which only literal and distance codes may be.
  if (std::count(counts.begin(), counts.end(), 0u) == 18) ++counts[counts[0] == 0 ? 0 : 1];
  header.code_lengths = make_code(counts, 7);
  for (size_t i = 0; i < 19; ++i)
    if (header.code_lengths.lengths[kCodeLengthOrder[i]] != 0) header.n_code_lengths = std::max(i + 1, size_t{4});
  header.size_bits = 5 + 5 + 4 + 3 * header.n_code_lengths;
  for (const LengthRun& run : header.runs)
    header.size_bits += header.code_lengths.lengths[run.symbol] +
                        static_cast<uint64_t>(run.symbol >= 16 ? kRunExtraBits[run.symbol - 16] : 0);
  return header;
}

// Tells short matches that pay from those whose literals would cost less: filtered pictures have many of the latter.
class Prices {
 public:
  // Guesses from the first bytes; each finished block's code is a better guess for the next one.
  explicit Prices(std::span<const uint8_t> in) {
    std::array<uint32_t, 256> counts{};
    for (uint8_t byte : in.first(std::min(in.size(), kSample))) ++counts[byte];
    optimal_code_lengths(counts, kDeflateMaxBits, literal_bits_);
  }
  void learn(const PrefixCode& literals) {
    std::copy_n(literals.lengths.begin(), literal_bits_.size(), literal_bits_.begin());
  }
  bool pays(std::span<const uint8_t> in, size_t at, const Match& match) const {
    if (match.length > kAlwaysPays) return true;
    int literal_bits = 0;
    for (uint8_t byte : in.subspan(at, match.length))
      literal_bits += literal_bits_[byte] != 0 ? literal_bits_[byte] : kRareLiteralBits;
    const int match_bits = kMatchSymbolBits + kLengthExtraBits[length_index(match.length)] +
                           kDistanceExtraBits[distance_index(match.distance)];
    return match_bits < literal_bits;
  }

 private:
  static constexpr size_t kSample = 32768;
  static constexpr size_t kAlwaysPays = 16;
  static constexpr int kMatchSymbolBits = 12;  // a length symbol and a distance symbol, typically
  static constexpr int kRareLiteralBits = 13;
  std::array<uint8_t, 256> literal_bits_{};
};

// Collects the tokens of one block, then writes it in the shortest of the three ways.
class BlockWriter {
 public:
  static constexpr size_t kMaxTokens = 32768;

  BlockWriter(std::span<const uint8_t> in, std::vector<uint8_t>& out) : in_(in), bits_(out), prices_(in) {
    tokens_.reserve(kMaxTokens);
  }

  void literal(uint8_t value) {
    tokens_.push_back({value, 0});
    ++literal_counts_[value];
    ++n_covered_;
  }
  void match(Match match) {
    tokens_.push_back({static_cast<uint16_t>(match.length), static_cast<uint16_t>(match.distance)});
    ++literal_counts_[kEndOfBlock + 1 + length_index(match.length)];
    ++distance_counts_[distance_index(match.distance)];
    n_covered_ += match.length;
  }
  const Prices& prices() const { return prices_; }
  bool full() const { return tokens_.size() >= kMaxTokens; }

  void flush(bool is_last) {
    ++literal_counts_[kEndOfBlock];
    const DynamicHeader dynamic = make_dynamic_header(literal_counts_, distance_counts_);
    const PrefixCode fixed_literals = make_fixed_code(kFixedLiteralLengths);
    const PrefixCode fixed_distances = make_fixed_code(kFixedDistanceLengths);
    const uint64_t dynamic_bits = 3 + dynamic.size_bits + body_bits(dynamic.literals, dynamic.distances);
    const uint64_t fixed_bits = 3 + body_bits(fixed_literals, fixed_distances);
    if (stored_bits() <= std::min(dynamic_bits, fixed_bits)) {
      write_stored(is_last);
    } else if (fixed_bits <= dynamic_bits) {
      bits_.put((is_last ? 1u : 0u) | 1u << 1, 3);
      write_body(fixed_literals, fixed_distances);
    } else {
      bits_.put((is_last ? 1u : 0u) | 2u << 1, 3);
      write_header(dynamic);
      write_body(dynamic.literals, dynamic.distances);
    }
    prices_.learn(dynamic.literals);
    start_ += n_covered_;
    n_covered_ = 0;
    tokens_.clear();
    literal_counts_.fill(0);
    distance_counts_.fill(0);
  }
  void finish() { bits_.align_to_byte(); }

 private:
  static constexpr size_t kMaxStored = 65535;  // bytes of one stored block [RFC 1951 3.2.4]

  uint64_t body_bits(const PrefixCode& literals, const PrefixCode& distances) const {
    uint64_t bits = 0;
    for (size_t s = 0; s < kLiteralSymbols; ++s) {
      const int extra = s > kEndOfBlock ? kLengthExtraBits[s - kEndOfBlock - 1] : 0;
      bits += uint64_t{literal_counts_[s]} * static_cast<uint64_t>(literals.lengths[s] + extra);
    }
    for (size_t s = 0; s < kDistanceSymbols; ++s)
      bits += uint64_t{distance_counts_[s]} * static_cast<uint64_t>(distances.lengths[s] + kDistanceExtraBits[s]);
    return bits;
  }
  // Each piece: 3 bits, padding to a byte, 2 + 2 bytes of length. The first one's padding depends on the position.
  uint64_t stored_bits() const {
    const uint64_t n_pieces = std::max<uint64_t>(1, (n_covered_ + kMaxStored - 1) / kMaxStored);
    const auto padding = static_cast<uint64_t>((8 - (bits_.bit_position() + 3) % 8) % 8);
    return 8 * n_covered_ + n_pieces * 40 - 5 + padding;
  }

  void write_stored(bool is_last) {
    const auto bytes = in_.subspan(start_, n_covered_);
    size_t at = 0;
    do {
      const size_t n = std::min(kMaxStored, bytes.size() - at);
      bits_.put(is_last && at + n == bytes.size() ? 1 : 0, 3);
      bits_.align_to_byte();
      bits_.put(static_cast<uint32_t>(n), 16);
      bits_.put(static_cast<uint32_t>(n) ^ 0xFFFFu, 16);
      bits_.put_bytes(bytes.subspan(at, n));
      at += n;
    } while (at < bytes.size());
  }

  void write_header(const DynamicHeader& header) {
    bits_.put(static_cast<uint32_t>(header.n_literals - 257), 5);
    bits_.put(static_cast<uint32_t>(header.n_distances - 1), 5);
    bits_.put(static_cast<uint32_t>(header.n_code_lengths - 4), 4);
    for (size_t i = 0; i < header.n_code_lengths; ++i) bits_.put(header.code_lengths.lengths[kCodeLengthOrder[i]], 3);
    for (const LengthRun& run : header.runs) {
      bits_.put(header.code_lengths.codes[run.symbol], header.code_lengths.lengths[run.symbol]);
      if (run.symbol >= 16) bits_.put(run.extra, kRunExtraBits[run.symbol - 16]);
    }
  }

  void write_body(const PrefixCode& literals, const PrefixCode& distances) {
    for (const Token& token : tokens_) {
      if (token.distance == 0) {
        bits_.put(literals.codes[token.length], literals.lengths[token.length]);
        continue;
      }
      const size_t l = length_index(token.length), d = distance_index(token.distance);
      bits_.put(literals.codes[kEndOfBlock + 1 + l], literals.lengths[kEndOfBlock + 1 + l]);
      bits_.put(static_cast<uint32_t>(token.length - kLengthBase[l]), kLengthExtraBits[l]);
      bits_.put(distances.codes[d], distances.lengths[d]);
      bits_.put(static_cast<uint32_t>(token.distance - kDistanceBase[d]), kDistanceExtraBits[d]);
    }
    bits_.put(literals.codes[kEndOfBlock], literals.lengths[kEndOfBlock]);
  }

  std::span<const uint8_t> in_;
  LsbWriter bits_;
  Prices prices_;
  std::vector<Token> tokens_;
  size_t start_ = 0;      // of the block in in_
  size_t n_covered_ = 0;  // bytes of in_ that its tokens stand for
  std::array<uint32_t, kLiteralSymbols> literal_counts_{};
  std::array<uint32_t, kDistanceSymbols> distance_counts_{};
};

// Lazy matching: a match is taken only if the next position has no longer one [RFC 1951 4].
void compress(std::span<const uint8_t> in, std::vector<uint8_t>& out) {
  constexpr int kTries = 8, kFewTries = 4;
  constexpr size_t kGoodLength = 8, kLazyLength = 16;
  MatchFinder finder(in);
  BlockWriter block(in, out);
  const auto find = [&](size_t at, size_t longer_than, int n_tries) {
    if (in.size() - at < MatchFinder::kMinLength) return Match{};
    const Match match = finder.find(at, longer_than, n_tries);
    return match.length != 0 && block.prices().pays(in, at, match) ? match : Match{};
  };
  Match current;  // for position `at`, where it was already looked for
  bool looked = false;
  for (size_t at = 0; at < in.size();) {
    if (!looked) current = find(at, 0, kTries);
    looked = false;
    finder.insert(at);
    Match next;
    if (current.length != 0 && current.length < kLazyLength)
      next = find(at + 1, current.length, current.length >= kGoodLength ? kFewTries : kTries);
    if (current.length == 0 || next.length != 0) {
      block.literal(in[at++]);
      looked = next.length != 0;
      current = next;
    } else {
      block.match(current);
      for (size_t i = 1; i < current.length; ++i) finder.insert(at + i);
      at += current.length;
    }
    if (block.full()) block.flush(false);
  }
  block.flush(true);
  block.finish();
}

}  // namespace

std::vector<uint8_t> deflate_zlib(std::span<const uint8_t> in) {
  PAC_ASSERT(in.size() < UINT32_MAX);
  std::vector<uint8_t> out;
  out.reserve(in.size() / 2 + 64);
  out.push_back(0x78);  // deflate, 32 KiB window
  out.push_back(0x9C);  // default effort; (0x78 * 256 + 0x9C) % 31 == 0
  compress(in, out);
  const uint32_t checksum = adler32(in);
  for (int shift = 24; shift >= 0; shift -= 8) out.push_back(static_cast<uint8_t>(checksum >> shift));
  return out;
}

}  // namespace pac
