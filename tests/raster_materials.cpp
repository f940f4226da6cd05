// Anisotropic filter, masks and blending, normal, specular and emission maps, reflections, fog, shadow maps.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <vector>

#include "base/hash.h"
#include "raster/renderer.h"
#include "raster/surface.h"
#include "tests/support/kernel_check.h"
#include "tests/support/raster_scenes.h"

namespace {

using namespace pac;
using namespace pac::raster;
using test::for_each_isa;
using test_scenes::Random;

constexpr int kSide = 96;

RgbImage draw(const Scene& scene, const Camera& camera, const RenderQuality& quality = {}, Isa isa = best_isa(),
              int threads = 1) {
  RendererOptions options;
  options.isa = isa;
  options.threads = threads;
  auto renderer = Renderer::create(kSide, kSide, options);
  REQUIRE(renderer.ok());
  RgbImage image(kSide, kSide);
  REQUIRE(renderer->render(scene, camera, quality, {image.view(), {}, {}}).ok());
  return image;
}

uint64_t hash(const RgbImage& image) {
  return hash_pixels(image.view());
}

// The picture, after checking that scalar code and three threads give the same one.
RgbImage draw_everywhere(const Scene& scene, const Camera& camera, const RenderQuality& quality = {}) {
  RgbImage image = draw(scene, camera, quality);
  CHECK(hash(draw(scene, camera, quality, Isa::scalar)) == hash(image));
  CHECK(hash(draw(scene, camera, quality, best_isa(), 3)) == hash(image));
  return image;
}

// The square [-1, 1]^2 at depth z of Camera{}, which looks along +z of clip space: (u, v) = (0, 0) at the top left.
void add_square(Scene& scene, float z, uint32_t material, std::array<uint8_t, 4> color, float low = -1,
                float high = 1) {
  const float corners[4][2] = {{low, low}, {high, low}, {high, high}, {low, high}};
  scene.mesh.faces.push_back({static_cast<uint32_t>(scene.mesh.indices.size()), 4, material});
  for (const auto& [x, y] : corners) {
    Vertex v;
    v.position[0] = x;
    v.position[1] = y;
    v.position[2] = z;
    v.normal[2] = 1;
    v.texcoord[0] = (x - low) / (high - low);
    v.texcoord[1] = (high - y) / (high - low);
    std::copy_n(color.data(), 4, v.color);
    scene.mesh.indices.push_back(static_cast<uint32_t>(scene.mesh.vertices.size()));
    scene.mesh.vertices.push_back(v);
  }
}

template <class Fn>
Texture texture_of(int width, int height, Fn&& color) {
  RgbaImage image(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::array<uint8_t, 4> c = color(x, y);
      std::copy_n(c.data(), 4, image.pixel(x, y));
    }
  return make_texture("t", image);
}

uint32_t add_material(Scene& scene, bool lit = false) {
  scene.materials.emplace_back();
  scene.materials.back().lit = lit;
  return static_cast<uint32_t>(scene.materials.size() - 1);
}

bool near(const uint8_t* pixel, std::array<int, 3> expected, int tolerance = 1) {
  for (size_t c = 0; c < 3; ++c)
    if (std::abs(pixel[c] - expected[c]) > tolerance) return false;
  return true;
}

double squared_error(const RgbImage& a, const RgbImage& b, int first_row, int last_row) {
  double sum = 0;
  for (int y = first_row; y < last_row; ++y)
    for (int i = 0; i < 3 * kSide; ++i) {
      const double d = a.view().row(y)[i] - b.view().row(y)[i];
      sum += d * d;
    }
  return sum;
}

TEST_CASE("shading kernels: every instruction set gives the scalar bits") {
  for_each_isa([&](const Kernels& scalar, const Kernels& table) {
    Random random(71);
    std::vector<float> depths(64 * 64);
    for (float& d : depths) d = random.unit();
    for (int round = 0; round < 60; ++round) {
      const int n = 1 + static_cast<int>(random.bits() % kBatchLanes);
      std::vector<float> normal(3 * kBatchLanes), position(3 * kBatchLanes), texels(3 * kBatchLanes),
          tangents(6 * kBatchLanes), color(3 * kBatchLanes);
      for (float& f : normal) f = random.between(-2, 2);
      for (float& f : position) f = random.between(-3, 3);
      for (float& f : tangents) f = random.between(-1, 1);
      for (float& f : texels) f = random.between(0, 255);
      for (float& f : color) f = random.between(-50, 400);
      for (size_t c = 0; c < 3; ++c) {
        normal[c * kBatchLanes] = 0;
        normal[c * kBatchLanes + 1] = c == 0 ? NAN : 1.0f;
        tangents[c * kBatchLanes + 2] = 0;
        for (size_t k = 0; k < 2; ++k) tangents[(3 * k + c) * kBatchLanes + 3] = normal[c * kBatchLanes + 3];
        position[c * kBatchLanes + 4] = 1e18f;
        normal[c * kBatchLanes + 5] = c == 2 ? -1.0f : 0.0f;
        position[c * kBatchLanes + 5] = 0;
      }
      const auto expect_equal = [&](auto&& run, size_t rows) {
        std::vector<float> expected(rows * kBatchLanes, 3.0f), actual = expected;
        run(scalar.tile, expected.data());
        run(table.tile, actual.data());
        REQUIRE(std::memcmp(expected.data(), actual.data(), expected.size() * sizeof(float)) == 0);
      };
      expect_equal(
          [&](const TileKernels& k, float* out) {
            std::copy(normal.begin(), normal.end(), out);
            k.bend_normals(n, round % 3 == 0 ? 1.0f : 0.7f, texels.data(), tangents.data(), out);
          },
          3);
      const float eye[3] = {0, round % 2 == 0 ? 0.0f : 1.0f, 5};
      expect_equal([&](const TileKernels& k,
                       float* out) { k.reflect(eye, n, normal.data(), position.data(), out, out + kBatchLanes); },
                   2);
      FogParameters fog{{0, 1, 5}, {200, 100, 50}, 6, 0.2f, round % 3};
      expect_equal(
          [&](const TileKernels& k, float* out) {
            std::copy(color.begin(), color.end(), out);
            k.fog(fog, n, position.data(), round % 2 != 0 ? texels.data() : nullptr,
                  round % 4 >= 2 ? tangents.data() : nullptr, out);
          },
          3);
      ShadowMap map{depths.data(), 64, {}, 0.1f, 0.01f};
      for (auto& row : map.m)
        for (float& f : row) f = random.between(-8, 8);
      for (int c = 0; c < 4; ++c) map.m[3][c] = round % 2 == 0 ? (c == 3 ? 1.0f : 0.0f) : random.between(-0.3f, 0.5f);
      for (int c = 0; c < 3; ++c) map.m[2][c] *= 0.05f;
      map.m[0][3] = map.m[1][3] = 32;
      map.m[2][3] = 0.5f;
      expect_equal([&](const TileKernels& k, float* out) { k.shadow_map(map, n, normal.data(), position.data(), out); },
                   1);
    }
  });
}

TEST_CASE("anisotropic and alpha filters: every instruction set gives the scalar bits for every size and wrap") {
  for_each_isa([&](const Kernels& scalar, const Kernels& table) {
    Random random(73);
    constexpr int kSizes[][2] = {{1, 1}, {1, 7}, {64, 64}, {37, 53}, {256, 16}};
    for (const auto& size : kSizes)
      for (int mode = 0; mode < 6; ++mode) {
        Scene scene;
        scene.textures.push_back(texture_of(size[0], size[1], [&](int, int) {
          return std::array<uint8_t, 4>{static_cast<uint8_t>(random.bits()), static_cast<uint8_t>(random.bits()),
                                        static_cast<uint8_t>(random.bits()), static_cast<uint8_t>(random.bits())};
        }));
        add_material(scene);
        scene.materials[0].texture = 0;
        scene.materials[0].wrap = mode % 2 == 0 ? Wrap::repeat : Wrap::clamp;
        scene.materials[0].filter = static_cast<Filter>(mode / 2);
        std::vector<Surface> surfaces;
        REQUIRE(prepare_surfaces(scene, {}, {}, nullptr, surfaces).ok());
        std::vector<float> rows[6], expected(3 * kBatchLanes), actual(3 * kBatchLanes);
        for (auto& row : rows) row.resize(kBatchLanes);
        for (size_t k = 0; k < kBatchLanes; ++k) {
          rows[0][k] = random.between(-3, 3);
          rows[1][k] = random.between(-3, 3);
          rows[2][k] = random.between(-2, 9);
          rows[3][k] = random.between(-1, 1);
          rows[4][k] = k % 7 == 0 ? 0x1p20f : random.between(-1, 1);
          rows[5][k] = static_cast<float>(1 + random.bits() % 8);
        }
        const auto run = [&](const TileKernels& k, float* out) {
          k.sample_anisotropic(surfaces[0].sampler, kBatchLanes, rows[0].data(), rows[1].data(), rows[2].data(),
                               rows[3].data(), rows[4].data(), rows[5].data(), out);
        };
        run(scalar.tile, expected.data());
        run(table.tile, actual.data());
        REQUIRE(std::memcmp(expected.data(), actual.data(), expected.size() * sizeof(float)) == 0);
        const auto run_alpha = [&](const TileKernels& k, float* out) {
          k.sample_alpha(surfaces[0].sampler, kBatchLanes, rows[0].data(), rows[1].data(), rows[2].data(), out);
        };
        run_alpha(scalar.tile, expected.data());
        run_alpha(table.tile, actual.data());
        REQUIRE(std::memcmp(expected.data(), actual.data(), expected.size() * sizeof(float)) == 0);
      }
  });
}

// A checkered floor that runs away from the viewer.
Scene checkered_floor(int anisotropy) {
  Scene scene;
  scene.textures.push_back(texture_of(256, 256, [](int x, int y) {
    const auto c = static_cast<uint8_t>((x / 16 + y / 16) % 2 == 0 ? 230 : 20);
    return std::array<uint8_t, 4>{c, c, static_cast<uint8_t>(255 - c), 255};
  }));
  add_material(scene);
  scene.materials[0].texture = 0;
  scene.materials[0].anisotropy = anisotropy;
  test_scenes::add_quad(scene, {{-40, 0, 2}, {40, 0, 2}, {40, 0, -78}, {-40, 0, -78}},
                        {{0, 0}, {20, 0}, {20, 20}, {0, 20}}, 0, {255, 255, 255, 255});
  return scene;
}

TEST_CASE("anisotropic filter: a floor at a grazing angle comes nearer to its supersampled picture with more probes") {
  const Camera camera = make_camera({0, 0.6f, 2}, {0, 0, -6}, {0, 1, 0}, 0.9f, 1, 0.05f, 200);
  RenderQuality many;
  many.samples = 64;
  const RgbImage truth = draw(checkered_floor(1), camera, many);
  std::vector<double> errors;
  for (const int anisotropy : {1, 2, 4, 8})
    errors.push_back(squared_error(draw_everywhere(checkered_floor(anisotropy), camera), truth, 40, kSide));
  CHECK(errors[1] < 0.9 * errors[0]);
  CHECK(errors[2] < 0.9 * errors[1]);
  CHECK(errors[3] < errors[2]);
  CHECK(errors[3] < 0.5 * errors[0]);
  CHECK(hash(draw(checkered_floor(8), camera)) == hash(draw(checkered_floor(1000), camera)));
  CHECK(hash(draw(checkered_floor(1), camera)) == hash(draw(checkered_floor(-3), camera)));
}

TEST_CASE("anisotropic filter: a surface seen straight on is filtered as before") {
  const auto flat = [](int anisotropy) {
    Scene scene = checkered_floor(anisotropy);
    scene.mesh = {};
    add_square(scene, 0, 0, {255, 255, 255, 255});
    return draw(scene, Camera{});
  };
  CHECK(squared_error(flat(8), flat(1), 0, kSide) <= 3.0 * kSide * kSide);  // a level at most
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

RenderQuality phong() {
  RenderQuality quality;
  quality.shading = Shading::phong;
  return quality;
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
