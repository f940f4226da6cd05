// Differences of logarithms: exact tables, and what they are good for.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "sim/client.h"
#include "sim/difference.h"
#include "sim/log_domain.h"
#include "sim/server.h"
#include "tests/support/client_server.h"
#include "tests/support/small_scene.h"

namespace {

using namespace pac;

TEST_CASE("codes are the rounded logarithms, rise with the sample, and go from 0 to 255") {
  const auto& codes = sim::log_codes();
  const double whole = std::log1p(255.0 / sim::kLogOffset);
  for (int v = 0; v < 256; ++v) {
    CHECK(std::fabs(codes[static_cast<size_t>(v)] - 255 * std::log1p(double(v) / sim::kLogOffset) / whole) < 0.502);
    if (v > 0) CHECK(codes[static_cast<size_t>(v)] >= codes[static_cast<size_t>(v - 1)]);
  }
  CHECK(codes[0] == 0);
  CHECK(codes[255] == 255);
}

TEST_CASE("the value of a code is the sample whose logarithm is nearest") {
  const auto& values = sim::values_of_log_codes();
  const double whole = std::log1p(255.0 / sim::kLogOffset);
  for (int code = 0; code < 256; ++code) {
    const double wanted = sim::kLogOffset * std::expm1(code * whole / 255);
    CHECK(std::fabs(values[static_cast<size_t>(code)] - wanted) < 0.52);
  }
}

TEST_CASE("where nothing was coded the sample is L's own; a code that rises never darkens") {
  RgbImage low(256, 1), codes(256, 1), shown(256, 1);
  for (int x = 0; x < 256; ++x)
    for (int c = 0; c < 3; ++c) low.pixel(x, 0)[c] = static_cast<uint8_t>(x);
  sim::log_from_rgb(low.view(), codes.view());
  sim::rgb_from_log(low.view(), codes.view(), shown.view());
  CHECK(std::equal(low.row(0), low.row(0) + 768, shown.row(0)));
  for (int x = 0; x < 256; ++x)
    for (int c = 0; c < 3; ++c) codes.pixel(x, 0)[c] = static_cast<uint8_t>(std::min(codes.pixel(x, 0)[c] + 9, 255));
  sim::rgb_from_log(low.view(), codes.view(), shown.view());
  for (int x = 0; x < 256; ++x) CHECK(shown.pixel(x, 0)[0] >= low.pixel(x, 0)[0]);
}

sim::Server make_server(sim::Residual residual, double quantizer, Isa isa = best_isa()) {
  sim::SceneSet scene = test::small_scene(false);
  const auto split = sim::make_split("lighting", scene, {4, true});
  REQUIRE(split.ok());
  CHECK(split->differs_in_light());
  sim::ServerOptions options;
  options.codec = sim::Codec::mpeg1;
  options.video.residual = residual;
  options.video.quantizer_scale = quantizer;
  options.isa = isa;
  return test::make_server(std::move(scene), *split, options);
}

TEST_CASE("ratios: the client shows what the server does over 60 frames, whatever the instruction set") {
  sim::Server server = make_server(sim::Residual::ratio, 5), scalar = make_server(sim::Residual::ratio, 5, Isa::scalar);
  sim::Client client = test::make_client(server, Isa::scalar);
  for (int number = 0; number < 60; ++number) {
    const raster::Camera camera = test::small_camera(number % 40, 90.0f / 71.0f);
    const auto packet = server.frame(static_cast<uint32_t>(number), camera);
    REQUIRE(packet.ok());
    if (number < 8) CHECK(*packet == *scalar.frame(static_cast<uint32_t>(number), camera));
    const auto shown = client.receive(*packet);
    REQUIRE(shown.ok());
    REQUIRE(sim::image_hash(shown->view()) == sim::image_hash(server.last_frame().composite.view()));
  }
}

TEST_CASE("the lighting split codes ratios unless told otherwise, and halved differences never do") {
  const raster::Camera camera = test::small_camera(0, 90.0f / 71.0f);
  sim::Server by_scene = make_server(sim::Residual::by_scene, 5), ratio = make_server(sim::Residual::ratio, 5),
              additive = make_server(sim::Residual::additive, 5);
  const Bytes packet = *by_scene.frame(0, camera);
  CHECK(packet == *ratio.frame(0, camera));
  CHECK(packet != *additive.frame(0, camera));
  sim::SceneSet scene = test::small_scene(false);
  const auto split = sim::make_split("lighting", scene, {4, true});
  sim::ServerOptions options;
  options.codec = sim::Codec::mpeg1;
  options.video.difference = sim::Difference::halved;
  options.video.residual = sim::Residual::ratio;
  CHECK(!sim::Server::create(test::small_scene(false), *split, options).ok());
  CHECK(!sim::make_split("texture", scene, {4, true})->differs_in_light());
}

}  // namespace
