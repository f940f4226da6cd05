// Server and client of the small scene, as tests of what passes between them use them.
#pragma once

#include <doctest/doctest.h>

#include <cstdint>
#include <utility>

#include "sim/client.h"
#include "sim/difference.h"
#include "sim/server.h"
#include "tests/support/small_scene.h"

namespace pac::test {

constexpr int kSmallWidth = 90, kSmallHeight = 71;  // no multiples of 16

// Of that size, whatever the options say.
inline sim::Server make_server(sim::SceneSet scene, const sim::Split& split, sim::ServerOptions options) {
  options.width = kSmallWidth;
  options.height = kSmallHeight;
  auto server = sim::Server::create(std::move(scene), split, options);
  REQUIRE(server.ok());
  return std::move(*server);
}

inline sim::Client make_client(const sim::Server& server, Isa isa = best_isa()) {
  sim::ClientOptions options;
  options.isa = isa;
  auto client = sim::Client::create(server.session(), options);
  REQUIRE(client.ok());
  return std::move(*client);
}

// The packet of a frame of small_camera()'s walk, which comes back after 40.
inline Bytes send(sim::Server& server, int number) {
  constexpr float kAspect = static_cast<float>(kSmallWidth) / static_cast<float>(kSmallHeight);
  auto packet = server.frame(static_cast<uint32_t>(number), small_camera(number % 40, kAspect));
  REQUIRE(packet.ok());
  return std::move(*packet);
}

inline bool shows_the_same(const Result<RgbImage>& shown, const sim::Server& server) {
  REQUIRE(shown.ok());
  return sim::image_hash(shown->view()) == sim::image_hash(server.last_frame().composite.view());
}

}  // namespace pac::test
