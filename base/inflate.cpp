#include "base/inflate.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "base/checksum.h"
#include "base/deflate_tables.h"

namespace pac {
namespace {

// Bits of bytes, least significant first [RFC 1951 3.1.1]. Sticky: past the end it delivers zeros and remembers it.
class LsbReader {
 public:
  explicit LsbReader(std::span<const uint8_t> bytes) : bytes_(bytes) {}

  // Makes at least 56 bits available, or all that are left.
  void refill() {
    if (next_ + 8 <= bytes_.size()) {
      uint64_t word = 0;
      for (size_t i = 0; i < 8; ++i) word |= uint64_t{bytes_[next_ + i]} << 8 * i;
      window_ |= word << n_bits_;  // bits above n_bits_ are or-ed again, equally, by the next refill
      next_ += static_cast<size_t>((63 - n_bits_) >> 3);
      n_bits_ |= 56;
    } else {
      for (; n_bits_ <= 56 && next_ < bytes_.size(); n_bits_ += 8) window_ |= uint64_t{bytes_[next_++]} << n_bits_;
    }
  }
  // The next bits; the low 56 are valid after refill() unless the input ends earlier (zeros follow).
  uint64_t window() const { return window_; }
  void skip(int count) {
    if (count > n_bits_) {
      overrun_ = true;
      window_ = 0;
      n_bits_ = 0;
      return;
    }
    window_ >>= count;
    n_bits_ -= count;
  }
  uint32_t take(int count) {
    const auto value = static_cast<uint32_t>(window_ & ((uint64_t{1} << count) - 1));
    skip(count);
    return value;
  }
  uint32_t read(int count) {
    refill();
    return take(count);
  }
  // Drops the rest of the current byte and gives whole unread bytes back.
  void align_to_byte() {
    next_ -= static_cast<size_t>(n_bits_ >> 3);
    window_ = 0;
    n_bits_ = 0;
  }
  // `count` bytes after align_to_byte(); empty and overrun where fewer are left.
  std::span<const uint8_t> read_bytes(size_t count) {
    if (count > bytes_.size() - next_) {
      overrun_ = true;
      return {};
    }
    next_ += count;
    return bytes_.subspan(next_ - count, count);
  }
  bool overrun() const { return overrun_; }
  size_t byte_offset() const { return overrun_ ? bytes_.size() : next_ - static_cast<size_t>(n_bits_ >> 3); }

 private:
  std::span<const uint8_t> bytes_;
  uint64_t window_ = 0;  // the next n_bits_ bits, lowest first
  size_t next_ = 0;      // first byte not counted in n_bits_
  int n_bits_ = 0;       // 0..63
  bool overrun_ = false;
};

// A canonical prefix code [RFC 1951 3.2.2]: codes of up to kFastBits bits by one look-up, longer ones bit by bit.
class PrefixDecoder {
 public:
  // False if the lengths (0..15) are over-subscribed, or incomplete. As an exception, where `may_be_incomplete`, a code
  // with no symbol, or one of one bit, is legal [RFC 1951 3.2.7]; decoding its unused words gives -1.
  bool build(std::span<const uint8_t> lengths, bool may_be_incomplete = true) {
    count_.fill(0);
    for (uint8_t length : lengths) ++count_[length];
    count_[0] = 0;
    int n_free = 1;
    int max_length = 0;
    for (int length = 1; length <= kDeflateMaxBits; ++length) {
      n_free = 2 * n_free - count_[static_cast<size_t>(length)];
      if (n_free < 0) return false;
      if (count_[static_cast<size_t>(length)] != 0) max_length = length;
    }
    if (n_free > 0 && (max_length > 1 || !may_be_incomplete)) return false;
    sort_symbols(lengths);
    fill_fast_table(lengths);
    return true;
  }

  // The next symbol, or -1 where no codeword matches. Needs 15 bits in the window (or the input's end).
  int decode(LsbReader& bits) const {
    const uint16_t entry = fast_[bits.window() & (kFastSize - 1)];
    if (entry != 0) {
      bits.skip(entry & 15);
      return entry >> 4;
    }
    return decode_slowly(bits);
  }

 private:
  static constexpr int kFastBits = 10;
  static constexpr uint32_t kFastSize = 1u << kFastBits;

  void sort_symbols(std::span<const uint8_t> lengths) {
    std::array<uint16_t, kDeflateMaxBits + 2> next{};
    for (size_t length = 1; length <= kDeflateMaxBits; ++length)
      next[length + 1] = static_cast<uint16_t>(next[length] + count_[length]);
    for (size_t s = 0; s < lengths.size(); ++s)
      if (lengths[s] != 0) symbols_[next[lengths[s]]++] = static_cast<uint16_t>(s);
  }
  void fill_fast_table(std::span<const uint8_t> lengths) {
    fast_.fill(0);
    std::array<uint16_t, kMaxSymbols> codes{};
    assign_deflate_codes(lengths, codes);
    for (size_t s = 0; s < lengths.size(); ++s) {
      if (lengths[s] == 0 || lengths[s] > kFastBits) continue;
      for (uint32_t i = codes[s]; i < kFastSize; i += 1u << lengths[s])
        fast_[i] = static_cast<uint16_t>(s << 4 | lengths[s]);
    }
  }
  // Codes of one length are consecutive numbers: compare with the first of each length.
  int decode_slowly(LsbReader& bits) const {
    int code = 0, first = 0, index = 0;
    uint64_t window = bits.window();
    for (int length = 1; length <= kDeflateMaxBits; ++length, window >>= 1) {
      code |= static_cast<int>(window & 1);
      const int n = count_[static_cast<size_t>(length)];
      if (code - first < n) {
        bits.skip(length);
        return symbols_[static_cast<size_t>(index + code - first)];
      }
      index += n;
      first = (first + n) << 1;
      code <<= 1;
    }
    return -1;
  }

  static constexpr size_t kMaxSymbols = 288;
  std::array<uint16_t, kFastSize> fast_{};  // symbol << 4 | length, by the next kFastBits bits; 0 = longer or none
  std::array<uint16_t, kDeflateMaxBits + 1> count_{};  // codes of each length
  std::array<uint16_t, kMaxSymbols> symbols_{};        // in code order
};

class Inflater {
 public:
  Inflater(std::span<const uint8_t> in, std::span<uint8_t> out) : bits_(in), out_(out) {}

  Result<InflateSizes> run() {
    bool is_last = false;
    while (!is_last) {
      is_last = bits_.read(1) != 0;
      switch (bits_.read(2)) {
        case 0:
          PAC_CHECK(stored_block());
          break;
        case 1:
          PAC_CHECK(use_fixed_codes());
          PAC_CHECK(compressed_block());
          break;
        case 2:
          PAC_CHECK(read_dynamic_codes());
          PAC_CHECK(compressed_block());
          break;
        default:
          return fail("deflate block of the reserved type");
      }
      if (bits_.overrun()) return fail("");
    }
    bits_.align_to_byte();
    return InflateSizes{bits_.byte_offset(), n_written_};
  }

 private:
  // The input's end explains whatever nonsense the zeros after it decode to.
  Failure fail(const char* text, Error error = Error::corrupt) const {
    if (bits_.overrun()) return {Error::truncated, bits_.byte_offset(), "compressed data ends early"};
    return {error, bits_.byte_offset(), text};
  }
  Failure fail_too_much() const { return fail("compressed data holds more than expected", Error::out_of_space); }

  Result<void> stored_block() {  // [RFC 1951 3.2.4]
    bits_.align_to_byte();
    const uint32_t length = bits_.read(16), complement = bits_.read(16);
    if (bits_.overrun() || (length ^ complement) != 0xFFFF) return fail("stored block's length check fails");
    bits_.align_to_byte();
    if (length > out_.size() - n_written_) return fail_too_much();
    const auto bytes = bits_.read_bytes(length);
    std::copy(bytes.begin(), bytes.end(), out_.begin() + static_cast<ptrdiff_t>(n_written_));
    n_written_ += bytes.size();
    return {};
  }

  Result<void> use_fixed_codes() {
    const bool ok = literals_.build(kFixedLiteralLengths) && distances_.build(kFixedDistanceLengths);
    PAC_ASSERT(ok);
    return {};
  }

  Result<void> read_dynamic_codes() {  // [RFC 1951 3.2.7]
    const size_t n_literals = bits_.read(5) + 257, n_distances = bits_.read(5) + 1, n_code_lengths = bits_.read(4) + 4;
    if (n_literals > kLiteralSymbols) return fail("more literal codes than there are symbols");
    if (n_distances > kDistanceSymbols) return fail("more distance codes than there are symbols");
    std::array<uint8_t, 19> code_lengths{};
    for (size_t i = 0; i < n_code_lengths; ++i) code_lengths[kCodeLengthOrder[i]] = static_cast<uint8_t>(bits_.read(3));
    if (!literals_.build(code_lengths, false)) return fail("code-length code is not a prefix code");
    std::array<uint8_t, kLiteralSymbols + kDistanceSymbols> lengths{};
    PAC_CHECK(read_code_lengths(std::span(lengths).first(n_literals + n_distances)));
    if (lengths[kEndOfBlock] == 0) return fail("no code for end of block");
    if (!literals_.build(std::span(lengths).first(n_literals))) return fail("literal code is not a prefix code");
    if (!distances_.build(std::span(lengths).subspan(n_literals, n_distances)))
      return fail("distance code is not a prefix code");
    return {};
  }

  Result<void> read_code_lengths(std::span<uint8_t> lengths) {
    for (size_t i = 0; i < lengths.size();) {
      bits_.refill();
      const int symbol = literals_.decode(bits_);
      if (symbol < 0 || bits_.overrun()) return fail("undefined code-length code");
      if (symbol < 16) {
        lengths[i++] = static_cast<uint8_t>(symbol);
        continue;
      }
      if (symbol == 16 && i == 0) return fail("repeat of a code length before the first");
      const uint8_t value = symbol == 16 ? lengths[i - 1] : uint8_t{0};
      const size_t n = symbol == 16 ? 3 + bits_.take(2) : symbol == 17 ? 3 + bits_.take(3) : 11 + bits_.take(7);
      if (n > lengths.size() - i) return fail("repeated code lengths run past the last code");
      std::fill_n(lengths.begin() + static_cast<ptrdiff_t>(i), n, value);
      i += n;
    }
    return {};
  }

  // Ends: each round writes at least one byte of the bounded output, or returns. A round takes at most
  // 15 + 5 + 15 + 13 = 48 bits: one refill is enough.
  Result<void> compressed_block() {
    while (true) {
      bits_.refill();
      const int symbol = literals_.decode(bits_);
      if (bits_.overrun() || symbol < 0) return fail("undefined literal code");
      if (symbol < kEndOfBlock) {
        if (n_written_ == out_.size()) return fail_too_much();
        out_[n_written_++] = static_cast<uint8_t>(symbol);
        continue;
      }
      if (symbol == kEndOfBlock) return {};
      if (symbol >= static_cast<int>(kLiteralSymbols)) return fail("reserved length code");
      const auto length_symbol = static_cast<size_t>(symbol - kEndOfBlock - 1);
      const size_t length = kLengthBase[length_symbol] + bits_.take(kLengthExtraBits[length_symbol]);
      const int distance_symbol = distances_.decode(bits_);
      if (distance_symbol < 0 || distance_symbol >= static_cast<int>(kDistanceSymbols))
        return fail("undefined distance code");
      const auto d = static_cast<size_t>(distance_symbol);
      const size_t distance = kDistanceBase[d] + bits_.take(kDistanceExtraBits[d]);
      if (bits_.overrun() || distance > n_written_) return fail("distance reaches before the first byte");
      if (length > out_.size() - n_written_) return fail_too_much();
      copy_match(distance, length);
    }
  }

  void copy_match(size_t distance, size_t length) {
    uint8_t* to = out_.data() + n_written_;
    const uint8_t* from = to - distance;
    n_written_ += length;
    if (distance >= length) {
      std::memcpy(to, from, length);
    } else {
      for (size_t i = 0; i < length; ++i) to[i] = from[i];  // overlapping: repeats the last `distance` bytes
    }
  }

  LsbReader bits_;
  std::span<uint8_t> out_;
  size_t n_written_ = 0;
  PrefixDecoder literals_, distances_;
};

}  // namespace

Result<InflateSizes> inflate(std::span<const uint8_t> in, std::span<uint8_t> out) {
  return Inflater(in, out).run();
}

Result<InflateSizes> inflate_zlib(std::span<const uint8_t> in, std::span<uint8_t> out) {
  if (in.size() < 2) return Failure{Error::truncated, in.size(), "zlib header ends early"};
  if ((in[0] & 15) != 8 || in[0] >> 4 > 7) return Failure{Error::corrupt, 0, "zlib method is not deflate"};
  if ((in[0] * 256 + in[1]) % 31 != 0) return Failure{Error::corrupt, 1, "zlib header check fails"};
  if ((in[1] & 0x20) != 0) return Failure{Error::unsupported, 1, "zlib preset dictionary"};
  auto sizes = inflate(in.subspan(2), out);
  if (!sizes.ok()) {
    Failure failure = sizes.failure();
    failure.byte_offset += 2;
    return failure;
  }
  const size_t at = 2 + sizes->n_read;
  if (in.size() - at < 4) return Failure{Error::truncated, in.size(), "zlib checksum ends early"};
  const uint32_t stored = uint32_t{in[at]} << 24 | uint32_t{in[at + 1]} << 16 | uint32_t{in[at + 2]} << 8 | in[at + 3];
  if (adler32(out.first(sizes->n_written)) != stored) return Failure{Error::corrupt, at, "zlib checksum is wrong"};
  return InflateSizes{at + 4, sizes->n_written};
}

}  // namespace pac
