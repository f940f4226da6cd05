// What each feature of materials and lights costs over the same room without it, and depth alone by numbers of
// triangles. 512x512 and 1280x720, one thread, the best instruction set.
#include <benchmark/benchmark.h>

#include <string>
#include <utility>

#include "raster/renderer.h"
#include "tests/support/raster_scenes.h"

namespace {

using namespace pac;
using namespace pac::raster;

// The room, lit at each pixel by a lamp and a beam through its trilinear textures.
Scene lit_room() {
  Scene scene = test_scenes::room();
  scene.ambient_light = {0.4f, 0.4f, 0.4f};
  Light lamp, beam;
  lamp.kind = Light::Kind::point;
  lamp.position = {0, 3.5f, 1};
  lamp.color = {0.7f, 0.7f, 0.6f};
  beam.kind = Light::Kind::spot;
  beam.position = {3, 3.5f, 3.5f};
  beam.direction = {-1, -1, -1};
  beam.cone_outer = 0.7f;
  scene.lights = {lamp, beam};
  for (Material& material : scene.materials) {
    material.lit = true;
    material.specular = glm::vec3(0.3f);
    material.shininess = 20;
  }
  return scene;
}

struct Feature {
  const char* name;
  void (*add)(Scene& scene, RenderQuality& quality);
};
const Feature kFeatures[] = {
    {"none", [](Scene&, RenderQuality&) {}},
    {"anisotropic_8x",
     [](Scene& scene, RenderQuality&) {
       for (Material& material : scene.materials) material.anisotropy = 8;
     }},
    {"normal_map",
     [](Scene& scene, RenderQuality&) {
       for (Material& material : scene.materials) material.normal_texture = 1;
     }},
    {"specular_map",
     [](Scene& scene, RenderQuality&) {
       for (Material& material : scene.materials) material.specular_texture = 2;
     }},
    {"alpha_mask",
     [](Scene& scene, RenderQuality&) {
       for (Material& material : scene.materials) material.alpha = AlphaMode::mask;
     }},
    {"alpha_blend",
     [](Scene& scene, RenderQuality&) {
       for (const size_t i : {1u, 2u, 5u}) {  // table, cupboard, chest, ceiling and back
         scene.materials[i].alpha = AlphaMode::blend;
         scene.materials[i].opacity = 0.5f;
       }
     }},
    {"environment",
     [](Scene& scene, RenderQuality&) {
       scene.environment = 3;
       for (Material& material : scene.materials) material.reflection = glm::vec3(0.2f);
     }},
    {"fog",
     [](Scene& scene, RenderQuality&) {
       scene.fog.kind = Fog::Kind::exponential;
       scene.fog.density = 0.1f;
     }},
    {"shadow_map", [](Scene&, RenderQuality& quality) { quality.lighting = Lighting::shadow_maps; }},
    {"hard_shadow_rays",
     [](Scene& scene, RenderQuality& quality) {
       quality.lighting = Lighting::full;
       scene.ambient_reach = 0;
     }},
    {"soft_shadow_rays_16",
     [](Scene& scene, RenderQuality& quality) {
       quality.lighting = Lighting::full;
       scene.ambient_reach = 0;
       for (Light& light : scene.lights) light.radius = 0.3f;
     }},
};

void with_feature(benchmark::State& state, const Feature& feature) {
  constexpr int kSide = 512;
  Renderer renderer = std::move(*Renderer::create(kSide, kSide));
  Scene scene = lit_room();
  RenderQuality quality;
  quality.shading = Shading::phong;
  feature.add(scene, quality);
  const Camera camera = test_scenes::room_camera(1);
  RgbImage image(kSide, kSide);
  for (auto _ : state)
    if (!renderer.render(scene, camera, quality, {image.view(), {}, {}}).ok()) state.SkipWithError("not drawn");
}

// A pin of about so many thousand triangles, front and back.
void depth_alone(benchmark::State& state, int side) {
  constexpr int kWidth = 1280, kHeight = 720;
  Renderer renderer = std::move(*Renderer::create(kWidth, kHeight));
  const Scene scene = test_scenes::bumpy_pin(side, side);
  const Camera camera = test_scenes::pin_camera(static_cast<float>(kWidth) / kHeight);
  RenderQuality quality;
  quality.cull_back_faces = true;
  DepthImage depth(kWidth, kHeight);
  for (auto _ : state)
    if (!renderer.render(scene, camera, quality, {{}, depth.view(), {}}).ok()) state.SkipWithError("not drawn");
  state.counters["triangles/s"] =
      benchmark::Counter(static_cast<double>(scene.mesh.faces.size()) * static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate);
}

const bool registered = [] {
  for (const Feature& feature : kFeatures)
    benchmark::RegisterBenchmark(("raster/material/" + std::string(feature.name)).c_str(), [&feature](auto& state) {
      with_feature(state, feature);
    })->Unit(benchmark::kMillisecond);
  const std::pair<const char*, int> kSizes[] = {{"48k", 155}, {"131k", 256}, {"262k", 362}};
  for (const auto& [name, side] : kSizes)
    benchmark::RegisterBenchmark(("raster/depth_720p/" + std::string(name)).c_str(), [side = side](auto& state) {
      depth_alone(state, side);
    })->Unit(benchmark::kMillisecond);
  return true;
}();

}  // namespace
