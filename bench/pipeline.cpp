// The whole system: what H+L+D cost over H alone (the paper's footnote: one pass through the data), what server and
// client spend a frame, and what a search for a file size costs.
#include <benchmark/benchmark.h>

#include <string>
#include <utility>

#include "sim/client.h"
#include "sim/difference.h"
#include "sim/match.h"
#include "sim/scenes.h"
#include "sim/server.h"
#include "sim/split.h"

namespace {

using namespace pac;

constexpr const char* kScene = "letter-texture";  // quick to build, textured and lit
constexpr int kSamples = 16;

struct Stage {
  sim::SceneSet scene;
  sim::Split split;
  raster::Camera camera;
  int width = 0, height = 0;

  Stage() {
    const sim::BuiltinScene* builtin = sim::find_scene(kScene);
    PAC_ASSERT(builtin != nullptr);
    scene = builtin->build(1);
    split = *sim::make_split("texture", scene, {kSamples});
    width = scene.width;
    height = scene.height;
    camera = builtin->camera(0, static_cast<float>(width) / static_cast<float>(height));
  }
  double pixels() const { return static_cast<double>(width) * height; }
};

raster::Renderer make_renderer(const Stage& stage, Isa isa) {
  raster::RendererOptions options;
  options.isa = isa;
  return std::move(*raster::Renderer::create(stage.width, stage.height, options));
}

void per_pixel(benchmark::State& state, const Stage& stage) {
  state.counters["pixels/s"] =
      benchmark::Counter(stage.pixels() * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

void render_high_alone(benchmark::State& state, Isa isa) {
  const Stage stage;
  raster::Renderer renderer = make_renderer(stage, isa);
  RgbImage high(stage.width, stage.height);
  for (auto _ : state) (void)renderer.render(stage.scene.fine, stage.camera, stage.split.high, {high.view(), {}, {}});
  per_pixel(state, stage);
}

void render_high_low_difference_one_pass(benchmark::State& state, Isa isa) {
  const Stage stage;
  raster::Renderer renderer = make_renderer(stage, isa);
  RgbImage high(stage.width, stage.height), low(stage.width, stage.height), difference(stage.width, stage.height);
  for (auto _ : state)
    (void)renderer.render_pair(stage.scene.fine, stage.camera, stage.split.high, stage.split.low, {high.view(), {}, {}},
                               low.view(), difference.view());
  per_pixel(state, stage);
}

void render_high_low_difference_three_passes(benchmark::State& state, Isa isa) {
  const Stage stage;
  raster::Renderer renderer = make_renderer(stage, isa);
  RgbImage high(stage.width, stage.height), low(stage.width, stage.height), difference(stage.width, stage.height);
  for (auto _ : state) {
    (void)renderer.render(stage.scene.fine, stage.camera, stage.split.high, {high.view(), {}, {}});
    (void)renderer.render(stage.scene.fine, stage.camera, stage.split.low, {low.view(), {}, {}});
    sim::difference_image(high.view(), low.view(), difference.view(), isa);
  }
  per_pixel(state, stage);
}

sim::Server make_server(bool transmit_model) {
  Stage stage;
  sim::ServerOptions options;
  options.width = stage.width;
  options.height = stage.height;
  options.transmit_model = transmit_model;
  return std::move(*sim::Server::create(std::move(stage.scene), stage.split, options));
}

void server_frame(benchmark::State& state) {
  const Stage stage;
  sim::Server server = make_server(state.range(0) != 0);
  for (auto _ : state) benchmark::DoNotOptimize(server.frame(0, stage.camera));
  state.counters["bytes/frame"] = static_cast<double>(server.last_frame().packet_bytes);
}

void client_frame(benchmark::State& state) {
  const Stage stage;
  sim::Server server = make_server(state.range(0) != 0);
  const Bytes packet = std::move(*server.frame(0, stage.camera));
  sim::Client client = std::move(*sim::Client::create(server.session()));
  for (auto _ : state) benchmark::DoNotOptimize(client.receive(packet));
}

void match_size(benchmark::State& state) {
  const Stage stage;
  raster::Renderer renderer = make_renderer(stage, best_isa());
  RgbImage high(stage.width, stage.height);
  (void)renderer.render(stage.scene.fine, stage.camera, stage.split.high, {high.view(), {}, {}});
  int encodes = 0;
  for (auto _ : state) encodes = sim::code_at_size(high.view(), sim::Content::image, 9836, {})->encodes;
  state.counters["encodes"] = encodes;
}

int register_per_isa() {
  for (int number = 0; number < kIsaCount; ++number) {
    const Isa isa = static_cast<Isa>(number);
    if (!isa_is_built(isa) || !isa_is_supported(isa)) continue;
    const auto add = [&](const char* name, void (*run)(benchmark::State&, Isa)) {
      benchmark::RegisterBenchmark((std::string("pipeline/") + name + "/" + isa_name(isa)).c_str(), run, isa)
          ->Unit(benchmark::kMillisecond);
    };
    add("high_alone", render_high_alone);
    add("high_low_difference/one_pass", render_high_low_difference_one_pass);
    add("high_low_difference/three_passes", render_high_low_difference_three_passes);
  }
  return 0;
}
const int kRegistered = register_per_isa();

BENCHMARK(server_frame)
    ->Name("pipeline/server_frame")
    ->ArgName("transmit")
    ->Arg(0)
    ->Arg(1)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(client_frame)
    ->Name("pipeline/client_frame")
    ->ArgName("transmit")
    ->Arg(0)
    ->Arg(1)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(match_size)->Name("pipeline/match_size")->Unit(benchmark::kMillisecond);

}  // namespace
