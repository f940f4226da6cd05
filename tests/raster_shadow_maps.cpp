// Shadow maps: against cast rays, and what casts and takes no shadow.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/support/raster_pictures.h"
#include "tests/support/raster_scenes.h"

namespace {

using namespace pac;
using namespace pac::raster;
using namespace test_pictures;

// A floor with three boxes, from above at an angle.
Scene boxes_on_floor(Light::Kind kind) {
  Scene scene;
  Material grey;
  grey.ambient = glm::vec3(0.2f);
  grey.diffuse = glm::vec3(0.7f);
  scene.materials = {grey};
  test_scenes::add_panel(scene, {-5, 0, 5}, {10, 0, 0}, {0, 0, -10}, 4, 4, 0, 1);
  test_scenes::add_box(scene, {-2, 0, -1}, {-1, 1.5f, 0}, 1, 0);
  test_scenes::add_box(scene, {0.5f, 0, -2}, {2, 0.5f, -1}, 1, 0);
  test_scenes::add_box(scene, {0, 1.2f, 1}, {1, 1.6f, 2}, 1, 0);
  for (Vertex& v : scene.mesh.vertices) std::fill_n(v.color, 3, uint8_t{255});
  scene.ambient_reach = 0;
  Light light;
  light.kind = kind;
  light.direction = {0.5f, -1, 0.3f};
  light.position = {-3, 6, -1.8f};
  light.cone_inner = 0.8f;
  light.cone_outer = 0.6f;
  scene.lights = {light};
  return scene;
}

TEST_CASE("shadow maps: nearly every pixel is as bright as under cast rays, for directional and spot lights") {
  const Camera camera = make_camera({0, 8, 8}, {0, 0, 0}, {0, 1, 0}, 0.8f, 1, 1, 30);
  for (const Light::Kind kind : {Light::Kind::directional, Light::Kind::spot}) {
    CAPTURE(static_cast<int>(kind));
    const Scene scene = boxes_on_floor(kind);
    RenderQuality rays = phong(), maps = phong(), local = phong();
    rays.lighting = Lighting::full;
    maps.lighting = Lighting::shadow_maps;
    const RgbImage by_rays = draw(scene, camera, rays), by_maps = draw_everywhere(scene, camera, maps),
                   without = draw(scene, camera, local);
    int differ = 0, shadowed = 0;
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        differ += std::abs(by_rays.pixel(x, y)[0] - by_maps.pixel(x, y)[0]) > 12 ? 1 : 0;
        shadowed += std::abs(by_rays.pixel(x, y)[0] - without.pixel(x, y)[0]) > 12 ? 1 : 0;
      }
    CHECK(shadowed > kSide * kSide / 50);
    CHECK(differ < kSide * kSide / 100);
  }
}

TEST_CASE("shadow maps: lights that cast none, and point lights, shine as under local lighting") {
  const Camera camera = make_camera({0, 8, 8}, {0, 0, 0}, {0, 1, 0}, 0.8f, 1, 1, 30);
  RenderQuality maps = phong(), local = phong();
  maps.lighting = Lighting::shadow_maps;
  Scene scene = boxes_on_floor(Light::Kind::point);
  CHECK(hash(draw(scene, camera, maps)) == hash(draw(scene, camera, local)));
  scene = boxes_on_floor(Light::Kind::directional);
  CHECK(hash(draw(scene, camera, maps)) != hash(draw(scene, camera, local)));
  scene.lights[0].casts_shadows = false;
  CHECK(hash(draw(scene, camera, maps)) == hash(draw(scene, camera, local)));
}

TEST_CASE("shadow maps: masked polygons let light through their holes, panes cast no shadow") {
  const Camera camera = make_camera({0, 9, 0.1f}, {0, 0, 0}, {0, 0, -1}, 0.8f, 1, 1, 30);
  Scene scene;
  Material grey;
  grey.diffuse = glm::vec3(0.7f);
  scene.materials = {grey, grey};
  scene.textures.push_back(texture_of(64, 64, [](int x, int) {
    return std::array<uint8_t, 4>{255, 255, 255, static_cast<uint8_t>(x < 32 ? 0 : 255)};
  }));
  scene.materials[1].texture = 0;
  scene.materials[1].wrap = Wrap::clamp;
  test_scenes::add_panel(scene, {-5, 0, 5}, {10, 0, 0}, {0, 0, -10}, 1, 1, 0, 1);
  test_scenes::add_quad(scene, {{-1, 1, 1}, {1, 1, 1}, {1, 1, -1}, {-1, 1, -1}}, {{0, 1}, {1, 1}, {1, 0}, {0, 0}}, 1,
                        {255, 255, 255, 255});
  for (Vertex& v : scene.mesh.vertices) std::fill_n(v.color, 3, uint8_t{255});
  scene.lights.push_back({Light::Kind::directional, {0, -1, 2}, {}, {1, 1, 1}});  // shadows at z in [1, 3]
  RenderQuality maps = phong();
  maps.lighting = Lighting::shadow_maps;
  const auto brightness = [&](float x, float z) {
    const float scale = kSide / 2.0f / (9.0f * std::tan(0.4f));
    return draw(scene, camera, maps)
        .pixel(static_cast<int>(kSide / 2.0f + x * scale), static_cast<int>(kSide / 2.0f + z * scale))[0];
  };
  CHECK(brightness(0.5f, 2) < 60);  // opaque
  scene.materials[1].alpha = AlphaMode::mask;
  CHECK(brightness(0.5f, 2) < 60);
  CHECK(brightness(-0.5f, 2) > 100);
  scene.materials[1].alpha = AlphaMode::blend;
  CHECK(brightness(0.5f, 2) > 100);
}

}  // namespace
