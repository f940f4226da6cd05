#include "sim/signed_composite.h"

#include <algorithm>
#include <vector>

namespace pac::sim {

namespace {

uint8_t clamped(int value) {
  return static_cast<uint8_t>(std::clamp(value, 0, 255));
}

// Row y of a chroma plane at twice its resolution, by weights 3/4 and 1/4 in each direction.
void upsample_row(const BorderedPlane& half, int y, std::vector<int16_t>& out) {
  const int near = y / 2;
  const int16_t *a = half.row(near), *b = half.row((y & 1) != 0 ? near + 1 : near - 1);
  const auto column = [a, b](int x) { return 3 * a[x] + b[x]; };
  for (int x = 0; x < half.width(); ++x) {
    const int here = 3 * column(x);
    out[static_cast<size_t>(2 * x)] = static_cast<int16_t>((here + column(x - 1) + 8) >> 4);
    out[static_cast<size_t>(2 * x + 1)] = static_cast<int16_t>((here + column(x + 1) + 7) >> 4);
  }
}

}  // namespace

void composite_signed(ConstRgbView low, const BorderedPlane& y, const BorderedPlane& cb, const BorderedPlane& cr,
                      RgbView composite) {
  PAC_ASSERT(low.width == y.width() && low.height == y.height());
  PAC_ASSERT(low.width == composite.width && low.height == composite.height);
  constexpr int kHalf = 1 << 15;
  const auto n = static_cast<size_t>(cb.width()) * 2;
  std::vector<int16_t> u_row(n), v_row(n);
  for (int row = 0; row < low.height; ++row) {
    upsample_row(cb, row, u_row);
    upsample_row(cr, row, v_row);
    const int16_t* luma = y.row(row);
    const uint8_t* from = low.row(row);
    uint8_t* to = composite.row(row);
    for (int x = 0; x < low.width; ++x) {
      const int d = luma[x], u = u_row[static_cast<size_t>(x)], v = v_row[static_cast<size_t>(x)];
      to[3 * x] = clamped(from[3 * x] + d + ((91881 * v + kHalf) >> 16));
      to[3 * x + 1] = clamped(from[3 * x + 1] + d + ((-22554 * u - 46802 * v + kHalf) >> 16));
      to[3 * x + 2] = clamped(from[3 * x + 2] + d + ((116130 * u + kHalf) >> 16));
    }
  }
}

}  // namespace pac::sim
