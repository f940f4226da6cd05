#include "sim/assisted_state.h"

#include <algorithm>

#include "raster/sample_pattern.h"
#include "sim/difference.h"
#include "sim/frame420.h"
#include "sim/log_domain.h"
#include "sim/object_motion.h"
#include "sim/signed_composite.h"

namespace pac::sim {

namespace {

raster::SampleOffset first_sample(int samples) {
  return raster::sample_pattern(samples)[0];
}

}  // namespace

Result<void> check(const AssistedScene& scene) {
  if (scene.width < 1 || scene.width > mpeg1::kMaxWidth || scene.height < 1 || scene.height > mpeg1::kMaxHeight)
    return Failure{Error::bad_argument, 0, "pictures of MPEG-1 are at most 4095 x 2800 pixels"};
  if (raster::sample_pattern(scene.samples).empty())
    return Failure{Error::bad_argument, 0, "samples a pixel must be 1, 4, 16 or 64"};
  return {};
}

AssistedState::AssistedState(const AssistedScene& scene, Isa isa)
    : isa_(isa),
      base_(scene.width, scene.height),
      coded_(scene.width, scene.height),
      codes_(scene.width, scene.height),
      predictor_(scene.width, scene.height, surfaces_of(*scene.low), first_sample(scene.samples).x / 256.0,
                 first_sample(scene.samples).y / 256.0, isa, movers_of(*scene.low)) {}

const Frame420* AssistedState::reference(Prediction prediction, Difference difference, Residual residual, bool is_key,
                                         ConstRgbView low, PlaneView<const float> depth, PlaneView<const uint32_t> id,
                                         const raster::Camera& camera, std::span<const glm::mat4> objects) {
  if (!begin(prediction, difference, residual, is_key, camera, objects)) return nullptr;
  add_rows(low, depth, id, 0, low.height);
  return end();
}

bool AssistedState::begin(Prediction prediction, Difference difference, Residual residual, bool is_key,
                          const raster::Camera& camera, std::span<const glm::mat4> objects) {
  is_full_ = difference == Difference::full;
  is_ratio_ = residual == Residual::ratio;
  if (prediction == Prediction::block || (prediction == Prediction::none && !is_full_)) return false;
  if (!is_full_) fill_gray();
  if (is_key || prediction == Prediction::none) predictor_.forget();
  predictor_.deblock(is_ratio_);  // measured: docs/video.md
  predictor_.begin(camera, objects);
  return true;
}

void AssistedState::add_rows(ConstRgbView low, PlaneView<const float> depth, PlaneView<const uint32_t> id, int first,
                             int last) {
  if (is_full_) frame420_rows_of(low, first, last, base_);
  predictor_.add_rows(base_, depth, id, first, last);
}

void AssistedState::frame420_of(ConstRgbView picture, Frame420& frame) {
  frame420_rows_of(picture, 0, picture.height, frame);
}

void AssistedState::frame420_rows_of(ConstRgbView picture, int first, int last, Frame420& frame) {
  if (!is_ratio_) return frame420_rows_from_rgb(picture, first, last, frame, isa_);
  const int n = last - first;
  log_from_rgb({picture.row(first), picture.width, n, picture.stride},
               {codes_.row(first), codes_.width(), n, codes_.view().stride});
  frame420_rows_from_rgb(codes_.view(), first, last, frame, isa_);
}

void AssistedState::keep(const mpeg1::FrameView& coded, bool uses_predictor, std::span<const uint8_t> macroblocks) {
  if (uses_predictor) predictor_.keep(coded.y, coded.cb, coded.cr, macroblocks);
  if (!is_full_) coded_ = mpeg1::copy_of(coded);
}

void AssistedState::composite(ConstRgbView low, RgbView shown) const {
  if (is_full_) {
    if (is_ratio_) log_from_rgb(low, shown);
    composite_signed(is_ratio_ ? ConstRgbView(shown) : low, predictor_.shown(0), predictor_.shown(1),
                     predictor_.shown(2), shown, isa_);
    if (is_ratio_) rgb_from_log(low, shown, shown);
    return;
  }
  rgb_from_frame420(coded_, shown, isa_);
  composite_image(low, shown, shown, isa_);
}

// D = 127 everywhere: no difference [Levoy95 s.3].
void AssistedState::fill_gray() {
  const auto fill = [](GrayImage& plane, uint8_t value) {
    for (int y = 0; y < plane.height(); ++y) std::fill_n(plane.row(y), plane.width(), value);
  };
  fill(base_.y, 127);
  fill(base_.cb, 128);
  fill(base_.cr, 128);
}

}  // namespace pac::sim
