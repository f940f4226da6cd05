// Client and server exchange bytes only; the client's picture is the one that the server predicts.
#include <doctest/doctest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "sim/client.h"
#include "sim/difference.h"
#include "sim/packet.h"
#include "sim/scenes.h"
#include "sim/server.h"
#include "tests/support/small_scene.h"

namespace {

using namespace pac;

struct Case {
  bool lit = false;
  const char* split = "texture";
  bool transmit = false;
  double quality = 41;
};

sim::Server make_server(const Case& item, Isa isa = best_isa(), int threads = 1) {
  sim::SceneSet scene = test::small_scene(item.lit);
  auto split = sim::make_split(item.split, scene, {4});
  REQUIRE(split.ok());
  sim::ServerOptions options;
  options.width = 90;  // no multiple of 8 or 16
  options.height = 70;
  options.quality = item.quality;
  options.transmit_model = item.transmit;
  options.isa = options.coding.isa = isa;
  options.threads = threads;
  auto server = sim::Server::create(std::move(scene), *split, options);
  REQUIRE(server.ok());
  return std::move(*server);
}

sim::Client make_client(const sim::Server& server, Isa isa = best_isa(), int threads = 1) {
  sim::ClientOptions options;
  options.isa = isa;
  options.threads = threads;
  auto client = sim::Client::create(server.session(), options);
  REQUIRE(client.ok());
  return std::move(*client);
}

Bytes send_frame(sim::Server& server, uint32_t number) {
  auto packet = server.frame(number, test::small_camera(static_cast<int>(number), 90.0f / 70.0f));
  REQUIRE(packet.ok());
  return std::move(*packet);
}

bool equal(const RgbImage& a, const RgbImage& b) {
  if (a.width() != b.width() || a.height() != b.height()) return false;
  for (int y = 0; y < a.height(); ++y)
    if (!std::equal(a.row(y), a.row(y) + 3 * a.width(), b.row(y))) return false;
  return true;
}

const Case kCases[] = {
    {false, "texture", false},      {false, "texture", true},      {true, "texture", false},
    {false, "tessellation", false}, {true, "tessellation", false}, {false, "texture,tessellation", true},
    {true, "shading", false},       {true, "shading", true},       {false, "antialiasing", false},
    {false, "antialiasing", true},  {false, "lighting", false},    {false, "texture,lighting", true},
    {false, "texture", false, 0.5}, {false, "texture", true, 100}, {true, "shading,tessellation", true},
};

TEST_CASE("the client shows what the server predicts, bit for bit, in every split, resident and transmitted") {
  for (const Case& item : kCases) {
    INFO(item.split << (item.lit ? ", lit" : ", baked") << (item.transmit ? ", transmitted" : ", resident"));
    sim::Server server = make_server(item);
    sim::Client client = make_client(server);
    for (const uint32_t number : {0u, 3u}) {
      const Bytes packet = send_frame(server, number);
      auto picture = client.receive(packet);
      REQUIRE(picture.ok());
      CHECK(equal(*picture, server.last_frame().composite));
      CHECK(equal(client.low(), server.last_frame().low));
      CHECK(client.frame_number() == number);
    }
  }
}

TEST_CASE("a server on the best instruction set and threads and a scalar client agree") {
  for (const bool transmit : {false, true}) {
    for (int number = 0; number < kIsaCount; ++number) {
      const Isa isa = static_cast<Isa>(number);
      if (!isa_is_supported(isa) || !isa_is_built(isa)) continue;
      sim::Server server = make_server({false, "texture", transmit}, isa, 2);
      sim::Client client = make_client(server, Isa::scalar, 1);
      const auto picture = client.receive(send_frame(server, 1));
      REQUIRE(picture.ok());
      CHECK(equal(*picture, server.last_frame().composite));
    }
  }
}

TEST_CASE("every built-in scene survives the wire under its own split, small") {
  for (const sim::BuiltinScene& builtin : sim::builtin_scenes()) {
    if (std::string(builtin.name) == "room") continue;  // its radiosity takes too long here; the experiments draw it
    INFO(builtin.name);
    sim::SceneSet scene = builtin.build(1);
    const auto split = sim::make_split(scene.default_split, scene, {1});
    REQUIRE(split.ok());
    sim::ServerOptions options;
    options.width = options.height = 64;
    auto server = sim::Server::create(std::move(scene), *split, options);
    REQUIRE(server.ok());
    sim::Client client = make_client(*server);
    const auto packet = server->frame(0, builtin.camera(0, 1));
    REQUIRE(packet.ok());
    const auto picture = client.receive(*packet);
    REQUIRE(picture.ok());
    CHECK(equal(*picture, server->last_frame().composite));
  }
}

TEST_CASE("a target size holds frame by frame") {
  sim::SceneSet scene = test::small_scene(false);
  const auto split = sim::make_split("texture", scene, {4});
  sim::ServerOptions options;
  options.width = options.height = 96;
  options.target_bytes = 1800;
  auto server = sim::Server::create(std::move(scene), *split, options);
  REQUIRE(server.ok());
  for (int number = 0; number < 2; ++number) {
    REQUIRE(server->frame(static_cast<uint32_t>(number), test::small_camera(4 * number, 1)).ok());
    const sim::ServerFrame& frame = server->last_frame();
    CHECK(frame.difference_bytes > 1750);
    CHECK(frame.difference_bytes < 1850);
    CHECK(frame.packet_bytes == frame.difference_bytes + sim::kFramePacketOverhead);
  }
}

TEST_CASE("a client whose low-quality rendering differs says so and is ready for the next frame") {
  sim::Server server = make_server({false, "texture", false});
  // Another machine with a slightly other model: one vertex color off by one.
  sim::SceneSet other = test::small_scene(false);
  for (Vertex& vertex : other.fine.mesh.vertices) vertex.color[1] ^= 1;
  const auto split = sim::make_split("texture", other, {4});
  sim::ServerOptions options;
  options.width = 90;
  options.height = 70;
  auto impostor = sim::Server::create(std::move(other), *split, options);
  REQUIRE(impostor.ok());
  sim::Client client = make_client(*impostor);
  const auto refused = client.receive(send_frame(server, 0));
  REQUIRE(!refused.ok());
  CHECK(refused.failure().error == Error::corrupt);
  CHECK(std::string(refused.failure().text) == "low-quality rendering differs from the server's");
  const auto good = impostor->frame(1, test::small_camera(1, 90.0f / 70.0f));
  REQUIRE(good.ok());
  CHECK(client.receive(*good).ok());
}

TEST_CASE("a picture that is used again shows what a new one shows, whatever its size was") {
  sim::Server server = make_server({false, "texture", false});
  sim::Client fresh = make_client(server), again = make_client(server);
  RgbImage picture(3, 200);
  for (uint32_t number = 0; number < 3; ++number) {
    const Bytes packet = send_frame(server, number);
    const auto shown = fresh.receive(packet);
    REQUIRE(shown.ok());
    REQUIRE(again.receive(packet, picture).ok());
    CHECK(equal(picture, *shown));
  }
}

TEST_CASE("packet and session must agree about where the model is, and about the size of the picture") {
  sim::Server resident = make_server({false, "texture", false}), transmitted = make_server({false, "texture", true});
  sim::Client client = make_client(resident);
  CHECK(std::string(client.receive(send_frame(transmitted, 0)).failure().text) ==
        "packet and session disagree about where the model is");
  sim::SceneSet scene = test::small_scene(false);
  const auto split = sim::make_split("texture", scene, {4});
  sim::ServerOptions options;
  options.width = options.height = 64;
  auto other_size = sim::Server::create(std::move(scene), *split, options);
  REQUIRE(other_size.ok());
  CHECK(std::string(client.receive(send_frame(*other_size, 0)).failure().text) ==
        "difference image has another size than the session");
}

TEST_CASE("a split whose low quality is textured cannot transmit its model, and bad options are refused") {
  const auto create = [](const char* name, const sim::ServerOptions& options) {
    sim::SceneSet scene = test::small_scene(false);
    const auto split = sim::make_split(name, scene, {1});
    REQUIRE(split.ok());
    return sim::Server::create(std::move(scene), *split, options);
  };
  sim::ServerOptions options;
  options.transmit_model = true;
  CHECK(create("lighting", options).failure().error == Error::bad_argument);
  options = {};
  options.width = 0;
  CHECK(create("texture", options).failure().error == Error::bad_argument);
  options.width = 65536;
  CHECK(create("texture", options).failure().error == Error::bad_argument);
  options = {};
  options.quality = 0;
  CHECK(create("texture", options).failure().error == Error::bad_argument);
}

TEST_CASE("the transmitted model takes fewer bytes than ten a vertex, and L stays close to the resident one") {
  sim::Server resident = make_server({false, "texture", false}), transmitted = make_server({false, "texture", true});
  send_frame(resident, 0);
  send_frame(transmitted, 0);
  CHECK(transmitted.last_frame().model_bytes > 0);
  CHECK(transmitted.last_frame().model_bytes < 10 * test::small_scene(false).fine.mesh.vertices.size() / 2);
  double error = 0;
  for (int y = 0; y < 70; ++y)
    for (int i = 0; i < 270; ++i) {
      const double difference = resident.last_frame().low.row(y)[i] - transmitted.last_frame().low.row(y)[i];
      error += difference * difference / (70 * 270);
    }
  CHECK(error < 4);  // rms 2: affine instead of perspective interpolation, 1/16 pixel
}

}  // namespace
