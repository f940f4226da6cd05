#include "tests/support/jpeg_file.h"

#include <algorithm>
#include <cstdlib>

#include "tests/support/generators.h"

namespace pac::test {

RgbImage test_image(int width, int height, uint64_t seed) {
  Random random(seed);
  RgbImage image(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const int noise = static_cast<int>(random.in(-12, 12));
      const int slope = (2 * x + 3 * y) % 256 / 2, edge = (x / 11 + y / 7) % 3 == 0 ? 90 : 0;
      const int samples[3] = {slope + edge + noise, 200 - slope + noise, 40 + edge + (x * y) % 64};
      for (int c = 0; c < 3; ++c) image.pixel(x, y)[c] = static_cast<uint8_t>(std::clamp(samples[c], 0, 255));
    }
  return image;
}

int max_difference(ConstRgbView a, ConstRgbView b) {
  if (a.width != b.width || a.height != b.height) return 256;
  int largest = 0;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < 3 * a.width; ++x) largest = std::max(largest, std::abs(a.row(y)[x] - b.row(y)[x]));
  return largest;
}

}  // namespace pac::test
