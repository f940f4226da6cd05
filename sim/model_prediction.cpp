#include "sim/model_prediction.h"

#include <algorithm>
#include <cstring>
#include <unordered_map>
#include <utility>

#include "base/kernels/kernels.h"
#include "sim/row_carrier.h"

namespace pac::sim {

namespace {

PlaneView<const uint8_t> plane(const Frame420& frame, int component) {
  return component == 0 ? frame.y.view() : component == 1 ? frame.cb.view() : frame.cr.view();
}

PlaneView<uint8_t> plane(Frame420& frame, int component) {
  return component == 0 ? frame.y.view() : component == 1 ? frame.cb.view() : frame.cr.view();
}

// What moves the faces, as surfaces of keys. Two that move alike need not be told apart: depth does that.
std::vector<uint32_t> keys_of(std::span<const uint32_t> movers) {
  constexpr uint32_t kTornKey = 0xFFFF;
  std::vector<uint32_t> keys;
  for (const uint32_t mover : movers) keys.push_back(mover == kTorn ? kTornKey : mover + 1);
  if (!keys.empty()) keys[0] = 0;
  return keys;
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
      keys_(keys_of(movers)),
      isa_(isa),
      flow_(width, height, sample_x, sample_y, std::move(movers), isa),
      surface_(width, height),
      reference_(width, height) {
  const int half_width = (width + 1) / 2, half_height = (height + 1) / 2;
  for (SurfaceMap* map : {now_, before_}) {
    map[0] = SurfaceMap(width, height);
    map[1] = SurfaceMap(half_width, half_height);
  }
  kept_[0] = BorderedPlane(width, height);
  kept_[1] = BorderedPlane(half_width, half_height);
  kept_[2] = BorderedPlane(half_width, half_height);
  for (int component = 0; component < 3; ++component)
    carried_[component] = Image<int16_t, 1>(kept_[component].width(), kept_[component].height());
}

void ModelPredictor::map_surfaces(PlaneView<const float> depth, PlaneView<const uint32_t> id) {
  const WarpKernels& kernels = kernels_for(isa_)->warp;
  now_[0].set(depth, id, keys_, kernels);
  now_[1].set_half(now_[0]);
  for (SurfaceMap& map : now_) map.find_smooth(kernels);
  const auto next = [](int at, int size) { return at == size - 1 ? size : std::min((at & ~3) + 4, size - 1); };
  for (int y = 0; y < height_; y = next(y, height_))
    for (int x = 0; x < width_; x = next(x, width_)) {
      const uint32_t shown = id.row(y)[x];
      surface_.row(y)[x] = shown < surfaces_.size() ? surfaces_[shown] : 0;
    }
}

void ModelPredictor::carry(const Frame420& base, PlaneView<const float> depth, PlaneView<const uint32_t> id) {
  const Kernels& kernels = *kernels_for(isa_);
  RowCarrier luma(now_[0], before_[0], false, kernels), chroma(now_[1], before_[1], true, kernels);
  const auto fetch = [&](RowCarrier& carrier, int component, int y) {
    int16_t* carried = carried_[component].row(y);
    carrier.fetch(kept_[component], carried);
    kernels.warp.add_carried_row(plane(base, component).row(y), carried, static_cast<size_t>(kept_[component].width()),
                                 plane(reference_, component).row(y));
  };
  uint64_t found = 0;
  for (int y = 0; y < height_; ++y) {
    flow_.find_row(depth, id, y, luma.flow());
    luma.find(y, kept_[0].stride());
    found += luma.found();
    fetch(luma, 0, y);
    if (y % 2 != 0) continue;
    chroma.find_half(y / 2, luma, kept_[1].stride());
    for (const int component : {1, 2}) fetch(chroma, component, y / 2);
  }
  stats_.carried_share = static_cast<double>(found) / (static_cast<double>(width_) * height_);
}

const Frame420& ModelPredictor::reference(const Frame420& base, PlaneView<const float> depth,
                                          PlaneView<const uint32_t> id, const raster::Camera& camera,
                                          std::span<const glm::mat4> objects) {
  PAC_ASSERT(base.width() == width_ && base.height() == height_);
  map_surfaces(depth, id);
  stats_ = {};
  if (has_kept_) {
    flow_.prepare(camera, objects);
    carry(base, depth, id);
  } else {
    for (int component = 0; component < 3; ++component) {
      const PlaneView<const uint8_t> from = plane(base, component);
      for (int y = 0; y < from.height; ++y) {
        std::memcpy(plane(reference_, component).row(y), from.row(y), static_cast<size_t>(from.width));
        std::fill_n(carried_[component].row(y), from.width, int16_t{0});
      }
    }
  }
  flow_.remember(camera, objects);
  return reference_;
}

void ModelPredictor::keep(PlaneView<const uint8_t> y, PlaneView<const uint8_t> cb, PlaneView<const uint8_t> cr) {
  constexpr int16_t kLargest = 255 << kCarriedBits;
  const PlaneView<const uint8_t> coded[3] = {y, cb, cr};
  for (int component = 0; component < 3; ++component) {
    BorderedPlane& kept = kept_[component];
    const int width = kept.width();
    for (int row = 0; row < kept.height(); ++row) {
      const uint8_t* from = coded[component].row(row);
      const uint8_t* minus = plane(reference_, component).row(row);
      const int16_t* carried = carried_[component].row(row);
      int16_t* to = kept.row(row);
      for (int x = 0; x < width; ++x) {
        // In 16 bits: beyond +-2^14 no picture brings it back within +-kLargest.
        const auto bounded = std::clamp<int16_t>(carried[x], -0x4000, 0x4000);
        const auto sum = static_cast<int16_t>(bounded + (from[x] - minus[x]) * (1 << kCarriedBits));
        to[x] = std::clamp<int16_t>(sum, -kLargest, kLargest);
      }
    }
    kept.extend();
  }
  std::swap(now_, before_);
  has_kept_ = true;
}

void ModelPredictor::add(const Frame420& before, const Frame420& after) {
  constexpr int kLargest = 255 << kCarriedBits;
  for (int component = 0; component < 3; ++component) {
    BorderedPlane& kept = kept_[component];
    for (int row = 0; row < kept.height(); ++row) {
      const uint8_t *from = plane(before, component).row(row), *to = plane(after, component).row(row);
      int16_t* sum = kept.row(row);
      for (int x = 0; x < kept.width(); ++x) {
        const int changed = sum[x] + (to[x] - from[x]) * (1 << kCarriedBits);
        sum[x] = static_cast<int16_t>(std::clamp(changed, -kLargest, kLargest));
      }
    }
    kept.extend();
  }
}

}  // namespace pac::sim
