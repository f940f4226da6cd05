#include "sim/row_carrier.h"

#include <algorithm>

#include "sim/warp_filter.h"

namespace pac::sim {

RowCarrier::RowCarrier(const SurfaceMap& before, const Kernels& kernels)
    : before_(before), kernels_(kernels.warp), width_(static_cast<size_t>(before.width())) {
  const size_t even = width_ + width_ % 2;  // pairs of them are read for chroma
  x_64_.resize(even);
  y_64_.resize(even);
  state_.resize(even);
  wanted_.resize(even);
}

WarpPlaces RowCarrier::places(int x) {
  return {x_64_.data() + x, y_64_.data() + x, state_.data() + x, wanted_.data() + x};
}

void RowCarrier::find(int x, int n, const ReprojectionRow& way, int from_first, const float* depth,
                      const uint32_t* now) {
  const WarpCounts found = kernels_.find_points(way, static_cast<size_t>(from_first), depth, now, before_.view(),
                                                static_cast<size_t>(n), places(x));
  counts_.plain += found.plain;
  counts_.edges += found.edges;
}

void RowCarrier::find_nowhere(int x, int n) {
  std::fill_n(x_64_.data() + x, n, kWarpNowhere);
  std::fill_n(y_64_.data() + x, n, kWarpNowhere);
  std::fill_n(state_.data() + x, n, kWarpAbsent);
  std::fill_n(wanted_.data() + x, n, 0);
}

// A chroma sample lies between four luma samples; half the position of the first of them is its own.
void RowCarrier::find_half(RowCarrier& luma) {
  begin();
  counts_ = kernels_.find_half_points(luma.places(), before_.view(), width_, places());
}

void RowCarrier::fetch_luma(const BorderedPlane& plane, int16_t* out) {
  if (found() == 0) {
    std::fill_n(out, width_, int16_t{0});
    return;
  }
  kernels_.filter_points(plane.row(0), plane.stride(), kWarpFilter.data(), x_64_.data(), y_64_.data(), state_.data(),
                         width_, out);
  if (counts_.edges > 0)
    lost_ =
        kernels_.filter_edges(plane.row(0), plane.stride(), before_.view(), kWarpFilter.data(), places(), width_, out);
}

void RowCarrier::fetch_chroma(const BorderedPlane& cb, const BorderedPlane& cr, int16_t* cb_out, int16_t* cr_out) {
  const int16_t* const planes[2] = {cb.row(0), cr.row(0)};
  int16_t* const out[2] = {cb_out, cr_out};
  if (found() == 0) {
    for (int16_t* row : out) std::fill_n(row, width_, int16_t{0});
    return;
  }
  kernels_.filter_both(planes, cb.stride(), kWarpFilter.data(), x_64_.data(), y_64_.data(), state_.data(), width_, out);
  if (counts_.edges > 0) lost_ = kernels_.mean_edges(planes, cb.stride(), before_.view(), places(), width_, out);
}

}  // namespace pac::sim
