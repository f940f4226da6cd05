// Profiles, Exif, XMP, comments and density: written, read back, passed from file to file; never in the picture's way.
#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "jpeg/jpeg.h"
#include "jpeg/metadata.h"
#include "tests/support/generators.h"
#include "tests/support/jpeg_file.h"
#include "tests/support/peer.h"

namespace pac::test {
namespace {

using jpeg::Density;
using jpeg::Metadata;

std::vector<uint8_t> random_bytes(size_t n, uint64_t seed) {
  Random random(seed);
  std::vector<uint8_t> bytes(n);
  for (uint8_t& byte : bytes) byte = static_cast<uint8_t>(random.next());
  return bytes;
}

Metadata rich() {
  Metadata m;
  m.density = {Density::Unit::per_inch, 300, 299};
  m.exif = {'I', 'I', 42, 0, 8, 0, 0, 0, 1, 0, 0x12, 1, 3, 0, 1, 0, 0, 0, 6, 0, 0, 0, 0, 0, 0, 0};  // orientation 6
  m.xmp = random_bytes(500, 1);
  m.icc_profile = random_bytes(150000, 2);  // three segments
  m.comments = {"first", std::string("with a \0 zero", 13), ""};
  return m;
}

TEST_CASE("metadata that the encoder was given are read back, and the picture is the same") {
  const RgbImage image = test_image(30, 20);
  const Metadata metadata = rich();
  jpeg::EncodeOptions options;
  const auto plain = *jpeg::encode(image.view(), options);
  options.metadata = &metadata;
  const auto file = *jpeg::encode(image.view(), options);
  CHECK(file.size() == plain.size() + jpeg::metadata_bytes(metadata));
  const auto found = jpeg::read_metadata(file);
  REQUIRE(found.ok());
  CHECK(found->metadata == metadata);
  CHECK(found->warnings == 0);
  CHECK(max_difference(jpeg::decode(file)->view(), jpeg::decode(plain)->view()) == 0);
  const auto info = *jpeg::read_info(file);
  CHECK(info.exif_orientation == 6);
  CHECK(info.density_x == 300);
  CHECK(info.has_icc_profile);
  CHECK(jpeg::with_metadata(plain, metadata).value() == file);
  CHECK(jpeg::with_metadata(file, {}).value() == plain);
}

TEST_CASE("djpeg hands out the profile that we wrote, and we read the one that cjpeg wrote") {
  if (!have_peer("cjpeg") || !have_peer("djpeg")) return;
  TempDir dir;
  Metadata metadata;
  metadata.icc_profile = random_bytes(70000, 3);
  jpeg::EncodeOptions options;
  options.metadata = &metadata;
  const RgbImage image = test_image(16, 16);
  write_bytes(dir.file("a.jpg"), *jpeg::encode(image.view(), options));
  REQUIRE(run("djpeg -icc " + dir.file("a.icc") + " -outfile " + dir.file("a.ppm") + " " + dir.file("a.jpg")) == 0);
  CHECK(read_bytes(dir.file("a.icc")) == metadata.icc_profile);
  REQUIRE(run("cjpeg -icc " + dir.file("a.icc") + " -outfile " + dir.file("b.jpg") + " " + dir.file("a.ppm")) == 0);
  CHECK(jpeg::read_metadata(read_bytes(dir.file("b.jpg")))->metadata.icc_profile == metadata.icc_profile);
}

TEST_CASE("a profile with a part missing, twice or out of count is left out with a warning") {
  const auto part = [](JpegFile& file, int number, int count) {
    std::vector<int> data{'I', 'C', 'C', '_', 'P', 'R', 'O', 'F', 'I', 'L', 'E', 0, number, count, number};
    file.segment(0xE2, data);
  };
  const std::vector<std::vector<std::pair<int, int>>> kBroken = {{{1, 2}}, {{1, 2}, {1, 2}}, {{1, 2}, {2, 3}},
                                                                 {{0, 1}}, {{3, 2}},         {{1, 1}, {1, 1}}};
  for (const auto& parts : kBroken) {
    JpegFile file = JpegFile().soi();
    for (const auto& [number, count] : parts) part(file, number, count);
    file.dqt().sof(8, 8).small_tables().sos().bits("00").eoi();
    const auto found = jpeg::read_metadata(file.bytes);
    REQUIRE(found.ok());
    CHECK(found->metadata.icc_profile.empty());
    CHECK(found->warnings == 1);
    CHECK(jpeg::decode(file.bytes).ok());
  }
  JpegFile turned = JpegFile().soi();  // parts may come in any order
  part(turned, 2, 2);
  part(turned, 1, 2);
  turned.dqt().sof(8, 8).small_tables().sos().bits("00").eoi();
  CHECK(jpeg::read_metadata(turned.bytes)->metadata.icc_profile == std::vector<uint8_t>{1, 2});
}

TEST_CASE("metadata pass to another file whose picture and tables stay as they are") {
  Metadata metadata = rich();
  const auto target = read_bytes(PAC_SOURCE_DIR "/tests/fuzz/corpus/jpeg_decode/progressive.jpg");
  const auto merged = jpeg::with_metadata(target, metadata);
  REQUIRE(merged.ok());
  CHECK(jpeg::read_metadata(*merged)->metadata == metadata);
  CHECK(max_difference(jpeg::decode(*merged)->view(), jpeg::decode(target)->view()) == 0);
  // An RGB file must not become one of JFIF, which would make it YCbCr.
  const auto rgb = read_bytes(PAC_SOURCE_DIR "/tests/fuzz/corpus/jpeg_decode/rgb.jpg");
  const auto rgb_merged = jpeg::with_metadata(rgb, metadata);
  CHECK(jpeg::read_info(*rgb_merged)->color == jpeg::ColorModel::rgb);
  CHECK(max_difference(jpeg::decode(*rgb_merged)->view(), jpeg::decode(rgb)->view()) == 0);
}

TEST_CASE("fields too long for their segments and impossible densities are bad arguments") {
  const RgbImage image = test_image(8, 8);
  const auto refused = [&](const Metadata& metadata) {
    jpeg::EncodeOptions options;
    options.metadata = &metadata;
    const auto result = jpeg::encode(image.view(), options);
    return !result.ok() && result.failure().error == Error::bad_argument;
  };
  Metadata m;
  m.exif.resize(65527);
  m.xmp.resize(65504);
  m.comments = {std::string(65533, 'x')};
  m.density = {Density::Unit::per_cm, 65535, 1};
  CHECK_FALSE(refused(m));
  Metadata longer = m;
  longer.exif.resize(65528);
  CHECK(refused(longer));
  longer = m;
  longer.xmp.resize(65505);
  CHECK(refused(longer));
  longer = m;
  longer.comments[0] += 'x';
  CHECK(refused(longer));
  longer = m;
  longer.density.x = 65536;
  CHECK(refused(longer));
  longer.density.x = 0;
  CHECK(refused(longer));
  longer = {};
  longer.icc_profile.resize(255 * 65519 + 1);
  CHECK(refused(longer));
}

TEST_CASE("every prefix of a file with metadata gives a failure or what it holds") {
  const Metadata metadata = rich();
  jpeg::EncodeOptions options;
  options.metadata = &metadata;
  const auto file = *jpeg::encode(test_image(8, 8).view(), options);
  for (size_t n = 0; n < file.size(); n += n < 1000 ? 1 : 997) {
    const std::vector<uint8_t> prefix(file.begin(), file.begin() + static_cast<ptrdiff_t>(n));
    const auto found = jpeg::read_metadata(prefix);
    const auto merged = jpeg::with_metadata(prefix, metadata);
    REQUIRE(found.ok() == merged.ok());
  }
}

}  // namespace
}  // namespace pac::test
