// H, L and D of one frame by the way a split asks for: one traversal, two models, or a transmitted model.
#pragma once

#include "base/image.h"
#include "base/isa.h"
#include "base/result.h"
#include "raster/renderer.h"
#include "raster/scene.h"
#include "sim/object_motion.h"
#include "sim/scenes.h"
#include "sim/screen_model.h"
#include "sim/split.h"

namespace pac::sim {

struct FrameImages {
  RgbImage high, low, difference;
  ScreenModel model;  // empty where the model is resident
  DepthImage depth;   // of L, as raster::RenderTargets; empty unless asked for
  IdImage id;
  Transforms objects;  // where both models' objects were
};

// What the server and the experiments share. One object, one thread at a time.
class FrameRenderer {
 public:
  // Copies what it needs besides the fine model. Fails as Renderer::create and check_objects; bad_argument where a
  // model that cannot be transmitted (L is textured) should be, or where the models have different numbers of objects.
  static Result<FrameRenderer> create(const SceneSet& scene, const Split& split, bool transmit_model, int width,
                                      int height, int threads, Isa isa);

  // `scene` is the one given to create(); the objects of scene.fine may have moved, and L's follow them. Fails as
  // Renderer::render and encode_screen_model.
  // with_geometry: depth and ids of L as well (resident models only).
  Result<FrameImages> render(const SceneSet& scene, const raster::Camera& camera, bool with_geometry = false);

  // Of models transmitted from now on, 1..16 (16).
  void set_position_bits(int bits) { position_bits_ = bits; }
  // L, the model and D once more, against the H that `images` holds from render(): after set_position_bits().
  Result<void> redraw_low(const raster::Camera& camera, FrameImages& images);

  // Its objects are where create() or the last render() found those of the fine model.
  const raster::Scene& low_scene() const { return low_scene_; }
  raster::Renderer& renderer() { return renderer_; }

 private:
  FrameRenderer(raster::Renderer renderer, const SceneSet& scene, const Split& split, bool transmit_model, int width,
                int height, Isa isa);
  void follow(const raster::Scene& fine);
  Result<void> draw_low(const raster::Camera& camera, FrameImages& images);

  raster::Renderer renderer_;
  Split split_;
  raster::Scene low_scene_;  // what the client has
  bool transmit_model_;
  int width_, height_, position_bits_ = 16;
  Isa isa_;
};

}  // namespace pac::sim
