#include "base/deflate.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <queue>
#include <string>
#include <vector>

#include "base/checksum.h"
#include "base/huffman_lengths.h"
#include "base/inflate.h"
#include "tests/support/generators.h"

namespace pac::test {
namespace {

using Bytes = std::vector<uint8_t>;

Bytes bytes_of(const std::string& text) {
  return {text.begin(), text.end()};
}

void require_round_trip(const Bytes& in) {
  CAPTURE(in.size());
  const Bytes packed = deflate_zlib(in);
  REQUIRE(packed.size() <= in.size() + in.size() / 4096 + 32);
  Bytes out(in.size());
  const auto sizes = inflate_zlib(packed, out);
  REQUIRE_MESSAGE(sizes.ok(), sizes.failure().text);
  REQUIRE(sizes->n_read == packed.size());
  REQUIRE(sizes->n_written == in.size());
  REQUIRE(out == in);
}

TEST_CASE("round trip of nasty inputs, each no longer than the bound") {
  require_round_trip({});
  for (const size_t n :
       {1u, 2u, 3u, 4u, 5u, 257u, 258u, 259u, 260u, 32767u, 32768u, 32769u, 65535u, 65536u, 65537u, 131071u, 200000u}) {
    for (const Pattern pattern :
         {Pattern::zeros, Pattern::random, Pattern::alternating, Pattern::sparse, Pattern::ramp}) {
      Bytes in(n);
      fill(std::span(in), pattern, 0, 255, n);
      require_round_trip(in);
    }
  }
}

TEST_CASE("round trip across the window: repeats at distances around 32768") {
  for (const size_t period : {32766u, 32767u, 32768u, 32769u, 40000u}) {
    Bytes in(period);
    fill(std::span(in), Pattern::random, 0, 255, period);
    in.resize(2 * period + 300);
    std::copy_n(in.begin(), period + 300, in.begin() + static_cast<ptrdiff_t>(period));
    require_round_trip(in);
  }
}

TEST_CASE("round trip of every byte value alone and of runs that change in the middle of a block") {
  for (int value = 0; value < 256; ++value) require_round_trip(Bytes(70, static_cast<uint8_t>(value)));
  Bytes in;
  Random random(2);
  while (in.size() < 300000)
    in.insert(in.end(), static_cast<size_t>(random.in(1, 700)), static_cast<uint8_t>(random.next()));
  require_round_trip(in);
}

TEST_CASE("round trip of frequencies so skewed that plain Huffman codes would exceed 15 bits") {
  Bytes in;
  uint32_t a = 1, b = 1;
  for (int symbol = 0; symbol < 22; ++symbol) {
    in.insert(in.end(), a, static_cast<uint8_t>(symbol * 11));
    b += std::exchange(a, b);
  }
  Random random(4);  // shuffled, so that matches do not hide the frequencies
  for (size_t i = in.size() - 1; i > 0; --i) std::swap(in[i], in[random.next() % (i + 1)]);
  in.resize(std::min<size_t>(in.size(), 30000));
  require_round_trip(in);
}

TEST_CASE("text and runs compress: zeros a thousandfold, a repeated sentence twentyfold") {
  CHECK(deflate_zlib(Bytes(1'000'000)).size() < 1100);
  std::string text;
  for (int i = 0; i < 200; ++i)
    text += "The polygons are drawn by both, the pixels are sent by one. " + std::to_string(i);
  CHECK(deflate_zlib(bytes_of(text)).size() < text.size() / 20);
}

// --- golden streams, bits annotated

TEST_CASE("golden: an empty fixed block, a stored block, a fixed block of one literal") {
  Bytes out(8);
  // 1 (last) 01 (fixed, low bit first: 1 0) 0000000 (end of block): 03 00
  CHECK(inflate(Bytes{0x03, 0x00}, out)->n_written == 0);
  // 1, 00, padding; LEN 3, NLEN; three bytes
  const Bytes stored = {0x01, 0x03, 0x00, 0xFC, 0xFF, 'p', 'a', 'c'};
  REQUIRE(inflate(stored, out).ok());
  CHECK(std::equal(stored.begin() + 5, stored.end(), out.begin()));
  // 1, 01, literal 'a' = 0x61: code 00110000 + 0x61 = 10010001 (highest bit first), end 0000000: 4B 04 00
  const auto one = inflate(Bytes{0x4B, 0x04, 0x00}, out);
  REQUIRE(one.ok());
  CHECK(one->n_written == 1);
  CHECK(out[0] == 'a');
}

TEST_CASE("golden: an overlapping match repeats its bytes") {
  // Fixed block: 'a', then length 7 (symbol 261: 0000101) distance 1 (symbol 0: 00000), end of block.
  Bytes bits;
  const auto put_code = [&](const char* code) {  // codes go highest bit first
    for (; *code != 0; ++code) bits.push_back(static_cast<uint8_t>(*code - '0'));
  };
  for (const char* code : {"1", "10", "10010001", "0000101", "00000", "0000000"}) put_code(code);
  Bytes stream((bits.size() + 7) / 8);
  for (size_t i = 0; i < bits.size(); ++i) stream[i / 8] = static_cast<uint8_t>(stream[i / 8] | bits[i] << i % 8);
  Bytes out(8);
  const auto sizes = inflate(stream, out);
  REQUIRE(sizes.ok());
  CHECK(out == Bytes(8, 'a'));
  CHECK(inflate(stream, std::span(out).first(7)).failure().error == Error::out_of_space);
}

// --- what is refused

std::string text_of(const Bytes& stream, size_t n_out = 100) {
  Bytes out(n_out);
  const auto sizes = inflate(stream, out);
  REQUIRE_FALSE(sizes.ok());
  REQUIRE(sizes.failure().byte_offset <= stream.size());
  return sizes.failure().text;
}

// A raw stream from bits written lowest first.
class Bits {
 public:
  Bits& put(uint32_t value, int count) {
    for (int i = 0; i < count; ++i, ++n_) {
      if (n_ % 8 == 0) bytes_.push_back(0);
      bytes_.back() = static_cast<uint8_t>(bytes_.back() | (value >> i & 1) << n_ % 8);
    }
    return *this;
  }
  Bytes done() { return put(0, 32).bytes_; }  // some padding, so that the fault comes before the end

 private:
  Bytes bytes_;
  int n_ = 0;
};

TEST_CASE("each rule of the format that a stream breaks is named") {
  CHECK(text_of(Bits().put(7, 3).done()) == "deflate block of the reserved type");
  CHECK(text_of({0x01, 0x03, 0x00, 0xFC, 0xFE, 'p', 'a', 'c'}) == "stored block's length check fails");
  CHECK(text_of(Bits().put(5, 3).put(30, 5).put(0, 5).put(0, 4).done()) == "more literal codes than there are symbols");
  CHECK(text_of(Bits().put(5, 3).put(0, 5).put(30, 5).put(0, 4).done()) ==
        "more distance codes than there are symbols");
  // Code-length codes: none at all; three of one bit.
  CHECK(text_of(Bits().put(5, 3).put(0, 14).put(0, 12).done()) == "code-length code is not a prefix code");
  CHECK(text_of(Bits().put(5, 3).put(0, 14).put(1 | 1 << 3 | 1 << 6, 12).done()) ==
        "code-length code is not a prefix code");
  // Code-length code of symbols 16 (code 0) and 18 (code 1): a repeat comes first; then zeros past the last code.
  const uint32_t codes_16_18 = 1 | 1 << 6;
  CHECK(text_of(Bits().put(5, 3).put(0, 14).put(codes_16_18, 12).put(0, 1).done()) ==
        "repeat of a code length before the first");
  CHECK(text_of(Bits().put(5, 3).put(0, 14).put(codes_16_18, 12).put(1, 1).put(127, 7).put(1, 1).put(127, 7).done()) ==
        "repeated code lengths run past the last code");
  // 258 zeros: 138 + 120.
  CHECK(text_of(Bits().put(5, 3).put(0, 14).put(codes_16_18, 12).put(1, 1).put(127, 7).put(1, 1).put(109, 7).done()) ==
        "no code for end of block");
  // Fixed: length symbols 286 and distance symbol 30 exist as codes only; a distance before the first byte.
  CHECK(text_of(Bits().put(3, 3).put(0b01100011, 8).done()) == "reserved length code");
  CHECK(text_of(Bits().put(3, 3).put(0b10001001, 8).put(0b1010000, 7).put(0b01111, 5).done()) ==
        "undefined distance code");
  CHECK(text_of(Bits().put(3, 3).put(0b1010000, 7).put(0, 5).done()) == "distance reaches before the first byte");
}

TEST_CASE("zlib: wrong method, window, check bits, dictionary and checksum are named") {
  Bytes good = deflate_zlib(bytes_of("hello hello hello")), out(100);
  const auto text = [&](size_t at, int value) {
    Bytes bad = good;
    bad[at] = static_cast<uint8_t>(value);
    const auto sizes = inflate_zlib(bad, out);
    REQUIRE_FALSE(sizes.ok());
    return std::string(sizes.failure().text);
  };
  CHECK(text(0, 0x77) == "zlib method is not deflate");
  CHECK(text(0, 0x88) == "zlib method is not deflate");
  CHECK(text(1, good[1] + 1) == "zlib header check fails");
  CHECK(text(1, 0x20 + (31 - (0x7820 % 31)) % 31) == "zlib preset dictionary");
  CHECK(text(good.size() - 1, good.back() ^ 0x40) == "zlib checksum is wrong");
}

TEST_CASE("every strict prefix of a stream is rejected as truncated") {
  Bytes in(3000);
  fill(std::span(in), Pattern::sparse, 0, 255, 1);
  for (const Bytes& data : {in, bytes_of("stored?"), Bytes(500, 9)}) {
    const Bytes packed = deflate_zlib(data);
    Bytes out(data.size());
    for (size_t n = 0; n < packed.size(); ++n) {
      CAPTURE(n);
      const Bytes prefix(packed.begin(), packed.begin() + static_cast<ptrdiff_t>(n));
      const auto sizes = inflate_zlib(prefix, out);
      REQUIRE_FALSE(sizes.ok());
      REQUIRE(sizes.failure().error == Error::truncated);
    }
  }
}

TEST_CASE("a stream with any one bit damaged is refused, unless it was a padding bit") {
  Bytes in(400), out(400);
  fill(std::span(in), Pattern::sparse, 0, 255, 1);
  const Bytes packed = deflate_zlib(in);
  for (size_t bit = 0; bit < 8 * packed.size(); ++bit) {
    Bytes damaged = packed;
    damaged[bit / 8] = static_cast<uint8_t>(damaged[bit / 8] ^ 1 << bit % 8);
    if (inflate_zlib(damaged, out).ok()) REQUIRE(out == in);
  }
}

// --- checksums and code lengths

TEST_CASE("CRC-32 and Adler-32 of the known strings, in one piece and in two") {
  const Bytes nine = bytes_of("123456789"), wikipedia = bytes_of("Wikipedia");
  CHECK(crc32(nine) == 0xCBF43926u);
  CHECK(adler32(wikipedia) == 0x11E60398u);
  Bytes many(100000);
  fill(std::span(many), Pattern::highest, 0, 255, 0);
  for (const size_t cut : {0u, 1u, 7u, 8u, 5552u, 99999u}) {
    CHECK(crc32(std::span(many).subspan(cut), crc32(std::span(many).first(cut))) == crc32(many));
    CHECK(adler32(std::span(many).subspan(cut), adler32(std::span(many).first(cut))) == adler32(many));
  }
}

// Cost of a Huffman code without a limit: the sum of all merged weights.
uint64_t huffman_cost(const std::vector<uint32_t>& frequencies) {
  std::priority_queue<uint64_t, std::vector<uint64_t>, std::greater<>> weights;
  for (uint32_t f : frequencies)
    if (f != 0) weights.push(f);
  uint64_t cost = 0;
  while (weights.size() > 1) {
    const uint64_t a = weights.top();
    weights.pop();
    const uint64_t sum = a + weights.top();
    weights.pop();
    weights.push(sum);
    cost += sum;
  }
  return cost;
}

TEST_CASE("code lengths fill the code space exactly, keep the limit, and cost what Huffman's cost where it is loose") {
  Random random(8);
  for (int round = 0; round < 200; ++round) {
    std::vector<uint32_t> frequencies(static_cast<size_t>(random.in(2, 286)));
    for (uint32_t& f : frequencies)
      f = static_cast<uint32_t>(random.next() % 3 == 0 ? 0 : random.next() % (1u << random.in(0, 20)));
    frequencies[0] = frequencies[1] = 1;
    std::vector<uint8_t> lengths(frequencies.size()), loose(frequencies.size());
    optimal_code_lengths(frequencies, 15, lengths);
    optimal_code_lengths(frequencies, 32, loose);
    double kraft = 0;
    uint64_t cost = 0, loose_cost = 0;
    for (size_t s = 0; s < frequencies.size(); ++s) {
      REQUIRE((lengths[s] == 0) == (frequencies[s] == 0));
      REQUIRE(lengths[s] <= 15);
      if (lengths[s] != 0) kraft += 1.0 / static_cast<double>(1u << lengths[s]);
      cost += uint64_t{frequencies[s]} * lengths[s];
      loose_cost += uint64_t{frequencies[s]} * loose[s];
    }
    REQUIRE(kraft == 1.0);
    REQUIRE(loose_cost == huffman_cost(frequencies));
    REQUIRE(cost >= loose_cost);
  }
}

TEST_CASE("code lengths under a tight limit: Fibonacci weights at 4 bits, and as many symbols as the limit allows") {
  const std::vector<uint32_t> fibonacci = {1, 1, 2, 3, 5, 8, 13, 21};
  std::vector<uint8_t> lengths(8);
  optimal_code_lengths(fibonacci, 4, lengths);
  // By hand: the four rarest at 4 bits, the next two at 3... cost 4*(1+1+2+3) + 3*(5+8) + 2*(13+21) = 135, Kraft 1.
  uint64_t cost = 0;
  for (size_t s = 0; s < 8; ++s) cost += uint64_t{fibonacci[s]} * lengths[s];
  CHECK(cost == 135);
  const std::vector<uint32_t> equal(16, 7);
  std::vector<uint8_t> four(16);
  optimal_code_lengths(equal, 4, four);
  CHECK(four == std::vector<uint8_t>(16, 4));
  std::vector<uint8_t> one(3);
  optimal_code_lengths(std::vector<uint32_t>{0, 9, 0}, 4, one);
  CHECK(one == std::vector<uint8_t>{0, 1, 0});
}

}  // namespace
}  // namespace pac::test
