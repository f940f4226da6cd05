#include "base/bits.h"

#include <doctest/doctest.h>

#include <vector>

#include "tests/support/generators.h"

namespace pac::test {
namespace {

TEST_CASE("what was written is read back, at every width and position") {
  Random random(1);
  std::vector<std::pair<uint32_t, int>> fields;
  BitWriter writer;
  uint64_t n_bits = 0;
  for (int i = 0; i < 5000; ++i) {
    const auto count = static_cast<int>(random.in(0, 32));
    const auto value = static_cast<uint32_t>(random.next());
    writer.put(value, count);
    n_bits += static_cast<uint64_t>(count);
    fields.push_back({count == 0 ? 0 : value << (32 - count) >> (32 - count), count});
    REQUIRE(writer.size_bits() == n_bits);
  }
  const auto bytes = writer.take();
  REQUIRE(bytes.size() == (n_bits + 7) / 8);
  CHECK(writer.size_bits() == 0);
  BitReader reader(bytes);
  for (const auto& [value, count] : fields) {
    REQUIRE(reader.peek(count) == value);
    REQUIRE(reader.read(count) == value);
  }
  CHECK(reader.position_bits() == n_bits);
  CHECK_FALSE(reader.overrun());
}

TEST_CASE("bits go most significant first") {
  BitWriter writer;
  writer.put(1, 1);
  writer.put(0, 2);
  writer.put(0x1F, 5);
  CHECK(writer.take() == std::vector<uint8_t>{0x9F});
  const uint8_t bytes[] = {0xA0, 0x0F};
  BitReader reader(bytes);
  CHECK(reader.read_flag());
  CHECK_FALSE(reader.read_flag());
  CHECK(reader.read(10) == 0x200);
  CHECK(reader.read(4) == 0xF);
}

TEST_CASE("aligning pads with the bit that is asked for, and skips it when reading") {
  BitWriter writer;
  writer.put(0, 3);
  writer.align_to_byte(1);
  writer.put(1, 1);
  writer.align_to_byte();
  writer.align_to_byte(1);  // already aligned: nothing
  CHECK(writer.take() == std::vector<uint8_t>{0x1F, 0x80});
  const uint8_t bytes[] = {1, 2, 3};
  BitReader reader(bytes);
  reader.align_to_byte();
  CHECK(reader.byte_offset() == 0);
  reader.skip(1);
  reader.align_to_byte();
  CHECK(reader.byte_offset() == 1);
  CHECK(reader.read(8) == 2);
}

TEST_CASE("past the end come zeros, and the reader remembers") {
  const uint8_t bytes[] = {0xFF, 0xFF};
  BitReader reader(bytes);
  CHECK(reader.peek(32) == 0xFFFF0000u);
  CHECK_FALSE(reader.overrun());  // peeking consumes nothing
  CHECK(reader.read(16) == 0xFFFF);
  CHECK_FALSE(reader.overrun());
  CHECK(reader.remaining_bits() == 0);
  CHECK(reader.read(1) == 0);
  CHECK(reader.overrun());
  CHECK(reader.read(32) == 0);
  CHECK(reader.overrun());
  CHECK(reader.remaining_bits() == 0);
  BitReader empty;
  CHECK(empty.read(7) == 0);
  CHECK(empty.overrun());
}

}  // namespace
}  // namespace pac::test
