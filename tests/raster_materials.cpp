// Masks and blending, normal, specular and emission maps, reflections, fog.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "tests/support/raster_pictures.h"
#include "tests/support/raster_scenes.h"

namespace {

using namespace pac;
using namespace pac::raster;
using namespace test_pictures;

bool near(const uint8_t* pixel, std::array<int, 3> expected, int tolerance = 1) {
  for (size_t c = 0; c < 3; ++c)
    if (std::abs(pixel[c] - expected[c]) > tolerance) return false;
  return true;
}

// Left half of the texture transparent, right half opaque, over a square behind it.
Scene curtain(AlphaMode mode) {
  Scene scene;
  scene.textures.push_back(texture_of(64, 64, [](int x, int) {
    return std::array<uint8_t, 4>{200, 100, 0, static_cast<uint8_t>(x < 32 ? 0 : 255)};
  }));
  add_material(scene);
  const uint32_t front = add_material(scene);
  scene.materials[front].texture = 0;
  scene.materials[front].alpha = mode;
  scene.materials[front].wrap = Wrap::clamp;
  add_square(scene, -0.5f, front, {255, 255, 255, 255});
  add_square(scene, 0.5f, 0, {0, 0, 240, 255});
  return scene;
}

TEST_CASE("masks: samples whose texel is transparent show, in color, depth and id, what is behind") {
  for (const int samples : {1, 4, 16}) {
    const Scene scene = curtain(AlphaMode::mask);
    RenderQuality quality;
    quality.samples = samples;
    const RgbImage image = draw_everywhere(scene, Camera{}, quality);
    auto renderer = Renderer::create(kSide, kSide);
    DepthImage depth(kSide, kSide);
    IdImage id(kSide, kSide);
    REQUIRE(renderer->render(scene, Camera{}, quality, {{}, depth.view(), id.view()}).ok());
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        if (x == kSide / 2 - 1 || x == kSide / 2) continue;
        const bool behind = x < kSide / 2;
        REQUIRE(near(image.pixel(x, y), behind ? std::array{0, 0, 240} : std::array{200, 100, 0}));
        REQUIRE(*id.pixel(x, y) == (behind ? 2u : 1u));
        REQUIRE(*depth.pixel(x, y) == (behind ? 0.75f : 0.25f));
      }
  }
  RenderQuality plain;  // the mask is geometry: it cuts where texturing is off, too
  plain.texture = false;
  const RgbImage image = draw_everywhere(curtain(AlphaMode::mask), Camera{}, plain);
  CHECK(near(image.pixel(10, 50), {0, 0, 240}));
  CHECK(near(image.pixel(80, 50), {200, 100, 0}));
}

TEST_CASE("masks: vertex alpha and opacity count, and the cutoff says how much is enough") {
  Scene scene = curtain(AlphaMode::mask);
  scene.materials[1].texture = -1;
  for (int i = 0; i < 4; ++i) scene.mesh.vertices[static_cast<size_t>(i)].color[3] = i == 0 || i == 3 ? 0 : 255;
  const RgbImage half = draw_everywhere(scene, Camera{});
  CHECK(near(half.pixel(kSide / 2 - 2, 9), {0, 0, 240}));
  CHECK(near(half.pixel(kSide / 2 + 1, 9), {255, 255, 255}));
  scene.materials[1].alpha_cutoff = 0.25f;
  CHECK(near(draw(scene, Camera{}).pixel(kSide / 4 + 1, 9), {255, 255, 255}));
  scene.materials[1].opacity = 0.2f;
  CHECK(near(draw(scene, Camera{}).pixel(kSide - 2, 9), {0, 0, 240}));
}

TEST_CASE("blending: panes lie over the opaque picture in the order of the scene and hide nothing") {
  Scene scene;
  add_material(scene);
  const uint32_t pane = add_material(scene);
  scene.materials[pane].alpha = AlphaMode::blend;
  scene.materials[pane].opacity = 0.5f;
  add_square(scene, -0.9f, pane, {255, 0, 0, 255});
  add_square(scene, -0.8f, pane, {0, 255, 0, 128}, -1, 0);  // later, so over the red one although it is behind
  add_square(scene, 0.0f, 0, {0, 0, 200, 255});
  add_square(scene, 0.5f, pane, {255, 255, 255, 255});  // hidden
  for (const int samples : {1, 4}) {
    RenderQuality quality;
    quality.samples = samples;
    const RgbImage image = draw_everywhere(scene, Camera{}, quality);
    CHECK(near(image.pixel(80, 10), {128, 0, 100}));
    CHECK(near(image.pixel(10, 80), {95, 64, 75}, 2));
  }
  auto renderer = Renderer::create(kSide, kSide);
  IdImage id(kSide, kSide);
  REQUIRE(renderer->render(scene, Camera{}, {}, {{}, {}, id.view()}).ok());
  CHECK(*id.pixel(80, 10) == 3);
  const RgbImage faded = draw_everywhere(curtain(AlphaMode::blend), Camera{});
  CHECK(near(faded.pixel(10, 50), {0, 0, 240}));
  CHECK(near(faded.pixel(80, 50), {200, 100, 0}));
  RenderQuality plain;
  plain.texture = false;  // the mean color, half opaque
  CHECK(near(draw_everywhere(curtain(AlphaMode::blend), Camera{}, plain).pixel(10, 50), {100, 50, 120}));
}

TEST_CASE("a pair of renderings with masks and panes equals two renderings and their difference") {
  for (const AlphaMode mode : {AlphaMode::mask, AlphaMode::blend}) {
    const Scene scene = curtain(mode);
    RenderQuality high, low;
    high.samples = low.samples = 4;
    low.texture = false;
    auto renderer = Renderer::create(kSide, kSide);
    RgbImage h(kSide, kSide), l(kSide, kSide), d(kSide, kSide);
    REQUIRE(renderer->render_pair(scene, Camera{}, high, low, {h.view(), {}, {}}, l.view(), d.view()).ok());
    CHECK(hash(h) == hash(draw(scene, Camera{}, high)));
    CHECK(hash(l) == hash(draw(scene, Camera{}, low)));
  }
}

TEST_CASE("opaque materials ignore alpha") {
  Scene scene = curtain(AlphaMode::opaque);
  scene.materials[1].opacity = 0;
  CHECK(near(draw_everywhere(scene, Camera{}).pixel(10, 50), {200, 100, 0}));
}

// A lit square whose front is at +z, and a light that shines along `direction`.
Scene lit_square(glm::vec3 direction) {
  Scene scene;
  add_material(scene, true);
  scene.materials[0].ambient = glm::vec3(0.0f);
  scene.materials[0].diffuse = glm::vec3(0.8f);
  add_square(scene, 0, 0, {255, 255, 255, 255});
  scene.lights.push_back({Light::Kind::directional, direction, {}, {1, 1, 1}});
  return scene;
}

TEST_CASE("normal maps: a texel that leans to the right, or up, is as bright as a surface that leans so") {
  Camera camera;
  camera.eye = {0, 0, 50};
  // (channel - 128) / 127 = (0.8, 0, 0.6), and (0, 0.8, 0.6).
  for (const bool upward : {false, true}) {
    Scene scene = lit_square(upward ? glm::vec3(0, -1, 0) : glm::vec3(-1, 0, 0));
    const std::array<uint8_t, 4> texel{static_cast<uint8_t>(upward ? 128 : 230),
                                       static_cast<uint8_t>(upward ? 230 : 128), 204, 255};
    scene.textures.push_back(texture_of(8, 8, [&](int, int) { return texel; }));
    CHECK(near(draw(scene, camera, phong()).pixel(40, 40), {0, 0, 0}));
    scene.materials[0].normal_texture = 0;
    const int lit = static_cast<int>(255 * 0.8 * 0.8);
    CHECK(near(draw_everywhere(scene, camera, phong()).pixel(40, 40), {lit, lit, lit}, 2));
    CHECK(near(draw(scene, camera, phong()).pixel(80, 20), {lit, lit, lit}, 2));
    scene.materials[0].normal_scale = -1;
    CHECK(near(draw(scene, camera, phong()).pixel(40, 40), {0, 0, 0}));
    scene.materials[0].normal_scale = 1;
    for (Vertex& v : scene.mesh.vertices) v.texcoord[0] = 1 - v.texcoord[0];  // mirrored: right becomes left
    CHECK(
        near(draw(scene, camera, phong()).pixel(40, 40), upward ? std::array{lit, lit, lit} : std::array{0, 0, 0}, 2));
  }
}

TEST_CASE("normal maps: a flat map, or no area of texture coordinates, changes nothing") {
  Camera camera;
  camera.eye = {0, 0, 50};
  Scene scene = lit_square({0.3f, 0.2f, -1});
  const RgbImage plain = draw(scene, camera, phong());
  CHECK(plain.pixel(40, 40)[0] > 100);
  scene.textures.push_back(texture_of(4, 4, [](int, int) { return std::array<uint8_t, 4>{128, 128, 255, 255}; }));
  scene.textures.push_back(texture_of(4, 4, [](int, int) { return std::array<uint8_t, 4>{250, 30, 140, 255}; }));
  scene.materials[0].normal_texture = 0;
  CHECK(squared_error(draw(scene, camera, phong()), plain, 0, kSide) == 0);
  scene.materials[0].normal_texture = 1;
  RenderQuality off = phong();
  off.texture = false;
  CHECK(squared_error(draw(scene, camera, off), plain, 0, kSide) == 0);
  for (Vertex& v : scene.mesh.vertices) v.texcoord[0] = v.texcoord[1] = 0.25f;
  CHECK(squared_error(draw_everywhere(scene, camera, phong()), plain, 0, kSide) == 0);
}

TEST_CASE("specular maps scale highlights; emission maps glow whatever the base texture and the lights") {
  Scene scene = lit_square({0, 0, -1});
  Camera camera;
  camera.eye = {0, 0, 1e6f};
  scene.materials[0].diffuse = glm::vec3(0.0f);
  scene.materials[0].specular = glm::vec3(0.8f);
  scene.textures.push_back(texture_of(64, 64, [](int x, int) {
    return x < 32 ? std::array<uint8_t, 4>{255, 128, 0, 255} : std::array<uint8_t, 4>{0, 0, 0, 255};
  }));
  scene.materials[0].wrap = Wrap::clamp;
  scene.materials[0].specular_texture = 0;
  for (const Shading shading : {Shading::flat, Shading::gouraud, Shading::phong}) {
    RenderQuality quality;
    quality.shading = shading;
    const RgbImage image = draw_everywhere(scene, camera, quality);
    CHECK(near(image.pixel(20, 40), {204, 102, 0}, 2));
    CHECK(near(image.pixel(80, 40), {0, 0, 0}, 2));
    quality.texture = false;  // the mean of the map
    CHECK(near(draw_everywhere(scene, camera, quality).pixel(80, 40), {102, 51, 0}, 2));
  }
  scene.materials[0].specular = glm::vec3(0.0f);
  scene.materials[0].specular_texture = -1;
  scene.materials[0].emission = {1, 1, 0.5f};
  scene.materials[0].emission_texture = 0;
  scene.textures.push_back(texture_of(4, 4, [](int, int) { return std::array<uint8_t, 4>{0, 0, 0, 255}; }));
  scene.materials[0].texture = 1;
  for (const Shading shading : {Shading::flat, Shading::gouraud, Shading::phong}) {
    RenderQuality quality;
    quality.shading = shading;
    const RgbImage image = draw_everywhere(scene, camera, quality);
    CHECK(near(image.pixel(20, 40), {255, 128, 0}, 2));
    CHECK(near(image.pixel(80, 40), {0, 0, 0}, 2));
    quality.texture = false;
    CHECK(near(draw_everywhere(scene, camera, quality).pixel(80, 40), {128, 64, 0}, 2));
  }
}

// A mirror whose normal is `normal`, seen from far along -z.
Scene mirror(glm::vec3 normal) {
  Scene scene = lit_square({0, 0, 1});
  scene.materials[0].diffuse = glm::vec3(0.0f);
  scene.materials[0].reflection = glm::vec3(1.0f);
  // Red grows with longitude, green with latitude.
  scene.textures.push_back(texture_of(256, 128, [](int x, int y) {
    return std::array<uint8_t, 4>{static_cast<uint8_t>(x), static_cast<uint8_t>(2 * y), 0, 255};
  }));
  scene.environment = 0;
  for (Vertex& v : scene.mesh.vertices)
    for (int c = 0; c < 3; ++c) v.normal[c] = normal[c];
  return scene;
}

TEST_CASE("reflections show the environment where the mirrored view meets it") {
  Camera camera;
  camera.eye = {0, 0, -1e6f};
  // The view travels along +z; at normal n it leaves along d - 2 (d . n) n.
  struct Case {
    glm::vec3 normal;
    int longitude, latitude;  // of 256
  };
  const float h = 0.70710678f;
  const Case cases[] = {{{0, 0, -1}, 128, 128},
                        {{h, 0, -h}, 192, 128},
                        {{-h, 0, -h}, 64, 128},
                        {{0, 0.38268343f, -0.92387953f}, 128, 64},
                        {{0.9659258f, 0, -0.2588190f}, 235, 128}};
  for (const Case& expected : cases) {
    CAPTURE(expected.normal.x);
    const Scene scene = mirror(expected.normal);
    for (const Shading shading : {Shading::gouraud, Shading::phong}) {
      RenderQuality quality;
      quality.shading = shading;
      CHECK(near(draw_everywhere(scene, camera, quality).pixel(50, 50), {expected.longitude, expected.latitude, 0}, 3));
    }
  }
  Scene blurred = mirror({0, 0, -1});
  blurred.materials[0].reflection_blur = 1;
  CHECK(near(draw_everywhere(blurred, camera).pixel(50, 50), {127, 127, 0}, 2));
  RenderQuality off;
  off.texture = false;
  CHECK(near(draw_everywhere(mirror({h, 0, -h}), camera, off).pixel(50, 50), {127, 127, 0}, 2));
}

TEST_CASE("fog: the share of the surface's color follows each law to a level") {
  Camera camera;
  camera.eye = {0, 0, -3};
  Scene scene;
  add_material(scene);
  add_square(scene, 0.25f, 0, {250, 130, 10, 255});
  scene.fog.color = {0.2f, 0.6f, 1.0f};
  scene.fog.start = 2;
  scene.fog.end = 5;
  scene.fog.density = 0.3f;
  for (const Fog::Kind kind : {Fog::Kind::linear, Fog::Kind::exponential, Fog::Kind::exponential_squared}) {
    scene.fog.kind = kind;
    const RgbImage image = draw_everywhere(scene, camera);
    for (int x = 0; x < kSide; x += 7) {
      const double px = (x + 0.5) * 2 / kSide - 1, py = 1 - 40.5 * 2 / kSide;
      const double distance = std::sqrt(px * px + py * py + 3.25 * 3.25), thick = 0.3 * distance;
      const double share = kind == Fog::Kind::linear        ? (5 - distance) / 3
                           : kind == Fog::Kind::exponential ? std::exp(-thick)
                                                            : std::exp(-thick * thick);
      const double fog[3] = {51, 153, 255}, color[3] = {250, 130, 10};
      for (int c = 0; c < 3; ++c)
        REQUIRE(std::fabs(image.pixel(x, 40)[c] - (fog[c] + (color[c] - fog[c]) * share)) < 0.6);
    }
  }
  scene.fog.kind = Fog::Kind::none;
  CHECK(near(draw(scene, camera).pixel(40, 40), {250, 130, 10}));
}

}  // namespace
