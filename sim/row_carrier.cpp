#include "sim/row_carrier.h"

#include <algorithm>
#include <cstring>

#include "sim/warp_filter.h"

namespace pac::sim {

RowCarrier::RowCarrier(const SurfaceMap& now, const SurfaceMap& before, bool is_chroma, const Kernels& kernels)
    : now_(now), before_(before), is_chroma_(is_chroma), kernels_(kernels.warp) {
  const auto width = static_cast<size_t>(now.width());
  x_64_.resize(width);
  y_64_.resize(width);
  u_before_.resize(width);
  state_.resize(width + 8);  // to be read in words
  wanted_.resize(width);
  edges_.resize(width);
  edge_points_.resize(width);
  edge_samples_.resize(width);
}

// A chroma sample lies between four luma samples; half the position of the first of them is its own.
void RowCarrier::find_half(int y, const RowCarrier& luma, ptrdiff_t plane_stride) {
  const size_t n = x_64_.size();
  const int32_t *x_64 = luma.x_64_.data(), *y_64 = luma.y_64_.data();
  const float* u_before = luma.u_before_.data();
  int32_t *half_x = x_64_.data(), *half_y = y_64_.data();
  float* u = u_before_.data();
  for (size_t i = 0; i < n; ++i) half_x[i] = x_64[2 * i] >> 1;
  for (size_t i = 0; i < n; ++i) half_y[i] = y_64[2 * i] >> 1;
  for (size_t i = 0; i < n; ++i) u[i] = u_before[2 * i];
  find(y, plane_stride);
}

void RowCarrier::find(int y, ptrdiff_t plane_stride) {
  const size_t n = wanted_.size();
  const size_t n_special = kernels_.place_points(before_.view(), x_64_.data(), y_64_.data(), u_before_.data(),
                                                 now_.row(y), n, {state_.data(), wanted_.data()});
  n_absent_ = n_edges_ = 0;
  if (n_special > 0) find_special(plane_stride);
  n_found_ = n - n_absent_;
}

// What is not plain. States are looked at eight at a time; those of edges without their surface become absent.
void RowCarrier::find_special(ptrdiff_t plane_stride) {
  constexpr uint64_t kAllPlain = uint64_t{kWarpPlain} * 0x0101010101010101u;
  const size_t n = wanted_.size();
  for (size_t first = 0; first < n; first += 8) {
    uint64_t states;
    std::memcpy(&states, state_.data() + first, sizeof states);
    if (states == kAllPlain) continue;
    const size_t end = std::min(first + 8, n);
    if (states == 0) {  // kWarpAbsent
      n_absent_ += end - first;
      continue;
    }
    for (size_t i = first; i < end; ++i) {
      if (state_[i] == kWarpEdge && !find_edge(i, x_64_[i], y_64_[i], plane_stride)) state_[i] = kWarpAbsent;
      if (state_[i] == kWarpAbsent) ++n_absent_;
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

void RowCarrier::fetch(const BorderedPlane& plane, int16_t* out) {
  kernels_.filter_points(plane.row(0), plane.stride(), kWarpFilter.data(), x_64_.data(), y_64_.data(), state_.data(),
                         wanted_.size(), out);
  const size_t n = n_edges_;
  for (size_t i = 0; i < n; ++i) edge_points_[i].stand_in = mean(plane.row(0), plane.stride(), edges_[i]);
  if (is_chroma_) {
    for (size_t i = 0; i < n; ++i) out[edges_[i].column] = edge_points_[i].stand_in;
    return;
  }
  kernels_.filter_edge_points(plane.row(0), plane.stride(), before_.row(0), before_.view().stride, kWarpFilter.data(),
                              edge_points_.data(), n, edge_samples_.data());
  for (size_t i = 0; i < n; ++i) out[edges_[i].column] = edge_samples_[i];
}

}  // namespace pac::sim
