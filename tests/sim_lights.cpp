// Lights that move between frames: both sides shade by them, and the client follows to the bit.
#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "base/metrics.h"
#include "sim/client.h"
#include "sim/packet.h"
#include "sim/server.h"
#include "tests/support/client_server.h"
#include "tests/support/run_cli.h"

namespace {

using namespace pac;

constexpr float kAspect = static_cast<float>(test::kSmallWidth) / static_cast<float>(test::kSmallHeight);

sim::SceneSet lit_scene() {
  sim::SceneSet scene = test::small_scene(true);
  sim::move_lights(scene.fine);
  return scene;
}

sim::Transforms lights_at(int frame, const sim::SceneSet& scene) {
  sim::Transforms transforms;
  sim::add_light_transforms(frame, scene.fine.lights.size(), transforms);
  return transforms;
}

TEST_CASE("the client shades by lights where the packet says that they are, additive and by ratio") {
  for (const sim::Residual residual : {sim::Residual::additive, sim::Residual::ratio}) {
    sim::SceneSet scene = lit_scene();
    REQUIRE(!scene.fine.lights.empty());
    const sim::SceneSet kept = scene;
    const auto split = sim::make_split("texture", scene, {4, true});
    REQUIRE(split.ok());
    sim::ServerOptions options;
    options.codec = sim::Codec::mpeg1;
    options.video.quantizer_scale = 6;
    options.video.residual = residual;
    sim::Server server = test::make_server(std::move(scene), *split, options);
    sim::Client client = test::make_client(server, Isa::scalar);
    uint64_t first = 0;
    for (int number = 0; number < 12; ++number) {
      REQUIRE(server.move_objects(lights_at(4 * number, kept)).ok());
      const auto packet = server.frame(static_cast<uint32_t>(number), test::small_camera(0, kAspect));
      REQUIRE(packet.ok());
      REQUIRE(test::shows_the_same(client.receive(*packet), server));
      REQUIRE(client.is_exact());
      if (number == 0) first = sim::image_hash(server.last_frame().low.view());
    }
    CHECK(sim::image_hash(server.last_frame().low.view()) != first);
  }
}

TEST_CASE("a light that moves with an object lights as one that stands where the object took it") {
  sim::SceneSet moved = lit_scene(), placed = test::small_scene(true);
  const sim::Transforms transforms = lights_at(25, moved);
  REQUIRE(sim::move_objects(transforms, moved.fine).ok());
  for (raster::Light& light : placed.fine.lights) {
    const glm::mat4& m = transforms[0];
    light.position = glm::vec3(m * glm::vec4(light.position, 1));
    light.direction = glm::vec3(m * glm::vec4(light.direction, 0));
  }
  auto renderer = raster::Renderer::create(64, 48, {});
  REQUIRE(renderer.ok());
  RgbImage images[2] = {RgbImage(64, 48), RgbImage(64, 48)};
  const raster::Camera camera = test::small_camera(0, 64.0f / 48.0f);
  REQUIRE(renderer->render(moved.fine, camera, {}, {images[0].view(), {}, {}}).ok());
  REQUIRE(renderer->render(placed.fine, camera, {}, {images[1].view(), {}, {}}).ok());
  CHECK(rms_error(images[0].view(), images[1].view()) < 0.1);
}

TEST_CASE("a session keeps which object a light moves with, and refuses one that is not there") {
  sim::SceneSet scene = lit_scene();
  const Bytes bytes = sim::serialize_model(scene.fine, true);
  const auto parsed = sim::parse_model(bytes);
  REQUIRE(parsed.ok());
  for (size_t i = 0; i < scene.fine.lights.size(); ++i) CHECK(parsed->lights[i].object == scene.fine.lights[i].object);
  Bytes damaged = bytes;
  damaged[damaged.size() - 4] = 99;
  CHECK(!sim::parse_model(damaged).ok());
}

TEST_CASE("pac animate --lights moving needs lights") {
  const test::CliFolder folder;
  const std::string small = " --frames 2 --width 64 --height 64 --samples 1 --codec mpeg1 --lights moving";
  CHECK(folder.pac("animate letter-texture" + small).code == 0);
  CHECK(folder.pac("animate room" + small).code == 2);
}

}  // namespace
