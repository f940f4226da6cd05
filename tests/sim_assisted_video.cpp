// MPEG-1 between server and client: no drift in any mode, on any instruction set; recovery after a loss; matched bytes.
#include <doctest/doctest.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "base/metrics.h"
#include "mpeg1/mpeg1.h"
#include "sim/animation.h"
#include "sim/assisted_video.h"
#include "sim/client.h"
#include "sim/difference.h"
#include "sim/frame_renderer.h"
#include "sim/packet.h"
#include "sim/server.h"
#include "sim/video_sequence.h"
#include "tests/support/client_server.h"
#include "tests/support/small_scene.h"

namespace {

using namespace pac;
using sim::Difference;
using sim::Prediction;
using test::make_client;
using test::send;
using test::shows_the_same;

struct Mode {
  Prediction prediction;
  Difference difference;
};

constexpr Mode kModes[] = {{Prediction::none, Difference::halved},
                           {Prediction::none, Difference::full},
                           {Prediction::block, Difference::halved},
                           {Prediction::model, Difference::halved},
                           {Prediction::model, Difference::full}};

sim::Server make_server(const Mode& mode, int key_interval = 132, Isa isa = best_isa(), double quantizer = 6) {
  sim::SceneSet scene = test::small_scene(false);
  const auto split = sim::make_split("texture", scene, {4, true});
  REQUIRE(split.ok());
  sim::ServerOptions options;
  options.codec = sim::Codec::mpeg1;
  options.video.prediction = mode.prediction;
  options.video.difference = mode.difference;
  options.video.key_interval = key_interval;
  options.video.quantizer_scale = quantizer;
  options.isa = isa;
  return test::make_server(std::move(scene), *split, options);
}

TEST_CASE("the client shows what the server predicts over 60 frames in every mode: nothing drifts") {
  for (const Mode& mode : kModes) {
    CAPTURE(static_cast<int>(mode.prediction));
    CAPTURE(static_cast<int>(mode.difference));
    sim::Server server = make_server(mode);
    sim::Client client = make_client(server);
    for (int number = 0; number < 60; ++number) {
      REQUIRE(shows_the_same(client.receive(send(server, number)), server));
      REQUIRE(client.is_exact());
    }
  }
}

TEST_CASE("packets are equal on every instruction set, and each set's client shows the same") {
  sim::Server reference = make_server({Prediction::model, Difference::full}, 132, Isa::scalar);
  sim::Server best = make_server({Prediction::model, Difference::full});
  sim::Client scalar_client = make_client(best, Isa::scalar);
  for (int number = 0; number < 12; ++number) {
    const Bytes packet = send(best, number);
    CHECK(packet == send(reference, number));
    CHECK(shows_the_same(scalar_client.receive(packet), best));
  }
}

TEST_CASE("after a lost frame the client goes on approximately and is exact again within one group of pictures") {
  constexpr int kGroup = 8;
  sim::Server server = make_server({Prediction::model, Difference::full}, kGroup);
  sim::Client client = make_client(server);
  for (int number = 0; number < 2 * kGroup; ++number) {
    const Bytes packet = send(server, number);
    if (number == 3) continue;  // lost
    const auto shown = client.receive(packet);
    REQUIRE(shown.ok());
    const bool exact = number < 3 || number >= kGroup;
    CHECK(client.is_exact() == exact);
    if (exact) {
      CHECK(shows_the_same(shown, server));
    } else {
      const sim::ServerFrame& sent = server.last_frame();
      CHECK(rms_error(sent.high.view(), shown->view()) < rms_error(sent.high.view(), sent.low.view()));
    }
  }
}

// Server and client of a small scene taken apart: what the frames are coded from, and both ends of the codec.
struct Wire {
  std::vector<sim::Shot> shots;
  std::optional<sim::AssistedEncoder> encoder;
  std::optional<sim::AssistedDecoder> decoder;

  explicit Wire(bool is_packed) {
    const sim::SceneSet scene = test::small_scene(false);
    const auto split = sim::make_split("texture", scene, {4, true});
    REQUIRE(split.ok());
    auto renderer = sim::FrameRenderer::create(scene, *split, false, 90, 71, 1, best_isa());
    REQUIRE(renderer.ok());
    for (int number = 0; number < 4; ++number) {
      const raster::Camera camera = test::small_camera(number, 90.0f / 71.0f);
      auto images = renderer->render(scene, camera, true);
      REQUIRE(images.ok());
      shots.push_back({camera, std::move(*images)});
    }
    const sim::AssistedScene seen{90, 71, &renderer->low_scene(), split->low.samples};
    sim::AssistedVideoOptions options;
    options.quantizer_scale = 6;
    options.is_packed = is_packed;
    auto made = sim::AssistedEncoder::create(seen, options);
    auto other = sim::AssistedDecoder::create(seen);
    REQUIRE(made.ok());
    REQUIRE(other.ok());
    encoder.emplace(std::move(*made));
    decoder.emplace(std::move(*other));
  }

  Bytes code(size_t number, bool force_key = false) {
    const sim::FrameImages& f = shots[number].images;
    Bytes bytes;
    REQUIRE(
        encoder
            ->encode({f.high.view(), f.low.view(), f.depth.view(), f.id.view(), shots[number].camera}, bytes, force_key)
            .ok());
    return bytes;
  }
  Result<void> show(size_t number, std::span<const uint8_t> bytes) {
    const sim::FrameImages& f = shots[number].images;
    RgbImage shown(90, 71);
    PAC_CHECK(decoder->decode(bytes, f.low.view(), f.depth.view(), f.id.view(), shots[number].camera, shown.view()));
    RgbImage wanted(90, 71);
    encoder->composite(f.low.view(), wanted.view());
    if (sim::image_hash(shown.view()) != sim::image_hash(wanted.view()))
      return Failure{Error::bad_argument, 0, "another picture"};
    return {};
  }
};

TEST_CASE("after a picture that is no picture the next one that stands alone puts everything right") {
  for (const bool is_packed : {false, true}) {
    CAPTURE(is_packed);
    Wire wire(is_packed);
    REQUIRE(wire.show(0, wire.code(0)).ok());
    Bytes broken = wire.code(1);
    broken.resize(1 + (broken.size() - 1) / 2);
    broken[0] &= 0xEF;  // as if it were not packed: a slice that breaks off, or nothing that is MPEG-1
    CHECK(!wire.show(1, broken).ok());
    const auto again = wire.show(2, wire.code(2, true));
    const std::string problem = again.ok() ? "" : again.failure().text;
    CAPTURE(problem);
    CHECK(again.ok());
    CHECK(wire.show(3, wire.code(3)).ok());
  }
}

TEST_CASE("a second picture in a frame's bytes is refused, and does not come out in the next one's place") {
  Wire wire(false);
  REQUIRE(wire.show(0, wire.code(0)).ok());
  Bytes two = wire.code(1);
  const Bytes one = two;
  two.insert(two.end(), one.begin() + 1, one.end());
  CHECK(!wire.show(1, two).ok());
  CHECK(wire.show(2, wire.code(2, true)).ok());
}

TEST_CASE("a key frame on request ends the damage at once") {
  sim::Server server = make_server({Prediction::model, Difference::full});
  sim::Client client = make_client(server);
  REQUIRE(client.receive(send(server, 0)).ok());
  send(server, 1);  // lost
  REQUIRE(client.receive(send(server, 2)).ok());
  CHECK(!client.is_exact());
  server.request_key();
  CHECK(shows_the_same(client.receive(send(server, 3)), server));
  CHECK(client.is_exact());
  CHECK(server.last_frame().video.is_key);
}

TEST_CASE("a lost key frame is told by name, and the next one puts everything right") {
  constexpr int kGroup = 4;
  sim::Server server = make_server({Prediction::model, Difference::full}, kGroup);
  sim::Client client = make_client(server);
  for (int number = 0; number < 3 * kGroup; ++number) {
    const Bytes packet = send(server, number);
    if (number == kGroup) continue;  // lost
    const auto shown = client.receive(packet);
    const bool leans_on_lost = number > kGroup && number < 2 * kGroup;
    REQUIRE(shown.ok() == !leans_on_lost);
    if (leans_on_lost)
      CHECK(std::string(shown.failure().text) == "the packet that this one leans on did not arrive");
    else
      CHECK(shows_the_same(shown, server));
  }
}

TEST_CASE("full differences pass the quality at which halved ones stop") {
  double rms[2];
  for (const Difference difference : {Difference::halved, Difference::full}) {
    sim::Server server = make_server({Prediction::model, difference}, 132, best_isa(), 1);
    for (int number = 0; number < 3; ++number) send(server, number);
    const sim::ServerFrame& sent = server.last_frame();
    rms[static_cast<size_t>(difference)] = rms_error(sent.high.view(), sent.composite.view());
  }
  MESSAGE("rms of halved differences " << rms[0] << ", of full ones " << rms[1]);
  CHECK(rms[1] < rms[0]);
}

TEST_CASE("differences coded by blocks alone are a stream that an ordinary decoder plays") {
  sim::Server server = make_server({Prediction::block, Difference::halved});
  Bytes stream;
  sim::PacketReader packets;
  for (int number = 0; number < 5; ++number) {
    const Bytes packet = send(server, number);
    const auto fields = packets.read(packet);
    REQUIRE(fields.ok());
    stream.insert(stream.end(), fields->difference.begin() + 1, fields->difference.end());
  }
  mpeg1::DecoderOptions strict;
  strict.strict = true;
  mpeg1::Decoder decoder(strict);
  decoder.feed(stream);
  decoder.finish();
  int pictures = 0;
  for (;;) {
    const auto picture = decoder.next();
    REQUIRE(picture.ok());
    if (*picture == nullptr) break;
    ++pictures;
  }
  CHECK(pictures == 5);
}

TEST_CASE("MPEG-1: the polygon-assisted arm takes at most the image-based one's bytes, and looks better") {
  sim::AnimationOptions options;
  options.render.width = 96;
  options.render.height = 80;
  options.render.samples = 4;
  options.frames = 6;
  options.codec = sim::VideoCodec::mpeg1;
  options.quantizer_scale = 12;
  const auto result = sim::run_animation(test::small_scene(false), test::small_camera, options);
  REQUIRE(result.ok());
  CHECK(result->polygon_assisted.bytes <= result->image_based.bytes);
  std::vector<sim::FrameScores> scores[2];
  for (const auto& frame : result->image_based.frames) scores[0].push_back(frame.scores);
  for (const auto& frame : result->polygon_assisted.frames) scores[1].push_back(frame.scores);
  CHECK(sim::summarize(scores[1], 0).mean > sim::summarize(scores[0], 0).mean + 2);
}

TEST_CASE("the quantizer for a size: within 1 % where there is one, an end of the scale where there is none") {
  const auto bytes_at = [](double q) -> Result<uint64_t> { return static_cast<uint64_t>(100000.0 / (q + 0.3)); };
  for (const uint64_t target : {4000u, 9000u, 30000u, 70000u}) {
    const auto quantizer = sim::quantizer_for_bytes(target, 12, bytes_at);
    REQUIRE(quantizer.ok());
    const auto bytes = static_cast<double>(*bytes_at(*quantizer));
    CHECK(bytes <= static_cast<double>(target));
    CHECK(bytes >= 0.985 * static_cast<double>(target));
  }
  // In steps: the best of them is found.
  const auto in_steps = [](double q) -> Result<uint64_t> {
    return static_cast<uint64_t>(q < 4 ? 120000 : q < 7 ? 101000 : q < 8 ? 96000 : 40000);
  };
  CHECK(*in_steps(*sim::quantizer_for_bytes(100000, 12, in_steps)) == 96000);
  CHECK(*sim::quantizer_for_bytes(100, 12, bytes_at) == 31.0);
  CHECK(*sim::quantizer_for_bytes(1000000, 12, bytes_at) == 1.0);
}

TEST_CASE("video refuses what it cannot do") {
  sim::SceneSet scene = test::small_scene(false);
  const auto split = sim::make_split("texture", scene, {4, true});
  sim::ServerOptions options;
  options.codec = sim::Codec::mpeg1;
  options.transmit_model = true;
  CHECK(!sim::Server::create(test::small_scene(false), *split, options).ok());
  options.transmit_model = false;
  options.video.prediction = Prediction::block;  // with full differences
  CHECK(!sim::Server::create(test::small_scene(false), *split, options).ok());
  options.video = {};
  options.video.key_interval = 133;
  CHECK(!sim::Server::create(test::small_scene(false), *split, options).ok());
}

}  // namespace
