// The block kernels of every instruction set equal the scalar ones.
#include <doctest/doctest.h>

#include "tests/support/kernel_check.h"

namespace pac::test {
namespace {

constexpr size_t kMaxBlocks = 5;  // pairs and fours of blocks, and what is left over

// Samples of `n_blocks` blocks at a row distance; the stride may exceed the row or be negative.
struct SampleLayout {
  ptrdiff_t stride;
  size_t bytes;     // that the rows span
  ptrdiff_t first;  // offset of row 0
};
SampleLayout layout_of(size_t n_blocks, size_t slack, bool upside_down) {
  const size_t row = 8 * n_blocks + slack;
  const auto stride = static_cast<ptrdiff_t>(row);
  return {upside_down ? -stride : stride, 7 * row + 8 * n_blocks, upside_down ? 7 * stride : 0};
}

TEST_CASE("fdct_islow: every instruction set gives the scalar bits") {
  KernelCheck check(8192);
  for (const Pattern pattern : kPatterns) {
    CAPTURE(pattern_name(pattern));
    for (uint64_t seed = 0; seed < 64; ++seed) {
      const size_t n = seed % (kMaxBlocks + 1);
      const SampleLayout layout = layout_of(n, seed % 3 * 5, seed % 2 != 0);
      const size_t bytes = n == 0 ? 0 : layout.bytes;
      const Guard guard = kGuards[seed / 2 % 2];
      const uint8_t* samples = check.input<uint8_t>(0, bytes, guard, seed * 7 % 64, pattern, 0, 255, seed);
      check.compare<int16_t>(64 * n, guard, seed * 2 % 64, [&](const Kernels& table, int16_t* out) {
        table.block.fdct_islow(samples + layout.first, layout.stride, n, out);
      });
    }
  }
}

// The largest coefficients: each basis function's signs as black and white samples.
TEST_CASE("fdct_islow: each basis function at full contrast, and its negative") {
  KernelCheck check(8192);
  for (uint64_t basis = 0; basis < 64; ++basis) {
    for (const bool negative : {false, true}) {
      uint8_t samples[64];
      for (size_t i = 0; i < 64; ++i) samples[i] = basis_is_negative(basis, i) != negative ? 0 : 255;
      check.compare<int16_t>(64, Guard::after, 0,
                             [&](const Kernels& table, int16_t* out) { table.block.fdct_islow(samples, 8, 1, out); });
    }
  }
}

TEST_CASE("idct_islow: every instruction set gives the scalar bits, whatever the input") {
  KernelCheck check(8192);
  struct Range {
    int64_t level, step;
  };
  // Ordinary pictures, the largest a baseline stream codes, and anything at all (products wrap).
  for (const Range& range : {Range{20, 60}, Range{2047, 255}, Range{32767, 65535}}) {
    for (const Pattern pattern : kPatterns) {
      CAPTURE(pattern_name(pattern));
      for (uint64_t seed = 0; seed < 64; ++seed) {
        const size_t n = seed % (kMaxBlocks + 1);
        const SampleLayout layout = layout_of(n, seed % 3 * 5, seed % 2 != 0);
        const size_t bytes = n == 0 ? 0 : layout.bytes;
        const Guard guard = kGuards[seed / 2 % 2];
        const int64_t lowest = range.level == 32767 ? -32768 : -range.level;
        int16_t* levels = check.input<int16_t>(0, 64 * n, guard, seed * 2 % 64, pattern, lowest, range.level, seed);
        const uint16_t* steps =
            check.input<uint16_t>(1, 64, guard, seed * 6 % 64, Pattern::random, 1, range.step, seed);
        uint8_t* last = check.input<uint8_t>(2, n, guard, seed % 64, Pattern::random, 0, 63, seed);
        for (size_t i = 0; i < n; ++i) {
          if (seed % 4 == 0) last[i] = 63;
          if (seed % 4 == 1 && i % 2 == 0) last[i] = 0;
          for (size_t k = last[i] + size_t{1}; k < 64; ++k) levels[64 * i + kNaturalFromZigzag[k]] = 0;
        }
        check.compare<uint8_t>(bytes, guard, seed * 3 % 64, [&](const Kernels& table, uint8_t* out) {
          table.block.idct_islow(levels, steps, last, n, out + layout.first, layout.stride);
        });
      }
    }
  }
}

TEST_CASE("reduced transforms: every instruction set gives the scalar bits, whatever the input") {
  KernelCheck check(8192);
  struct Range {
    int64_t level, step;
  };
  for (const Range& range : {Range{20, 60}, Range{2047, 255}, Range{32767, 65535}}) {
    for (const Pattern pattern : kPatterns) {
      CAPTURE(pattern_name(pattern));
      for (uint64_t seed = 0; seed < 36; ++seed) {
        const size_t n = seed % (kMaxBlocks + 1), size = size_t{1} << seed / 6 % 3;
        const auto stride = static_cast<ptrdiff_t>(size * n + seed % 3 * 5);
        const size_t bytes = n == 0 ? 0 : (size - 1) * static_cast<size_t>(stride) + size * n;
        const Guard guard = kGuards[seed / 2 % 2];
        const int64_t lowest = range.level == 32767 ? -32768 : -range.level;
        const int16_t* levels =
            check.input<int16_t>(0, 64 * n, guard, seed * 2 % 64, pattern, lowest, range.level, seed);
        const uint16_t* steps =
            check.input<uint16_t>(1, 64, guard, seed * 6 % 64, Pattern::random, 1, range.step, seed);
        check.compare<uint8_t>(bytes, guard, seed * 3 % 64, [&](const Kernels& table, uint8_t* out) {
          const auto kernel = size == 4   ? table.block.idct_4x4
                              : size == 2 ? table.block.idct_2x2
                                          : table.block.idct_1x1;
          kernel(levels, steps, n, out, stride);
        });
      }
    }
  }
}

TEST_CASE("idct_islow: every DC level alone, with and without the promise that it is alone") {
  KernelCheck check(8192);
  int16_t levels[64] = {};
  uint16_t steps[64];
  for (uint16_t& step : steps) step = 1;
  for (int dc = -32768; dc <= 32767; dc += dc > -3000 && dc < 3000 ? 1 : 97) {
    levels[0] = static_cast<int16_t>(dc);
    for (const uint8_t last : {uint8_t{0}, uint8_t{63}}) {
      check.compare<uint8_t>(64, Guard::after, 0, [&](const Kernels& table, uint8_t* out) {
        table.block.idct_islow(levels, steps, &last, 1, out, 8);
      });
    }
  }
}

TEST_CASE("idct_islow: each basis function at levels beyond what a forward transform gives") {
  KernelCheck check(8192);
  uint16_t steps[64];
  for (uint16_t& step : steps) step = 1;
  for (const int magnitude : {1, 300, 1024, 2047, 32767}) {
    for (uint64_t pixel = 0; pixel < 64; ++pixel) {  // levels whose signs drive this sample to an extreme
      int16_t levels[64];
      for (size_t k = 0; k < 64; ++k)
        levels[k] = static_cast<int16_t>(basis_is_negative(k, static_cast<size_t>(pixel)) ? -magnitude : magnitude);
      const uint8_t last = 63;
      check.compare<uint8_t>(64, Guard::after, 0, [&](const Kernels& table, uint8_t* out) {
        table.block.idct_islow(levels, steps, &last, 1, out, 8);
      });
    }
  }
}

// The kernels must agree even where reciprocal and scale stand for no divisor; only 0 must stay 0, as the contract
// says.
TEST_CASE("quantize: every instruction set gives the scalar bits and masks") {
  KernelCheck check(8192);
  alignas(64) BlockQuantizer quantizer;
  for (const Pattern pattern : kPatterns) {
    CAPTURE(pattern_name(pattern));
    for (uint64_t seed = 0; seed < 64; ++seed) {
      fill(std::span(quantizer.reciprocal), Pattern::random, 0, 65535, seed);
      Random random(seed);
      for (size_t i = 0; i < 64; ++i) quantizer.scale[i] = static_cast<uint16_t>(1u << random.in(0, 15));
      fill(std::span(quantizer.bias), Pattern::random, 0, seed % 3 == 0 ? 16383 : 100, seed);
      for (size_t i = 0; i < 64; ++i)
        if ((quantizer.bias[i] * quantizer.reciprocal[i] >> 16) * quantizer.scale[i] >> 16 != 0) quantizer.bias[i] = 0;
      const size_t n = seed % (kMaxBlocks + 1);
      const Guard guard = kGuards[seed / 2 % 2];
      const int64_t range = seed % 2 == 0 ? 16383 : 150;
      const int16_t* coefficients = check.input<int16_t>(0, 64 * n, guard, seed * 2 % 64, pattern, -range, range, seed);
      check.compare<int16_t>(64 * n, guard, seed * 6 % 64, [&](const Kernels& table, int16_t* levels) {
        uint64_t masks[kMaxBlocks] = {};
        table.block.quantize(coefficients, quantizer, n, levels, masks);
      });
      check.compare<uint64_t>(n, guard, seed * 8 % 64, [&](const Kernels& table, uint64_t* masks) {
        int16_t levels[64 * kMaxBlocks];
        table.block.quantize(coefficients, quantizer, n, levels, masks);
      });
    }
  }
}

TEST_CASE("fdct_quantize: every instruction set gives what its two halves give") {
  KernelCheck check(8192);
  BlockQuantizer quantizer;
  for (size_t i = 0; i < 64; ++i) {
    quantizer.reciprocal[i] = 0x8000;
    quantizer.scale[i] = static_cast<uint16_t>(1u << (13 - i / 8));
    quantizer.bias[i] = static_cast<uint16_t>(i);
  }
  const auto run = [&](const Kernels& table, const uint8_t* samples, const SampleLayout& layout, size_t n,
                       int16_t* levels, uint64_t* masks) {
    table.block.fdct_quantize(samples + layout.first, layout.stride, n, quantizer, levels, masks);
  };
  for (const Pattern pattern : kPatterns) {
    CAPTURE(pattern_name(pattern));
    for (uint64_t seed = 0; seed < 32; ++seed) {
      const size_t n = seed % (kMaxBlocks + 1);
      const SampleLayout layout = layout_of(n, seed % 3 * 5, seed % 2 != 0);
      const Guard guard = kGuards[seed / 2 % 2];
      const uint8_t* samples =
          check.input<uint8_t>(0, n == 0 ? 0 : layout.bytes, guard, seed * 7 % 64, pattern, 0, 255, seed);
      check.compare<int16_t>(64 * n, guard, seed * 2 % 64, [&](const Kernels& table, int16_t* levels) {
        uint64_t masks[kMaxBlocks] = {};
        run(table, samples, layout, n, levels, masks);
      });
      check.compare<uint64_t>(n, guard, seed * 8 % 64, [&](const Kernels& table, uint64_t* masks) {
        int16_t levels[64 * kMaxBlocks];
        run(table, samples, layout, n, levels, masks);
      });
      int16_t coefficients[64 * kMaxBlocks], whole[64 * kMaxBlocks] = {}, halves[64 * kMaxBlocks] = {};
      uint64_t masks[2][kMaxBlocks] = {};
      const Kernels& scalar = *kernels_for(Isa::scalar);
      scalar.block.fdct_islow(samples + layout.first, layout.stride, n, coefficients);
      scalar.block.quantize(coefficients, quantizer, n, halves, masks[0]);
      run(scalar, samples, layout, n, whole, masks[1]);
      REQUIRE(std::equal(std::begin(whole), std::end(whole), std::begin(halves)));
      REQUIRE(std::equal(std::begin(masks[0]), std::end(masks[0]), std::begin(masks[1])));
    }
  }
}

TEST_CASE("quantize: the mask of each single nonzero level has that zigzag bit") {
  KernelCheck check(8192);
  BlockQuantizer quantizer;
  for (size_t i = 0; i < 64; ++i) {
    quantizer.reciprocal[i] = 1 << 15;  // with scale 2^15: n / 4
    quantizer.scale[i] = 1 << 15;
    quantizer.bias[i] = 0;
  }
  const auto each = [&](const Kernels& table) {
    for (size_t k = 0; k < 64; ++k) {
      int16_t coefficients[64] = {}, levels[64];
      uint64_t mask = 0;
      coefficients[kNaturalFromZigzag[k]] = -20;
      table.block.quantize(coefficients, quantizer, 1, levels, &mask);
      REQUIRE(mask == uint64_t{1} << k);
      REQUIRE(levels[k] == -5);
    }
  };
  each(*kernels_for(Isa::scalar));
  for_each_isa([&](const Kernels&, const Kernels& table) { each(table); });
}

}  // namespace
}  // namespace pac::test
