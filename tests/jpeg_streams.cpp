// Abbreviated streams: tables once, images without.
#include <doctest/doctest.h>

#include <vector>

#include "jpeg/abbreviated.h"
#include "tests/support/jpeg_file.h"
#include "tests/support/peer.h"

namespace pac::test {
namespace {

using jpeg::EncodeOptions;
using jpeg::StreamDecoder;
using jpeg::StreamTables;

std::vector<RgbImage> frames() {
  std::vector<RgbImage> images;
  for (uint64_t i = 0; i < 4; ++i) images.push_back(test_image(40, 30, i));
  return images;
}

TEST_CASE("images of a stream decode to the pixels of whole files") {
  const auto images = frames();
  for (const auto effort : {jpeg::Effort::fast, jpeg::Effort::normal, jpeg::Effort::best}) {
    EncodeOptions options = jpeg::options_for(effort, jpeg::Tune::psnr, 60);
    const ConstRgbView first[] = {images[0].view(), images[1].view()};
    const auto tables = StreamTables::for_pictures(first, options);
    REQUIRE(tables.ok());
    StreamDecoder decoder;
    REQUIRE(decoder.read_tables(tables->file()).ok());
    for (const RgbImage& image : images) {
      EncodeOptions own = options;
      own.tables = tables->steps();
      own.trellis = false;  // the trellis weighs bits, which differ
      own.stream = nullptr;
      const auto whole = *jpeg::encode(image.view(), own);
      own.stream = &*tables;
      const auto part = *jpeg::encode(image.view(), own);
      CHECK(part.size() + 200 < whole.size());
      REQUIRE_FALSE(jpeg::decode(part).ok());  // alone it is no file
      const auto decoded = decoder.decode(part);
      REQUIRE(decoded.ok());
      REQUIRE(max_difference(decoded->view(), jpeg::decode(whole)->view()) == 0);
      own.trellis = options.trellis;
      REQUIRE(decoder.decode(*jpeg::encode(image.view(), own)).ok());
    }
  }
}

TEST_CASE("tables with Annex K's codes serve every picture, gray ones too") {
  const auto tables = StreamTables::standard(jpeg::annex_k_tables(80));
  REQUIRE(tables.ok());
  StreamDecoder decoder;
  REQUIRE(decoder.read_tables(tables->file()).ok());
  EncodeOptions options;
  options.stream = &*tables;
  options.huffman = jpeg::Huffman::standard;
  for (const auto subsampling : {jpeg::Subsampling::yuv420, jpeg::Subsampling::gray, jpeg::Subsampling::yuv444}) {
    options.subsampling = subsampling;
    options.restart_interval_mcus = subsampling == jpeg::Subsampling::gray ? 2 : 0;
    const auto decoded = decoder.decode(*jpeg::encode(test_image(33, 21).view(), options));
    REQUIRE(decoded.ok());
    CHECK(decoded->width() == 33);
  }
  jpeg::QuantTables bad = jpeg::annex_k_tables(80);
  bad.chroma[3] = 256;
  CHECK_FALSE(StreamTables::standard(bad).ok());
  CHECK_FALSE(StreamTables::for_pictures({}, {}).ok());
}

TEST_CASE("trained tables code pictures unlike those that they were trained on") {
  RgbImage flat(16, 16);
  const ConstRgbView pictures[] = {flat.view()};
  EncodeOptions options;
  options.quality = 100;
  const auto tables = StreamTables::for_pictures(pictures, options);
  REQUIRE(tables.ok());
  options.stream = &*tables;
  StreamDecoder decoder;
  REQUIRE(decoder.read_tables(tables->file()).ok());
  RgbImage harsh(64, 64);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 192; ++x) harsh.row(y)[x] = static_cast<uint8_t>((x * 7919 + y * 104729) % 251 > 125 ? 255 : 0);
  const auto decoded = decoder.decode(*jpeg::encode(harsh.view(), options));
  REQUIRE(decoded.ok());
  options.tables = tables->steps();
  options.stream = nullptr;
  CHECK(max_difference(decoded->view(), jpeg::decode(*jpeg::encode(harsh.view(), options))->view()) == 0);
}

TEST_CASE("a failed file changes no table; other tables replace the old ones; forgotten ones are missed") {
  const RgbImage image = test_image(24, 24);
  const auto fine = *StreamTables::standard(jpeg::annex_k_tables(90));
  const auto coarse = *StreamTables::standard(jpeg::annex_k_tables(10));
  EncodeOptions options;
  options.stream = &fine;
  const auto part = *jpeg::encode(image.view(), options);
  StreamDecoder decoder;
  REQUIRE(decoder.read_tables(fine.file()).ok());
  const auto expected = decoder.decode(part);
  REQUIRE(expected.ok());
  auto cut = coarse.file();
  cut.resize(cut.size() - 1);
  CHECK_FALSE(decoder.read_tables(cut).ok());
  EncodeOptions own_tables;
  own_tables.quality = 20;
  auto damaged = *jpeg::encode(image.view(), own_tables);
  damaged.resize(damaged.size() - 20);
  CHECK_FALSE(decoder.decode(damaged).ok());
  CHECK(max_difference(decoder.decode(part)->view(), expected->view()) == 0);
  REQUIRE(decoder.read_tables(coarse.file()).ok());
  CHECK(max_difference(decoder.decode(part)->view(), expected->view()) > 0);
  CHECK_FALSE(decoder.read_tables(part).ok());  // an image where tables are due
  decoder.forget_tables();
  CHECK_FALSE(decoder.decode(part).ok());
  CHECK(decoder.decode(*jpeg::encode(image.view())).ok());  // a whole file brings its own
}

TEST_CASE("a decoder that has our tables file before an image reads it as one file: djpeg agrees") {
  if (!have_peer("djpeg")) return;
  TempDir dir;
  const RgbImage image = test_image(50, 41);
  const ConstRgbView pictures[] = {image.view()};
  EncodeOptions options;
  const auto tables = *StreamTables::for_pictures(pictures, options);
  options.stream = &tables;
  // An interchange file of the two: the image's segments behind those of the tables.
  auto file = tables.file();
  file.resize(file.size() - 2);  // EOI
  const auto part = *jpeg::encode(image.view(), options);
  file.insert(file.end(), part.begin() + 2, part.end());  // SOI
  write_bytes(dir.file("joined.jpg"), file);
  CHECK(run("djpeg -outfile " + dir.file("x.ppm") + " " + dir.file("joined.jpg")) == 0);
  StreamDecoder decoder;
  REQUIRE(decoder.read_tables(tables.file()).ok());
  CHECK(max_difference(jpeg::decode(file)->view(), decoder.decode(part)->view()) == 0);
}

TEST_CASE("a stream's images cannot be fitted to a size: their tables are fixed") {
  const RgbImage image = test_image(32, 24);
  const auto tables = *jpeg::StreamTables::standard(jpeg::annex_k_tables(50));
  EncodeOptions options;
  options.stream = &tables;
  const auto refused = jpeg::encode_to_size(image.view(), options, 100000);
  REQUIRE_FALSE(refused.ok());
  CHECK(refused.failure().error == Error::bad_argument);
  options.stream = nullptr;
  CHECK(jpeg::encode_to_size(image.view(), options, 100000).ok());
}

}  // namespace
}  // namespace pac::test
