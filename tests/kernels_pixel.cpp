// The pixel kernels of every instruction set equal the scalar ones.
#include <doctest/doctest.h>

#include <vector>

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

TEST_CASE("ycc_from_rgb_row: every instruction set gives the scalar bits") {
  KernelCheck check(4096);
  for (const Pattern pattern : kPatterns) {
    CAPTURE(pattern_name(pattern));
    for_each_placement(kMaxWidth, [&](size_t n, Guard guard, size_t shift) {
      const uint8_t* rgb = check.input<uint8_t>(0, 3 * n, guard, shift, pattern, 0, 255, n);
      check.compare<uint8_t>(3 * n, guard, (shift * 3) % 64, [&](const Kernels& table, uint8_t* out) {
        table.pixel.ycc_from_rgb_row(rgb, n, out, out + n, out + 2 * n);
      });
    });
  }
}

// The outputs of three planes above share one buffer; this one gives the last plane its own guard.
TEST_CASE("ycc420_from_rgb_rows: every instruction set gives the scalar bits, and those of the rows it joins") {
  KernelCheck check(4096);
  for (const Pattern pattern : kPatterns) {
    CAPTURE(pattern_name(pattern));
    for_each_placement(kMaxWidth, [&](size_t half, Guard guard, size_t shift) {
      const size_t n = 2 * half;
      const uint8_t* upper = check.input<uint8_t>(0, 3 * n, guard, shift, pattern, 0, 255, n);
      const uint8_t* lower = check.input<uint8_t>(1, 3 * n, guard, (shift * 7) % 64, Pattern::random, 0, 255, n + 1);
      check.compare<uint8_t>(3 * n, guard, (shift * 3) % 64, [&](const Kernels& table, uint8_t* out) {
        table.pixel.ycc420_from_rgb_rows(upper, lower, n, out, out + n, out + 2 * n, out + 2 * n + half);
      });
      const PixelKernels& scalar = kernels_for(Isa::scalar)->pixel;
      std::vector<uint8_t> y(2 * n), cb(2 * n), cr(2 * n), apart(n), joined(3 * n);
      scalar.ycc_from_rgb_row(upper, n, y.data(), cb.data(), cr.data());
      scalar.ycc_from_rgb_row(lower, n, y.data() + n, cb.data() + n, cr.data() + n);
      scalar.downsample_h2v2_row(cb.data(), cb.data() + n, half, apart.data());
      scalar.downsample_h2v2_row(cr.data(), cr.data() + n, half, apart.data() + half);
      y.insert(y.end(), apart.begin(), apart.end());
      kernels().pixel.ycc420_from_rgb_rows(upper, lower, n, joined.data(), joined.data() + n, joined.data() + 2 * n,
                                           joined.data() + 2 * n + half);
      REQUIRE(joined == y);
    });
  }
}

TEST_CASE("ycc_from_rgb_row: each output plane ends where it should") {
  KernelCheck check(4096);
  for (int plane = 0; plane < 3; ++plane) {
    for_each_placement(kMaxWidth, [&](size_t n, Guard guard, size_t shift) {
      const uint8_t* rgb = check.input<uint8_t>(0, 3 * n, guard, shift, Pattern::random, 0, 255, n);
      uint8_t others[2][kMaxWidth];
      check.compare<uint8_t>(n, guard, shift, [&](const Kernels& table, uint8_t* out) {
        uint8_t* planes[3];
        planes[(plane + 1) % 3] = others[0];
        planes[(plane + 2) % 3] = others[1];
        planes[plane] = out;
        table.pixel.ycc_from_rgb_row(rgb, n, planes[0], planes[1], planes[2]);
      });
    });
  }
}

TEST_CASE("rgb_from_ycc_row: every instruction set gives the scalar bits") {
  KernelCheck check(4096);
  for (const Pattern pattern : kPatterns) {
    CAPTURE(pattern_name(pattern));
    for_each_placement(kMaxWidth, [&](size_t n, Guard guard, size_t shift) {
      const uint8_t* y = check.input<uint8_t>(0, n, guard, shift, Pattern::random, 0, 255, n);
      const uint8_t* cb = check.input<uint8_t>(1, n, guard, (shift * 7) % 64, pattern, 0, 255, n);
      const uint8_t* cr = check.input<uint8_t>(2, n, guard, (shift * 5) % 64, pattern, 0, 255, n + 1);
      check.compare<uint8_t>(3 * n, guard, (shift * 3) % 64, [&](const Kernels& table, uint8_t* rgb) {
        table.pixel.rgb_from_ycc_row(y, cb, cr, n, rgb);
      });
    });
  }
}

// All 2^24 triples would be slow under emulation: every pair of chroma at the extremes and middle of luma, and every
// triple on a grid of fives, which holds 0 and 255.
TEST_CASE("color conversion: every chroma pair, and a grid of all colors") {
  KernelCheck check(4096);
  uint8_t first[256], second[256], rest[256], rgb[3 * 256];
  for (size_t i = 0; i < 256; ++i) rest[i] = static_cast<uint8_t>(i);
  for (int u = 0; u < 256; ++u) {
    for (const int y : {0, 77, 255}) {
      std::memset(first, y, sizeof first);
      std::memset(second, u, sizeof second);
      check.compare<uint8_t>(3 * 256, Guard::after, 0, [&](const Kernels& table, uint8_t* out) {
        table.pixel.rgb_from_ycc_row(first, second, rest, 256, out);
      });
    }
  }
  for (int r = 0; r < 256; r += 5) {
    for (int g = 0; g < 256; g += 5) {
      for (int b = 0; b < 256; ++b) {
        rgb[3 * b] = static_cast<uint8_t>(r);
        rgb[3 * b + 1] = static_cast<uint8_t>(g);
        rgb[3 * b + 2] = static_cast<uint8_t>(b);
      }
      check.compare<uint8_t>(3 * 256, Guard::after, 0, [&](const Kernels& table, uint8_t* out) {
        table.pixel.ycc_from_rgb_row(rgb, 256, out, out + 256, out + 512);
      });
    }
  }
}

TEST_CASE("chroma downsampling: every instruction set gives the scalar bits") {
  KernelCheck check(4096);
  for (const Pattern pattern : kPatterns) {
    CAPTURE(pattern_name(pattern));
    for_each_placement(kMaxWidth, [&](size_t n, Guard guard, size_t shift) {
      const uint8_t* a = check.input<uint8_t>(0, 2 * n, guard, shift, pattern, 0, 255, n);
      const uint8_t* b = check.input<uint8_t>(1, 2 * n, guard, (shift * 7) % 64, Pattern::random, 0, 255, n + 1);
      check.compare<uint8_t>(n, guard, (shift * 3) % 64,
                             [&](const Kernels& table, uint8_t* out) { table.pixel.downsample_h2v1_row(a, n, out); });
      check.compare<uint8_t>(n, guard, (shift * 3) % 64, [&](const Kernels& table, uint8_t* out) {
        table.pixel.downsample_h2v2_row(a, b, n, out);
      });
    });
  }
}

TEST_CASE("chroma upsampling: every instruction set gives the scalar bits") {
  KernelCheck check(4096);
  for (const Pattern pattern : kPatterns) {
    CAPTURE(pattern_name(pattern));
    for_each_placement(kMaxWidth, [&](size_t n, Guard guard, size_t shift) {
      if (n == 0) return;
      const uint8_t* near = check.input<uint8_t>(0, n, guard, shift, pattern, 0, 255, n);
      const uint8_t* far = check.input<uint8_t>(1, n, guard, (shift * 7) % 64, Pattern::extremes, 0, 255, n + 1);
      check.compare<uint8_t>(2 * n, guard, (shift * 3) % 64,
                             [&](const Kernels& table, uint8_t* out) { table.pixel.upsample_h2v1_row(near, n, out); });
      check.compare<uint8_t>(2 * n, guard, (shift * 3) % 64, [&](const Kernels& table, uint8_t* out) {
        table.pixel.upsample_h2v2_row(near, far, n, out);
      });
      for (const int bias : {1, 2})
        check.compare<uint8_t>(n, guard, (shift * 3) % 64, [&](const Kernels& table, uint8_t* out) {
          table.pixel.upsample_h1v2_row(near, far, bias, n, out);
        });
    });
  }
}

TEST_CASE("rgb_from_ycc420_row: every instruction set gives what upsampling and color one after the other give") {
  KernelCheck check(8192);
  const Kernels& scalar = *kernels_for(Isa::scalar);
  for (const Pattern pattern : kPatterns) {
    CAPTURE(pattern_name(pattern));
    for_each_placement(150, [&](size_t n, Guard guard, size_t shift) {
      if (n == 0) return;
      const size_t n_chroma = (n + 1) / 2;
      const uint8_t* y = check.input<uint8_t>(0, n, guard, shift, pattern, 0, 255, n);
      const uint8_t* chroma[4];
      for (size_t i = 0; i < 4; ++i)
        chroma[i] = check.input<uint8_t>(1 + i, n_chroma, guard, shift * (i + 2) % 64, pattern, 0, 255, n + i + 1);
      check.compare<uint8_t>(3 * n, guard, shift, [&](const Kernels& table, uint8_t* rgb) {
        table.pixel.rgb_from_ycc420_row(y, chroma[0], chroma[1], chroma[2], chroma[3], n, rgb);
      });
      std::vector<uint8_t> cb(2 * n_chroma), cr(2 * n_chroma), at_once(3 * n), in_turn(3 * n);
      scalar.pixel.upsample_h2v2_row(chroma[0], chroma[1], n_chroma, cb.data());
      scalar.pixel.upsample_h2v2_row(chroma[2], chroma[3], n_chroma, cr.data());
      scalar.pixel.rgb_from_ycc_row(y, cb.data(), cr.data(), n, in_turn.data());
      scalar.pixel.rgb_from_ycc420_row(y, chroma[0], chroma[1], chroma[2], chroma[3], n, at_once.data());
      REQUIRE(at_once == in_turn);
    });
  }
}

}  // namespace
}  // namespace pac::test
