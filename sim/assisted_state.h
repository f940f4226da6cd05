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

  // Of the frame whose reference was asked for last; empty where it was the codec's own.
  PlaneView<const uint32_t> surface() const { return predictor_.surface(); }

  // What is coded in place of the picture: itself, or the logarithms of its samples.
  void frame420_of(ConstRgbView picture, Frame420& frame);

  // What the codec made of it.
  void keep(const mpeg1::FrameView& coded, bool uses_predictor);

  void composite(ConstRgbView low, RgbView shown) const;

  double carried_share() const { return predictor_.stats().carried_share; }

 private:
  void fill_gray();

  Isa isa_;
  bool is_full_ = true, is_ratio_ = false;
  Frame420 base_, coded_;
  RgbImage codes_;
  ModelPredictor predictor_;
};

}  // namespace pac::sim
