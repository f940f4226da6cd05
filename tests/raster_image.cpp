#include <doctest/doctest.h>

#include <vector>

#include "base/hash.h"
#include "raster/renderer.h"
#include "tests/support/raster_scenes.h"

namespace {

using namespace pac;
using namespace pac::raster;

TEST_CASE("an empty scene is its background, at depth 1 and id 0") {
  Scene scene;
  scene.background = {1.0f, 0.5f, 0.0f};
  auto renderer = Renderer::create(33, 17);
  REQUIRE(renderer.ok());
  RgbImage color(33, 17);
  DepthImage depth(33, 17);
  IdImage id(33, 17);
  REQUIRE(renderer->render(scene, test_scenes::room_camera(), {}, {color.view(), depth.view(), id.view()}).ok());
  for (int y = 0; y < 17; ++y)
    for (int x = 0; x < 33; ++x) {
      REQUIRE(color.pixel(x, y)[0] == 255);
      REQUIRE(color.pixel(x, y)[1] == 128);
      REQUIRE(color.pixel(x, y)[2] == 0);
      REQUIRE(*depth.pixel(x, y) == 1.0f);
      REQUIRE(*id.pixel(x, y) == 0);
    }
}

}  // namespace
