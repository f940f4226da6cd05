// Damaged, cut and malicious streams: a defined outcome for each, and nothing beyond it.
#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "mpeg1/headers.h"
#include "mpeg1/system.h"
#include "tests/support/generators.h"
#include "tests/support/mpeg1_clip.h"

namespace pac::test {
namespace {

std::vector<uint8_t> sample_stream(int width = 64, int height = 48, int slice_rows = 1) {
  mpeg1::SequenceOptions options;
  options.width = width;
  options.height = height;
  options.slice_rows = slice_rows;
  options.gop_length = 4;
  return encode_clip(clip(width, height, 6), options);
}

// Decodes what may be anything; the outcome of the last call.
struct Outcome {
  size_t pictures = 0;
  bool failed = false;
  Failure failure;
  mpeg1::ErrorReport report;
};
Outcome decode_anything(std::span<const uint8_t> bytes, bool strict) {
  mpeg1::DecoderOptions options;
  options.strict = strict;
  options.limits.max_pixels = 1 << 20;
  mpeg1::Decoder decoder(options);
  // From memory of exactly that size, so that a sanitizer sees every read beyond it.
  const std::vector<uint8_t> exact(bytes.begin(), bytes.end());
  decoder.feed(exact);
  decoder.finish();
  Outcome outcome;
  for (;;) {
    const auto picture = decoder.next();
    if (!picture.ok()) {
      outcome.failed = true;
      outcome.failure = picture.failure();
      break;
    }
    if (*picture == nullptr) break;
    ++outcome.pictures;
  }
  outcome.report = decoder.report();
  return outcome;
}

TEST_CASE("every strict prefix decodes to no more pictures, and never fails in lenient mode") {
  const std::vector<uint8_t> bytes = sample_stream();
  const size_t all = decode_anything(bytes, true).pictures;
  CHECK(all == 6);
  size_t last = 0;
  for (size_t size = 0; size < bytes.size(); ++size) {
    const Outcome outcome = decode_anything(std::span(bytes).first(size), false);
    REQUIRE_FALSE(outcome.failed);
    REQUIRE(outcome.pictures <= all);
    REQUIRE(outcome.pictures >= last);
    last = outcome.pictures;
  }
}

TEST_CASE("corrupted bytes are concealed and reported, or a failure with an offset inside the stream") {
  const std::vector<uint8_t> bytes = sample_stream();
  Random random(5);
  int reported = 0;
  for (int round = 0; round < 400; ++round) {
    std::vector<uint8_t> damaged = bytes;
    for (int i = 0; i < 1 + round % 5; ++i)
      damaged[static_cast<size_t>(random.in(0, static_cast<int64_t>(bytes.size()) - 1))] =
          static_cast<uint8_t>(random.next());
    for (const bool strict : {false, true}) {
      const Outcome outcome = decode_anything(damaged, strict);
      REQUIRE(outcome.pictures <= 2000);
      if (outcome.failed) REQUIRE(outcome.failure.byte_offset <= damaged.size());
      if (outcome.report.errors > 0) {
        ++reported;
        REQUIRE(outcome.report.first.byte_offset <= damaged.size());
        REQUIRE(outcome.report.first.text[0] != 0);
      }
    }
  }
  CHECK(reported > 300);
}

TEST_CASE("a lost slice is concealed from the picture before, and decoding goes on at the next") {
  const std::vector<uint8_t> bytes = sample_stream();
  // The second picture's second slice.
  size_t at = 0;
  int pictures = 0;
  for (; at + 4 < bytes.size(); ++at) {
    if (bytes[at] != 0 || bytes[at + 1] != 0 || bytes[at + 2] != 1) continue;
    if (bytes[at + 3] == 0) ++pictures;
    if (pictures == 2 && bytes[at + 3] == 2) break;
  }
  size_t end = at + 4;
  while (bytes[end] != 0 || bytes[end + 1] != 0 || bytes[end + 2] != 1) ++end;
  std::vector<uint8_t> damaged = bytes;
  damaged.erase(damaged.begin() + static_cast<ptrdiff_t>(at), damaged.begin() + static_cast<ptrdiff_t>(end));
  const Outcome lenient = decode_anything(damaged, false);
  CHECK(lenient.pictures == 6);
  CHECK(lenient.report.concealed_macroblocks == 4);
  const Outcome strict = decode_anything(damaged, true);
  CHECK(strict.failed);
  CHECK(strict.pictures < 6);
}

TEST_CASE("any division of the stream into feeds gives the same pictures") {
  const std::vector<uint8_t> bytes = sample_stream(80, 64, 0);
  const std::vector<Frame420> expected = decode_all(bytes);
  for (const size_t step : {size_t{1}, size_t{3}, size_t{7}, size_t{1000}}) {
    mpeg1::Decoder decoder;
    size_t n = 0;
    const auto drain = [&] {
      for (;;) {
        const auto picture = decoder.next();
        REQUIRE(picture.ok());
        if (*picture == nullptr) return;
        REQUIRE(n < expected.size());
        REQUIRE(equal((*picture)->view, mpeg1::view_of(expected[n++])));
      }
    };
    for (size_t at = 0; at < bytes.size(); at += step) {
      decoder.feed(std::span(bytes).subspan(at, std::min(step, bytes.size() - at)));
      drain();
    }
    decoder.finish();
    drain();
    CHECK(n == expected.size());
  }
}

TEST_CASE("with low_delay and end_picture each picture comes out as soon as its bytes are there") {
  mpeg1::SequenceOptions options;
  options.width = 64;
  options.height = 48;
  auto encoder = mpeg1::Encoder::create(options);
  mpeg1::DecoderOptions decoder_options;
  decoder_options.low_delay = true;
  mpeg1::Decoder decoder(decoder_options);
  for (const Frame420& frame : clip(64, 48, 5)) {
    std::vector<uint8_t> bytes;
    REQUIRE(encoder->add(frame, bytes).ok());
    decoder.feed(bytes);
    decoder.end_picture();
    const auto picture = decoder.next();
    REQUIRE(picture.ok());
    REQUIRE(*picture != nullptr);
    CHECK(equal((*picture)->view, encoder->reconstruction()));
    CHECK(*decoder.next() == nullptr);
  }
}

// A stream whose sequence header has one field changed.
std::vector<uint8_t> with_header(const mpeg1::SequenceHeader& header) {
  std::vector<uint8_t> bytes;
  mpeg1::write_sequence_header(header, bytes);
  return bytes;
}
mpeg1::SequenceHeader good_header() {
  mpeg1::SequenceHeader header;
  header.width = 64;
  header.height = 48;
  return header;
}

TEST_CASE("each field of the sequence header is refused one past its limit") {
  const auto parse = [](const mpeg1::SequenceHeader& header) {
    const std::vector<uint8_t> bytes = with_header(header);
    return mpeg1::parse_sequence_header(std::span(bytes).subspan(4));
  };
  CHECK(parse(good_header()).ok());
  const auto fails = [&](auto change, Error error) {
    mpeg1::SequenceHeader header = good_header();
    change(header);
    const auto result = parse(header);
    REQUIRE_FALSE(result.ok());
    CHECK(result.failure().error == error);
  };
  fails([](auto& h) { h.width = 0; }, Error::corrupt);
  fails([](auto& h) { h.height = 0; }, Error::corrupt);
  fails([](auto& h) { h.height = 2801; }, Error::unsupported);
  fails([](auto& h) { h.pel_aspect_ratio_code = 0; }, Error::corrupt);
  fails([](auto& h) { h.pel_aspect_ratio_code = 15; }, Error::corrupt);
  fails([](auto& h) { h.picture_rate_code = 0; }, Error::corrupt);
  fails([](auto& h) { h.picture_rate_code = 9; }, Error::corrupt);
  fails([](auto& h) { h.bit_rate = 0; }, Error::corrupt);
  fails([](auto& h) { h.has_intra_matrix = true, h.intra_matrix[5] = 0; }, Error::corrupt);
  fails([](auto& h) { h.has_non_intra_matrix = true, h.non_intra_matrix[63] = 0; }, Error::corrupt);
}

TEST_CASE("a header of the largest size allocates nothing before a picture, and then only within the limit") {
  mpeg1::SequenceHeader header = good_header();
  header.width = 4095;
  header.height = 2800;
  const Outcome outcome = decode_anything(with_header(header), false);
  CHECK(outcome.failed);
  CHECK(outcome.failure.error == Error::limit_exceeded);
}

TEST_CASE("MPEG-2 is unsupported, by name") {
  std::vector<uint8_t> bytes = with_header(good_header());
  mpeg1::write_start_code(mpeg1::kExtensionStart, bytes);
  bytes.insert(bytes.end(), {0x14, 0x82, 0, 1, 0, 0, 0, 0});
  const Outcome outcome = decode_anything(bytes, false);
  CHECK(outcome.failed);
  CHECK(outcome.failure.error == Error::unsupported);
  CHECK(std::string(outcome.failure.text).find("MPEG-2") != std::string::npos);
}

TEST_CASE("pictures without their references are dropped and counted") {
  const std::vector<uint8_t> bytes = sample_stream();
  // From the first P picture on, with the sequence header before it.
  std::vector<uint8_t> cut(bytes.begin(), bytes.begin() + 12);
  int pictures = 0;
  for (size_t at = 0; at + 4 < bytes.size(); ++at) {
    if (bytes[at] != 0 || bytes[at + 1] != 0 || bytes[at + 2] != 1 || bytes[at + 3] != 0) continue;
    if (++pictures == 2) cut.insert(cut.end(), bytes.begin() + static_cast<ptrdiff_t>(at), bytes.end());
  }
  const Outcome outcome = decode_anything(cut, false);
  CHECK_FALSE(outcome.failed);
  CHECK(outcome.report.dropped_pictures == 3);
  CHECK(outcome.pictures == 2);  // the second group
}

TEST_CASE("a system stream gives back the elementary stream, whatever is cut off its end") {
  const std::vector<uint8_t> video = sample_stream(320, 240, 0);
  const auto system = mpeg1::multiplex(video);
  REQUIRE(system.ok());
  CHECK(mpeg1::is_system_stream(*system));
  CHECK_FALSE(mpeg1::is_system_stream(video));
  const auto back = mpeg1::demultiplex(*system);
  REQUIRE(back.ok());
  CHECK(back->video == video);
  CHECK(back->errors == 0);
  CHECK(back->first_pts_90khz > 0);
  for (size_t size = 0; size < system->size(); size += 97) {
    const auto part = mpeg1::demultiplex(std::span(*system).first(size));
    if (part.ok()) CHECK(std::equal(part->video.begin(), part->video.end(), video.begin()));
  }
}

TEST_CASE("info counts pictures and knows repeated ones") {
  mpeg1::SequenceOptions options;
  options.width = 64;
  options.height = 48;
  auto encoder = mpeg1::Encoder::create(options);
  std::vector<uint8_t> bytes;
  for (const Frame420& frame : clip(64, 48, 3)) REQUIRE(encoder->add(frame, bytes).ok());
  REQUIRE(encoder->repeat(bytes).ok());
  encoder->finish(bytes);
  const auto info = mpeg1::read_info(bytes);
  REQUIRE(info.ok());
  CHECK(info->sequence.width == 64);
  CHECK(info->pictures[1] == 1);
  CHECK(info->pictures[2] == 3);
  CHECK(info->repeated_pictures == 1);
  CHECK(info->ends);
}

}  // namespace
}  // namespace pac::test
