// Bit rate of assisted video: the bucket, the search for a quantizer, whole streams that keep to it.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/metrics.h"
#include "mpeg1/mpeg1.h"
#include "sim/bit_rate.h"
#include "sim/client.h"
#include "sim/difference.h"
#include "sim/server.h"
#include "tests/support/json_check.h"
#include "tests/support/run_cli.h"
#include "tests/support/small_scene.h"

namespace {

using namespace pac;

constexpr int kFramesPerSecond = 20;

sim::Server make_server(uint64_t bits_per_second, double buffer_seconds) {
  sim::SceneSet scene = test::small_scene(false);
  const auto split = sim::make_split("texture", scene, {1});
  REQUIRE(split.ok());
  sim::ServerOptions options;
  options.width = 80;
  options.height = 64;
  options.codec = sim::Codec::mpeg1;
  options.video.key_interval = 0;
  options.video.effort = mpeg1::Effort::fast;
  options.video.rate = {bits_per_second, kFramesPerSecond, buffer_seconds};
  auto server = sim::Server::create(std::move(scene), *split, options);
  REQUIRE(server.ok());
  return std::move(*server);
}

// Sizes of the packets of a walk that jumps to another place every `jump` frames; the client follows to the bit.
std::vector<double> packet_sizes(sim::Server& server, int frames, int jump, bool ask_for_keys) {
  auto client = sim::Client::create(server.session());
  REQUIRE(client.ok());
  std::vector<double> sizes;
  for (int number = 0; number < frames; ++number) {
    if (ask_for_keys && number % 17 == 11) server.request_key();
    const int place = number + number / jump * 41;
    const auto packet = server.frame(static_cast<uint32_t>(number), test::small_camera(place % 97, 80.0f / 64.0f));
    REQUIRE(packet.ok());
    sizes.push_back(static_cast<double>(packet->size()));
    const auto shown = client->receive(*packet);
    REQUIRE(shown.ok());
    REQUIRE(sim::image_hash(shown->view()) == sim::image_hash(server.last_frame().composite.view()));
  }
  return sizes;
}

// The most that a bucket ever holds into which the packets fall, one a frame.
double fullest(const std::vector<double>& sizes, double per_frame) {
  double full = 0, most = 0;
  for (const double size : sizes) {
    full = std::max(0.0, full - per_frame) + size;
    most = std::max(most, full);
  }
  return most;
}

TEST_CASE("the bucket never overflows and no packet after the first exceeds twice the mean, whatever the camera does") {
  for (const uint64_t rate : {20000u, 40000u, 160000u})
    for (const int jump : {1, 9})
      for (const bool ask_for_keys : {false, true}) {
        CAPTURE(rate);
        CAPTURE(jump);
        CAPTURE(ask_for_keys);
        const double per_frame = static_cast<double>(rate) / 8 / kFramesPerSecond;
        sim::Server server = make_server(rate, 0.5);
        const std::vector<double> sizes = packet_sizes(server, 40, jump, ask_for_keys);
        CHECK(fullest(sizes, per_frame) <= 0.5 * static_cast<double>(rate) / 8);
        CHECK(*std::max_element(sizes.begin() + 1, sizes.end()) <= 2 * per_frame);
        CHECK(server.bucket()->fullest_bytes() == doctest::Approx(fullest(sizes, per_frame)));
      }
}

TEST_CASE("the rate is used where there is something to send with it, and more of it looks better") {
  double last_rms = 1e9;
  for (const uint64_t rate : {24000u, 48000u, 96000u}) {
    sim::Server server = make_server(rate, 1);
    const std::vector<double> sizes = packet_sizes(server, 120, 10, false);
    double second_half = 0;  // the first picture is paid off
    for (size_t i = 60; i < 120; ++i) second_half += sizes[i];
    const double budget = 60 * static_cast<double>(rate) / 8 / kFramesPerSecond;
    CHECK(second_half <= 1.02 * budget);
    CHECK(second_half >= 0.75 * budget);
    const double rms = rms_error(server.last_frame().high.view(), server.last_frame().composite.view());
    CHECK(rms < last_rms);
    last_rms = rms;
  }
}

// Codes a picture whose size is `bytes` * quantizer_scale^-power, until the search keeps it.
struct Search {
  double scale, size;
  int codings;
};
Search search(const sim::LeakyBucket::Goal& goal, double bytes, double power, double start) {
  sim::QuantizerSearch search(goal, 40);
  Search out{start, 0, 0};
  for (;;) {
    ++out.codings;
    REQUIRE(out.codings <= sim::QuantizerSearch::kMostCodings + 1);
    const auto coded = static_cast<uint64_t>(bytes * std::pow(out.scale, -power));
    out.size = static_cast<double>(coded) + 40;
    const double next = search.next(out.scale, coded);
    if (next == 0) return out;
    out.scale = next;
    if (next == mpeg1::kSkipEverything) return out;
    REQUIRE(next >= 1);
    REQUIRE(next <= 31);
  }
}

TEST_CASE("the quantizer is found in few codings, from anywhere, whatever the slope; what never fits is skipped") {
  for (const double power : {0.5, 1.2, 3.0})
    for (const double start : {1.0, 8.0, 31.0})
      for (const double at : {1.5, 6.0, 25.0}) {  // the scale that is right
        CAPTURE(power);
        CAPTURE(start);
        CAPTURE(at);
        const Search found = search({1000, 1500}, 960 * std::pow(at, power), power, start);
        CHECK(found.size <= 1500);
        CHECK(found.size >= 600);
      }
  CHECK(search({1000, 1500}, 50, 1, 31).scale == 1);
  CHECK(search({1000, 1500}, 1e6, 0.5, 4).scale == mpeg1::kSkipEverything);
  CHECK(search({1000, 2000}, 1900, 0, 4).size == 1940);  // no scale reaches what is wanted, but it fits
}

TEST_CASE("a picture told to skip everything shows its reference, and a picture told nothing is as before") {
  Frame420 source(50, 40), reference(50, 40);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 50; ++x) {
      source.y.row(y)[x] = static_cast<uint8_t>(x * 5);
      reference.y.row(y)[x] = static_cast<uint8_t>(255 - y * 6);
    }
  mpeg1::SequenceOptions sequence;
  sequence.width = 50;
  sequence.height = 40;
  auto encoder = mpeg1::Encoder::create(sequence);
  REQUIRE(encoder.ok());
  mpeg1::PictureOptions options;
  options.type = mpeg1::PictureType::P;
  options.reference = &reference;
  options.code_again = [](void*, double, uint64_t) { return mpeg1::kSkipEverything; };
  std::vector<uint8_t> code;
  const auto report = encoder->add(source, code, options);
  REQUIRE(report.ok());
  CHECK(report->size_bytes == code.size());
  mpeg1::DecoderOptions decoding;
  decoding.strict = true;
  decoding.reference = [](void* context, const mpeg1::PictureHeader&, const mpeg1::FrameView&) {
    return static_cast<const Frame420*>(context);
  };
  decoding.reference_context = &reference;
  mpeg1::Decoder decoder(decoding);
  decoder.feed(code);
  decoder.finish();
  const auto picture = decoder.next();
  REQUIRE(picture.ok());
  REQUIRE(*picture != nullptr);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 50; ++x) {
      REQUIRE((*picture)->view.y.row(y)[x] == reference.y.row(y)[x]);
      REQUIRE(encoder->reconstruction().y.row(y)[x] == reference.y.row(y)[x]);
    }
}

TEST_CASE("rates that cannot be kept are refused") {
  const auto fails = [](uint64_t rate, double buffer, sim::Prediction prediction) {
    sim::SceneSet scene = test::small_scene(false);
    const auto split = sim::make_split("texture", scene, {1});
    sim::ServerOptions options;
    options.codec = sim::Codec::mpeg1;
    options.video.prediction = prediction;
    options.video.rate = {rate, 20, buffer};
    return !sim::Server::create(std::move(scene), *split, options).ok();
  };
  CHECK(!fails(30000, 1, sim::Prediction::model));
  CHECK(fails(20000, 1, sim::Prediction::model));
  CHECK(fails(100000, 0.05, sim::Prediction::model));
  CHECK(fails(100000, 61, sim::Prediction::model));
  CHECK(fails(100000, 1, sim::Prediction::none));
}

TEST_CASE("pac animate --bit-rate: the packets keep to the bucket, the other arm to their bytes") {
  const test::CliFolder folder;
  const auto run = folder.pac(
      "animate letter --codec mpeg1 --width 96 --height 96 --samples 1 --frames 30 --effort fast --bit-rate 60000 "
      "--buffer 0.5 --json");
  CAPTURE(run.err);
  REQUIRE(run.code == 0);
  const auto json = test::json_leaves(run.out);
  REQUIRE(json.has_value());
  const auto number = [&](const std::string& key) { return std::stod(json->at(key)); };
  CHECK(number("bit_rate.bucket_bytes") == 3750);
  CHECK(number("bit_rate.fullest_bucket_bytes") <= 3750);
  for (int i = 1; i < 30; ++i)
    CHECK(number("polygon_assisted.frames[" + std::to_string(i) + "].bytes") <= 2 * 60000 / 8.0 / 20);
  CHECK(number("image_based.bytes") <= number("polygon_assisted.bytes"));
  const auto wrong = folder.pac("animate letter --codec mpeg1 --prediction block --bit-rate 60000");
  CHECK(wrong.code == 2);
  CHECK(wrong.err.find("--bit-rate needs --prediction model") != std::string::npos);
  CHECK(folder.pac("animate letter --codec mpeg1 --buffer 2").code == 2);
}

}  // namespace
