#include "sim/model_prediction.h"

#include <algorithm>
#include <cstring>
#include <unordered_map>
#include <utility>

#include "base/kernels/kernels.h"
#include "mpeg1/mpeg1.h"

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
      surface_((width + 15) / 16 * 4, (height + 15) / 16 * 4),
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
    carried_[component] = BorderedPlane(kept_[component].width(), kept_[component].height());
}

// Row y of this frame's maps, and where luma was. By short runs, so that reading depth and ids does not wait for
// memory.
void ModelPredictor::find_row(int y, const float* depth, const uint32_t* ids, RowCarrier& luma) {
  constexpr int kRun = 128;
  const WarpKernels& kernels = kernels_for(isa_)->warp;
  const auto set = [&](int x, int n) { now_[0].set(x, y, n, depth + x, ids + x, keys_, kernels); };
  luma.begin();
  if (!has_kept_) return set(0, width_);
  for_each_way(flow_.ways(), flow_.way_of_id(), ids, width_, [&](int first, int n, const Reprojection* way) {
    if (way == nullptr) {
      set(first, n);
      luma.find_nowhere(first, n);
      return;
    }
    const ReprojectionRow row = way->row(y, first);
    for (int x = first; x < first + n; x += kRun) {
      const int run = std::min(first + n - x, kRun);
      set(x, run);
      luma.find(x, run, row, x - first, depth + x, now_[0].row(y) + x);
    }
  });
}

void ModelPredictor::end_row(int y, const uint32_t* ids) {
  const WarpKernels& kernels = kernels_for(isa_)->warp;
  now_[0].end_row(y, kernels);
  if (y % 2 == 0) now_[1].set_half_row(y / 2, now_[0], kernels);
  for (const int step : {8, 16}) set_surfaces(y, ids, step);
}

// In the middle of squares of `step` pixels, where row y is the one that counts for them.
void ModelPredictor::set_surfaces(int y, const uint32_t* ids, int step) {
  const int middle = step / 2, width = 4 * surface_.width(), height = 4 * surface_.height();
  const auto set = [&](uint32_t* to) {
    for (int x = middle; x < width; x += step) {
      const uint32_t id = ids[std::min(x, width_ - 1)];
      to[x / 4] = id < surfaces_.size() ? surfaces_[id] : 0;
    }
  };
  if (y % step == middle) set(surface_.row(y / 4));
  if (y < height_ - 1) return;
  for (int below = y / step * step + middle; below < height; below += step)
    if (below > y) set(surface_.row(below / 4));
}

// Row y of luma and, where it is even, what of chroma belongs to it.
void ModelPredictor::carry_row(int y, RowCarrier& luma, RowCarrier& chroma) {
  if (has_kept_)
    luma.fetch_luma(kept_[0], carried_[0].row(y));
  else
    std::fill_n(carried_[0].row(y), width_, int16_t{0});
  if (y % 2 != 0) return;
  int16_t *cb = carried_[1].row(y / 2), *cr = carried_[2].row(y / 2);
  if (has_kept_) {
    chroma.find_half(luma);
    chroma.fetch_chroma(kept_[1], kept_[2], cb, cr);
  } else {
    std::fill_n(cb, kept_[1].width(), int16_t{0});
    std::fill_n(cr, kept_[2].width(), int16_t{0});
  }
}

// The reference's row: base + carried difference.
void ModelPredictor::add_row(int component, int y, const Frame420& base) {
  kernels_for(isa_)->warp.add_carried_row(plane(base, component).row(y), carried_[component].row(y),
                                          static_cast<size_t>(kept_[component].width()),
                                          plane(reference_, component).row(y));
}

const Frame420& ModelPredictor::reference(const Frame420& base, PlaneView<const float> depth,
                                          PlaneView<const uint32_t> id, const raster::Camera& camera,
                                          std::span<const glm::mat4> objects) {
  begin(camera, objects);
  add_rows(base, depth, id, 0, height_);
  return end();
}

void ModelPredictor::begin(const raster::Camera& camera, std::span<const glm::mat4> objects) {
  const Kernels& kernels = *kernels_for(isa_);
  if (has_kept_) flow_.prepare(camera, objects);
  begun_.emplace(Begun{camera, objects, RowCarrier(before_[0], kernels), RowCarrier(before_[1], kernels)});
}

// Row by row, so that depth, ids and what comes of them stay in the cache.
void ModelPredictor::add_rows(const Frame420& base, PlaneView<const float> depth, PlaneView<const uint32_t> id,
                              int first, int last) {
  PAC_ASSERT(begun_ && base.width() == width_ && base.height() == height_);
  for (int y = first; y < last; ++y) {
    const uint32_t* const ids = id.row(y - first);
    find_row(y, depth.row(y - first), ids, begun_->luma);
    end_row(y, ids);
    if (deblocks_) deblocker_.see_row(y, ids);
    carry_row(y, begun_->luma, begun_->chroma);
    begun_->found += begun_->luma.found();
    add_row(0, y, base);
    if (y % 2 != 0) continue;
    add_row(1, y / 2, base);
    add_row(2, y / 2, base);
  }
}

const Frame420& ModelPredictor::end() {
  PAC_ASSERT(begun_);
  for (SurfaceMap& map : now_) map.finish(kernels_for(isa_)->warp);
  stats_.carried_share = static_cast<double>(begun_->found) / (static_cast<double>(width_) * height_);
  flow_.remember(begun_->camera, begun_->objects);
  begun_.reset();
  return reference_;
}

void ModelPredictor::keep(PlaneView<const uint8_t> y, PlaneView<const uint8_t> cb, PlaneView<const uint8_t> cr,
                          std::span<const uint8_t> macroblocks) {
  const PlaneView<const uint8_t> coded[3] = {y, cb, cr};
  const int columns = (width_ + 15) / 16, rows = (height_ + 15) / 16;
  PAC_ASSERT(macroblocks.empty() || macroblocks.size() == static_cast<size_t>(columns) * static_cast<size_t>(rows));
  for (int component = 0; component < 3; ++component) {
    const int size = component == 0 ? 16 : 8;
    std::swap(kept_[component], carried_[component]);
    for (int row = 0; row < rows; ++row) {
      const auto is_copied = [&](int column) {
        return !macroblocks.empty() &&
               macroblocks[static_cast<size_t>(row * columns + column)] == mpeg1::kCopiedMacroblock;
      };
      for (int first = 0, end = 0; first < columns; first = end) {
        for (end = first + 1; end < columns && is_copied(end) == is_copied(first);) ++end;
        if (is_copied(first)) continue;
        const BorderedPlane& plane = kept_[component];
        keep_part(component, coded[component], size * first, size * row,
                  std::min(size * (end - first), plane.width() - size * first),
                  std::min(size, plane.height() - size * row));
      }
    }
    kept_[component].extend();
  }
  std::swap(now_, before_);
  has_kept_ = true;
  if (deblocks_) deblocker_.filter(kept_[0], y, reference_.y.view(), deblocked_);
}

void ModelPredictor::deblock(bool on) {
  deblocks_ = on;
  if (!on || deblocked_.width() > 0) return;
  deblocker_ = Deblocker(width_, height_);
  deblocked_ = BorderedPlane(width_, height_);
}

// What was carried becomes what is kept, in a part of the plane.
void ModelPredictor::keep_part(int component, PlaneView<const uint8_t> coded, int x, int y, int width, int height) {
  for (int row = y; row < y + height; ++row) {
    const uint8_t *const from = coded.row(row) + x, *const minus = plane(reference_, component).row(row) + x;
    int16_t* const to = kept_[component].row(row) + x;
    for (int i = 0; i < width; ++i) {
      const auto sum = static_cast<int16_t>(to[i] + (from[i] - minus[i]) * (1 << kCarriedBits));
      to[i] = std::clamp<int16_t>(sum, -kLargestCarried, kLargestCarried);
    }
  }
}

void ModelPredictor::add(const Frame420& before, const Frame420& after) {
  for (int component = 0; component < 3; ++component) {
    BorderedPlane& kept = kept_[component];
    for (int row = 0; row < kept.height(); ++row) {
      const uint8_t *from = plane(before, component).row(row), *to = plane(after, component).row(row);
      int16_t* sum = kept.row(row);
      for (int x = 0; x < kept.width(); ++x) {
        const int changed = sum[x] + (to[x] - from[x]) * (1 << kCarriedBits);
        sum[x] = static_cast<int16_t>(std::clamp<int>(changed, -kLargestCarried, kLargestCarried));
      }
    }
    kept.extend();
  }
}

}  // namespace pac::sim
