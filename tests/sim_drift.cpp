// Model prediction over a long walk: server and client hold the same picture to the end.
#include <doctest/doctest.h>

#include "sim/client.h"
#include "sim/difference.h"
#include "sim/server.h"
#include "tests/support/small_scene.h"

namespace {

using namespace pac;

TEST_CASE("nothing drifts in 1,100 frames from one key picture: server on its best instructions, client scalar") {
  constexpr int kFrames = 1100;
  sim::SceneSet scene = test::small_scene(false);
  const auto split = sim::make_split("texture", scene, {1});
  REQUIRE(split.ok());
  sim::ServerOptions options;
  options.width = 64;
  options.height = 48;
  options.codec = sim::Codec::mpeg1;
  options.video.quantizer_scale = 9;
  options.video.key_interval = 0;
  options.threads = 2;
  auto server = sim::Server::create(std::move(scene), *split, options);
  REQUIRE(server.ok());
  sim::ClientOptions on_client;
  on_client.isa = Isa::scalar;
  auto client = sim::Client::create(server->session(), on_client);
  REQUIRE(client.ok());
  int n_keys = 0, n_equal = 0;
  double carried = 0;
  for (int number = 0; number < kFrames; ++number) {
    const auto packet = server->frame(static_cast<uint32_t>(number), test::small_camera(number % 70, 64.0f / 48.0f));
    REQUIRE(packet.ok());
    const auto shown = client->receive(*packet);
    REQUIRE(shown.ok());
    const sim::ServerFrame& sent = server->last_frame();
    const bool is_equal = sim::image_hash(shown->view()) == sim::image_hash(sent.composite.view());
    n_equal += is_equal && client->is_exact() ? 1 : 0;
    n_keys += sent.video.is_key ? 1 : 0;
    carried += sent.video.carried_share / kFrames;
  }
  CHECK(n_equal == kFrames);
  CHECK(n_keys == 1);
  CHECK(carried > 0.6);
}

}  // namespace
