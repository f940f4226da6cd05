// PGM, PPM and PFM files.
#include "base/pnm.h"

#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include "base/image_io.h"
#include "base/pfm.h"
#include "tests/support/generators.h"
#include "tests/support/peer.h"

namespace pac::test {
namespace {

using Bytes = std::vector<uint8_t>;

Bytes bytes_of(const std::string& text) {
  return {text.begin(), text.end()};
}
Failure failure_of(const std::string& text, const Limits& limits = {}) {
  const auto image = decode_pnm_rgb(bytes_of(text), limits);
  CAPTURE(text);
  REQUIRE_FALSE(image.ok());
  CHECK(image.failure().byte_offset <= text.size());
  return image.failure();
}

TEST_CASE("PPM and PGM come back as they were written") {
  RgbImage rgb(7, 5);
  GrayImage gray(7, 5);
  for (int y = 0; y < 5; ++y) {
    fill(std::span(rgb.row(y), 21), Pattern::random, 0, 255, static_cast<uint64_t>(y));
    fill(std::span(gray.row(y), 7), Pattern::random, 0, 255, static_cast<uint64_t>(y));
  }
  const auto rgb_again = decode_pnm_rgb(encode_ppm(rgb.view()));
  const auto gray_again = decode_pgm(encode_pgm(gray.view()));
  const auto spread = decode_pnm_rgb(encode_pgm(gray.view()));
  REQUIRE(rgb_again.ok());
  REQUIRE(gray_again.ok());
  REQUIRE(spread.ok());
  for (int y = 0; y < 5; ++y) {
    CHECK(std::memcmp(rgb.row(y), rgb_again->row(y), 21) == 0);
    CHECK(std::memcmp(gray.row(y), gray_again->row(y), 7) == 0);
    for (int x = 0; x < 7; ++x)
      for (int c = 0; c < 3; ++c) REQUIRE(spread->pixel(x, y)[c] == *gray.pixel(x, y));
  }
  CHECK(decode_pgm(encode_ppm(rgb.view())).failure().error == Error::unsupported);
}

TEST_CASE("plain files, comments anywhere in the header, any white space") {
  const auto ppm = decode_pnm_rgb(bytes_of("P3# a\n#b\n2\t1 #c\r255\n1 2 3\n # between samples\n4 5\v6"));
  REQUIRE_MESSAGE(ppm.ok(), ppm.failure().text);
  CHECK(ppm->pixel(1, 0)[2] == 6);
  const auto pgm = decode_pgm(bytes_of("P2 3 1 15 0 7 15 "));
  REQUIRE(pgm.ok());
  CHECK(*pgm->pixel(1, 0) == 119);
  CHECK(*pgm->pixel(2, 0) == 255);
  const auto raw = decode_pgm(bytes_of("P5\n# made by hand\n2 1\n255\n#!"));  // '#' after the header is a sample
  REQUIRE(raw.ok());
  CHECK(*raw->pixel(0, 0) == '#');
}

TEST_CASE("any maxval reduces to 8 bits with rounding") {
  for (const int maxval : {1, 2, 7, 100, 254, 255, 256, 1000, 4095, 65534, 65535}) {
    CAPTURE(maxval);
    Bytes file = bytes_of("P5 5 1 " + std::to_string(maxval) + "\n");
    const int samples[5] = {0, 1, maxval / 2, maxval - 1, maxval};
    for (int sample : samples) {
      if (maxval > 255) file.push_back(static_cast<uint8_t>(sample >> 8));
      file.push_back(static_cast<uint8_t>(sample));
    }
    const auto image = decode_pgm(file);
    REQUIRE(image.ok());
    for (int x = 0; x < 5; ++x) {
      const double exact = 255.0 * samples[x] / maxval;
      CHECK(std::abs(*image->pixel(x, 0) - exact) <= 0.5);
    }
  }
}

TEST_CASE("what breaks the format is named") {
  CHECK(failure_of("P6 2 1 0\nxxxxxx").error == Error::corrupt);
  CHECK(failure_of("P6 2 1 65536\nxxxxxx").error == Error::corrupt);
  CHECK(failure_of("P6 0 1 255\n").error == Error::corrupt);
  CHECK(failure_of("P6 1 0 255\n").error == Error::corrupt);
  CHECK(failure_of("P6 -1 1 255\n").error == Error::corrupt);
  CHECK(failure_of("P6 2147483648 1 255\n").error == Error::corrupt);
  CHECK(failure_of("P6 1 1 255x").error == Error::corrupt);
  CHECK(failure_of("P7 1 1 255\n").error == Error::corrupt);
  CHECK(failure_of("P1 1 1 1\n").error == Error::unsupported);
  CHECK(failure_of("P4 1 1 1\n").error == Error::unsupported);
  const Failure over = failure_of("P3 1 1 9\n1 10 1");
  CHECK(std::string(over.text) == "PNM sample is not a number up to maxval");
  CHECK(over.byte_offset == 11);
  CHECK(failure_of("P3 1 1 9\n1 2 x").byte_offset == 13);
  CHECK(failure_of("P3 1 1 9\n1 2x 3").byte_offset == 12);
  const Failure raw_over = failure_of("P6 1 1 9\n\x01\x02\x0A");
  CHECK(std::string(raw_over.text) == "PNM sample is over maxval");
  CHECK(raw_over.byte_offset == 11);
}

TEST_CASE("limits: a picture at the limit is read, one pixel more is not, nor is a huge claim") {
  Limits limits;
  limits.max_pixels = 4;
  CHECK(decode_pgm(bytes_of("P5 2 2 255\nabcd"), limits).ok());
  CHECK(failure_of("P5 5 1 255\nabcde", limits).error == Error::limit_exceeded);
  CHECK(failure_of("P5 2147483647 2147483647 255\nabcde").error == Error::limit_exceeded);
  CHECK(failure_of("P5 10000 10000 255\nabcde").error == Error::truncated);
  CHECK(failure_of("P2 10000 10000 255\n1 2 3").error == Error::truncated);
}

TEST_CASE("every strict prefix of a raw or plain file is rejected as truncated") {
  for (const std::string& text :
       {std::string("P6\n#c\n3 2\n255\nabcdefghijklmnopqr"), std::string("P5 2 2 999\n\0\1\0\2\0\3\0\4", 19),
        std::string("P3 1 2 255\n1 2 3 4 5 6"), std::string("P2 2 1 20\n7 8")}) {
    REQUIRE(decode_pnm_rgb(bytes_of(text)).ok());
    for (size_t n = 0; n < text.size(); ++n) {
      CAPTURE(n);
      REQUIRE(failure_of(text.substr(0, n)).error == Error::truncated);
    }
  }
}

TEST_CASE("peer: netpbm writes plain and 16-bit files that we read as it does") {
  if (!have_peer("pnmtoplainpnm") || !have_peer("pamdepth")) return;
  const TempDir dir;
  RgbImage image(9, 4);
  for (int y = 0; y < 4; ++y) fill(std::span(image.row(y), 27), Pattern::random, 0, 255, static_cast<uint64_t>(y));
  write_bytes(dir.file("a.ppm"), encode_ppm(image.view()));
  for (const char* command : {"pnmtoplainpnm", "pamdepth 65535", "pamdepth 255"}) {
    CAPTURE(command);
    REQUIRE(run(std::string(command) + " " + dir.file("a.ppm") + " > " + dir.file("b.ppm")) == 0);
    const auto again = decode_rgb(read_bytes(dir.file("b.ppm")));
    REQUIRE_MESSAGE(again.ok(), again.failure().text);
    for (int y = 0; y < 4; ++y) CHECK(std::memcmp(image.row(y), again->row(y), 27) == 0);
  }
}

// --- PFM

DepthImage make_depth() {
  DepthImage depth(3, 2);
  const float values[6] = {
      0.0f, -1.5f, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN(), 1e-40f, 0.1f};
  for (int i = 0; i < 6; ++i) *depth.pixel(i % 3, i / 3) = values[i];
  return depth;
}

TEST_CASE("PFM keeps every bit of every float, in either byte order") {
  const DepthImage depth = make_depth();
  const Bytes little = encode_pfm(depth.view());
  const std::string header = "Pf\n3 2\n-1.0\n";
  REQUIRE(std::equal(header.begin(), header.end(), little.begin()));
  Bytes big = bytes_of("Pf 3 2\n2.5\n");
  for (size_t i = header.size(); i < little.size(); i += 4)
    for (size_t k = 4; k-- > 0;) big.push_back(little[i + k]);
  for (const Bytes& file : {little, big}) {
    const auto again = decode_pfm(file);
    REQUIRE_MESSAGE(again.ok(), again.failure().text);
    for (int y = 0; y < 2; ++y) CHECK(std::memcmp(depth.row(y), again->row(y), 12) == 0);
  }
}

TEST_CASE("PFM: prefixes, wrong headers and sizes over the limit are refused") {
  const Bytes file = encode_pfm(make_depth().view());
  for (size_t n = 0; n < file.size(); ++n) {
    CAPTURE(n);
    const auto image = decode_pfm(std::span(file).first(n));
    REQUIRE_FALSE(image.ok());
    REQUIRE(image.failure().error == Error::truncated);
  }
  const auto error_of = [](const std::string& text, const Limits& limits = {}) {
    const auto image = decode_pfm(bytes_of(text), limits);
    REQUIRE_FALSE(image.ok());
    return image.failure().error;
  };
  CHECK(error_of("PF\n1 1\n-1\n") == Error::unsupported);
  CHECK(error_of("P6\n1 1\n-1\n") == Error::corrupt);
  CHECK(error_of("Pf\n0 1\n-1\n") == Error::corrupt);
  CHECK(error_of("Pf\n1 1\n0.0\n1234") == Error::corrupt);
  CHECK(error_of("Pf\n1 1\nx\n1234") == Error::corrupt);
  CHECK(error_of("Pf22346.1") == Error::corrupt);  // a scale after a failure: once read for ever
  CHECK(error_of("Pf\n1 1\n1.0x1234") == Error::corrupt);
  Limits limits;
  limits.max_pixels = 3;
  CHECK(error_of("Pf\n2 2\n-1\n0123456789abcdef", limits) == Error::limit_exceeded);
  CHECK(error_of("Pf\n2147483647 2147483647\n-1\n") == Error::limit_exceeded);
}

}  // namespace
}  // namespace pac::test
