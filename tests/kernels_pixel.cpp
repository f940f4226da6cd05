// The pixel kernels of every instruction set equal the scalar ones.
#include <doctest/doctest.h>

#include "tests/support/kernel_check.h"

namespace pac::test {
namespace {

constexpr size_t kMaxWidth = 130;  // over two of the widest vectors plus a tail, with room for unrolling

TEST_CASE("difference_row: every instruction set gives the scalar bits") {
  KernelCheck check(4096);
  for (const Pattern pattern : kPatterns) {
    CAPTURE(pattern_name(pattern));
    for_each_placement(kMaxWidth, [&](size_t n, Guard guard, size_t shift) {
      const uint8_t* h = check.input<uint8_t>(0, n, guard, shift, pattern, 0, 255, n);
      const uint8_t* l = check.input<uint8_t>(1, n, guard, (shift * 7) % 64, Pattern::random, 0, 255, n + 1);
      check.compare<uint8_t>(n, guard, (shift * 3) % 64,
                             [&](const Kernels& table, uint8_t* d) { table.pixel.difference_row(h, l, d, n); });
    });
  }
}

TEST_CASE("difference_row and composite_row: all 65536 pairs of samples") {
  KernelCheck check(4096);
  uint8_t low[256], same[256];
  for (size_t i = 0; i < 256; ++i) low[i] = static_cast<uint8_t>(i);
  for (int h = 0; h < 256; ++h) {
    std::memset(same, h, sizeof same);
    check.compare<uint8_t>(256, Guard::after, 0,
                           [&](const Kernels& table, uint8_t* d) { table.pixel.difference_row(same, low, d, 256); });
    check.compare<uint8_t>(256, Guard::after, 0,
                           [&](const Kernels& table, uint8_t* c) { table.pixel.composite_row(low, same, c, 256); });
  }
}

TEST_CASE("composite_row: every instruction set gives the scalar bits, also in place") {
  KernelCheck check(4096);
  for (const Pattern pattern : kPatterns) {
    CAPTURE(pattern_name(pattern));
    for_each_placement(kMaxWidth, [&](size_t n, Guard guard, size_t shift) {
      const uint8_t* d = check.input<uint8_t>(1, n, guard, (shift * 7) % 64, Pattern::random, 0, 255, n + 1);
      check.compare_in_place<uint8_t>(
          n, guard, shift, [&](std::span<uint8_t> c) { fill(c, pattern, 0, 255, n); },
          [&](const Kernels& table, uint8_t* c) { table.pixel.composite_row(c, d, c, n); });
    });
  }
}

}  // namespace
}  // namespace pac::test
