#include "base/y4m.h"

#include <doctest/doctest.h>

#include <cstring>
#include <string>
#include <string_view>

#include "tests/support/generators.h"
#include "tests/support/peer.h"

namespace pac::test {
namespace {

Frame420 make_frame(int width, int height, uint64_t seed) {
  Frame420 frame(width, height);
  for (GrayImage* plane : {&frame.y, &frame.cb, &frame.cr})
    for (int y = 0; y < plane->height(); ++y)
      fill(std::span(plane->row(y), static_cast<size_t>(plane->width())), Pattern::random, 0, 255,
           ++seed * 1000 + static_cast<uint64_t>(y));
  return frame;
}

bool equal(const GrayImage& a, const GrayImage& b) {
  if (a.width() != b.width() || a.height() != b.height()) return false;
  for (int y = 0; y < a.height(); ++y)
    if (std::memcmp(a.row(y), b.row(y), static_cast<size_t>(a.width())) != 0) return false;
  return true;
}
bool equal(const Frame420& a, const Frame420& b) {
  return equal(a.y, b.y) && equal(a.cb, b.cb) && equal(a.cr, b.cr);
}

std::vector<uint8_t> bytes_of(std::string_view text) {
  return {text.begin(), text.end()};
}

Failure failure_of(std::string_view text, const Limits& limits = {}) {
  const auto reader = Y4mReader::open(bytes_of(text), limits);
  REQUIRE_FALSE(reader.ok());
  return reader.failure();
}

TEST_CASE("frames come back as they were written, odd sizes too") {
  for (const auto& [width, height] : {std::pair{1, 1}, {2, 3}, {7, 5}, {64, 48}}) {
    std::vector<uint8_t> file;
    append_y4m_header(file, {width, height, 20, 1, 1, 1, ChromaSiting::mpeg2});
    for (uint64_t i = 0; i < 3; ++i) append_y4m_frame(file, make_frame(width, height, i));
    auto reader = Y4mReader::open(file);
    REQUIRE(reader.ok());
    CHECK(reader->header().width == width);
    CHECK(reader->header().rate_numerator == 20);
    CHECK(reader->header().siting == ChromaSiting::mpeg2);
    Frame420 frame;
    for (uint64_t i = 0; i < 3; ++i) {
      const auto more = reader->next(frame);
      REQUIRE(more.ok());
      REQUIRE(*more);
      CHECK(equal(frame, make_frame(width, height, i)));
    }
    const auto more = reader->next(frame);
    REQUIRE(more.ok());
    CHECK_FALSE(*more);
  }
}

TEST_CASE("the header's parameters may come in any order, with comments and defaults") {
  const auto reader = Y4mReader::open(bytes_of("YUV4MPEG2 H4 XYSCSS=420JPEG W6 A0:0 I? F30000:1001 XCOLOR\n"));
  REQUIRE(reader.ok());
  CHECK(reader->header().width == 6);
  CHECK(reader->header().height == 4);
  CHECK(reader->header().rate_denominator == 1001);
  CHECK(reader->header().siting == ChromaSiting::jpeg);
}

TEST_CASE("a wrong header is named, with its place") {
  CHECK(failure_of("").error == Error::truncated);
  CHECK(failure_of("YUV4MPEG W1 H1\n").byte_offset == 8);
  CHECK(std::string(failure_of("YUV4MPEG2 W4\n").text) == "Y4M header without a height");
  CHECK(std::string(failure_of("YUV4MPEG2 H4\n").text) == "Y4M header without a width");
  CHECK(std::string(failure_of("YUV4MPEG2 W4 H4 W4\n").text) == "Y4M parameter is repeated");
  CHECK(failure_of("YUV4MPEG2 W4 H4 W4\n").byte_offset == 16);
  CHECK(std::string(failure_of("YUV4MPEG2 W4 H4 Q\n").text) == "Y4M parameter is undefined");
  CHECK(failure_of("YUV4MPEG2 W0 H4\n").error == Error::corrupt);
  CHECK(failure_of("YUV4MPEG2 W-1 H4\n").error == Error::corrupt);
  CHECK(failure_of("YUV4MPEG2 W2147483648 H4\n").error == Error::corrupt);
  CHECK(failure_of("YUV4MPEG2 W4 H4 F25\n").error == Error::corrupt);
  CHECK(failure_of("YUV4MPEG2 W4 H4 F25:0\n").error == Error::corrupt);
  CHECK(failure_of("YUV4MPEG2 W4x H4\n").error == Error::corrupt);
  CHECK(failure_of("YUV4MPEG2 W4 H4 Iz\n").error == Error::corrupt);
  for (const char* text :
       {"YUV4MPEG2 W4 H4 C422\n", "YUV4MPEG2 W4 H4 C420p10\n", "YUV4MPEG2 W4 H4 Cmono\n", "YUV4MPEG2 W4 H4 It\n"}) {
    CAPTURE(text);
    CHECK(failure_of(text).error == Error::unsupported);
  }
}

TEST_CASE("a size at the limit is read, one past it is refused before anything is allocated") {
  Limits limits;
  limits.max_pixels = 600;
  CHECK(Y4mReader::open(bytes_of("YUV4MPEG2 W30 H20\n"), limits).ok());
  CHECK(failure_of("YUV4MPEG2 W601 H1\n", limits).error == Error::limit_exceeded);
  CHECK(failure_of("YUV4MPEG2 W2147483647 H2147483647\n").error == Error::limit_exceeded);
}

TEST_CASE("every strict prefix is either a shorter sequence of whole frames or rejected as truncated") {
  std::vector<uint8_t> file;
  append_y4m_header(file, {5, 3, 25, 1, 0, 0, ChromaSiting::jpeg});
  const size_t header_size = file.size();
  for (uint64_t i = 0; i < 2; ++i) append_y4m_frame(file, make_frame(5, 3, i));
  const size_t frame_size = (file.size() - header_size) / 2;
  for (size_t n = 0; n < file.size(); ++n) {
    CAPTURE(n);
    const std::vector<uint8_t> prefix(file.begin(), file.begin() + static_cast<ptrdiff_t>(n));
    auto reader = Y4mReader::open(prefix);
    REQUIRE(reader.ok() == (n >= header_size));
    if (!reader.ok()) {
      REQUIRE(reader.failure().error == Error::truncated);
      continue;
    }
    Frame420 frame;
    auto more = reader->next(frame);
    while (more.ok() && *more) more = reader->next(frame);
    REQUIRE(more.ok() == ((n - header_size) % frame_size == 0));
    if (!more.ok()) REQUIRE(more.failure().error == Error::truncated);
  }
}

TEST_CASE("something else than FRAME between frames is corrupt") {
  std::vector<uint8_t> file;
  append_y4m_header(file, {1, 1, 25, 1, 0, 0, ChromaSiting::jpeg});
  const size_t at = file.size();
  append_y4m_frame(file, make_frame(1, 1, 0));
  file[at + 2] = 'x';
  auto reader = Y4mReader::open(file);
  REQUIRE(reader.ok());
  Frame420 frame;
  const auto more = reader->next(frame);
  REQUIRE_FALSE(more.ok());
  CHECK(more.failure().error == Error::corrupt);
  CHECK(more.failure().byte_offset == at + 2);
}

TEST_CASE("peer: ffmpeg reads our Y4M to the same samples, and writes one that we read to them again") {
  if (!have_peer("ffmpeg")) return;
  const TempDir dir;
  std::vector<uint8_t> file;
  append_y4m_header(file, {34, 18, 20, 1, 1, 1, ChromaSiting::jpeg});
  for (uint64_t i = 0; i < 3; ++i) append_y4m_frame(file, make_frame(34, 18, i));
  write_bytes(dir.file("ours.y4m"), file);
  const std::string command = "ffmpeg -y -i " + dir.file("ours.y4m") + " -pix_fmt yuv420p -f yuv4mpegpipe ";
  REQUIRE(run(command + dir.file("theirs.y4m")) == 0);
  const auto theirs = read_bytes(dir.file("theirs.y4m"));
  auto reader = Y4mReader::open(theirs);
  REQUIRE(reader.ok());
  CHECK(reader->header().rate_numerator == 20);
  Frame420 frame;
  for (uint64_t i = 0; i < 3; ++i) {
    const auto more = reader->next(frame);
    REQUIRE(more.ok());
    REQUIRE(*more);
    CHECK(equal(frame, make_frame(34, 18, i)));
  }
}

}  // namespace
}  // namespace pac::test
