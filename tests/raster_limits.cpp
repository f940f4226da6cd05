// Large numbers of everything: sizes, coordinates, materials, threads.
#include <doctest/doctest.h>

#include <utility>
#include <vector>

#include "base/hash.h"
#include "raster/renderer.h"
#include "tests/support/raster_scenes.h"

namespace {

using namespace pac;
using namespace pac::raster;

void add_triangle(Scene& scene, const glm::vec3 (&corner)[3], uint32_t material) {
  scene.mesh.faces.push_back({static_cast<uint32_t>(scene.mesh.indices.size()), 3, material});
  for (const glm::vec3& p : corner) {
    Vertex v;
    for (int c = 0; c < 3; ++c) v.position[c] = p[c];
    scene.mesh.indices.push_back(static_cast<uint32_t>(scene.mesh.vertices.size()));
    scene.mesh.vertices.push_back(v);
  }
}

Scene unlit_scene() {
  Scene scene;
  scene.materials.emplace_back();
  scene.materials[0].lit = false;
  return scene;
}

struct Drawn {
  RenderStats stats;
  IdImage id;
};
Drawn draw_ids(const Scene& scene, int width, int height) {
  auto renderer = Renderer::create(width, height);
  REQUIRE(renderer.ok());
  Drawn drawn{{}, IdImage(width, height)};
  const auto stats = renderer->render(scene, Camera{}, {}, {{}, {}, drawn.id.view()});
  REQUIRE(stats.ok());
  drawn.stats = *stats;
  return drawn;
}

TEST_CASE("triangles up to a hundred million times as large as the image cover every pixel, once") {
  for (const float size : {3e1f, 3e3f, 1e6f, 1e8f}) {
    CAPTURE(size);
    Scene scene = unlit_scene();
    add_triangle(scene, {{-size, -size, 0}, {size, -size, 0}, {0, size, 0}}, 0);
    const Drawn one = draw_ids(scene, 100, 70);
    CHECK(one.stats.triangles_dropped == 0);
    for (int y = 0; y < 70; ++y)
      for (int x = 0; x < 100; ++x) REQUIRE(*one.id.pixel(x, y) == 1);
  }
  // Two that meet in a diagonal through the image, at the same depth.
  for (const float size : {3e1f, 3e3f, 1e6f}) {
    CAPTURE(size);
    Scene scene = unlit_scene();
    add_triangle(scene, {{-size, -size, 0}, {size, -size, 0}, {size, size, 0}}, 0);
    add_triangle(scene, {{-size, -size, 0}, {size, size, 0}, {-size, size, 0}}, 0);
    const Drawn two = draw_ids(scene, 64, 64);
    int count[3] = {0, 0, 0};
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) ++count[*two.id.pixel(x, y)];
    CHECK(count[0] == 0);
    CHECK(count[1] >= 64 * 63 / 2);
    CHECK(count[2] >= 64 * 63 / 2);
  }
}

TEST_CASE("triangles wholly behind the eye, or beyond one side of the view, are neither drawn nor dropped") {
  Scene scene = unlit_scene();
  const Camera camera = make_camera({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 1.0f, 1, 0.1f, 20);
  add_triangle(scene, {{-1, -1, 1}, {1, -1, 1}, {0, 1, 1}}, 0);
  add_triangle(scene, {{-1, -1, 0.01f}, {1, -1, 5}, {0, 1, 900}}, 0);
  add_triangle(scene, {{50, -1, -5}, {60, -1, -5}, {55, 1, -9}}, 0);
  add_triangle(scene, {{-1, -1, -21}, {1, -1, -21}, {0, 1, -30}}, 0);
  auto renderer = Renderer::create(32, 32);
  IdImage id(32, 32);
  const auto stats = renderer->render(scene, camera, {}, {{}, {}, id.view()});
  REQUIRE(stats.ok());
  CHECK(stats->triangles_submitted == 4);
  CHECK(stats->triangles_drawn == 0);
  CHECK(stats->triangles_dropped == 0);
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) REQUIRE(*id.pixel(x, y) == 0);
}

TEST_CASE("a 20 000 x 20 000 image is drawn in the memory of its targets") {
  constexpr int kLong = 20000;
  auto renderer = Renderer::create(kLong, kLong);
  REQUIRE(renderer.ok());
  Scene scene = unlit_scene();
  const float left = 1.0f - 2.0f * 10 / kLong;  // ten columns at the right side
  test_scenes::add_quad(scene, {{left, -1, 0}, {1, -1, 0}, {1, 1, 0}, {left, 1, 0}}, {{0, 0}, {0, 0}, {0, 0}, {0, 0}},
                        0, {9, 9, 9, 9});
  std::vector<uint32_t> row(kLong, 7);  // every row of the picture is the same: all go here
  const auto stats = renderer->render(scene, Camera{}, {}, {{}, {}, {row.data(), kLong, kLong, 0}});
  REQUIRE(stats.ok());
  for (size_t x = 0; x < kLong; ++x) REQUIRE(row[x] == (x < kLong - 10 ? 0u : 1u));
}

TEST_CASE("ten million triangles: all are looked at, in memory that grows with those that are drawn") {
  constexpr size_t kFaces = 10'000'000;
  Scene scene = unlit_scene();
  scene.materials[0].two_sided = false;
  add_triangle(scene, {{-0.5f, -0.5f, 0}, {0, 0.5f, 0}, {0.5f, -0.5f, 0}}, 0);  // seen from its back
  add_triangle(scene, {{-0.5f, -0.5f, 0}, {0.5f, -0.5f, 0}, {0, 0.5f, 0}}, 0);
  std::vector<Face>& faces = scene.mesh.faces;
  const Face drawn = faces[1];
  faces.assign(kFaces, faces[0]);
  for (size_t i = 999'999; i < kFaces; i += 1'000'000) faces[i] = drawn;
  auto renderer = Renderer::create(32, 32);
  IdImage id(32, 32);
  RenderQuality quality;
  quality.cull_back_faces = true;
  const auto stats = renderer->render(scene, Camera{}, quality, {{}, {}, id.view()});
  REQUIRE(stats.ok());
  CHECK(stats->triangles_submitted == kFaces);
  CHECK(stats->triangles_drawn == 10);
  CHECK(*id.pixel(16, 16) == 1'000'000);  // of equal depths the first
}

TEST_CASE("more than 2^16 materials: each face has its own") {
  constexpr uint32_t kMaterials = 70000;
  Scene scene;
  scene.materials.resize(kMaterials);
  for (Material& m : scene.materials) m.ambient = m.diffuse = glm::vec3(0);
  scene.materials[kMaterials - 1].emission = {1, 0, 0};
  scene.materials[kMaterials - 1 - 65536].emission = {0, 1, 0};
  add_triangle(scene, {{-3, -3, 0}, {3, -3, 0}, {0, 3, 0}}, kMaterials - 1);
  auto renderer = Renderer::create(8, 8);
  RgbImage color(8, 8);
  REQUIRE(renderer->render(scene, Camera{}, {}, {color.view(), {}, {}}).ok());
  CHECK(color.pixel(4, 4)[0] == 255);
  CHECK(color.pixel(4, 4)[1] == 0);
  scene.mesh.faces[0].material = kMaterials;
  CHECK(renderer->render(scene, Camera{}, {}, {color.view(), {}, {}}).failure().error == Error::corrupt);
}

TEST_CASE("textures 32768 texels wide or high are drawn the same everywhere") {
  for (const auto& [w, h] : {std::pair{16384, 1}, {1, 16384}, {32768, 3}}) {
    Scene scene = test_scenes::room();
    scene.textures[0] = scene.textures[2] = test_scenes::pattern_texture(w, h, 5);
    uint64_t reference = 0;
    for (int i = 0; i < kIsaCount; ++i) {
      RendererOptions options;
      options.isa = static_cast<Isa>(i);
      auto renderer = Renderer::create(64, 64, options);
      if (!renderer.ok()) continue;
      RgbImage color(64, 64);
      REQUIRE(renderer->render(scene, test_scenes::room_camera(), {}, {color.view(), {}, {}}).ok());
      if (options.isa == Isa::scalar) reference = hash_pixels(color.view());
      CHECK(hash_pixels(color.view()) == reference);
    }
  }
}

TEST_CASE("more threads than tiles, than triangles and than cores draw the same") {
  const Scene room = test_scenes::room();
  Scene one = unlit_scene();
  add_triangle(one, {{-4, 0, -2}, {4, 0, -2}, {0, 4, -2}}, 0);
  for (const Scene* scene : {&room, &std::as_const(one)})
    for (const int side : {1, 20, 100}) {
      uint64_t reference = 0;
      for (const int threads : {1, 0, 3, 64}) {
        RendererOptions options;
        options.threads = threads;
        auto renderer = Renderer::create(side, side, options);
        REQUIRE(renderer.ok());
        RgbImage color(side, side);
        REQUIRE(renderer->render(*scene, test_scenes::room_camera(), {}, {color.view(), {}, {}}).ok());
        const uint64_t hash = hash_pixels(color.view());
        if (threads == 1) reference = hash;
        CHECK(hash == reference);
      }
    }
}

// A grid of triangles a fraction of a pixel large, so many that most hold no sample.
TEST_CASE("a surface of a million triangles smaller than a pixel has no holes") {
  Scene scene = unlit_scene();
  constexpr uint32_t kCells = 708;
  for (uint32_t y = 0; y <= kCells; ++y)
    for (uint32_t x = 0; x <= kCells; ++x) {
      Vertex v;
      v.position[0] = 2.2f * static_cast<float>(x) / kCells - 1.1f;
      v.position[1] = 2.2f * static_cast<float>(y) / kCells - 1.1f;
      v.position[2] = 0.3f * v.position[0] * v.position[1];
      scene.mesh.vertices.push_back(v);
    }
  const auto add = [&](uint32_t a, uint32_t b, uint32_t c) {
    scene.mesh.faces.push_back({static_cast<uint32_t>(scene.mesh.indices.size()), 3, 0});
    scene.mesh.indices.insert(scene.mesh.indices.end(), {a, b, c});
  };
  for (uint32_t y = 0; y < kCells; ++y)
    for (uint32_t x = 0; x < kCells; ++x) {
      const uint32_t a = y * (kCells + 1) + x, b = a + kCells + 1;
      add(a, a + 1, b);
      add(a + 1, b + 1, b);
    }
  const Drawn drawn = draw_ids(scene, 96, 96);
  CHECK(drawn.stats.triangles_submitted == 2 * kCells * kCells);
  CHECK(drawn.stats.triangles_drawn < 96 * 96 * 3);  // what covers no sample goes before it costs
  for (int y = 0; y < 96; ++y)
    for (int x = 0; x < 96; ++x) REQUIRE(*drawn.id.pixel(x, y) != 0);
}

}  // namespace
