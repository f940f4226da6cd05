#include "sim/predicted_stills.h"

#include "raster/sample_pattern.h"
#include "sim/difference.h"
#include "sim/frame420.h"
#include "sim/object_motion.h"
#include "sim/signed_composite.h"

namespace pac::sim {

StillPredictor::StillPredictor(const AssistedScene& scene, Isa isa)
    : isa_(isa),
      predictor_(scene.width, scene.height, surfaces_of(*scene.low), raster::sample_pattern(scene.samples)[0].x / 256.0,
                 raster::sample_pattern(scene.samples)[0].y / 256.0, isa, movers_of(*scene.low)),
      predicted_(scene.width, scene.height),
      before_(scene.width, scene.height),
      after_(scene.width, scene.height) {}

ConstRgbView StillPredictor::predict(bool stands_alone, ConstRgbView low, PlaneView<const float> depth,
                                     PlaneView<const uint32_t> id, const raster::Camera& camera,
                                     std::span<const glm::mat4> objects) {
  if (stands_alone) predictor_.forget();
  frame420_from_rgb(low, before_, isa_);
  const Frame420& reference = predictor_.reference(before_, depth, id, camera, objects);
  predictor_.keep(reference.y.view(), reference.cb.view(), reference.cr.view());  // as carried; show() adds to it
  composite_signed(low, predictor_.difference(0), predictor_.difference(1), predictor_.difference(2), predicted_.view(),
                   isa_);
  return predicted_.view();
}

void StillPredictor::show(ConstRgbView difference, RgbView shown) {
  composite_image(predicted_.view(), difference, shown, isa_);
  // Where D is 127 both are the same: nothing is rounded that was not coded.
  frame420_from_rgb(predicted_.view(), before_, isa_);
  frame420_from_rgb(shown, after_, isa_);
  predictor_.add(before_, after_);
}

Result<PacketStill> read_packet_still(std::span<const uint8_t> bytes) {
  if (bytes.empty()) return Failure{Error::truncated, 0, "predicted still has no bytes"};
  if (bytes[0] > 1) return Failure{Error::corrupt, 0, "unknown kind of predicted still"};
  return PacketStill{bytes[0] == 1, bytes.subspan(1)};
}

}  // namespace pac::sim
