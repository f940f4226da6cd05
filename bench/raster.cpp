// The rasterizer by scene, shading, samples, threads and instruction set; what H, L and D in one traversal cost over H
// alone; what full lighting costs. The scenes are those of bench/peers/llvmpipe_peer.cpp.
#include <benchmark/benchmark.h>

#include <string>
#include <utility>

#include "base/kernels/kernels.h"
#include "raster/renderer.h"
#include "tests/support/raster_scenes.h"

namespace {

using namespace pac;
using namespace pac::raster;

constexpr int kSide = 512;

struct Stage {
  Scene scene;
  Camera camera;
};

const Stage& room() {
  static const Stage stage{test_scenes::room(), test_scenes::room_camera(1.0f)};
  return stage;
}
const Stage& pin() {  // 75,264 triangles
  static const Stage stage{test_scenes::bumpy_pin(194, 194), test_scenes::pin_camera(1.0f)};
  return stage;
}

struct Case {
  const char* name;
  const Stage& (*stage)();
  RenderQuality quality;
};

RenderQuality quality_of(Shading shading, bool texture, int samples, Lighting lighting = Lighting::local) {
  RenderQuality quality;
  quality.shading = shading;
  quality.texture = texture;
  quality.samples = samples;
  quality.cull_back_faces = true;
  quality.lighting = lighting;
  return quality;
}

Renderer make_renderer(Isa isa, int threads) {
  RendererOptions options;
  options.isa = isa;
  options.threads = threads;
  return std::move(*Renderer::create(kSide, kSide, options));
}

void per_pixel(benchmark::State& state) {
  state.counters["pixels/s"] =
      benchmark::Counter(double{kSide} * kSide * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

void one_rendering(benchmark::State& state, const Case& what, Isa isa, int threads) {
  Renderer renderer = make_renderer(isa, threads);
  const Stage& stage = what.stage();
  RgbImage image(kSide, kSide);
  for (auto _ : state) (void)renderer.render(stage.scene, stage.camera, what.quality, {image.view(), {}, {}});
  per_pixel(state);
}

// H as given, L the same without texture and lit at the corners; of several samples shaded each as stills have it
// (low_shading_samples 0), or once as video has it (1).
void high_low_difference(benchmark::State& state, const Case& what, int low_shading_samples, Isa isa, int threads) {
  Renderer renderer = make_renderer(isa, threads);
  const Stage& stage = what.stage();
  RenderQuality low = what.quality;
  low.texture = false;
  low.shading = Shading::gouraud;
  low.lighting = Lighting::local;
  low.shading_samples = low_shading_samples;
  RgbImage high(kSide, kSide), low_image(kSide, kSide), difference(kSide, kSide);
  for (auto _ : state)
    (void)renderer.render_pair(stage.scene, stage.camera, what.quality, low, {high.view(), {}, {}}, low_image.view(),
                               difference.view());
  per_pixel(state);
}

const Case kCases[] = {
    {"room_gouraud", room, quality_of(Shading::gouraud, false, 1)},
    {"room_trilinear", room, quality_of(Shading::gouraud, true, 1)},
    {"room_trilinear_16_samples", room, quality_of(Shading::gouraud, true, 16)},
    {"pin75k_gouraud", pin, quality_of(Shading::gouraud, false, 1)},
    {"pin75k_phong", pin, quality_of(Shading::phong, false, 1)},
    {"pin75k_gouraud_16_samples", pin, quality_of(Shading::gouraud, false, 16)},
    {"pin75k_full_lighting", pin, quality_of(Shading::phong, false, 1, Lighting::full)},
};

const bool registered = [] {
  for (const Isa isa : {Isa::scalar, Isa::sse41, Isa::avx2, Isa::neon}) {
    if (kernels_for(isa) == nullptr) continue;
    const std::string suffix = std::string("/") + isa_name(isa);
    for (const Case& what : kCases)
      benchmark::RegisterBenchmark(("raster/" + std::string(what.name) + suffix).c_str(), [&what, isa](auto& state) {
        one_rendering(state, what, isa, 1);
      })->Unit(benchmark::kMillisecond);
  }
  for (const Case& what : kCases) {
    const std::string name = "raster/" + std::string(what.name);
    benchmark::RegisterBenchmark((name + "/high_low_difference").c_str(), [&what](auto& state) {
      high_low_difference(state, what, 0, best_isa(), 1);
    })->Unit(benchmark::kMillisecond);
    if (what.quality.samples > 1)
      benchmark::RegisterBenchmark((name + "/high_low_once_difference").c_str(), [&what](auto& state) {
        high_low_difference(state, what, 1, best_isa(), 1);
      })->Unit(benchmark::kMillisecond);
    benchmark::RegisterBenchmark((name + "/2_threads").c_str(),
                                 [&what](auto& state) { one_rendering(state, what, best_isa(), 2); })
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime();
  }
  return true;
}();

}  // namespace
