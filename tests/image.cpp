// Images, results and whole files.
#include "base/image.h"

#include <doctest/doctest.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "base/file_io.h"
#include "tests/support/peer.h"

namespace pac::test {
namespace {

TEST_CASE("an image's rows are 64-byte aligned, zero, and followed by readable bytes") {
  for (const int width : {1, 3, 21, 22, 64, 100}) {
    RgbImage image(width, 3);
    CHECK(image.stride() % 64 == 0);
    CHECK(image.stride() >= 3 * width);
    for (int y = 0; y < 3; ++y) {
      CHECK(reinterpret_cast<uintptr_t>(image.row(y)) % 64 == 0);
      for (ptrdiff_t i = 0; i < image.stride(); ++i) REQUIRE(image.row(y)[i] == 0);
    }
    for (ptrdiff_t i = 0; i < 64; ++i) REQUIRE(image.row(2)[image.stride() + i] == 0);
  }
  const DepthImage depth(5, 2);
  CHECK(depth.stride() == 16);  // in elements
}

TEST_CASE("sizes that are negative or over the limit make no image") {
  Limits limits;
  limits.max_pixels = 100;
  CHECK(RgbImage::create(10, 10, limits).ok());
  CHECK(RgbImage::create(101, 1, limits).failure().error == Error::limit_exceeded);
  CHECK(RgbImage::create(-1, 5).failure().error == Error::bad_argument);
  CHECK(RgbImage::create(5, -1).failure().error == Error::bad_argument);
  CHECK(RgbImage::create(int64_t{1} << 40, 0).failure().error == Error::limit_exceeded);
  CHECK(RgbImage::create(int64_t{1} << 32, int64_t{1} << 32).failure().error == Error::limit_exceeded);
  const auto empty = RgbImage::create(0, 7);
  REQUIRE(empty.ok());
  CHECK(empty->empty());
}

TEST_CASE("moving an image leaves an empty one; a clone is independent") {
  GrayImage a(4, 4);
  *a.pixel(3, 3) = 9;
  GrayImage copy = a.clone();
  *copy.pixel(3, 3) = 1;
  CHECK(*a.pixel(3, 3) == 9);
  const uint8_t* data = a.row(0);
  GrayImage b = std::move(a);
  CHECK(a.empty());  // NOLINT(bugprone-use-after-move): that it is empty is the claim
  CHECK(b.row(0) == data);
  CHECK(*b.pixel(3, 3) == 9);
  b = GrayImage(1, 1);
  CHECK(b.width() == 1);
}

TEST_CASE("a 4:2:0 frame's chroma is half its luma, rounded up") {
  const Frame420 frame(5, 3);
  CHECK(frame.cb.width() == 3);
  CHECK(frame.cr.height() == 2);
}

TEST_CASE("a view with a negative stride walks an image upside down") {
  GrayImage image(2, 3);
  for (int y = 0; y < 3; ++y) *image.pixel(1, y) = static_cast<uint8_t>(y);
  const PlaneView<uint8_t> flipped{image.row(2), 2, 3, -image.stride()};
  CHECK(*flipped.pixel(1, 0) == 2);
  CHECK(*flipped.pixel(1, 2) == 0);
}

Result<int> half(int value) {
  if (value % 2 != 0) return Failure{Error::bad_argument, 7, "odd"};
  return value / 2;
}
Result<int> quarter(int value) {
  PAC_TRY(const int h, half(value));
  PAC_CHECK(half(h));
  return half(h);
}

TEST_CASE("results carry a value or a failure, and PAC_TRY hands the failure on") {
  CHECK(quarter(12).value() == 3);
  CHECK(quarter(3).failure().byte_offset == 7);
  CHECK(std::string(quarter(6).failure().text) == "odd");
  CHECK_FALSE(quarter(6));
  Result<void> fine;
  CHECK(fine.ok());
  const Result<void> failed = Failure{Error::io, 1, "x"};
  CHECK(failed.failure().error == Error::io);
  CHECK(std::string(error_name(Error::io)) == "i/o error");
  CHECK(std::string(error_name(Error::truncated)) == "truncated");
  Result<std::vector<int>> moved = std::vector<int>{1, 2, 3};
  CHECK(std::move(moved).value().size() == 3);
}

TEST_CASE("files: written whole, read whole, refused over the limit") {
  const TempDir dir;
  const std::vector<uint8_t> bytes(100000, 42);
  REQUIRE(write_file(dir.file("a"), bytes).ok());
  const auto again = read_file(dir.file("a"));
  REQUIRE(again.ok());
  CHECK(*again == bytes);
  Limits limits;
  limits.max_bytes = 99999;
  CHECK(read_file(dir.file("a"), limits).failure().error == Error::limit_exceeded);
  CHECK(read_file(dir.file("none")).failure().error == Error::io);
  CHECK(read_file(dir.path()).failure().error == Error::io);
  CHECK(write_file(dir.file("no/such/folder"), bytes).failure().error == Error::io);
  REQUIRE(write_file(dir.file("a"), {}).ok());
  CHECK(read_file(dir.file("a"))->empty());
}

}  // namespace
}  // namespace pac::test
