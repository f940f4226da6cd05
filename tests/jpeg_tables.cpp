// Quantization and Huffman tables.
#include <doctest/doctest.h>

#include <cmath>

#include "base/kernels/kernels.h"
#include "jpeg/huffman.h"
#include "jpeg/jpeg.h"
#include "jpeg/quantizer.h"
#include "jpeg/tables.h"
#include "tests/support/generators.h"

namespace pac::test {
namespace {

using jpeg::HuffmanSpec;

// Share of all 16-bit words that start with a code, in units of 2^-16.
uint32_t kraft_sum(const HuffmanSpec& spec) {
  uint32_t sum = 0;
  for (int length = 1; length <= 16; ++length) sum += static_cast<uint32_t>(spec.count[length]) << (16 - length);
  return sum;
}

// Also the promise that any difference image can be coded with them, whatever its quality.
TEST_CASE("the Huffman tables for difference images are valid and have a code for each symbol of a baseline file") {
  for (int table = 0; table < 2; ++table) {
    for (const bool is_dc : {true, false}) {
      const HuffmanSpec& spec = is_dc ? jpeg::difference_dc(table) : jpeg::difference_ac(table);
      const HuffmanSpec& standard = is_dc ? jpeg::standard_dc(table) : jpeg::standard_ac(table);
      CHECK(jpeg::is_valid(spec));
      CHECK(kraft_sum(spec) < 65536);
      CHECK(spec.n_symbols() == standard.n_symbols());
      jpeg::HuffmanCodes codes, known;
      jpeg::make_codes(spec, codes);
      jpeg::make_codes(standard, known);
      for (size_t symbol = 0; symbol < 256; ++symbol)
        CHECK((codes.code_and_length[symbol] != 0) == (known.code_and_length[symbol] != 0));
    }
  }
}

TEST_CASE("the standard Huffman tables are valid, complete but for the all-ones code, and name each symbol once") {
  for (int table = 0; table < 2; ++table) {
    for (const HuffmanSpec* spec : {&jpeg::standard_dc(table), &jpeg::standard_ac(table)}) {
      CHECK(jpeg::is_valid(*spec));
      CHECK(kraft_sum(*spec) < 65536);
      bool seen[256] = {};
      for (int i = 0; i < spec->n_symbols(); ++i) {
        CHECK_FALSE(seen[spec->symbols[i]]);
        seen[spec->symbols[i]] = true;
      }
    }
    CHECK(jpeg::standard_dc(table).n_symbols() == 12);
    CHECK(jpeg::standard_ac(table).n_symbols() == 162);
  }
}

uint64_t total_bits(const HuffmanSpec& spec, const uint64_t (&frequency)[256]) {
  jpeg::HuffmanCodes codes;
  jpeg::make_codes(spec, codes);
  uint64_t bits = 0;
  for (int s = 0; s < 256; ++s) {
    if (frequency[s] == 0) continue;
    REQUIRE((codes.code_and_length[s] & 255) != 0);
    bits += frequency[s] * (codes.code_and_length[s] & 255);
  }
  return bits;
}

TEST_CASE("optimal Huffman tables stay within 16 bits, leave the all-ones code free and beat the standard tables") {
  uint64_t fibonacci[256] = {}, flat[256], one[256] = {}, two[256] = {};
  uint64_t a = 1, b = 1;
  for (int i = 0; i < 60; ++i) {  // without a limit: codes of 60 bits
    fibonacci[i] = a;
    b = a + b;
    a = b - a;
  }
  for (uint64_t& f : flat) f = 1000000;
  one[17] = 5;
  two[3] = 1;
  two[200] = uint64_t{1} << 40;
  for (const auto* frequency : {&fibonacci, &flat, &one, &two}) {
    const HuffmanSpec spec = jpeg::optimal_huffman(*frequency);
    CHECK(jpeg::is_valid(spec));
    CHECK(kraft_sum(spec) < 65536);
    total_bits(spec, *frequency);
  }
  CHECK(jpeg::optimal_huffman(one).count[1] == 1);
  const uint64_t none[256] = {};
  CHECK(jpeg::optimal_huffman(none).n_symbols() == 0);

  Random random(5);
  for (int round = 0; round < 50; ++round) {
    uint64_t frequency[256] = {};
    const HuffmanSpec& standard = jpeg::standard_ac(0);
    for (int i = 0; i < standard.n_symbols(); ++i)
      frequency[standard.symbols[i]] = random.next() % 8 == 0 ? 0 : random.next() >> random.in(30, 60);
    CHECK(total_bits(jpeg::optimal_huffman(frequency), frequency) <= total_bits(standard, frequency));
  }
}

TEST_CASE("codes and decoder agree on every symbol of every table") {
  for (const HuffmanSpec* spec : {&jpeg::standard_dc(0), &jpeg::standard_ac(0), &jpeg::standard_ac(1)}) {
    jpeg::HuffmanCodes codes;
    jpeg::HuffmanDecoder decoder;
    jpeg::make_codes(*spec, codes);
    jpeg::make_decoder(*spec, decoder);
    for (int i = 0; i < spec->n_symbols(); ++i) {
      const uint8_t symbol = spec->symbols[i];
      const auto length = static_cast<int>(codes.code_and_length[symbol] & 255);
      const auto code = static_cast<int32_t>(codes.code_and_length[symbol] >> 8);
      if (length <= jpeg::HuffmanDecoder::kLookupBits) {
        CHECK(decoder.lookup[code << (jpeg::HuffmanDecoder::kLookupBits - length)].symbol == symbol);
      } else {
        CHECK(code <= decoder.max_code[length]);
        CHECK(decoder.symbols[code + decoder.offset[length]] == symbol);
      }
    }
  }
}

TEST_CASE("Annex K tables at whole qualities are the IJG software's; steps fall as quality rises") {
  for (int quality = 1; quality <= 100; ++quality) {
    const int percent = quality < 50 ? 5000 / quality : 200 - 2 * quality;
    const jpeg::QuantTables tables = jpeg::annex_k_tables(quality);
    for (size_t i = 0; i < 64; ++i) {
      // The IJG's 5000 / quality is an integer division; where it cuts, a real-valued scale may be a step finer or
      // coarser.
      const int ijg = std::min(255, std::max(1, (jpeg::kAnnexKLuma[i] * percent + 50) / 100));
      if (quality >= 50 || 5000 % quality == 0) {
        CHECK(tables.luma[i] == ijg);
      } else {
        CHECK(std::abs(tables.luma[i] - ijg) <= 2);
      }
    }
  }
  jpeg::QuantTables before = jpeg::annex_k_tables(0.01);
  for (int tenths = 1; tenths <= 1000; ++tenths) {
    const jpeg::QuantTables tables = jpeg::annex_k_tables(tenths / 10.0);
    for (size_t i = 0; i < 64; ++i) {
      REQUIRE(tables.luma[i] <= before.luma[i]);
      REQUIRE(tables.chroma[i] <= before.chroma[i]);
    }
    before = tables;
  }
  CHECK(before.luma[63] == 1);
}

TEST_CASE("halved tables halve every step, never below 1") {
  const jpeg::QuantTables tables = jpeg::annex_k_tables(90), half = jpeg::halved(tables);
  for (size_t i = 0; i < 64; ++i) {
    CHECK(half.luma[i] == std::max(1, (tables.luma[i] + 1) / 2));
    CHECK(half.chroma[i] == std::max(1, (tables.chroma[i] + 1) / 2));
  }
}

// Luma's, and chroma's where nothing is subsampled.
jpeg::ChromaGain no_gain() {
  return jpeg::chroma_gain(jpeg::Tune::psnr, false, false);
}

TEST_CASE("multiplying by reciprocals divides exactly, for every step and every magnitude") {
  const auto high = [](uint32_t a, uint32_t b) { return a * b >> 16; };
  for (int step = 1; step <= 255; ++step) {
    jpeg::QuantTable steps;
    steps.fill(static_cast<uint16_t>(step));
    const BlockQuantizer quantizer = jpeg::make_quantizer(steps, 0.0, no_gain().gain);
    const auto divisor = static_cast<uint32_t>(8 * step);
    REQUIRE(quantizer.bias[0] == divisor / 2);
    uint32_t mistakes = 0;
    for (uint32_t n = 0; n < 32768; ++n)
      mistakes += high(high(n, quantizer.reciprocal[5]), quantizer.scale[5]) != n / divisor ? 1 : 0;
    REQUIRE(mistakes == 0);
  }
}

TEST_CASE("a gain makes the divisor smaller, never below that of step 1") {
  const jpeg::ChromaGain chroma = jpeg::chroma_gain(jpeg::Tune::psnr, true, true);
  CHECK(chroma.gain[0] == 1.0);
  CHECK(chroma.gain[63] > 2.0);
  jpeg::QuantTable steps;
  for (const int step : {1, 2, 40}) {
    steps.fill(static_cast<uint16_t>(step));
    const BlockQuantizer quantizer = jpeg::make_quantizer(steps, 0.0, chroma.gain);
    int16_t coefficients[64] = {}, levels[64];
    uint64_t nonzero;
    coefficients[63] = 2000;
    kernels().block.quantize(coefficients, quantizer, 1, levels, &nonzero);
    const double gain = chroma.gain[63] < step ? chroma.gain[63] : step;
    CHECK(std::abs(levels[63] - gain * 250.0 / step) < 1.0);
  }
}

TEST_CASE("the dead zone moves the rounding point of AC and leaves DC alone") {
  jpeg::QuantTable steps;
  steps.fill(10);
  int16_t coefficients[64] = {}, levels[64];
  uint64_t nonzero;
  coefficients[0] = 8 * 25 + 1;     // DC 2.51 steps
  coefficients[1] = 8 * 15 + 4;     // 1.55 steps: level 2 without, 1 with a dead zone of 0.1
  coefficients[8] = -(8 * 16) - 4;  // -1.65 steps: level -2 in both
  const auto quantize = [&](double dead_zone) {
    kernels().block.quantize(coefficients, jpeg::make_quantizer(steps, dead_zone, no_gain().gain), 1, levels, &nonzero);
  };
  quantize(0.0);
  CHECK((levels[0] == 3 && levels[1] == 2 && levels[2] == -2 && nonzero == 7));
  quantize(0.1);
  CHECK((levels[0] == 3 && levels[1] == 1 && levels[2] == -2 && nonzero == 7));
}

}  // namespace
}  // namespace pac::test
