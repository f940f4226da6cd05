// What server and client of assisted video do alike, and the first byte of their frames. Inside sim/ only.
#pragma once

#include <cstdint>
#include <span>

#include "base/image.h"
#include "base/result.h"
#include "mpeg1/mpeg1.h"
#include "sim/assisted_video.h"
#include "sim/model_prediction.h"

namespace pac::sim {

// The first byte of each frame: what the decoder must know before the picture.
inline constexpr uint8_t kKey = 1, kPredictionShift = 1, kPredictionMask = 6, kFull = 8, kPacked = 16, kRatio = 32;

Result<void> check(const AssistedScene& scene);

// What server and client do alike.
class AssistedState {
 public:
  AssistedState(const AssistedScene& scene, Isa isa);

  // The picture that predicts this frame, or null where the codec's own does.
  const Frame420* reference(Prediction prediction, Difference difference, Residual residual, bool is_key,
                            ConstRgbView low, PlaneView<const float> depth, PlaneView<const uint32_t> id,
                            const raster::Camera& camera, std::span<const glm::mat4> objects);

  // The same by rows as they are drawn: begin(), whether there is a predicting picture at all; if so, rows as
  // ModelPredictor::add_rows() has them, `low` the whole picture, and end().
  bool begin(Prediction prediction, Difference difference, Residual residual, bool is_key, const raster::Camera& camera,
             std::span<const glm::mat4> objects);
  void add_rows(ConstRgbView low, PlaneView<const float> depth, PlaneView<const uint32_t> id, int first, int last);
  const Frame420* end() { return &predictor_.end(); }

  // Of the frame whose reference was asked for last; empty where it was the codec's own.
  PlaneView<const uint32_t> surface() const { return predictor_.surface(); }

  // What is coded in place of the picture: itself, or the logarithms of its samples.
  void frame420_of(ConstRgbView picture, Frame420& frame);

  // What the codec made of it.
  void keep(const mpeg1::FrameView& coded, bool uses_predictor, std::span<const uint8_t> macroblocks = {});

  void composite(ConstRgbView low, RgbView shown) const;

  double carried_share() const { return predictor_.stats().carried_share; }

 private:
  void fill_gray();
  void frame420_rows_of(ConstRgbView picture, int first, int last, Frame420& frame);

  Isa isa_;
  bool is_full_ = true, is_ratio_ = false;
  Frame420 base_, coded_;
  RgbImage codes_;
  ModelPredictor predictor_;
};

}  // namespace pac::sim
