// Motion JPEG predicted by the model: no drift, recovery, fewer bytes, refusals.
#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

#include "base/metrics.h"
#include "sim/animation.h"
#include "sim/client.h"
#include "sim/difference.h"
#include "sim/packet.h"
#include "sim/predicted_stills.h"
#include "sim/server.h"
#include "tests/support/client_server.h"
#include "tests/support/small_scene.h"

namespace {

using namespace pac;
using test::make_client;
using test::send;
using test::shows_the_same;

sim::Server make_server(sim::Codec codec, double quality = 50, int key_interval = 132, Isa isa = best_isa()) {
  sim::SceneSet scene = test::small_scene(false);
  const auto split = sim::make_split("texture", scene, {4});
  REQUIRE(split.ok());
  sim::ServerOptions options;
  options.quality = quality;
  options.codec = codec;
  options.coding.tables = sim::TableFamily::adapted;
  options.coding.huffman = jpeg::Huffman::optimal;
  options.video.key_interval = key_interval;
  options.isa = options.coding.isa = isa;
  return test::make_server(std::move(scene), *split, options);
}

TEST_CASE("predicted stills: the client shows what the server predicts over 150 frames: nothing drifts") {
  for (const double quality : {15.0, 60.0}) {
    sim::Server server = make_server(sim::Codec::predicted_jpeg, quality);
    sim::Client client = make_client(server);
    for (int number = 0; number < 150; ++number) {
      REQUIRE(shows_the_same(client.receive(send(server, number)), server));
      REQUIRE(client.is_exact());
      CHECK(server.last_frame().video.is_key == (number % 132 == 0));
    }
  }
}

TEST_CASE("predicted stills: packets are equal on every instruction set, and each set's client shows the same") {
  sim::Server reference = make_server(sim::Codec::predicted_jpeg, 40, 132, Isa::scalar);
  sim::Server best = make_server(sim::Codec::predicted_jpeg, 40);
  sim::Client scalar_client = make_client(best, Isa::scalar);
  for (int number = 0; number < 12; ++number) {
    const Bytes packet = send(best, number);
    CHECK(packet == send(reference, number));
    CHECK(shows_the_same(scalar_client.receive(packet), best));
  }
}

TEST_CASE("predicted stills: exact again within one interval after a lost frame, and at once on request") {
  constexpr int kInterval = 8;
  sim::Server server = make_server(sim::Codec::predicted_jpeg, 40, kInterval);
  sim::Client client = make_client(server);
  for (int number = 0; number < 2 * kInterval + 3; ++number) {
    if (number == 2 * kInterval + 2) server.request_key();
    const Bytes packet = send(server, number);
    if (number == 3 || number == 2 * kInterval + 1) continue;  // lost
    const auto shown = client.receive(packet);
    REQUIRE(shown.ok());
    const bool exact = number < 3 || number >= kInterval;
    CHECK(client.is_exact() == exact);
    if (exact) {
      CHECK(shows_the_same(shown, server));
    } else {
      const sim::ServerFrame& sent = server.last_frame();
      CHECK(rms_error(sent.high.view(), shown->view()) < rms_error(sent.high.view(), sent.low.view()));
    }
  }
}

TEST_CASE("predicted stills: after the first, a third fewer bytes and less error than stills by themselves") {
  uint64_t bytes[2] = {};
  double error[2] = {};
  for (const bool is_predicted : {false, true}) {
    sim::Server server = is_predicted ? make_server(sim::Codec::predicted_jpeg, 60) : make_server(sim::Codec::jpeg, 50);
    for (int number = 0; number < 12; ++number) {
      const Bytes packet = send(server, number);
      if (number == 0) continue;
      const sim::ServerFrame& sent = server.last_frame();
      bytes[is_predicted] += sent.difference_bytes;
      error[is_predicted] += rms_error(sent.high.view(), sent.composite.view()) / 11;
    }
  }
  MESSAGE("bytes " << bytes[0] << " and " << bytes[1] << ", rms error " << error[0] << " and " << error[1]);
  CHECK(3 * bytes[1] < 2 * bytes[0]);
  CHECK(error[1] < error[0]);
}

TEST_CASE("predicted stills: the first frame is the paper's still of the same size, to the bit") {
  sim::Server plain = make_server(sim::Codec::jpeg), predicted = make_server(sim::Codec::predicted_jpeg);
  send(plain, 0);
  send(predicted, 0);
  CHECK(plain.last_frame().code == predicted.last_frame().code);
  CHECK(sim::image_hash(plain.last_frame().composite.view()) ==
        sim::image_hash(predicted.last_frame().composite.view()));
}

TEST_CASE("predicted stills: what is none is refused, and the next one that stands alone puts everything right") {
  sim::Server server = make_server(sim::Codec::predicted_jpeg, 40, 2);
  sim::Client client = make_client(server);
  REQUIRE(client.receive(send(server, 0)).ok());
  const Bytes good = send(server, 1);
  const auto read = sim::read_frame_packet(good);
  REQUIRE(read.ok());
  for (const Bytes& still : {Bytes{}, Bytes{2, 0xFF, 0xD8}, Bytes{0}, Bytes{0, 0xFF, 0xD8, 0xFF, 0xD9}}) {
    sim::FramePacket packet = *read;
    packet.difference = still;
    CHECK(!client.receive(sim::write_frame_packet(packet)).ok());
  }
  const auto shown = client.receive(send(server, 2));
  CHECK(shows_the_same(shown, server));
  CHECK(client.is_exact());
}

TEST_CASE("predicted stills need a resident model; blocks predict none") {
  sim::SceneSet scene = test::small_scene(false);
  const auto split = sim::make_split("texture", scene, {4});
  REQUIRE(split.ok());
  sim::ServerOptions options;
  options.width = test::kSmallWidth;
  options.height = test::kSmallHeight;
  options.codec = sim::Codec::predicted_jpeg;
  options.transmit_model = true;
  CHECK(!sim::Server::create(test::small_scene(false), *split, options).ok());
  sim::AnimationOptions animation;
  animation.frames = 1;
  animation.still_prediction = sim::Prediction::block;
  CHECK(!sim::run_animation(test::small_scene(false), test::small_camera, animation).ok());
}

TEST_CASE("motion JPEG of both arms at equal bytes, predicted: the client shows it") {
  sim::AnimationOptions options;
  options.render.width = test::kSmallWidth;
  options.render.height = test::kSmallHeight;
  options.render.samples = 4;
  options.render.split = "texture";
  options.coding.huffman = jpeg::Huffman::optimal;
  options.still_prediction = sim::Prediction::model;
  options.frames = 4;
  options.quality = 30;
  const auto animation = sim::run_animation(test::small_scene(false), test::small_camera, options);
  REQUIRE(animation.ok());
  CHECK(animation->polygon_assisted.frames.size() == 4);
}

}  // namespace
