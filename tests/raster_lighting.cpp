// Full lighting: shadows by rays, soft shadows of lights with a size, occlusion of the ambient light, spot lights.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "base/hash.h"
#include "raster/occluder_tree.h"
#include "raster/renderer.h"
#include "raster/shadows.h"
#include "tests/support/kernel_check.h"
#include "tests/support/raster_scenes.h"

namespace {

using namespace pac;
using namespace pac::raster;
using test_scenes::Random;

constexpr int kSize = 96;

void add_rectangle(Scene& scene, glm::vec3 corner, glm::vec3 s, glm::vec3 t, uint32_t material = 0) {
  const glm::vec3 corners[4] = {corner, corner + s, corner + s + t, corner + t};
  scene.mesh.faces.push_back({static_cast<uint32_t>(scene.mesh.indices.size()), 4, material});
  for (const glm::vec3& p : corners) {
    Vertex v;
    for (int c = 0; c < 3; ++c) v.position[c] = p[c];
    scene.mesh.indices.push_back(static_cast<uint32_t>(scene.mesh.vertices.size()));
    scene.mesh.vertices.push_back(v);
  }
}

// A floor of 8 x 8 at height 0, seen from straight above, and a 2 x 2 slab at height 1 outside the picture's middle
// row of pixels only where the light comes from.
Scene floor_with_slab() {
  Scene scene;
  Material grey;
  grey.ambient = glm::vec3(0.2f);
  grey.diffuse = glm::vec3(0.6f);
  scene.materials = {grey};
  add_rectangle(scene, {-4, 0, 4}, {8, 0, 0}, {0, 0, -8});
  add_rectangle(scene, {-3, 1, 1}, {2, 0, 0}, {0, 0, -2});
  scene.ambient_reach = 0;
  Light sun;
  sun.direction = {1, -1, 0};  // the slab's shadow falls on x in [-2, 0]
  scene.lights = {sun};
  return scene;
}

Camera from_above() {
  return make_camera({0, 20, 0}, {0, 0, 0}, {0, 0, -1}, 0.4f, 1.0f, 1.0f, 30.0f);
}

RenderQuality quality_of(Lighting lighting, int samples = 1) {
  RenderQuality quality;
  quality.shading = Shading::phong;
  quality.lighting = lighting;
  quality.samples = samples;
  return quality;
}

RgbImage draw(const Scene& scene, const Camera& camera, const RenderQuality& quality, RendererOptions options = {}) {
  auto renderer = Renderer::create(kSize, kSize, options);
  REQUIRE(renderer.ok());
  RgbImage image(kSize, kSize);
  REQUIRE(renderer->render(scene, camera, quality, {image.view(), {}, {}}).ok());
  return image;
}

// Red at a point of the floor.
int red_at(const RgbImage& image, float x, float z) {
  const float scale = kSize / 2.0f / (20.0f * std::tan(0.2f));
  const int px = static_cast<int>(kSize / 2.0f + x * scale), py = static_cast<int>(kSize / 2.0f + z * scale);
  return image.pixel(px, py)[0];
}

TEST_CASE("a slab casts its shadow on the floor under full lighting and none under local lighting") {
  const Scene scene = floor_with_slab();
  const RgbImage local = draw(scene, from_above(), quality_of(Lighting::local));
  const RgbImage full = draw(scene, from_above(), quality_of(Lighting::full));
  const int lit = static_cast<int>(std::lround(255 * (0.2 + 0.6 * std::sqrt(0.5)))), shadowed = 51;
  CHECK(std::abs(red_at(local, -0.5f, 0) - lit) <= 1);
  CHECK(std::abs(red_at(full, -0.5f, 0) - shadowed) <= 1);
  for (const float x : {0.3f, 1.0f, 3.5f}) CHECK(red_at(full, x, 0) == red_at(local, x, 0));
  CHECK(red_at(full, -2.0f, 0) == red_at(local, -2.0f, 0));  // the slab itself
}

TEST_CASE("point, spot and directional lights cast shadows, and a light can be told not to") {
  for (const Light::Kind kind : {Light::Kind::directional, Light::Kind::point, Light::Kind::spot}) {
    Scene scene = floor_with_slab();
    Light& light = scene.lights[0];
    light.kind = kind;
    light.position = {-52, 51, 0};  // far away along the sun's direction, through the slab's middle
    light.cone_inner = 0.9f;
    light.cone_outer = 0.8f;
    const RgbImage full = draw(scene, from_above(), quality_of(Lighting::full));
    CHECK(red_at(full, -0.5f, 0) <= 52);
    CHECK(red_at(full, 1.0f, 0) > 120);
    light.casts_shadows = false;
    const RgbImage none = draw(scene, from_above(), quality_of(Lighting::full));
    const RgbImage local = draw(scene, from_above(), quality_of(Lighting::local));
    CHECK(hash_pixels(none.view()) == hash_pixels(local.view()));
    CHECK(red_at(none, -0.5f, 0) > 120);
  }
}

TEST_CASE("a light with a size has a penumbra that brightens steadily, a point has an edge") {
  Scene scene = floor_with_slab();
  const auto profile = [&](float radius) {
    scene.lights[0].radius = radius;
    RenderQuality quality = quality_of(Lighting::full, 16);
    quality.light_samples = 64;
    const RgbImage image = draw(scene, from_above(), quality);
    std::vector<int> reds;
    for (float x = -0.75f; x < 1.2f; x += 0.1f) reds.push_back(red_at(image, x, 0));
    return reds;
  };
  const auto between = [](const std::vector<int>& reds) {
    return std::count_if(reds.begin(), reds.end(), [&](int r) { return r > reds.front() + 4 && r < reds.back() - 4; });
  };
  const std::vector<int> soft = profile(0.3f), hard = profile(0.0f);
  for (size_t i = 1; i < soft.size(); ++i) CHECK(soft[i] >= soft[i - 1] - 3);
  CHECK(soft.front() + 80 < soft.back());
  CHECK(between(soft) >= 4);
  CHECK(between(hard) <= 1);
}

TEST_CASE("a spot light is full inside its inner cone, dark outside the outer one, and fades between") {
  Scene scene;
  Material white;
  white.ambient = glm::vec3(0);
  white.diffuse = glm::vec3(0.5f);
  scene.materials = {white};
  add_rectangle(scene, {-4, 0, 4}, {8, 0, 0}, {0, 0, -8});
  Light spot;
  spot.kind = Light::Kind::spot;
  spot.position = {0, 2, 0};
  spot.direction = {0, -3, 0};
  spot.cone_inner = 0.9f;  // radius 0.97 on the floor
  spot.cone_outer = 0.7f;  // radius 2.04
  scene.lights = {spot};
  const RgbImage image = draw(scene, from_above(), quality_of(Lighting::local));
  CHECK(std::abs(red_at(image, 0, 0) - 128) <= 1);
  CHECK(red_at(image, 0.5f, 0) > 110);
  CHECK(red_at(image, 1.4f, 0) > 10);
  CHECK(red_at(image, 1.4f, 0) < 80);
  CHECK(red_at(image, 2.2f, 0) == 0);
}

TEST_CASE("ambient light is occluded in a corner and not on an open floor") {
  Scene scene = floor_with_slab();
  scene.lights.clear();
  scene.mesh.faces.pop_back();
  scene.materials[0].ambient = glm::vec3(0.8f);
  const RgbImage open = draw(scene, from_above(), quality_of(Lighting::full));
  CHECK(red_at(open, 0, 0) == 204);
  scene.ambient_reach = 2;
  CHECK(red_at(draw(scene, from_above(), quality_of(Lighting::full)), 0, 0) == 204);
  add_rectangle(scene, {0, 0, 4}, {0, 0, -8}, {0, 3, 0});  // a wall, seen edge on
  const RgbImage corner = draw(scene, from_above(), quality_of(Lighting::full, 16));
  CHECK(red_at(corner, -0.2f, 0) < 150);
  CHECK(red_at(corner, 0.2f, 0) < 150);
  CHECK(red_at(corner, 3.0f, 0) == 204);
  CHECK(red_at(draw(scene, from_above(), quality_of(Lighting::local, 16)), -0.2f, 0) == 204);
}

TEST_CASE("a finely cut convex body casts no shadow on itself where it faces the light") {
  Scene scene = test_scenes::bumpy_pin(60, 60);
  scene.mesh = {};
  constexpr int kN = 48;
  for (int j = 0; j <= kN; ++j)
    for (int i = 0; i <= kN; ++i) {
      const double theta = kPi * j / kN, phi = 2 * kPi * (i % kN) / kN;
      const double p[3] = {exact_sin(theta) * exact_cos(phi), exact_cos(theta), exact_sin(theta) * exact_sin(phi)};
      Vertex v;
      for (int c = 0; c < 3; ++c) v.position[c] = v.normal[c] = static_cast<float>(p[c]);
      scene.mesh.vertices.push_back(v);
    }
  for (uint32_t j = 0; j < kN; ++j)
    for (uint32_t i = 0; i < kN; ++i) {
      const uint32_t a = j * (kN + 1) + i, below = a + kN + 1;
      scene.mesh.faces.push_back({static_cast<uint32_t>(scene.mesh.indices.size()), 4, 0});
      scene.mesh.indices.insert(scene.mesh.indices.end(), {a, a + 1, below + 1, below});
    }
  scene.ambient_reach = 0;
  const Camera camera = make_camera({0, 2, 6}, {0, 0, 0}, {0, 1, 0}, 0.5f, 1.0f, 1.0f, 10.0f);
  const RgbImage full = draw(scene, camera, quality_of(Lighting::full));
  const RgbImage local = draw(scene, camera, quality_of(Lighting::local));
  int differing = 0;
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < 3 * kSize; ++x) differing += std::abs(full.view().row(y)[x] - local.view().row(y)[x]) > 6;
  CHECK(differing == 0);
}

// The scene that the next tests compare bits on: everything at once.
Scene everything() {
  Scene scene = test_scenes::bumpy_pin(30, 30);
  Light spot;
  spot.kind = Light::Kind::spot;
  spot.position = {3, 6, 3};
  spot.direction = {-3, -5, -3};
  spot.cone_inner = 0.95f;
  spot.cone_outer = 0.6f;
  spot.radius = 0.5f;
  scene.lights.push_back(spot);
  scene.lights[0].radius = 0.2f;
  add_rectangle(scene, {-6, 0, 6}, {12, 0, 0}, {0, 0, -12});
  return scene;
}

TEST_CASE("full lighting gives the same bits on every instruction set and thread count") {
  const Scene scene = everything();
  for (const Shading shading : {Shading::flat, Shading::gouraud, Shading::phong}) {
    RenderQuality quality = quality_of(Lighting::full, 4);
    quality.shading = shading;
    RendererOptions options;
    options.isa = Isa::scalar;
    const auto hash = [&] {
      const RgbImage image = draw(scene, test_scenes::pin_camera(1.0f), quality, options);
      uint64_t h = 0;
      for (int y = 0; y < kSize; ++y) h = hash_bytes(image.view().row(y), 3 * kSize, h);
      return h;
    };
    const uint64_t expected = hash();
    for (const Isa isa : {Isa::sse41, Isa::avx2, Isa::neon}) {
      if (kernels_for(isa) == nullptr) continue;
      options.isa = isa;
      for (const int threads : {1, 7}) {
        options.threads = threads;
        CHECK(hash() == expected);
      }
    }
  }
}

TEST_CASE("one traversal with full lighting in H and local in L gives the bits of two") {
  const Scene scene = everything();
  const Camera camera = test_scenes::pin_camera(1.0f);
  auto renderer = Renderer::create(kSize, kSize);
  RgbImage high(kSize, kSize), low(kSize, kSize), difference(kSize, kSize);
  REQUIRE(renderer
              ->render_pair(scene, camera, quality_of(Lighting::full, 4), quality_of(Lighting::local, 4),
                            {high.view(), {}, {}}, low.view(), difference.view())
              .ok());
  const RgbImage full = draw(scene, camera, quality_of(Lighting::full, 4));
  const RgbImage local = draw(scene, camera, quality_of(Lighting::local, 4));
  for (int y = 0; y < kSize; ++y) {
    REQUIRE(std::memcmp(high.view().row(y), full.view().row(y), 3 * kSize) == 0);
    REQUIRE(std::memcmp(low.view().row(y), local.view().row(y), 3 * kSize) == 0);
  }
}

TEST_CASE(
    "vertices shared by faces and materials draw as if each face had its own, and normals as if turned to the eye "
    "before") {
  Scene shared = everything();
  shared.materials.push_back(shared.materials[0]);
  shared.materials[1].diffuse = {0.2f, 0.7f, 0.9f};
  shared.materials[1].two_sided = true;
  for (size_t f = 0; f < shared.mesh.faces.size(); ++f) shared.mesh.faces[f].material = f % 3 == 0 ? 1 : 0;
  for (size_t v = 0; v < shared.mesh.vertices.size(); v += 7)  // some normals point inwards, some are missing
    for (float& component : shared.mesh.vertices[v].normal) component = v % 2 == 0 ? -component : 0.0f;
  Scene split = shared;
  split.mesh.vertices.clear();
  for (uint32_t& index : split.mesh.indices) {
    split.mesh.vertices.push_back(shared.mesh.vertices[index]);
    index = static_cast<uint32_t>(split.mesh.vertices.size() - 1);
  }
  Scene negated = shared;
  for (Vertex& vertex : negated.mesh.vertices)
    for (float& component : vertex.normal) component = -component;
  for (const Lighting lighting : {Lighting::local, Lighting::full}) {
    RenderQuality quality = quality_of(lighting);
    quality.shading = Shading::gouraud;
    for (const bool cull : {false, true}) {
      quality.cull_back_faces = cull;
      const Camera camera = test_scenes::pin_camera(1.0f);
      const uint64_t expected = hash_pixels(draw(shared, camera, quality).view());
      CHECK(hash_pixels(draw(split, camera, quality).view()) == expected);
      CHECK(hash_pixels(draw(negated, camera, quality).view()) == expected);
    }
  }
}

TEST_CASE("a renderer that is given another mesh, or a moved vertex, casts the new shadows") {
  Scene scene = floor_with_slab();
  auto renderer = Renderer::create(kSize, kSize);
  RgbImage image(kSize, kSize);
  const auto red = [&] {
    REQUIRE(renderer->render(scene, from_above(), quality_of(Lighting::full), {image.view(), {}, {}}).ok());
    return red_at(image, -0.5f, 0);
  };
  CHECK(red() <= 52);
  for (size_t i = 4; i < 8; ++i) scene.mesh.vertices[i].position[2] -= 2.5f;
  CHECK(red() > 120);
  for (size_t i = 4; i < 8; ++i) scene.mesh.vertices[i].position[2] += 2.5f;
  CHECK(red() <= 52);
  scene.mesh.faces.pop_back();
  CHECK(red() > 120);
}

TEST_CASE("rays: every instruction set finds what the scalar one finds, and that is what every triangle says") {
  Random random(11);
  Mesh mesh;
  for (uint32_t i = 0; i < 600; ++i) {
    float middle[3];
    for (float& f : middle) f = random.between(-5, 5);
    if (i % 3 == 0) mesh.faces.push_back({static_cast<uint32_t>(mesh.indices.size()), 3, 0});
    Vertex v;
    for (int c = 0; c < 3; ++c)
      v.position[c] = i % 3 == 0 ? middle[c] : mesh.vertices[i - i % 3].position[c] + random.between(-1, 1);
    if (i == 300) v.position[0] = NAN;
    if (i == 303) v.position[1] = 1e30f;
    mesh.indices.push_back(i);
    mesh.vertices.push_back(v);
  }
  OccluderTree occluders;
  occluders.update(mesh);
  const RayTree tree = occluders.view();
  REQUIRE(tree.nodes != nullptr);
  // One leaf with everything: no boxes to go wrong.
  std::vector<RayTriangle> all(tree.triangles, tree.triangles + 198);
  RayNode leaf{{-100, -100, -100}, {100, 100, 100}, 0, 198, 0};
  const RayTree flat{&leaf, all.data(), tree.back_limit};
  uint32_t n_hits = 0;
  for (int round = 0; round < 400; ++round) {
    alignas(32) float origin[3 * kBatchLanes] = {}, direction[3 * kBatchLanes] = {}, limit[8];
    for (int k = 0; k < 8; ++k) {
      glm::vec3 d;
      float squared = 0;
      for (int c = 0; c < 3; ++c) {
        origin[c * kBatchLanes + k] = random.between(-6, 6);
        d[c] = round % 7 == 0 && c != round % 3 ? 0.0f : random.between(-1, 1);
        squared += d[c] * d[c];
      }
      for (int c = 0; c < 3; ++c) direction[c * kBatchLanes + k] = d[c] / std::sqrt(squared);
      limit[k] = random.between(0, 8);
      if (round % 50 == 1 && k == 3) direction[k] = NAN;
      if (round % 50 == 2 && k == 5) origin[k] = INFINITY;
    }
    const uint32_t mask = random.bits() & 0xFF;
    const uint32_t expected = kernels_for(Isa::scalar)->tile.occluded(tree, origin, direction, limit, mask);
    CHECK(expected == kernels_for(Isa::scalar)->tile.occluded(flat, origin, direction, limit, mask));
    for (const Isa isa : {Isa::sse41, Isa::avx2, Isa::neon})
      if (const Kernels* table = kernels_for(isa); table != nullptr)
        CHECK(table->tile.occluded(tree, origin, direction, limit, mask) == expected);
    n_hits += static_cast<uint32_t>(__builtin_popcount(expected));
  }
  CHECK(n_hits > 50);
}

TEST_CASE("samples of a light lie in the unit ball around its middle, those of the sky on the sphere") {
  for (const int n : {1, 2, 4, 7, 16, 64}) {
    const LightSamples samples = make_light_samples(n);
    REQUIRE(samples.count == n);
    double mean[3] = {};
    for (int i = 0; i < n; ++i) {
      double ball = 0, sphere = 0;
      for (int c = 0; c < 3; ++c) {
        ball += static_cast<double>(samples.ball[i][c]) * static_cast<double>(samples.ball[i][c]);
        sphere += static_cast<double>(samples.sphere[i][c]) * static_cast<double>(samples.sphere[i][c]);
        mean[c] += static_cast<double>(samples.ball[i][c]) / n;
      }
      CHECK(ball <= 1.0001);
      if (n > 1) CHECK(std::fabs(sphere - 1) < 1e-5);
    }
    if (n >= 16)
      for (const double m : mean) CHECK(std::fabs(m) < 0.12);
  }
}

}  // namespace
