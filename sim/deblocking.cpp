#include "sim/deblocking.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "base/kernels/warp_kernels.h"

namespace pac::sim {

namespace {

constexpr int kBlock = 8;
// Greater steps are content; half as great ones beside the border, too. No sample moves by more than a quarter.
constexpr int kStep = 6 << kCarriedBits;  // measured: docs/video.md

// The border lies before *at, `step` samples apart from what is before it.
void smooth(int16_t* at, ptrdiff_t step) {
  const int p1 = at[-2 * step], p0 = at[-step], q0 = at[0], q1 = at[step];
  if (std::abs(p0 - q0) >= kStep || std::abs(p1 - p0) > kStep / 2 || std::abs(q1 - q0) > kStep / 2) return;
  const int change = std::clamp((4 * (q0 - p0) + (p1 - q1) + 4) >> 3, -kStep / 4, kStep / 4);
  at[-step] = static_cast<int16_t>(p0 + change);
  at[0] = static_cast<int16_t>(q0 - change);
}

}  // namespace

Deblocker::Deblocker(int width, int height)
    : last_row_(width, 1),
      across_((width + kBlock - 1) / kBlock, height),
      down_(width, (height + kBlock - 1) / kBlock),
      coded_((width + 15) / 16, (height + 15) / 16) {}

void Deblocker::see_row(int y, const uint32_t* ids) {
  const int width = down_.width();
  for (int x = kBlock; x < width; x += kBlock) across_.row(y)[x / kBlock] = ids[x] == ids[x - 1] ? 1 : 0;
  uint32_t* const last = last_row_.row(0);
  if (y > 0 && y % kBlock == 0)
    for (int x = 0; x < width; ++x) down_.row(y / kBlock)[x] = ids[x] == last[x] ? 1 : 0;
  if (y % kBlock == kBlock - 1) std::copy_n(ids, width, last);
}

void Deblocker::filter(const BorderedPlane& difference, PlaneView<const uint8_t> coded,
                       PlaneView<const uint8_t> reference, BorderedPlane& out) {
  const int width = difference.width(), height = difference.height();
  for (int y = 0; y < height; ++y) std::copy_n(difference.row(y), width, out.row(y));
  for (int row = 0; row < coded_.height(); ++row)
    for (int column = 0; column < coded_.width(); ++column) {
      const int x = 16 * column, last = std::min(16 * row + 16, height);
      const auto n = static_cast<size_t>(std::min(16, width - x));
      bool differs = false;
      for (int y = 16 * row; y < last && !differs; ++y)
        differs = std::memcmp(coded.row(y) + x, reference.row(y) + x, n) != 0;
      coded_.row(row)[column] = differs ? 1 : 0;
    }
  for (int y = 0; y < height; ++y)
    for (int x = kBlock; x + 1 < width; x += kBlock)
      if (across_.row(y)[x / kBlock] != 0 && (is_coded(x, y) || is_coded(x - 1, y))) smooth(out.row(y) + x, 1);
  if (height < 2) return;
  const ptrdiff_t down = out.row(1) - out.row(0);
  for (int y = kBlock; y + 1 < height; y += kBlock)
    for (int x = 0; x < width; ++x)
      if (down_.row(y / kBlock)[x] != 0 && (is_coded(x, y) || is_coded(x, y - 1))) smooth(out.row(y) + x, down);
}

}  // namespace pac::sim
