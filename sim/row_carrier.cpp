#include "sim/row_carrier.h"

#include <algorithm>
#include <cstring>

#include "sim/warp_filter.h"

namespace pac::sim {

RowCarrier::RowCarrier(const SurfaceMap& now, const SurfaceMap& before, const Flow& flow, bool is_chroma,
                       const Kernels& kernels)
    : now_(now), before_(before), flow_(flow), is_chroma_(is_chroma), kernels_(kernels.warp) {
  const auto width = static_cast<size_t>(now.width());
  if (is_chroma) {
    x_64_.resize(width);
    y_64_.resize(width);
    u_before_.resize(width);
  }
  offset_.resize(width);
  phase_x_.resize(width);
  phase_y_.resize(width);
  state_.resize(width + 8);  // to be read in words
  wanted_.resize(width);
  picked_.resize(width);
  absent_.resize(width);
  edges_.resize(width);
  edge_points_.resize(width);
  edge_samples_.resize(width);
}

// A chroma sample lies between four luma samples; half the position of the first of them is its own.
void RowCarrier::halve_flow(int y) {
  const int32_t *x_64 = flow_.x_64.row(2 * y), *y_64 = flow_.y_64.row(2 * y);
  const float* u_before = flow_.u_before.row(2 * y);
  const size_t n = x_64_.size();
  int32_t *half_x = x_64_.data(), *half_y = y_64_.data();
  float* u = u_before_.data();
  for (size_t i = 0; i < n; ++i) half_x[i] = x_64[2 * i] >> 1;
  for (size_t i = 0; i < n; ++i) half_y[i] = y_64[2 * i] >> 1;
  for (size_t i = 0; i < n; ++i) u[i] = u_before[2 * i];
}

void RowCarrier::find(int y, ptrdiff_t plane_stride) {
  if (is_chroma_) halve_flow(y);
  const int32_t* x_64 = is_chroma_ ? x_64_.data() : flow_.x_64.row(y);
  const int32_t* y_64 = is_chroma_ ? y_64_.data() : flow_.y_64.row(y);
  const float* u_before = is_chroma_ ? u_before_.data() : flow_.u_before.row(y);
  const size_t n = offset_.size();
  const WarpPlaces places{offset_.data(), phase_x_.data(), phase_y_.data(), state_.data(), wanted_.data()};
  const size_t n_special =
      kernels_.place_points(before_.view(), plane_stride, x_64, y_64, u_before, now_.row(y), n, places);
  n_absent_ = n_edges_ = 0;
  if (n_special > 0) find_special(x_64, y_64, plane_stride);
  n_found_ = n - n_absent_;
}

// What is not plain. States are looked at eight at a time.
void RowCarrier::find_special(const int32_t* x_64, const int32_t* y_64, ptrdiff_t plane_stride) {
  constexpr uint64_t kAllPlain = uint64_t{kWarpPlain} * 0x0101010101010101u;
  const size_t n = offset_.size();
  for (size_t first = 0; first < n; first += 8) {
    uint64_t states;
    std::memcpy(&states, state_.data() + first, sizeof states);
    if (states == kAllPlain) continue;
    for (size_t i = first; i < std::min(first + 8, n); ++i) {
      if (state_[i] == kWarpPlain) continue;
      if (state_[i] == kWarpAbsent || !find_edge(i, x_64[i], y_64[i], plane_stride)) absent_[n_absent_++] = i;
    }
  }
}

bool RowCarrier::find_edge(size_t column, int32_t x_64, int32_t y_64, ptrdiff_t plane_stride) {
  const int x = x_64 >> 6, y = y_64 >> 6;
  const int32_t right = x_64 & (kWarpPhases - 1), below = y_64 & (kWarpPhases - 1);
  const uint32_t *keys = before_.row(y) + x, *keys_below = before_.row(y + 1) + x;
  const uint32_t wanted = wanted_[column];
  const auto weight = [wanted](uint32_t key, int32_t w) { return same_surface(key, wanted) ? w : 0; };
  Edge& edge = edges_[n_edges_];
  edge.weight[0] = weight(keys[0], (kWarpPhases - right) * (kWarpPhases - below));
  edge.weight[1] = weight(keys[1], right * (kWarpPhases - below));
  edge.weight[2] = weight(keys_below[0], (kWarpPhases - right) * below);
  edge.weight[3] = weight(keys_below[1], right * below);
  edge.sum = (edge.weight[0] + edge.weight[1]) + (edge.weight[2] + edge.weight[3]);
  if (edge.sum == 0) return false;
  edge.column = column;
  edge.offset = y * plane_stride + x;
  edge_points_[n_edges_++] = {static_cast<int32_t>(edge.offset - kWarpTapsBefore * (plane_stride + 1)),
                              static_cast<int32_t>((y - kWarpTapsBefore) * before_.view().stride + x - kWarpTapsBefore),
                              wanted,
                              0,
                              static_cast<uint8_t>(right),
                              static_cast<uint8_t>(below)};
  return true;
}

int16_t RowCarrier::mean(const int16_t* samples, ptrdiff_t stride, const Edge& edge) {
  const int16_t *at = samples + edge.offset, *below = at + stride;
  const int32_t sum =
      (edge.weight[0] * at[0] + edge.weight[1] * at[1]) + (edge.weight[2] * below[0] + edge.weight[3] * below[1]);
  if (edge.sum == kWarpPhases * kWarpPhases) {  // most often: a shift that rounds as the division does
    const int32_t sign = sum >> 31;
    return static_cast<int16_t>(
        ((((sum ^ sign) - sign) + kWarpPhases * kWarpPhases / 2) / (kWarpPhases * kWarpPhases) ^ sign) - sign);
  }
  const int32_t half = edge.sum / 2;
  return static_cast<int16_t>(sum >= 0 ? (sum + half) / edge.sum : -((half - sum) / edge.sum));
}

const int16_t* RowCarrier::fetch(const BorderedPlane& plane) {
  kernels_.filter_points(plane.row(0), plane.stride(), kWarpFilter.data(), offset_.data(), phase_x_.data(),
                         phase_y_.data(), offset_.size(), picked_.data());
  for (size_t i = 0; i < n_absent_; ++i) picked_[absent_[i]] = 0;
  const size_t n = n_edges_;
  for (size_t i = 0; i < n; ++i) edge_points_[i].stand_in = mean(plane.row(0), plane.stride(), edges_[i]);
  kernels_.filter_edge_points(plane.row(0), plane.stride(), before_.row(0), before_.view().stride, kWarpFilter.data(),
                              edge_points_.data(), n, edge_samples_.data());
  for (size_t i = 0; i < n; ++i) picked_[edges_[i].column] = edge_samples_[i];
  return picked_.data();
}

}  // namespace pac::sim
