#include "sim/row_carrier.h"

#include <algorithm>

#include "sim/warp_filter.h"

namespace pac::sim {

namespace {

constexpr int kPhaseBits = 6;
static_assert(1 << kPhaseBits == kWarpPhases);

int floor_of(int position_64) {
  return position_64 >> kPhaseBits;
}

int phase_of(int position_64) {
  return position_64 & (kWarpPhases - 1);
}

// Bilinear, of one of the four nearest samples.
int weight(int bit, int x_64, int y_64) {
  const int fx = phase_of(x_64), fy = phase_of(y_64);
  return ((bit & 1) == 0 ? kWarpPhases - fx : fx) * (bit >> 1 == 0 ? kWarpPhases - fy : fy);
}

}  // namespace

void RowCarrier::find(int y, ptrdiff_t plane_stride) {
  const auto width = static_cast<size_t>(now_.u.width());
  offset_.resize(width);
  phase_x_.resize(width);
  phase_y_.resize(width);
  column_.resize(width);
  candidates_.clear();
  edge_points_.clear();
  edges_.clear();
  nearest_.clear();
  find_plain(y, plane_stride);
  n_plain_ = n_found_;
  for (const Point& point : candidates_) add_edge(point, plane_stride);
}

// What is not plain, but inside the picture, becomes a candidate.
void RowCarrier::find_plain(int y, ptrdiff_t plane_stride) {
  const int step = is_chroma_ ? 2 : 1, shift = is_chroma_ ? 1 : 0, width = now_.u.width();
  const int width_before = before_.u.width(), height_before = before_.u.height();
  const int32_t *flow_x = flow_.x_64.row(y * step), *flow_y = flow_.y_64.row(y * step);
  const float* flow_u = flow_.u_before.row(y * step);
  const uint32_t* surface = now_.surface.row(y);
  size_t n = 0;  // no member: stores through bytes may alias those
  for (int column = 0; column < width; ++column) {
    if (flow_x[column * step] == kWarpNowhere) continue;
    // A chroma sample lies between four luma samples; half the position of the first of them is its own.
    const int x_64 = flow_x[column * step] >> shift, y_64 = flow_y[column * step] >> shift;
    const int near_x = floor_of(x_64 + kWarpPhases / 2), near_y = floor_of(y_64 + kWarpPhases / 2);
    if (near_x < 0 || near_y < 0 || near_x >= width_before || near_y >= height_before) continue;
    const int at_x = floor_of(x_64), at_y = floor_of(y_64);
    const float u = flow_u[column * step];
    const bool is_plain = before_.smooth.row(std::max(0, at_y))[std::max(0, at_x)] != 0 &&
                          before_.surface.row(near_y)[near_x] == surface[column] &&
                          same_depth(before_.u.row(near_y)[near_x], u);
    if (!is_plain) {
      candidates_.push_back({column, x_64, y_64, surface[column], u});
      continue;
    }
    offset_[n] = static_cast<int32_t>((at_y - kWarpTapsBefore) * plane_stride + at_x - kWarpTapsBefore);
    phase_x_[n] = static_cast<uint8_t>(phase_of(x_64));
    phase_y_[n] = static_cast<uint8_t>(phase_of(y_64));
    column_[n] = column;
    ++n;
  }
  n_found_ = n;
}

void RowCarrier::add_place(const Point& point, int32_t offset) {
  offset_[n_found_] = offset;
  phase_x_[n_found_] = static_cast<uint8_t>(phase_of(point.x_64));
  phase_y_[n_found_] = static_cast<uint8_t>(phase_of(point.y_64));
  column_[n_found_] = point.column;
  ++n_found_;
}

// Only where one of the four nearest samples, with some weight, shows what is looked for.
void RowCarrier::add_edge(const Point& point, ptrdiff_t plane_stride) {
  const int x = floor_of(point.x_64), y = floor_of(point.y_64);
  int nearest = 0;
  for (int bit = 0; bit < 4; ++bit)
    if (weight(bit, point.x_64, point.y_64) > 0 && shows(x + (bit & 1), y + (bit >> 1), point)) nearest |= 1 << bit;
  if (nearest == 0) return;
  const int left = x - kWarpTapsBefore, top = y - kWarpTapsBefore;
  add_place(point, static_cast<int32_t>(edges_.size() * kEdgePatch));
  edges_.push_back({static_cast<int32_t>(top * plane_stride + left),
                    static_cast<int32_t>(top * before_.u.stride() + left), point.surface, point.u, 0});
  edge_points_.push_back(point);
  nearest_.push_back(static_cast<uint8_t>(nearest));
}

bool RowCarrier::shows(int x, int y, const Point& point) const {
  if (x < 0 || y < 0 || x >= before_.u.width() || y >= before_.u.height()) return false;
  return before_.surface.row(y)[x] == point.surface && same_depth(before_.u.row(y)[x], point.u);
}

bool RowCarrier::is_inside(const Point& point) const {
  const int left = floor_of(point.x_64) - kWarpTapsBefore, top = floor_of(point.y_64) - kWarpTapsBefore;
  return left >= 0 && top >= 0 && left + kWarpTaps <= before_.u.width() && top + kWarpTaps <= before_.u.height();
}

int16_t RowCarrier::nearest_mean(const BorderedPlane& plane, size_t edge) const {
  const Point& point = edge_points_[edge];
  const int x = floor_of(point.x_64), y = floor_of(point.y_64);
  int32_t sum = 0, weights = 0;
  for (int bit = 0; bit < 4; ++bit) {
    if ((nearest_[edge] >> bit & 1) == 0) continue;
    const int w = weight(bit, point.x_64, point.y_64);
    weights += w;
    sum += w * plane.row(y + (bit >> 1))[x + (bit & 1)];
  }
  return static_cast<int16_t>(sum >= 0 ? (sum + weights / 2) / weights : -((-sum + weights / 2) / weights));
}

void RowCarrier::cut_at_border(const BorderedPlane& plane, size_t edge) {
  const Point& point = edge_points_[edge];
  int16_t* patch = patches_.data() + edge * kEdgePatch;
  for (int k = 0; k < kWarpTaps; ++k)
    for (int j = 0; j < kWarpTapStride; ++j) {
      const int x = floor_of(point.x_64) - kWarpTapsBefore + j, y = floor_of(point.y_64) - kWarpTapsBefore + k;
      const bool is_shown = j < kWarpTaps && shows(x, y, point);
      patch[k * kWarpTapStride + j] = is_shown ? plane.row(y)[x] : edges_[edge].stand_in;
    }
}

// Taps on other surfaces, behind others or outside the picture become the mean of the nearest samples that are shown.
void RowCarrier::cut_patches(const BorderedPlane& plane) {
  const size_t n = edges_.size();
  patches_.resize(n * kEdgePatch);
  for (size_t i = 0; i < n; ++i) edges_[i].stand_in = nearest_mean(plane, i);
  for (size_t i = 0; i < n;) {  // runs inside the picture
    size_t end = i;
    while (end < n && is_inside(edge_points_[end])) ++end;
    kernels_.warp.cut_patches(plane.row(0), plane.stride(), before_.surface.row(0), before_.u.row(0),
                              before_.u.stride(), edges_.data() + i, end - i, patches_.data() + i * kEdgePatch);
    if (end < n) cut_at_border(plane, end);
    i = end + 1;
  }
}

void RowCarrier::fetch(const BorderedPlane& plane, int16_t* out) {
  const size_t n = n_found_, n_edges = n - n_plain_;
  picked_.resize(n);
  const auto filter = [&](const int16_t* samples, ptrdiff_t stride, size_t first, size_t count) {
    kernels_.warp.filter_points(samples, stride, kWarpFilter.data(), offset_.data() + first, phase_x_.data() + first,
                                phase_y_.data() + first, count, picked_.data() + first);
  };
  filter(plane.row(0), plane.stride(), 0, n_plain_);
  if (n_edges > 0) {
    cut_patches(plane);
    filter(patches_.data(), kWarpTapStride, n_plain_, n_edges);
  }
  for (size_t i = 0; i < n; ++i) out[column_[i]] = picked_[i];
}

}  // namespace pac::sim
