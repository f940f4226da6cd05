// Sequences through both arms: matched bytes, the client equal to the server, files that hold what was sent.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "jpeg/jpeg.h"
#include "sim/animation.h"
#include "sim/client.h"
#include "sim/difference.h"
#include "sim/frame420.h"
#include "sim/packet.h"
#include "sim/pacs.h"
#include "tests/support/small_scene.h"

namespace {

using namespace pac;

sim::AnimationOptions small_options() {
  sim::AnimationOptions options;
  options.render.width = 90;  // no multiple of 8 or 16
  options.render.height = 70;
  options.render.samples = 4;
  options.frames = 3;
  return options;
}

TEST_CASE("motion JPEG: the polygon-assisted frame is as large as the image-based one, and looks better") {
  const auto result = sim::run_animation(test::small_scene(false), test::small_camera, small_options());
  REQUIRE(result.ok());
  REQUIRE(result->image_based.frames.size() == 3);
  for (size_t i = 0; i < 3; ++i) {
    const auto image = static_cast<double>(result->image_based.frames[i].bytes);
    const auto polygon = static_cast<double>(result->polygon_assisted.frames[i].bytes);
    CHECK(std::fabs(polygon - image) <= 0.02 * image);
    CHECK(result->polygon_assisted.frames[i].scores[0] > result->image_based.frames[i].scores[0]);
  }
}

TEST_CASE("a client fed from the .pacs file shows the composites of the run") {
  Bytes file;
  std::vector<uint64_t> shown;
  sim::AnimationSink sink;
  sink.session = [&](std::span<const uint8_t> session) { sim::append_pacs_message(file, session); };
  sink.frame = [&](const sim::AnimationFrame& frame) {
    sim::append_pacs_message(file, frame.packet);
    shown.push_back(sim::image_hash(frame.composite.view()));
  };
  REQUIRE(sim::run_animation(test::small_scene(true), test::small_camera, small_options(), sink).ok());
  const auto messages = sim::read_pacs(file);
  REQUIRE(messages.ok());
  REQUIRE(messages->size() == 1 + shown.size());
  auto client = sim::Client::create((*messages)[0]);
  REQUIRE(client.ok());
  for (size_t i = 0; i < shown.size(); ++i) {
    const auto picture = client->receive((*messages)[i + 1]);
    REQUIRE(picture.ok());
    CHECK(sim::image_hash(picture->view()) == shown[i]);
  }
}

TEST_CASE("every strict prefix of a .pacs file is refused or ends between two messages") {
  Bytes file;
  const Bytes messages[] = {{1, 2, 3}, {}, {4}};
  for (const Bytes& message : messages) sim::append_pacs_message(file, message);
  CHECK(file.size() == 4 + 3 * 4 + 4);
  for (size_t n = 0; n <= file.size(); ++n) {
    const auto read = sim::read_pacs(std::span(file).first(n));
    const bool whole = n == 4 || n == 11 || n == 15 || n == 20;
    CHECK(read.ok() == whole);
  }
  file[0] ^= 1;
  CHECK(!sim::read_pacs(file).ok());
}

TEST_CASE("RGB survives the way to 4:2:0 and back where color is flat, whatever the parity of the sides") {
  for (const int width : {1, 2, 15, 16})
    for (const int height : {1, 2, 9, 16}) {
      RgbImage picture(width, height), back(width, height);
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
          picture.pixel(x, y)[0] = 200;
          picture.pixel(x, y)[1] = 90;
          picture.pixel(x, y)[2] = 30;
        }
      Frame420 frame(width, height);
      sim::frame420_from_rgb(picture.view(), frame);
      sim::rgb_from_frame420(frame, back.view());
      for (int y = 0; y < height; ++y)
        for (int i = 0; i < 3 * width; ++i) CHECK(std::abs(picture.row(y)[i] - back.row(y)[i]) <= 2);
    }
}

}  // namespace
