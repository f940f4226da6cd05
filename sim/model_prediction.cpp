#include "sim/model_prediction.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "base/kernels/kernels.h"
#include "sim/warp_filter.h"

namespace pac::sim {

namespace {

constexpr int kPhaseBits = 6;
static_assert(1 << kPhaseBits == kWarpPhases);
constexpr int kTapsBefore = 2, kTapsAfter = kWarpTaps - 1 - kTapsBefore;

// Depths of one surface at two pixels belong together where u differs by less than this share. A floor seen at a
// grazing angle changes by about 1 % a pixel; things that hide each other are farther apart.
constexpr float kDepthTolerance = 1.0f / 16;

bool same_depth(float a, float b) {
  return std::fabs(a - b) <= kDepthTolerance * std::fmax(a, b);
}

uint8_t clamped(int value) {
  return static_cast<uint8_t>(std::clamp(value, 0, 255));
}

// 1 where a pixel and its right or lower neighbor do not belong together.
void mark_jumps(const SurfaceMap& map, GrayImage& jumps) {
  const int width = map.surface.width(), height = map.surface.height();
  for (int y = 0; y < height; ++y) {
    const int below = std::min(y + 1, height - 1);
    const uint32_t *s = map.surface.row(y), *s_below = map.surface.row(below);
    const float *u = map.u.row(y), *u_below = map.u.row(below);
    uint8_t* out = jumps.row(y);
    for (int x = 0; x < width; ++x) {
      const int right = std::min(x + 1, width - 1);
      const bool together =
          s[x] == s[right] && s[x] == s_below[x] && same_depth(u[x], u[right]) && same_depth(u[x], u_below[x]);
      out[x] = together ? 0 : 1;
    }
  }
}

// map.smooth from the jumps: none among the taps around a position whose floor is this pixel.
void find_smooth(SurfaceMap& map, GrayImage& jumps) {
  const int width = map.surface.width(), height = map.surface.height();
  GrayImage across(width, height);
  std::vector<uint8_t> padded(static_cast<size_t>(width) + kWarpTaps);
  for (int y = 0; y < height; ++y) {
    std::memcpy(padded.data() + kTapsBefore, jumps.row(y), static_cast<size_t>(width));
    uint8_t* out = across.row(y);
    for (int x = 0; x < width; ++x) {
      uint8_t any = 0;
      for (size_t tap = 0; tap < kWarpTaps; ++tap) any |= padded[static_cast<size_t>(x) + tap];
      out[x] = any;
    }
  }
  for (int y = 0; y < height; ++y) {
    uint8_t* out = map.smooth.row(y);
    std::memset(out, 0, static_cast<size_t>(width));
    for (int row = std::max(0, y - kTapsBefore); row <= std::min(height - 1, y + kTapsAfter); ++row)
      for (int x = 0; x < width; ++x) out[x] |= across.row(row)[x];
    for (int x = 0; x < width; ++x) out[x] ^= 1;
  }
}

void make_map(int width, int height, SurfaceMap& map) {
  if (map.surface.width() == width && map.surface.height() == height) return;
  map = {IdImage(width, height), DepthImage(width, height), GrayImage(width, height)};
}

PlaneView<const uint8_t> plane(const Frame420& frame, int component) {
  return component == 0 ? frame.y.view() : component == 1 ? frame.cb.view() : frame.cr.view();
}

// What a pixel looks for in the frame before.
struct Wanted {
  uint32_t surface;
  float u;
};

// One point near an edge: taps on other surfaces, behind others or outside the picture are replaced by the mean of the
// visible ones among the nearest four. False where those four show nothing of it.
class CarefulFilter {
 public:
  CarefulFilter(const BorderedPlane& plane, const SurfaceMap& map) : plane_(plane), map_(map) {}

  bool filter(int x_64, int y_64, const Wanted& wanted, int16_t& out) const {
    const int x = x_64 >> kPhaseBits, y = y_64 >> kPhaseBits;
    const int fx = x_64 & (kWarpPhases - 1), fy = y_64 & (kWarpPhases - 1);
    int32_t stand_in;
    if (!nearest_mean(x, y, fx, fy, wanted, stand_in)) return false;
    const int16_t *taps_x = &kWarpFilter[static_cast<size_t>(fx * kWarpTapStride)],
                  *taps_y = &kWarpFilter[static_cast<size_t>(fy * kWarpTapStride)];
    int32_t sum = 1 << 13;
    for (int k = 0; k < kWarpTaps; ++k)
      for (int j = 0; j < kWarpTaps; ++j) {
        const int tx = x + j - kTapsBefore, ty = y + k - kTapsBefore;
        sum += taps_x[j] * taps_y[k] * (visible(tx, ty, wanted) ? plane_.row(ty)[tx] : stand_in);
      }
    out = static_cast<int16_t>(std::clamp(sum >> 14, -255, 255));
    return true;
  }

 private:
  bool visible(int x, int y, const Wanted& wanted) const {
    if (x < 0 || y < 0 || x >= plane_.width() || y >= plane_.height()) return false;
    return map_.surface.row(y)[x] == wanted.surface && same_depth(map_.u.row(y)[x], wanted.u);
  }

  bool nearest_mean(int x, int y, int fx, int fy, const Wanted& wanted, int32_t& mean) const {
    int32_t weight = 0, sum = 0;
    for (int k = 0; k < 2; ++k)
      for (int j = 0; j < 2; ++j) {
        if (!visible(x + j, y + k, wanted)) continue;
        const int w = (j == 0 ? kWarpPhases - fx : fx) * (k == 0 ? kWarpPhases - fy : fy);
        weight += w;
        sum += w * plane_.row(y + k)[x + j];
      }
    if (weight == 0) return false;
    mean = sum >= 0 ? (sum + weight / 2) / weight : -((-sum + weight / 2) / weight);
    return true;
  }

  const BorderedPlane& plane_;
  const SurfaceMap& map_;
};

}  // namespace

void BorderedPlane::extend() {
  const int w = width(), h = height();
  if (w == 0 || h == 0) return;
  for (int y = 0; y < h; ++y) {
    int16_t* samples = row(y);
    for (int i = 1; i <= kBorder; ++i) {
      samples[-i] = samples[0];
      samples[w - 1 + i] = samples[w - 1];
    }
  }
  const size_t bytes = static_cast<size_t>(w + 2 * kBorder) * sizeof(int16_t);
  for (int i = 1; i <= kBorder; ++i) {
    std::memcpy(row(-i) - kBorder, row(0) - kBorder, bytes);
    std::memcpy(row(h - 1 + i) - kBorder, row(h - 1) - kBorder, bytes);
  }
}

std::vector<uint32_t> surfaces_of(const raster::Scene& low) {
  std::vector<uint32_t> surfaces(low.mesh.faces.size() + 1);
  for (size_t face = 0; face < low.mesh.faces.size(); ++face) surfaces[face + 1] = low.mesh.faces[face].material + 1;
  return surfaces;
}

ModelPredictor::ModelPredictor(int width, int height, std::vector<uint32_t> surfaces, double sample_x, double sample_y,
                               Isa isa)
    : width_(width),
      height_(height),
      surfaces_(std::move(surfaces)),
      sample_x_(sample_x),
      sample_y_(sample_y),
      isa_(isa),
      reference_(width, height) {
  const int half_width = (width + 1) / 2, half_height = (height + 1) / 2;
  for (SurfaceMap* map : {now_, before_}) {
    make_map(width, height, map[0]);
    make_map(half_width, half_height, map[1]);
  }
  kept_[0] = BorderedPlane(width, height);
  kept_[1] = BorderedPlane(half_width, half_height);
  kept_[2] = BorderedPlane(half_width, half_height);
}

void ModelPredictor::map_surfaces(PlaneView<const float> depth, PlaneView<const uint32_t> id, SurfaceMap& luma,
                                  SurfaceMap& chroma) {
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x) {
      const uint32_t face = id.row(y)[x];
      luma.surface.row(y)[x] = face < surfaces_.size() ? surfaces_[face] : 0;
      luma.u.row(y)[x] = 1.0f - depth.row(y)[x];
    }
  for (int y = 0; y < chroma.u.height(); ++y)
    for (int x = 0; x < chroma.u.width(); ++x) {
      chroma.surface.row(y)[x] = luma.surface.row(2 * y)[2 * x];
      chroma.u.row(y)[x] = luma.u.row(2 * y)[2 * x];
    }
  for (SurfaceMap* map : {&luma, &chroma}) {
    GrayImage jumps(map->u.width(), map->u.height());
    mark_jumps(*map, jumps);
    find_smooth(*map, jumps);
  }
}

void ModelPredictor::carry(int component, const Frame420& base) {
  const bool chroma = component > 0;
  const BorderedPlane& kept = kept_[component];
  const SurfaceMap &now = now_[chroma ? 1 : 0], &before = before_[chroma ? 1 : 0];
  const CarefulFilter careful(kept, before);
  GrayImage& target = component == 0 ? reference_.y : component == 1 ? reference_.cb : reference_.cr;
  const int width = kept.width(), height = kept.height(), step = chroma ? 2 : 1;
  const auto n = static_cast<size_t>(width);
  std::vector<int32_t> offset(n), column(n);
  std::vector<uint8_t> phase_x(n), phase_y(n);
  std::vector<int16_t> picked(n), carried(n);
  uint64_t found = 0;
  for (int y = 0; y < height; ++y) {
    const int32_t *flow_x = flow_.x_64.row(y * step), *flow_y = flow_.y_64.row(y * step);
    const float* flow_u = flow_.u_before.row(y * step);
    size_t count = 0;
    for (int x = 0; x < width; ++x) {
      carried[static_cast<size_t>(x)] = 0;
      if (flow_x[x * step] == kWarpNowhere) continue;
      // A chroma sample lies between four luma samples; half the position of the first of them is its own.
      const int x_64 = chroma ? flow_x[x * step] >> 1 : flow_x[x], y_64 = chroma ? flow_y[x * step] >> 1 : flow_y[x];
      const int near_x = (x_64 + kWarpPhases / 2) >> kPhaseBits, near_y = (y_64 + kWarpPhases / 2) >> kPhaseBits;
      if (near_x < 0 || near_y < 0 || near_x >= width || near_y >= height) continue;
      const Wanted wanted{now.surface.row(y)[x], flow_u[x * step]};
      const int floor_x = x_64 >> kPhaseBits, floor_y = y_64 >> kPhaseBits;
      const bool plain = before.smooth.row(std::max(0, floor_y))[std::max(0, floor_x)] != 0 &&
                         before.surface.row(near_y)[near_x] == wanted.surface &&
                         same_depth(before.u.row(near_y)[near_x], wanted.u);
      if (!plain) {
        found += careful.filter(x_64, y_64, wanted, carried[static_cast<size_t>(x)]) ? 1 : 0;
        continue;
      }
      offset[count] = static_cast<int32_t>((floor_y - kTapsBefore) * kept.stride() + floor_x - kTapsBefore);
      phase_x[count] = static_cast<uint8_t>(x_64 & (kWarpPhases - 1));
      phase_y[count] = static_cast<uint8_t>(y_64 & (kWarpPhases - 1));
      column[count++] = x;
    }
    kernels_for(isa_)->warp.filter_points(kept.row(0), kept.stride(), kWarpFilter.data(), offset.data(), phase_x.data(),
                                          phase_y.data(), count, picked.data());
    for (size_t i = 0; i < count; ++i) carried[static_cast<size_t>(column[i])] = picked[i];
    found += count;
    const uint8_t* from = plane(base, component).row(y);
    for (size_t x = 0; x < n; ++x) target.row(y)[x] = clamped(from[x] + carried[x]);
  }
  if (!chroma) stats_.carried_share = static_cast<double>(found) / (static_cast<double>(width) * height);
}

const Frame420& ModelPredictor::reference(const Frame420& base, PlaneView<const float> depth,
                                          PlaneView<const uint32_t> id, const raster::Camera& camera) {
  PAC_ASSERT(base.width() == width_ && base.height() == height_);
  map_surfaces(depth, id, now_[0], now_[1]);
  stats_ = {};
  if (has_kept_) {
    reproject(Reprojection(camera, camera_, width_, height_, sample_x_, sample_y_), depth, flow_, isa_);
    for (int component = 0; component < 3; ++component) carry(component, base);
  } else {
    for (int component = 0; component < 3; ++component) {
      const PlaneView<const uint8_t> from = plane(base, component);
      GrayImage& target = component == 0 ? reference_.y : component == 1 ? reference_.cb : reference_.cr;
      for (int y = 0; y < from.height; ++y) std::memcpy(target.row(y), from.row(y), static_cast<size_t>(from.width));
    }
  }
  camera_ = camera;
  return reference_;
}

void ModelPredictor::keep(PlaneView<const uint8_t> y, PlaneView<const uint8_t> cb, PlaneView<const uint8_t> cr,
                          const Frame420& base) {
  const PlaneView<const uint8_t> coded[3] = {y, cb, cr};
  for (int component = 0; component < 3; ++component) {
    BorderedPlane& kept = kept_[component];
    for (int row = 0; row < kept.height(); ++row) {
      const uint8_t *from = coded[component].row(row), *minus = plane(base, component).row(row);
      for (int x = 0; x < kept.width(); ++x) kept.row(row)[x] = static_cast<int16_t>(from[x] - minus[x]);
    }
    kept.extend();
  }
  std::swap(now_, before_);
  has_kept_ = true;
}

}  // namespace pac::sim
