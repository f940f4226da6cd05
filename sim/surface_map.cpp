#include "sim/surface_map.h"

#include <algorithm>

namespace pac::sim {

namespace {

constexpr int kAhead = 3;  // rows: the taps of a point's next ones end there

// Bit i of the result: bit i + n, or i - n.
uint64_t later(const uint64_t* word, int n) {
  return word[0] >> n | word[1] << (64 - n);
}
uint64_t earlier(const uint64_t* word, int n) {
  return word[0] << n | word[-1] >> (64 - n);
}

}  // namespace

SurfaceMap::SurfaceMap(int width, int height) : keys_(width + 2 * kBorder, height + 2 * kBorder) {
  const size_t words = (static_cast<size_t>(width) + 63) / 64 + 2;
  for (BitRow* rows : {right_, above_})
    for (int i = 0; i < kRows; ++i) rows[i].resize(words);
  for (BitRow* row : {&mixed_, &mixed_above_, &spread_}) row->resize(words);
}

void SurfaceMap::set(int x, int y, int n, const float* depth, const uint32_t* id, std::span<const uint32_t> surfaces,
                     const WarpKernels& kernels) {
  kernels.surface_keys_row(id, depth, surfaces.empty() ? nullptr : surfaces.data(), surfaces.size(),
                           static_cast<size_t>(n), written_row(y) + x);
}

void SurfaceMap::set_half_row(int y, const SurfaceMap& full, const WarpKernels& kernels) {
  const uint32_t* from = full.row(2 * y);
  uint32_t* to = written_row(y);
  const int w = width();
  for (int x = 0; x < w; ++x) to[x] = from[2 * x];
  end_row(y, kernels);
}

void SurfaceMap::end_row(int y, const WarpKernels& kernels) {
  if (y == 0)
    for (int before = -kAhead; before < 0; ++before) clear(before);
  kernels.compare_keys(row(std::max(y - 1, 0)), row(y), static_cast<size_t>(width()), &right_[y % kRows][1],
                       &above_[y % kRows][1]);
  if (y >= kAhead) mark_smooth(y - kAhead, kernels);
}

void SurfaceMap::finish(const WarpKernels& kernels) {
  const int h = height();
  for (int y = h; y < h + kAhead; ++y) {
    clear(y);
    if (y >= kAhead) mark_smooth(y - kAhead, kernels);
  }
}

void SurfaceMap::clear(int y) {
  for (BitRow* rows : {right_, above_}) std::ranges::fill(rows[(y + kRows) % kRows], 0);
}

// Of the taps of the filter around a place between here and the next ones, columns and rows -2..3: pairs side by side
// begin in columns -2..2, and pairs above each other in rows -2..2.
void SurfaceMap::mark_smooth(int y, const WarpKernels& kernels) {
  const size_t words = mixed_.size() - 2;
  uint64_t *mixed = mixed_.data() + 1, *mixed_above = mixed_above_.data() + 1, *spread = spread_.data() + 1;
  const auto bits = [&](const BitRow* rows, int from_here) { return rows[(y + from_here + kRows) % kRows].data() + 1; };
  const uint64_t *r0 = bits(right_, -2), *r1 = bits(right_, -1), *r2 = bits(right_, 0), *r3 = bits(right_, 1),
                 *r4 = bits(right_, 2), *r5 = bits(right_, 3);
  const uint64_t *a1 = bits(above_, -1), *a2 = bits(above_, 0), *a3 = bits(above_, 1), *a4 = bits(above_, 2),
                 *a5 = bits(above_, 3);
  for (size_t i = 0; i < words; ++i) {
    mixed_above[i] = (a1[i] | a2[i]) | (a3[i] | a4[i]) | a5[i];
    mixed[i] = ((r0[i] | r1[i]) | (r2[i] | r3[i])) | ((r4[i] | r5[i]) | mixed_above[i]);
  }
  for (size_t i = 0; i < words; ++i)
    spread[i] = mixed[i] | (later(mixed + i, 1) | later(mixed + i, 2)) |
                (earlier(mixed + i, 1) | earlier(mixed + i, 2)) | later(mixed_above + i, 3);
  kernels.mark_smooth(spread, static_cast<size_t>(width()), written_row(y));
}

}  // namespace pac::sim
