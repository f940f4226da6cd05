// read_info: everything that headers say, and nothing of what follows them.
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <string>

#include "jpeg/jpeg.h"
#include "tests/support/jpeg_file.h"

namespace pac::test {
namespace {

TEST_CASE("read_info lists markers with their offsets, tables, frame and metadata") {
  JpegFile file = JpegFile().soi();
  file.segment(0xE0, {'J', 'F', 'I', 'F', 0, 1, 2, 1, 0, 72, 0, 96, 0, 0});
  file.segment(0xE1,
               {'E', 'x', 'i', 'f', 0, 0, 'M', 'M', 0, 42, 0, 0, 0, 8, 0, 1, 0x01, 0x12, 0, 3, 0, 0, 0, 1, 0, 6, 0, 0});
  file.segment(0xFE, {'h', 'e', 'l', 'l', 'o'});
  std::vector<int> icc;
  for (const char c : std::string("ICC_PROFILE")) icc.push_back(c);
  icc.insert(icc.end(), {0, 1, 1, 0});
  file.segment(0xE2, icc);
  const size_t dqt_offset = file.bytes.size();
  file.dqt(1, 1, 300).dqt(0, 0, 7);
  file.sof(100, 50, {{1, 2, 1, 0}, {2, 1, 1, 1}, {3, 1, 1, 1}}, 0xC1).small_tables().dri(12);
  file.sos({{1, 0x00}, {2, 0x00}, {3, 0x00}});
  const auto info = jpeg::read_info(file.bytes);
  REQUIRE(info.ok());
  CHECK(info->width == 100);
  CHECK(info->height == 50);
  CHECK(info->precision_bits == 8);
  CHECK(info->start_of_frame == 0xC1);
  REQUIRE(info->components.size() == 3);
  CHECK(info->components[0].horizontal_sampling == 2);
  CHECK(info->components[2].quant_table == 1);
  CHECK(info->color == jpeg::ColorModel::ycc);
  CHECK(info->unsupported == nullptr);
  REQUIRE(info->markers.size() == 12);
  CHECK(info->markers[0].code == 0xD8);
  CHECK(info->markers[5].code == 0xDB);
  CHECK(info->markers[5].offset == dqt_offset);
  CHECK(info->markers[5].size_bytes == 129);
  CHECK(info->markers.back().code == 0xDA);
  CHECK(info->quant_tables[1]->at(63) == 300);
  CHECK(info->quant_tables[0]->at(5) == 7);
  CHECK_FALSE(info->quant_tables[2].has_value());
  CHECK(info->restart_interval_mcus == 12);
  CHECK_FALSE(info->default_huffman);
  CHECK(info->jfif);
  CHECK((info->density_units == 1 && info->density_x == 72 && info->density_y == 96));
  CHECK(info->adobe_transform == -1);
  CHECK(info->exif_orientation == 6);
  CHECK(info->has_icc_profile);
  REQUIRE(info->comments.size() == 1);
  CHECK(std::memcmp(file.bytes.data() + info->comments[0].offset, "hello", 5) == 0);
  CHECK(info->comments[0].size == 5);
  CHECK(info->header_bytes == file.bytes.size());
}

TEST_CASE("read_info never looks behind the first SOS") {
  JpegFile file = JpegFile().soi().dqt().sof(8, 8).small_tables().sos();
  CHECK(jpeg::read_info(file.bytes).ok());
  file.raw({0xFF, 0x02, 0, 0});
  CHECK(jpeg::read_info(file.bytes).ok());
  file.bytes.resize(file.bytes.size() - 5);
  CHECK_FALSE(jpeg::read_info(file.bytes).ok());
}

TEST_CASE("the estimated quality of our own files is the quality that made them") {
  const RgbImage image = test_image(8, 8);
  for (int quality = 2; quality <= 100; ++quality) {
    jpeg::EncodeOptions options;
    options.quality = quality;
    CHECK(jpeg::read_info(*jpeg::encode(image.view(), options))->estimated_quality == quality);
  }
  for (const double quality : {12.4, 51.3, 77.7}) {
    jpeg::EncodeOptions options;
    options.quality = quality;
    CHECK(std::abs(jpeg::read_info(*jpeg::encode(image.view(), options))->estimated_quality - quality) < 0.4);
  }
}

JpegFile three_components(int id0, int id1, int id2) {
  return JpegFile()
      .dqt()
      .sof(8, 8, {{id0}, {id1}, {id2}})
      .small_tables()
      .sos({{id0}, {id1}, {id2}})
      .bits("00 00 00")
      .eoi();
}

jpeg::ColorModel color_of(const JpegFile& prefix, const JpegFile& rest) {
  JpegFile file = JpegFile().soi();
  file.bytes.insert(file.bytes.end(), prefix.bytes.begin(), prefix.bytes.end());
  file.bytes.insert(file.bytes.end(), rest.bytes.begin(), rest.bytes.end());
  REQUIRE(jpeg::decode(file.bytes).ok());
  return jpeg::read_info(file.bytes)->color;
}

TEST_CASE("the color model follows JFIF, then Adobe's transform, then the component ids") {
  const JpegFile none, jfif = JpegFile().segment(0xE0, {'J', 'F', 'I', 'F', 0, 1, 1, 0, 0, 1, 0, 1, 0, 0});
  const auto adobe = [](int transform) {
    return JpegFile().segment(0xEE, {'A', 'd', 'o', 'b', 'e', 0, 100, 0, 0, 0, 0, transform});
  };
  using jpeg::ColorModel;
  CHECK(color_of(none, three_components(1, 2, 3)) == ColorModel::ycc);
  CHECK(color_of(none, three_components('R', 'G', 'B')) == ColorModel::rgb);
  CHECK(color_of(none, three_components(7, 8, 9)) == ColorModel::ycc);
  CHECK(color_of(jfif, three_components('R', 'G', 'B')) == ColorModel::ycc);
  CHECK(color_of(adobe(0), three_components(1, 2, 3)) == ColorModel::rgb);
  CHECK(color_of(adobe(1), three_components('R', 'G', 'B')) == ColorModel::ycc);
  JpegFile four = JpegFile().dqt().sof(8, 8, {{1}, {2}, {3}, {4}}).small_tables();
  four.sos({{1}, {2}, {3}, {4}}).bits("00 00 00 00").eoi();
  CHECK(color_of(none, four) == ColorModel::cmyk);
  CHECK(color_of(adobe(0), four) == ColorModel::cmyk);
  CHECK(color_of(adobe(2), four) == ColorModel::ycck);
}

TEST_CASE("broken Exif data is no orientation, never an error") {
  const auto orientation = [](const std::vector<int>& tiff) {
    std::vector<int> data{'E', 'x', 'i', 'f', 0, 0};
    data.insert(data.end(), tiff.begin(), tiff.end());
    return jpeg::read_info(JpegFile().soi().segment(0xE1, data).dqt().sof(8, 8).small_tables().sos().bytes)
        ->exif_orientation;
  };
  CHECK(orientation({'I', 'I', 42, 0, 8, 0, 0, 0, 1, 0, 0x12, 0x01, 3, 0, 1, 0, 0, 0, 8, 0, 0, 0}) == 8);
  CHECK(orientation({'I', 'I', 42, 0, 8, 0, 0, 0, 1, 0, 0x12, 0x01, 3, 0, 1, 0, 0, 0, 9, 0, 0, 0}) == 0);
  CHECK(orientation({'I', 'I', 42, 0, 8, 0, 0, 0, 1, 0, 0x12, 0x01, 3, 0, 1, 0}) == 0);
  CHECK(orientation({'I', 'I', 42, 0, 0xFF, 0xFF, 0xFF, 0xFF}) == 0);
  CHECK(orientation({'I', 'I', 42, 0, 8, 0, 0, 0, 0xFF, 0xFF}) == 0);
  CHECK(orientation({'X', 'X', 42, 0, 8, 0, 0, 0}) == 0);
  CHECK(orientation({}) == 0);
}

}  // namespace
}  // namespace pac::test
