#include "sim/frame_renderer.h"

#include <algorithm>
#include <utility>

#include "raster/pose.h"
#include "sim/difference.h"

namespace pac::sim {

namespace {

bool has_texture(const raster::Scene& scene) {
  return std::any_of(scene.materials.begin(), scene.materials.end(),
                     [](const raster::Material& material) { return material.texture >= 0; });
}

}  // namespace

Result<FrameRenderer> FrameRenderer::create(const SceneSet& scene, const Split& split, bool transmit_model, int width,
                                            int height, int threads, Isa isa) {
  const raster::Scene& low = split.low_model == Model::coarse ? scene.coarse : scene.fine;
  if (transmit_model && split.low.texture && has_texture(low))
    return Failure{Error::bad_argument, 0, "a model whose low-quality rendering is textured cannot be transmitted"};
  if (low.objects.size() != scene.fine.objects.size())
    return Failure{Error::bad_argument, 0, "both models must have the same objects"};
  PAC_CHECK(check_objects(scene.fine));
  PAC_CHECK(check_objects(low));
  if (width < 1 || width > 65535 || height < 1 || height > 65535)
    return Failure{Error::bad_argument, 0, "picture sides must be 1..65535"};
  raster::RendererOptions options;
  options.threads = threads;
  options.isa = isa;
  PAC_TRY(raster::Renderer renderer, raster::Renderer::create(width, height, options));
  return FrameRenderer(std::move(renderer), scene, split, transmit_model, width, height, isa);
}

FrameRenderer::FrameRenderer(raster::Renderer renderer, const SceneSet& scene, const Split& split, bool transmit_model,
                             int width, int height, Isa isa)
    : renderer_(std::move(renderer)),
      split_(split),
      low_scene_(sim::low_scene(scene, split)),
      transmit_model_(transmit_model),
      width_(width),
      height_(height),
      isa_(isa) {
  follow(scene.fine);
}

// Ranges of vertices differ between the models, transforms do not.
void FrameRenderer::follow(const raster::Scene& fine) {
  for (size_t i = 0; i < low_scene_.objects.size(); ++i) {
    low_scene_.objects[i].world_from_object = fine.objects[i].world_from_object;
    low_scene_.objects[i].previous_world_from_object = fine.objects[i].previous_world_from_object;
  }
}

Result<FrameImages> FrameRenderer::render(const SceneSet& scene, const raster::Camera& camera, bool with_geometry) {
  PAC_ASSERT(scene.fine.objects.size() == low_scene_.objects.size());
  follow(scene.fine);
  FrameImages images;
  images.objects = transforms_of(scene.fine);
  if (with_geometry) {
    images.depth = DepthImage(width_, height_);
    images.id = IdImage(width_, height_);
  }
  images.high = RgbImage(width_, height_);
  images.low = RgbImage(width_, height_);
  images.difference = RgbImage(width_, height_);
  raster::RenderTargets high{images.high.view(), {}, {}};
  if (!transmit_model_ && split_.single_pass()) {
    high.depth = images.depth.view();  // L's, too: both see the same triangles at the same samples
    high.id = images.id.view();
    PAC_CHECK(renderer_.render_pair(scene.fine, camera, split_.high, split_.low, high, images.low.view(),
                                    images.difference.view()));
    return images;
  }
  PAC_CHECK(renderer_.render(scene.fine, camera, split_.high, high));
  PAC_CHECK(redraw_low(camera, images));
  return images;
}

Result<void> FrameRenderer::redraw_low(const raster::Camera& camera, FrameImages& images) {
  PAC_CHECK(draw_low(camera, images));
  difference_image(images.high.view(), images.low.view(), images.difference.view(), isa_);
  return {};
}

Result<void> FrameRenderer::draw_low(const raster::Camera& camera, FrameImages& images) {
  if (!transmit_model_) {
    PAC_CHECK(
        renderer_.render(low_scene_, camera, split_.low, {images.low.view(), images.depth.view(), images.id.view()}));
    return {};
  }
  if (low_scene_.objects.empty()) {
    PAC_TRY(images.model, encode_screen_model(low_scene_, camera, split_.low, width_, height_, position_bits_));
  } else {
    raster::Scene posed = low_scene_;
    PAC_CHECK(raster::pose_mesh(low_scene_, posed.mesh));
    posed.objects.clear();
    PAC_TRY(images.model, encode_screen_model(posed, camera, split_.low, width_, height_, position_bits_));
  }
  return draw_screen_model(renderer_, images.model.bytes, split_.low, low_scene_.background, images.low.view());
}

}  // namespace pac::sim
