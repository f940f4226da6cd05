#include "sim/model_prediction.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <unordered_map>
#include <utility>

#include "base/kernels/kernels.h"
#include "sim/row_carrier.h"

namespace pac::sim {

namespace {

constexpr int kTapsAfter = kWarpTaps - 1 - kWarpTapsBefore;

uint8_t clamped(int value) {
  return static_cast<uint8_t>(std::clamp(value, 0, 255));
}

// 1 where a pixel and its right or lower neighbor do not belong together. Without branches: whole rows in vectors.
void mark_jumps(const SurfaceMap& map, GrayImage& jumps) {
  const int width = map.surface.width(), height = map.surface.height();
  const auto jump = [](uint32_t surface, uint32_t other_surface, float u, float other_u) {
    return static_cast<int>(surface != other_surface) | static_cast<int>(!same_depth(u, other_u));
  };
  for (int y = 0; y < height; ++y) {
    const int below = std::min(y + 1, height - 1);
    const uint32_t *s = map.surface.row(y), *s_below = map.surface.row(below);
    const float *u = map.u.row(y), *u_below = map.u.row(below);
    uint8_t* out = jumps.row(y);
    for (int x = 0; x < width; ++x) out[x] = static_cast<uint8_t>(jump(s[x], s_below[x], u[x], u_below[x]));
    for (int x = 0; x + 1 < width; ++x) out[x] |= static_cast<uint8_t>(jump(s[x], s[x + 1], u[x], u[x + 1]));
    // The last column is its own neighbor: a jump only where u is below 0 or no number.
    out[width - 1] |= static_cast<uint8_t>(!same_depth(u[width - 1], u[width - 1]));
  }
}

// map.smooth from the jumps: none among the taps around a position whose floor is this pixel.
void find_smooth(SurfaceMap& map, GrayImage& jumps) {
  const int width = map.surface.width(), height = map.surface.height();
  GrayImage across(width, height);
  std::vector<uint8_t> padded(static_cast<size_t>(width) + kWarpTaps);
  for (int y = 0; y < height; ++y) {
    std::memcpy(padded.data() + kWarpTapsBefore, jumps.row(y), static_cast<size_t>(width));
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
    for (int row = std::max(0, y - kWarpTapsBefore); row <= std::min(height - 1, y + kTapsAfter); ++row)
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
  const std::vector<uint32_t> movers = movers_of(low);
  std::unordered_map<uint64_t, uint32_t> number_of;
  std::vector<uint32_t> surfaces(low.mesh.faces.size() + 1);
  for (size_t face = 0; face < low.mesh.faces.size(); ++face) {
    const uint64_t mover = movers.empty() ? kStands : movers[face + 1];
    const auto next = static_cast<uint32_t>(number_of.size() + 1);
    surfaces[face + 1] = number_of.try_emplace(mover << 32 | low.mesh.faces[face].material, next).first->second;
  }
  return surfaces;
}

ModelPredictor::ModelPredictor(int width, int height, std::vector<uint32_t> surfaces, double sample_x, double sample_y,
                               Isa isa, std::vector<uint32_t> movers)
    : width_(width),
      height_(height),
      surfaces_(std::move(surfaces)),
      isa_(isa),
      flow_(width, height, sample_x, sample_y, std::move(movers), isa),
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
  const uint32_t* surfaces = surfaces_.data();
  const size_t n_surfaces = surfaces_.size();
  for (int y = 0; y < height_; ++y) {
    const uint32_t* faces = id.row(y);
    const float* depths = depth.row(y);
    uint32_t* surface = luma.surface.row(y);
    float* u = luma.u.row(y);
    for (int x = 0; x < width_; ++x) surface[x] = faces[x] < n_surfaces ? surfaces[faces[x]] : 0;
    for (int x = 0; x < width_; ++x) u[x] = 1.0f - depths[x];
  }
  for (int y = 0; y < chroma.u.height(); ++y) {
    const uint32_t* luma_surface = luma.surface.row(2 * y);
    const float* luma_u = luma.u.row(2 * y);
    uint32_t* surface = chroma.surface.row(y);
    float* u = chroma.u.row(y);
    for (int x = 0; x < chroma.u.width(); ++x) {
      surface[x] = luma_surface[2 * x];
      u[x] = luma_u[2 * x];
    }
  }
  for (SurfaceMap* map : {&luma, &chroma}) {
    GrayImage jumps(map->u.width(), map->u.height());
    mark_jumps(*map, jumps);
    find_smooth(*map, jumps);
  }
}

void ModelPredictor::carry(bool chroma, const Flow& flow, const Frame420& base) {
  const size_t level = chroma ? 1 : 0;
  RowCarrier carrier(now_[level], before_[level], flow, chroma, *kernels_for(isa_));
  const int width = kept_[level].width(), height = kept_[level].height();
  std::vector<int16_t> carried(static_cast<size_t>(width));
  uint64_t found = 0;
  for (int y = 0; y < height; ++y) {
    carrier.find(y, kept_[level].stride());
    found += carrier.found();
    for (int component = chroma ? 1 : 0; component <= (chroma ? 2 : 0); ++component) {
      std::fill(carried.begin(), carried.end(), int16_t{0});
      carrier.fetch(kept_[component], carried.data());
      GrayImage& target = component == 0 ? reference_.y : component == 1 ? reference_.cb : reference_.cr;
      const uint8_t* from = plane(base, component).row(y);
      uint8_t* to = target.row(y);
      for (int x = 0; x < width; ++x) to[x] = clamped(from[x] + carried[static_cast<size_t>(x)]);
    }
  }
  if (!chroma) stats_.carried_share = static_cast<double>(found) / (static_cast<double>(width) * height);
}

const Frame420& ModelPredictor::reference(const Frame420& base, PlaneView<const float> depth,
                                          PlaneView<const uint32_t> id, const raster::Camera& camera,
                                          std::span<const glm::mat4> objects) {
  PAC_ASSERT(base.width() == width_ && base.height() == height_);
  map_surfaces(depth, id, now_[0], now_[1]);
  stats_ = {};
  if (has_kept_) {
    const Flow& flow = flow_.find(depth, id, camera, objects);
    carry(false, flow, base);
    carry(true, flow, base);
  } else {
    for (int component = 0; component < 3; ++component) {
      const PlaneView<const uint8_t> from = plane(base, component);
      GrayImage& target = component == 0 ? reference_.y : component == 1 ? reference_.cb : reference_.cr;
      for (int y = 0; y < from.height; ++y) std::memcpy(target.row(y), from.row(y), static_cast<size_t>(from.width));
    }
  }
  flow_.remember(camera, objects);
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
