// The code tables of 11172-2 Annex B are prefix codes, and reading inverts writing.
#include <doctest/doctest.h>

#include <vector>

#include "mpeg1/vlc_tables.h"

namespace pac::test {
namespace {

using namespace pac::mpeg1;

// Sum of 2^-length in units of 2^-16; requires that no code begins another.
uint32_t kraft_sum(const std::vector<Code>& codes) {
  uint32_t sum = 0;
  for (const Code& a : codes) {
    sum += 0x10000u >> a.length;
    for (const Code& b : codes) {
      if (&a == &b || a.length > b.length) continue;
      CHECK((b.bits >> (b.length - a.length)) != a.bits);
    }
  }
  return sum;
}

template <class Range>
std::vector<Code> codes_of(const Range& types) {
  std::vector<Code> codes;
  for (const auto& type : types) codes.push_back(type.code);
  return codes;
}

TEST_CASE("every table is a prefix code whose unused space is what the standard leaves") {
  // What is missing from 2^16: the codes that begin with as many zeros as no code has, which keep start codes unique.
  std::vector<Code> coefficients = codes_of(kRunLevelCodes);
  coefficients.push_back(kEscapeCode);
  coefficients.push_back(kEndOfBlock);
  CHECK(kraft_sum(coefficients) == 0x10000 - (0x10000 >> 12));
  CHECK(kraft_sum({kAddressIncrementCodes.begin() + 1, kAddressIncrementCodes.end()}) < 0x10000);
  CHECK(kraft_sum({kPatternCodes.begin() + 1, kPatternCodes.end()}) == 0x10000 - 2 * (0x10000 >> 9));
  CHECK(kraft_sum(codes_of(kTypesOfP)) == 0x10000 - (0x10000 >> 6));
  CHECK(kraft_sum(codes_of(kTypesOfB)) == 0x10000 - (0x10000 >> 6));
  CHECK(kraft_sum({kDcSizeLuminance.begin(), kDcSizeLuminance.end()}) == 0x10000 - (0x10000 >> 7));
  CHECK(kraft_sum({kDcSizeChrominance.begin(), kDcSizeChrominance.end()}) == 0x10000 - (0x10000 >> 8));
}

TEST_CASE("each coefficient code reads back as its run and level, with either sign") {
  for (const RunLevelCode& entry : kRunLevelCodes) {
    for (const int sign : {0, 1}) {
      const uint32_t bits = (static_cast<uint32_t>(entry.code.bits) << 1 | static_cast<uint32_t>(sign))
                            << (kLongBits - entry.code.length - 1);
      CoefficientSymbol symbol = kReading.coefficient_short[bits >> (kLongBits - kShortBits)];
      if (symbol.length == 0) symbol = kReading.coefficient_long[bits];
      CHECK(symbol.advance == entry.run + 1);
      CHECK(symbol.level == (sign != 0 ? -entry.level : entry.level));
      CHECK(symbol.length == entry.code.length + 1);
    }
    CHECK(run_level_bits(entry.run, entry.level) == entry.code.length + 1);
  }
  CHECK(run_level_bits(40, 1) == 20);
  CHECK(run_level_bits(0, 128) == 28);
}

TEST_CASE("a token is written as its code with the sign, or as the escape where there is none") {
  for (int run = 0; run < kTokenRuns; ++run)
    for (int level = 1 - kTokenLevels; level < kTokenLevels; ++level) {
      if (level == 0) continue;
      const int magnitude = level < 0 ? -level : level;
      const uint32_t entry = kWriting.token[static_cast<size_t>(run)][static_cast<size_t>(level + kTokenLevels)];
      uint32_t expected = 1u << 14 | static_cast<uint32_t>(run) << 8 | (static_cast<uint32_t>(level) & 255);
      for (const RunLevelCode& code : kRunLevelCodes)
        if (code.run == run && code.level == magnitude)
          expected = static_cast<uint32_t>(code.code.bits) << 1 | (level < 0 ? 1u : 0u);
      CHECK((entry >> 5) == expected);
      CHECK(static_cast<int>(entry & 31) == run_level_bits(run, magnitude));
    }
}

TEST_CASE("motion codes and address increments read back") {
  for (int i = 1; i < 36; ++i) {
    const Code& code = kAddressIncrementCodes[static_cast<size_t>(i)];
    const Symbol symbol = kReading.address_increment[static_cast<size_t>(code.bits << (11 - code.length))];
    CHECK(symbol.value == i);
    CHECK(symbol.length == code.length);
  }
  for (int i = 1; i <= 16; ++i) {
    const Code& code = kMotionCodes[static_cast<size_t>(i)];
    const Symbol negative = kReading.motion[static_cast<size_t>((code.bits << 1 | 1) << (10 - code.length))];
    CHECK(negative.value == 16 - i);
    CHECK(negative.length == code.length + 1);
  }
}

}  // namespace
}  // namespace pac::test
