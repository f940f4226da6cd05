// What the application puts before the rest: its pixels get better at equal bytes, and the client still follows.
#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

#include "sim/client.h"
#include "sim/frame_renderer.h"
#include "sim/server.h"
#include "sim/video_sequence.h"
#include "tests/support/client_server.h"
#include "tests/support/run_cli.h"

namespace {

using namespace pac;
using sim::Difference;
using sim::Prediction;

constexpr int kSide = 128, kFrames = 4;
constexpr const char* kHinted = "tartan";

// The cubes as a server draws them.
struct Drawn {
  sim::SceneSet scene = sim::find_scene("cubes")->build(1);
  raster::Scene low;
  int samples = 1;
  std::vector<sim::Shot> shots;

  Drawn() {
    const auto split = sim::make_split("texture", scene, {4, true});
    REQUIRE(split.ok());
    samples = split->low.samples;
    auto renderer = sim::FrameRenderer::create(scene, *split, false, kSide, kSide, 1, best_isa());
    REQUIRE(renderer.ok());
    low = renderer->low_scene();
    for (int number = 0; number < kFrames; ++number) {
      const raster::Camera camera = sim::find_scene("cubes")->camera(number, 1);
      auto images = renderer->render(scene, camera, true);
      REQUIRE(images.ok());
      shots.push_back({camera, std::move(*images)});
    }
  }

  bool is_hinted(uint32_t id) const { return id > 0 && low.materials[low.mesh.faces[id - 1].material].name == kHinted; }

  // Mean squared errors: of the hinted material's pixels, of the others.
  struct Errors {
    uint64_t bytes = 0;
    double mean[2] = {};
  };
  Errors code(const sim::AssistedVideoOptions& options) const {
    auto frames = sim::code_assisted_video(shots, {kSide, kSide, &low, samples}, options, best_isa(), true);
    REQUIRE(frames.ok());
    Errors errors{sim::total_bytes(*frames), {}};
    double count[2] = {};
    for (size_t i = 0; i < shots.size(); ++i)
      for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) {
          const size_t kind = is_hinted(shots[i].images.id.row(y)[x]) ? 0 : 1;
          for (int c = 0; c < 3; ++c) {
            const int error = shots[i].images.high.pixel(x, y)[c] - (*frames)[i].shown.pixel(x, y)[c];
            errors.mean[kind] += error * error;
          }
          count[kind] += 3;
        }
    for (const size_t kind : {size_t{0}, size_t{1}}) errors.mean[kind] /= count[kind];
    REQUIRE(count[0] > 1000);
    return errors;
  }
};

double decibels(double before, double after) {
  return 10 * std::log10(before / after);
}

TEST_CASE("a foreground is nearer to H at the same bytes, with and without the model's prediction") {
  const Drawn drawn;
  for (const auto& form :
       {std::pair{Prediction::model, Difference::full}, std::pair{Prediction::model, Difference::halved},
        std::pair{Prediction::block, Difference::halved}, std::pair{Prediction::none, Difference::halved}}) {
    CAPTURE(static_cast<int>(form.first));
    CAPTURE(static_cast<int>(form.second));
    sim::AssistedVideoOptions options;
    options.prediction = form.first;
    options.difference = form.second;
    options.quantizer_scale = 6;
    const Drawn::Errors alike = drawn.code(options);
    options.foreground.materials = {kHinted};
    const auto bytes_at = [&](double quantizer) -> Result<uint64_t> {
      options.quantizer_scale = quantizer;
      return drawn.code(options).bytes;
    };
    const auto quantizer = sim::quantizer_for_bytes(alike.bytes, 8, bytes_at);
    REQUIRE(quantizer.ok());
    options.quantizer_scale = *quantizer;
    const Drawn::Errors hinted = drawn.code(options);
    CHECK(hinted.bytes <= alike.bytes);
    CHECK(decibels(alike.mean[0], hinted.mean[0]) > 0.5);
    CHECK(decibels(alike.mean[1], hinted.mean[1]) < 0);
  }
}

TEST_CASE("worth below 1 puts a material behind the rest") {
  const Drawn drawn;
  sim::AssistedVideoOptions options;
  options.quantizer_scale = 6;
  options.foreground.materials = {kHinted};
  options.foreground.worth = 1;
  const Drawn::Errors alike = drawn.code(options);
  options.foreground.worth = 0.125;
  const Drawn::Errors behind = drawn.code(options);
  CHECK(behind.bytes < alike.bytes);
  CHECK(decibels(alike.mean[0], behind.mean[0]) < -0.1);
}

sim::Server make_server(const sim::Foreground& foreground, Prediction prediction, Isa isa = best_isa()) {
  sim::SceneSet scene = test::small_scene(false);
  scene.fine.materials[0].name = "wall";
  const auto split = sim::make_split("texture", scene, {4, true});
  REQUIRE(split.ok());
  sim::ServerOptions options;
  options.codec = sim::Codec::mpeg1;
  options.video.prediction = prediction;
  options.video.difference = prediction == Prediction::block ? Difference::halved : Difference::full;
  options.video.quantizer_scale = 6;
  options.video.foreground = foreground;
  options.isa = isa;
  return test::make_server(std::move(scene), *split, options);
}

TEST_CASE("the client knows nothing of a foreground and shows what the server predicts, on every instruction set") {
  const sim::Foreground wall{{"wall"}, false, 9};
  for (const Prediction prediction : {Prediction::model, Prediction::block, Prediction::none}) {
    sim::Server server = make_server(wall, prediction), scalar = make_server(wall, prediction, Isa::scalar);
    sim::Client client = test::make_client(server, Isa::scalar);
    for (int number = 0; number < 8; ++number) {
      const Bytes packet = test::send(server, number);
      CHECK(packet == test::send(scalar, number));
      REQUIRE(test::shows_the_same(client.receive(packet), server));
    }
  }
}

TEST_CASE("a material that the model has not, or a worth beyond sixteen, is no foreground") {
  const sim::SceneSet scene = test::small_scene(false);
  CHECK(!sim::QuantizerAdaptation::create(scene.fine, {{"no such"}, false, 4}).ok());
  CHECK(!sim::QuantizerAdaptation::create(scene.fine, {{}, true, 17}).ok());
  CHECK(sim::QuantizerAdaptation::create(scene.fine, {{}, true, 16}).ok());
}

TEST_CASE("pac animate takes a foreground by name and says when the model has no such material") {
  const test::CliFolder folder;
  const std::string small = "animate cubes --codec mpeg1 --frames 2 --width 64 --height 64 --samples 1 ";
  CHECK(folder.pac(small + "--foreground tartan,moving --objects moving --worth 8").code == 0);
  CHECK(folder.pac(small + "--foreground velvet").code != 0);
  CHECK(folder.pac(small + "--worth 8").code == 2);
  CHECK(folder.pac("animate cubes --foreground tartan").code == 2);
}

}  // namespace
