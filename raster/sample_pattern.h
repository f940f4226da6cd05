// Where the samples of a pixel are.
#pragma once

#include <cstdint>
#include <span>

namespace pac::raster {

// 1/256 pixel from the pixel's top left corner.
struct SampleOffset {
  uint8_t x, y;
};

// The n sample positions of a pixel, n = 1, 4, 16 or 64; empty for any other n. The first is the nearest to the
// center; depth and id are taken there. 1: the center. 4: rotated grid. 16 and 64: (0, m, 2)-nets, that is one sample
// in each of the n cells of every grid of 2^a x 2^b cells with 2^(a+b) = n, so also one in each of n rows and n
// columns; among random Owen scramblings of the Sobol net the one whose closest pair (on the torus) is farthest apart:
// 0.23 and 0.078 pixels. The mean of every pattern is the pixel's center.
std::span<const SampleOffset> sample_pattern(int n);

}  // namespace pac::raster
