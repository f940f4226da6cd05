// A stream written by hand, bit by bit, and what the standard makes of it.
#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "tests/support/mpeg1_clip.h"

namespace pac::test {
namespace {

// Bits written as '0' and '1' (other characters are for the reader), filled up to bytes with zeros.
std::vector<uint8_t> bytes_of(const std::string& text) {
  std::vector<uint8_t> bytes;
  int n = 0;
  for (const char c : text) {
    if (c != '0' && c != '1') continue;
    if (n++ % 8 == 0) bytes.push_back(0);
    bytes.back() = static_cast<uint8_t>(bytes.back() | (c - '0') << (7 - (n - 1) % 8));
  }
  return bytes;
}

void append(std::vector<uint8_t>& stream, uint8_t start_code, const std::string& bits) {
  stream.insert(stream.end(), {0, 0, 1, start_code});
  const std::vector<uint8_t> payload = bytes_of(bits);
  stream.insert(stream.end(), payload.begin(), payload.end());
}

std::vector<uint8_t> golden_stream() {
  std::vector<uint8_t> stream;
  // 16x16, square samples, 25 pictures a second, variable rate; no matrices
  append(stream, 0xB3, "000000010000 000000010000 0001 0011 111111111111111111 1 0000010100 0 0 0");
  // time code 0:00:00:00 with its marker, closed_gop, no broken_link
  append(stream, 0xB8, "0 00000 000000 1 000000 000000 1 0");
  // picture 0, I, vbv_delay 0xFFFF, no extra information
  append(stream, 0x00, "0000000000 001 1111111111111111 0");
  // slice 1: quantizer_scale 8, no extra information
  append(stream, 0x01,
         "01000 0"
         "1 1"      // macroblock_address_increment 1, intra
         "00 1 10"  // luma: dct_dc_size 1, differential +1: 129; end_of_block
         "100 10"   // the other three: size 0, the same again
         "100 10"
         "100 10"
         "01 0 10"     // Cb: size 1, differential -1: 127
         "10 11 10");  // Cr: size 2, differential +3: 131
  // picture 1, P: full_pel_forward_vector 0, forward_f_code 1
  append(stream, 0x00, "0000000001 010 1111111111111111 0 001 0");
  append(stream, 0x01,
         "01000 0"
         "1 01"    // increment 1, not moved but coded
         "111"     // coded_block_pattern 60: the luma blocks
         "1 0 10"  // run 0, level +1: (2 + 1) * 8 * 16 / 16 = 24, made odd: 23; (23 + 4) >> 3 = +3
         "1 1 10"  // level -1: (-23 + 4) >> 3 = -3
         "1 0 10"
         "0100 0 10");  // run 0, level +2: (4 + 1) * 8 = 40, made odd: 39; (39 + 4) >> 3 = +5
  stream.insert(stream.end(), {0, 0, 1, 0xB7});
  return stream;
}

TEST_CASE("the golden stream decodes to the samples that were computed by hand") {
  mpeg1::DecoderOptions strict;
  strict.strict = true;
  const std::vector<Frame420> frames = decode_all(golden_stream(), strict);
  REQUIRE(frames.size() == 2);
  const auto all_are = [](const GrayImage& plane, int x0, int y0, int size, int value) {
    for (int y = y0; y < y0 + size; ++y)
      for (int x = x0; x < x0 + size; ++x)
        if (plane.row(y)[x] != value) return false;
    return true;
  };
  CHECK(all_are(frames[0].y, 0, 0, 16, 129));
  CHECK(all_are(frames[0].cb, 0, 0, 8, 127));
  CHECK(all_are(frames[0].cr, 0, 0, 8, 131));
  CHECK(all_are(frames[1].y, 0, 0, 8, 132));
  CHECK(all_are(frames[1].y, 8, 0, 8, 126));
  CHECK(all_are(frames[1].y, 0, 8, 8, 132));
  CHECK(all_are(frames[1].y, 8, 8, 8, 134));
  CHECK(all_are(frames[1].cb, 0, 0, 8, 127));
}

TEST_CASE("stuffing, user data and extra information change nothing") {
  const std::vector<uint8_t> plain = golden_stream();
  // After the group header's start code and payload: user data; before every start code: zeros.
  std::vector<uint8_t> padded;
  for (size_t i = 0; i < plain.size(); ++i) {
    const bool is_start = i + 3 < plain.size() && plain[i] == 0 && plain[i + 1] == 0 && plain[i + 2] == 1;
    if (is_start && plain[i + 3] == 0)
      for (const int byte : {0, 0, 0, 0, 1, 0xB2, 0x68, 0x69, 0, 0}) padded.push_back(static_cast<uint8_t>(byte));
    padded.push_back(plain[i]);
  }
  mpeg1::DecoderOptions strict;
  strict.strict = true;
  const std::vector<Frame420> expected = decode_all(plain, strict), actual = decode_all(padded, strict);
  REQUIRE(actual.size() == expected.size());
  for (size_t i = 0; i < actual.size(); ++i) CHECK(equal(mpeg1::view_of(actual[i]), mpeg1::view_of(expected[i])));
}

}  // namespace
}  // namespace pac::test
