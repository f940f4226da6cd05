// Where slices end: some players look for the next start code from the next byte boundary on.
#include <doctest/doctest.h>

#include <vector>

#include "mpeg1/slice_writer.h"

namespace pac::test {
namespace {

// A P picture of two macroblocks, both with this vector and without coefficients, in one slice.
std::vector<uint8_t> two_macroblocks(mpeg1::MotionVector vector, bool one_by_one) {
  mpeg1::Macroblock macroblocks[2];
  for (mpeg1::Macroblock& macroblock : macroblocks) {
    macroblock.kind = mpeg1::MacroblockKind::inter;
    macroblock.vector = vector;
  }
  mpeg1::PictureToWrite picture;
  picture.header.type = mpeg1::PictureType::P;
  picture.header.forward_f_code = 1;
  picture.columns = 1;
  picture.rows = picture.slice_rows = 2;
  picture.macroblocks = macroblocks;
  std::vector<mpeg1::RowBits> bits(one_by_one ? 2 : 1);
  for (size_t i = 0; i < bits.size(); ++i)
    mpeg1::write_rows(picture, nullptr, static_cast<int>(i), i + 1 == bits.size() ? 2 : 1, bits[i]);
  std::vector<uint8_t> bytes;
  mpeg1::join_rows(bits, bytes);
  return bytes;
}

TEST_CASE("the last macroblock of a slice never ends in the byte that the one before ended in") {
  constexpr int kStuffingBits = 11, kLastBits = 6;  // increment 1, type, no difference of vectors
  int n_stuffed = 0;
  for (int x = -8; x <= 8; ++x)
    for (int y = -8; y <= 8; ++y) {
      const int before = 32 + 6 + 4 + mpeg1::motion_bits(x, 0, 0) + mpeg1::motion_bits(y, 0, 0);
      const bool is_hidden = before % 8 != 0 && before % 8 + kLastBits <= 8;
      n_stuffed += is_hidden ? 1 : 0;
      const int bits = before + (is_hidden ? kStuffingBits : 0) + kLastBits;
      const mpeg1::MotionVector vector{static_cast<int16_t>(x), static_cast<int16_t>(y)};
      const std::vector<uint8_t> bytes = two_macroblocks(vector, false);
      CHECK(bytes.size() == static_cast<size_t>((bits + 7) / 8));
      CHECK(two_macroblocks(vector, true) == bytes);
    }
  CHECK(n_stuffed > 10);
}

}  // namespace
}  // namespace pac::test
