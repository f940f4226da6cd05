// One stream made by hand, every bit accounted for.
#include <doctest/doctest.h>

#include "jpeg/jpeg.h"
#include "tests/support/jpeg_file.h"

namespace pac::test {
namespace {

TEST_CASE("a stream made by hand decodes to the picture that its bits spell") {
  JpegFile file;
  file.raw({0xFF, 0xD8});                    // SOI
  file.raw({0xFF, 0xDB, 0x00, 0x43, 0x00});  // DQT: length 67; Pq 0 (8 bits), Tq 0
  file.raw({8, 4});                          // zigzag 0 (DC): step 8; zigzag 1 (first horizontal frequency): step 4
  for (int i = 2; i < 64; ++i) file.raw({1});
  file.raw({0xFF, 0xC0, 0x00, 0x0B});        // SOF0: length 11
  file.raw({8, 0, 8, 0, 16, 1});             // 8 bits, 8 lines, 16 samples a line, 1 component:
  file.raw({1, 0x11, 0});                    //   id 1, sampling 1x1, quantization table 0
  file.raw({0xFF, 0xC4, 0x00, 0x15, 0x00});  // DHT: length 21; class DC, table 0
  file.raw({1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  file.raw({0, 4});                          //   0 -> category 0, 10 -> category 4
  file.raw({0xFF, 0xC4, 0x00, 0x15, 0x10});  // DHT: class AC, table 0
  file.raw({1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  file.raw({0x00, 0x03});              //   0 -> EOB, 10 -> run 0, size 3
  file.raw({0xFF, 0xDA, 0x00, 0x08});  // SOS: length 8
  file.raw({1, 1, 0x00, 0, 63, 0});    // 1 component: id 1, DC table 0, AC table 0; 0..63, Ah 0, Al 0
  // Block 1: 10 = category 4, 1001 = +9: DC difference 9; 0 = EOB.
  // Block 2: 10 = category 4, 1010 = +10: DC level 9 + 10; 10 = run 0, size 3, 111 = +7; 0 = EOB. Padded with ones.
  // 10 1001 0 1 | 0 1010 10 1 | 11 0 11111
  file.raw({0xA5, 0x55, 0xDF});
  file.raw({0xFF, 0xD9});  // EOI

  const auto decoded = jpeg::decode(file.bytes);
  REQUIRE(decoded.ok());
  REQUIRE(decoded->width() == 16);
  REQUIRE(decoded->height() == 8);
  // Block 1: 9 * 8 / 8 = 9 above gray. Block 2: 19 above gray plus 7 * 4 * cos((2x+1) pi / 16) / (4 sqrt 2).
  const int kSecond[8] = {152, 151, 150, 148, 146, 144, 143, 142};
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) {
      CHECK(decoded->pixel(x, y)[0] == 137);
      CHECK(decoded->pixel(8 + x, y)[1] == kSecond[x]);
    }
}

}  // namespace
}  // namespace pac::test
