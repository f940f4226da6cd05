// Bad files: each kind gets its named error and no picture; harmless oddities are accepted.
#include <doctest/doctest.h>

#include <cstring>
#include <string>

#include "jpeg/jpeg.h"
#include "tests/support/jpeg_file.h"

namespace pac::test {
namespace {

void require_failure(const JpegFile& file, Error error, const char* text) {
  CAPTURE(text);
  const auto result = jpeg::decode(file.bytes);
  REQUIRE_FALSE(result.ok());
  CAPTURE(result.failure().text);
  CHECK(result.failure().error == error);
  CHECK(std::strstr(result.failure().text, text) != nullptr);
  CHECK(result.failure().byte_offset <= file.bytes.size());
}

JpegFile start() {
  return JpegFile().soi();
}
JpegFile through_frame() {
  return start().dqt().sof(8, 8);
}
JpegFile through_tables() {
  return through_frame().small_tables();
}

TEST_CASE("what is no JPEG file at all is refused") {
  require_failure({}, Error::truncated, "empty file");
  require_failure(JpegFile().raw({0xFF}), Error::truncated, "SOI");
  require_failure(JpegFile().raw({0x89, 'P', 'N', 'G', 13, 10, 26, 10}), Error::corrupt, "no SOI");
  require_failure(start(), Error::truncated, "marker is due");
  require_failure(start().eoi(), Error::corrupt, "EOI before any scan");
  require_failure(start().raw({0xFF, 0xE0}), Error::truncated, "segment length");
  require_failure(start().soi(), Error::corrupt, "second SOI");
}

TEST_CASE("segments cut short, or with impossible lengths, are refused") {
  require_failure(start().raw({0xFF, 0xDB, 0, 67, 0, 1, 2, 3}), Error::truncated, "inside a segment");
  require_failure(start().dqt().raw({0xFF, 0xC0, 0, 11, 8, 0}), Error::truncated, "inside a segment");
  require_failure(through_frame().raw({0xFF, 0xC4, 0, 20, 0}), Error::truncated, "inside a segment");
  require_failure(through_tables().raw({0xFF, 0xDA, 0, 8, 1}), Error::truncated, "inside a segment");
  require_failure(start().raw({0xFF, 0xE0, 0, 0, 1, 2}), Error::corrupt, "length below 2");
  require_failure(start().raw({0xFF, 0xE0, 0, 1, 1, 2}), Error::corrupt, "length below 2");
  require_failure(start().raw({0xFF, 0xE0, 0xFF, 0xFF, 1, 2}), Error::truncated, "inside a segment");
  require_failure(start().segment(0xDB, {0, 1, 2, 3}), Error::corrupt, "DQT: segment too short");
  require_failure(start().segment(0xC4, {0, 1, 2, 3}), Error::corrupt, "DHT: segment too short");
  require_failure(start().segment(0xC0, {8, 0, 8}), Error::corrupt, "SOF: segment too short");
  require_failure(through_tables().segment(0xDA, {}), Error::corrupt, "SOS: segment too short");
  require_failure(start().segment(0xDD, {0, 1, 2}), Error::corrupt, "DRI");
  require_failure(start().raw({0xFF, 0x02, 0, 2}), Error::corrupt, "reserved marker");
}

TEST_CASE("frame headers beyond what T.81 allows are refused") {
  require_failure(start().sof(0, 8), Error::corrupt, "width 0");
  require_failure(start().sof(8, 0).sos(), Error::unsupported, "DNL");
  require_failure(start().sof(8, 8, {{}}, 0xC0, 12), Error::corrupt, "precision");
  require_failure(start().sof(8, 8, {{}}, 0xC0, 0), Error::corrupt, "precision");
  require_failure(start().sof(8, 8, {}), Error::corrupt, "no components");
  require_failure(start().segment(0xC0, {8, 0, 8, 0, 8, 3, 1, 0x11, 0}), Error::corrupt, "length does not fit");
  require_failure(start().sof(8, 8, {{1}, {2}, {3}, {4}, {5}}).sos(), Error::unsupported, "more than 4 components");
  require_failure(start().sof(8, 8, {{1}, {2}}).sos(), Error::unsupported, "two components");
  require_failure(start().sof(8, 8, {{1, 0, 0}}), Error::corrupt, "sampling factor");
  require_failure(start().sof(8, 8, {{1, 5, 5}}), Error::corrupt, "sampling factor");
  require_failure(start().sof(8, 8, {{1}, {1}, {3}}), Error::corrupt, "used twice");
  require_failure(start().sof(8, 8, {{1, 1, 1, 4}}), Error::corrupt, "quantization table above 3");
  require_failure(start().dqt().sof(8, 8).sof(8, 8), Error::corrupt, "second SOF");
  JpegFile large_mcu = start().dqt().sof(64, 64, {{1, 4, 4}, {2, 1, 1}, {3, 1, 1}}).small_tables();
  require_failure(large_mcu.sos({{1}, {2}, {3}}), Error::corrupt, "more than 10 blocks");
}

TEST_CASE("tables that cannot be are refused") {
  require_failure(start().dqt(7), Error::corrupt, "destination above 3");
  require_failure(start().dqt(0, 2), Error::corrupt, "neither 8 nor 16");
  require_failure(start().dqt(0, 0, 0), Error::corrupt, "step 0");
  require_failure(start().dqt(0, 1, 0), Error::corrupt, "step 0");
  require_failure(start().dht(2, 0, {1}, {0}), Error::corrupt, "class above 1");
  require_failure(start().dht(0, 5, {1}, {0}), Error::corrupt, "destination above 3");
  std::array<int, 16> many{};
  many[8] = many[9] = 200;
  require_failure(start().dht(1, 0, many, std::vector<int>(400, 1)), Error::corrupt, "more than 256");
  require_failure(start().dht(0, 0, {3}, {0, 1, 2}), Error::corrupt, "more codes of a length");
  require_failure(start().dht(0, 0, {2, 1}, {0, 1, 2}), Error::corrupt, "more codes of a length");
  require_failure(start().dht(0, 0, {1}, {255}), Error::corrupt, "DC category");
  require_failure(start().dht(0, 0, {1, 1}, {1}), Error::corrupt, "too short for its symbols");
}

TEST_CASE("scans that do not fit their frame are refused") {
  require_failure(start().dqt().sos(), Error::corrupt, "SOS before SOF");
  require_failure(start().sof(8, 8).small_tables().sos().bits("00").eoi(), Error::corrupt, "quantization table is not");
  require_failure(start().dqt().sof(8, 8, {{1, 1, 1, 2}}).small_tables().sos(), Error::corrupt,
                  "quantization table is");
  require_failure(through_frame().dht(0, 0, {1}, {0}).sos(), Error::corrupt, "Huffman table is not defined");
  require_failure(through_frame().small_tables(1).sos(), Error::corrupt, "Huffman table is not defined");
  require_failure(through_tables().segment(0xDA, {0, 0, 63, 0}), Error::corrupt, "count outside 1..4");
  require_failure(through_tables().segment(0xDA, {5, 0, 63, 0}), Error::corrupt, "count outside 1..4");
  require_failure(through_tables().segment(0xDA, {4, 1, 0, 0, 63, 0}), Error::corrupt, "length does not fit");
  require_failure(through_tables().sos({{9}}), Error::corrupt, "not in the frame");
  require_failure(through_tables().sos({{1}, {1}}), Error::corrupt, "named twice");
  require_failure(through_tables().sos({{1, 0x70}}), Error::corrupt, "Huffman table above 3");
  require_failure(through_tables().sos({{1}}, 1, 63), Error::corrupt, "not a full sequential scan");
  require_failure(through_tables().sos({{1}}, 0, 62), Error::corrupt, "not a full sequential scan");
  require_failure(through_tables().sos({{1}}, 0, 63, 0x01), Error::corrupt, "not a full sequential scan");
  require_failure(through_tables().sos().bits("00").sos().bits("00").eoi(), Error::corrupt, "second scan");
  JpegFile two_missing = start().dqt().sof(8, 8, {{1}, {2}, {3}}).small_tables().sos({{1}}).bits("00").eoi();
  require_failure(two_missing, Error::corrupt, "EOI before every component");
}

TEST_CASE("progressive scans that no encoder may write are refused") {
  const auto frame = [] { return start().dqt().sof(8, 8, {{1}, {2}, {3}}, 0xC2).small_tables(); };
  require_failure(frame().sos({{1}}, 0, 63), Error::corrupt, "not a band");
  require_failure(frame().sos({{1}}, 5, 4), Error::corrupt, "not a band");
  require_failure(frame().sos({{1}}, 1, 64), Error::corrupt, "not a band");
  require_failure(frame().sos({{1}, {2}}, 1, 5), Error::corrupt, "not a band");
  require_failure(frame().sos({{1}}, 0, 0, 0x0E), Error::corrupt, "bit positions");
  require_failure(frame().sos({{1}}, 0, 0, 0x31), Error::corrupt, "bit positions");
  require_failure(frame().sos({{1}}, 0, 0).bits("00").eoi(), Error::corrupt, "EOI before every component");
  JpegFile endless = start().dqt().sof(8, 8, {{1}}, 0xC2).small_tables();
  for (int i = 0; i < 300; ++i) endless = endless.sos({{1}}, 0, 0, 0x21).bits("0");
  require_failure(endless.eoi(), Error::limit_exceeded, "more scans");
}

TEST_CASE("processes other than 8-bit sequential and progressive Huffman are unsupported, each by its name") {
  const struct {
    int marker, precision;
    const char* text;
  } kProcesses[] = {{0xC3, 8, "lossless"},     {0xC5, 8, "hierarchical"}, {0xC6, 8, "hierarchical"},
                    {0xC7, 8, "hierarchical"}, {0xC9, 8, "arithmetic"},   {0xCA, 8, "arithmetic"},
                    {0xCB, 8, "arithmetic"},   {0xCD, 8, "arithmetic"},   {0xCF, 8, "arithmetic"},
                    {0xC1, 12, "12-bit"},      {0xC2, 12, "12-bit"}};
  for (const auto& p : kProcesses) {
    const JpegFile file = start().dqt().sof(8, 8, {{}}, p.marker, p.precision).small_tables().sos();
    require_failure(file, Error::unsupported, p.text);
    const auto info = jpeg::read_info(file.bytes);
    REQUIRE(info.ok());  // the headers are readable all the same
    REQUIRE(info->unsupported != nullptr);
  }
  require_failure(start().segment(0xDE, {8, 0, 8, 0, 8, 1, 1, 0x11, 0}), Error::unsupported, "hierarchical");
  require_failure(through_tables().sos().bits("00").segment(0xDC, {0, 8}).eoi(), Error::unsupported, "DNL");
}

TEST_CASE("damaged entropy-coded data is refused strictly, by what is wrong") {
  require_failure(through_tables().sos().eoi(), Error::corrupt, "marker inside the entropy-coded data");
  require_failure(through_tables().sos(), Error::truncated, "inside the entropy-coded data");
  require_failure(through_tables().sos().raw({0xFF, 0x7F, 0, 0}).eoi(), Error::corrupt, "marker inside");
  require_failure(through_tables().sos().bits("0 11111 111").raw({0, 0}).eoi(), Error::corrupt,
                  "undefined Huffman code");
  require_failure(through_tables().sos().bits("11 0").raw({0, 0, 0, 0}).eoi(), Error::corrupt,
                  "undefined Huffman code");
  // DC, then five times run 15 size 1: the fourth would end at position 64.
  require_failure(through_tables().sos().bits("0 11101 11101 11101 11101 0").eoi(), Error::corrupt,
                  "run past the last");
  require_failure(through_tables().sos().bits("0 110 110 110 110 0").eoi(), Error::corrupt, "run past the last");
  JpegFile end_of_band = through_frame().dht(0, 0, {1}, {0}).dht(1, 0, {1}, {0x10}).sos().bits("0 0").raw({0, 0}).eoi();
  require_failure(end_of_band, Error::corrupt, "undefined run/size");
  require_failure(through_tables().sos().bits("0 0"), Error::truncated, "marker is due");  // no EOI
}

JpegFile four_blocks_with_restarts(int second, int third, int fourth) {
  JpegFile file = start().dqt().sof(32, 8).small_tables().dri(1).sos().bits("10 111 0");  // DIFF 7
  file.raw({0xFF, second}).bits("10 000 0");                                              // DIFF -7
  file.raw({0xFF, third}).bits("10 111 0");
  return file.raw({0xFF, fourth}).bits("10 000 0").eoi();
}

TEST_CASE("restart markers that are missing, wrong or out of order are refused strictly") {
  REQUIRE(jpeg::decode(four_blocks_with_restarts(0xD0, 0xD1, 0xD2).bytes).ok());
  require_failure(four_blocks_with_restarts(0xD1, 0xD2, 0xD3), Error::corrupt, "restart marker");
  require_failure(four_blocks_with_restarts(0xD0, 0xD0, 0xD1), Error::corrupt, "restart marker");
  require_failure(start().dqt().sof(32, 8).small_tables().dri(1).sos().bits("00").eoi(), Error::corrupt,
                  "restart marker");
  require_failure(start().dqt().sof(32, 8).small_tables().dri(1).sos().bits("00"), Error::truncated, "restart marker");
}

TEST_CASE("lenient decoding keeps what a damaged file holds and says what is wrong") {
  // Of 16 blocks in a row, the fifth is damaged and nothing marks where to go on.
  JpegFile file = start().dqt().sof(32, 8).small_tables().sos().bits("10 111 0  0 0  0 11111").raw({0, 0}).eoi();
  const auto damaged = jpeg::decode_lenient(file.bytes);
  REQUIRE(damaged.ok());
  REQUIRE(damaged->failure.has_value());
  CHECK(damaged->failure->error == Error::corrupt);
  CHECK(damaged->errors == 1);
  CHECK(damaged->warnings == 1);        // what is left of the data before EOI
  const int bright = 128 + 7 * 16 / 8;  // DC level 7, step 16, a block's mean is an eighth of its DC
  CHECK(damaged->image.pixel(0, 0)[0] == bright);
  CHECK(damaged->image.pixel(15, 7)[1] == bright);
  CHECK(damaged->image.pixel(24, 0)[2] == 128);

  // With restart markers only the damaged interval is lost; lost markers are counted by their numbers.
  JpegFile marked = start().dqt().sof(32, 8).small_tables().dri(1).sos().bits("10 111 0").raw({0xFF, 0xD1});
  marked.bits("10 111 0").raw({0xFF, 0xD2}).bits("10 000 0").eoi();
  const auto resumed = jpeg::decode_lenient(marked.bytes);
  REQUIRE(resumed.ok());
  REQUIRE(resumed->failure.has_value());
  CHECK(resumed->image.pixel(0, 0)[0] == bright);
  CHECK(resumed->image.pixel(8, 0)[0] == 128);
  CHECK(resumed->image.pixel(16, 0)[0] == bright);
  CHECK(resumed->image.pixel(24, 0)[0] == 128 - 14);

  const auto sound = jpeg::decode_lenient(sound_gray().bytes);
  REQUIRE(sound.ok());
  CHECK_FALSE(sound->failure.has_value());
  CHECK(sound->errors == 0);
  CHECK(sound->warnings == 0);
  // Bytes between segments harm nothing: a warning, no error.
  const auto odd =
      jpeg::decode_lenient(start().raw({1, 2, 3}).dqt().sof(8, 8).small_tables().sos().bits("00").eoi().bytes);
  REQUIRE(odd.ok());
  CHECK_FALSE(odd->failure.has_value());
  CHECK(odd->errors == 0);
  CHECK(odd->warnings == 1);
  CHECK_FALSE(jpeg::decode_lenient(start().bytes).ok());
}

TEST_CASE("oddities that harm nothing are accepted") {
  const auto accepted = [](const JpegFile& file) { return jpeg::decode(file.bytes).ok(); };
  CHECK(accepted(sound_gray()));
  CHECK(accepted(sound_gray().raw({1, 2, 3, 0xFF, 0xFF, 0xD8})));  // trailing junk
  CHECK(accepted(start().raw({0xFF, 0xFF, 0xFF}).dqt().sof(8, 8).small_tables().sos().bits("00").raw({0xFF}).eoi()));
  CHECK(accepted(start().segment(0xC4, {}).dqt().sof(8, 8).small_tables().sos().bits("00").eoi()));  // empty DHT
  CHECK(accepted(start().raw({1, 2, 3}).dqt().sof(8, 8).small_tables().sos().bits("00").eoi()));     // junk between
  CHECK(accepted(start().raw({0xFF, 0}).dqt().sof(8, 8).small_tables().sos().bits("00").eoi()));
  CHECK(accepted(through_tables().sos().bits("00").raw({9, 9}).eoi()));
  CHECK(accepted(start().segment(0xE2, {'I', 'C', 'C'}).dqt().sof(8, 8).small_tables().sos().bits("00").eoi()));
  CHECK(accepted(start().dqt(0, 1, 300).sof(8, 8, {{}}, 0xC1).small_tables().sos().bits("00").eoi()));
  // No DHT anywhere: the tables of Annex K are meant, DC category 0 is 00, EOB is 1010.
  CHECK(accepted(through_frame().sos().bits("00 1010").eoi()));
  CHECK(jpeg::read_info(through_frame().sos().bytes)->default_huffman);
}

TEST_CASE("every strict prefix of a file is refused, and none of its prefixes upsets lenient decoding") {
  jpeg::EncodeOptions options;
  options.restart_interval_mcus = 2;
  const auto bytes = *jpeg::encode(test_image(40, 24).view(), options);
  REQUIRE(jpeg::decode(bytes).ok());
  for (size_t n = 0; n < bytes.size(); ++n) {
    // Exactly sized, so that AddressSanitizer sees a read beyond it.
    const std::vector<uint8_t> prefix(bytes.begin(), bytes.begin() + static_cast<ptrdiff_t>(n));
    const auto strict = jpeg::decode(prefix);
    REQUIRE_FALSE(strict.ok());
    REQUIRE(strict.failure().byte_offset <= n);
    const auto lenient = jpeg::decode_lenient(prefix);
    if (lenient.ok()) REQUIRE(lenient->failure.has_value());
  }
}

TEST_CASE("single damaged bytes never do worse than an error") {
  const auto bytes = *jpeg::encode(test_image(24, 24).view(), {});
  for (size_t i = 0; i < bytes.size(); ++i) {
    for (const int change : {0x01, 0x80, 0xFF}) {
      std::vector<uint8_t> damaged = bytes;
      damaged[i] = static_cast<uint8_t>(damaged[i] ^ change);
      Limits limits;
      limits.max_pixels = 1 << 12;
      const auto strict = jpeg::decode(damaged, limits);
      const auto lenient = jpeg::decode_lenient(damaged, limits);
      if (strict.ok()) {
        REQUIRE(lenient.ok());
        REQUIRE(max_difference(strict->view(), lenient->image.view()) == 0);
      }
    }
  }
}

TEST_CASE("limits hold before anything is allocated") {
  const JpegFile huge = start().dqt().sof(65535, 65535).small_tables().sos().bits("00").eoi();
  require_failure(huge, Error::limit_exceeded, "more pixels than the limit");
  Limits limits;
  limits.max_pixels = 64;
  CHECK(jpeg::decode(sound_gray().bytes, limits).ok());
  limits.max_pixels = 63;
  REQUIRE_FALSE(jpeg::decode(sound_gray().bytes, limits).ok());
  CHECK(jpeg::decode(sound_gray().bytes, limits).failure().error == Error::limit_exceeded);
  // 3 bytes a pixel and one 8x8 plane.
  limits.max_pixels = 64;
  limits.max_bytes = 3 * 64 + 64;
  CHECK(jpeg::decode(sound_gray().bytes, limits).ok());
  limits.max_bytes -= 1;
  CHECK(jpeg::decode(sound_gray().bytes, limits).failure().error == Error::limit_exceeded);
}

}  // namespace
}  // namespace pac::test
