// Motion JPEG with model prediction: the decoded difference of the frame before is carried to where the model says that
// its surfaces are now (sim/model_prediction.h), added to L, and the JPEG codes D = 127 + (H - that) / 2.
//
//   stills in packets   kind u8 (1: stands alone, D is H against L itself; 0: against the prediction) | JPEG file
#pragma once

#include <cstdint>
#include <span>

#include "base/image.h"
#include "base/isa.h"
#include "base/result.h"
#include "raster/renderer.h"
#include "sim/assisted_video.h"
#include "sim/model_prediction.h"

namespace pac::sim {

// The same object on server and client. One object, one thread at a time.
class StillPredictor {
 public:
  // Reads scene.low here only.
  StillPredictor(const AssistedScene& scene, Isa isa = best_isa());

  // What this frame's H is subtracted from: L plus the carried difference, or L itself where the frame stands alone.
  // Valid until the next call. Depth and ids are L's; objects as AssistedFrame's.
  ConstRgbView predict(bool stands_alone, ConstRgbView low, PlaneView<const float> depth, PlaneView<const uint32_t> id,
                       const raster::Camera& camera, std::span<const glm::mat4> objects = {});

  // D as it was decoded becomes the picture to show; what it says is kept for the next frame. Once after predict().
  void show(ConstRgbView difference, RgbView shown);

 private:
  Isa isa_;
  ModelPredictor predictor_;
  RgbImage predicted_;
  Frame420 before_, after_;  // predicted and shown picture
};

// The two parts of a still in a packet. Fails with truncated or corrupt.
struct PacketStill {
  bool stands_alone = false;
  std::span<const uint8_t> jpeg;
};
Result<PacketStill> read_packet_still(std::span<const uint8_t> bytes);

}  // namespace pac::sim
