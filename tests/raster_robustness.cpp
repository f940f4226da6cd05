// Bad scenes, cameras and sizes: a defined error or a defined picture, never undefined behavior.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "base/hash.h"
#include "raster/renderer.h"
#include "tests/support/raster_scenes.h"

namespace {

using namespace pac;
using namespace pac::raster;
using test_scenes::Random;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr int kSide = 64;

struct Drawn {
  Error error = Error::io;
  bool ok = false;
  RenderStats stats;
  uint64_t hash = 0;
  RgbImage color{kSide, kSide};
  DepthImage depth{kSide, kSide};
  IdImage id{kSide, kSide};
};

Drawn draw(const Scene& scene, const Camera& camera, const RenderQuality& quality = {}, Isa isa = best_isa()) {
  RendererOptions options;
  options.isa = isa;
  auto renderer = Renderer::create(kSide, kSide, options);
  REQUIRE(renderer.ok());
  Drawn drawn;
  const auto result =
      renderer->render(scene, camera, quality, {drawn.color.view(), drawn.depth.view(), drawn.id.view()});
  drawn.ok = result.ok();
  if (!result.ok()) {
    drawn.error = result.failure().error;
    return drawn;
  }
  drawn.stats = *result;
  bool in_range = true;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const float depth = *drawn.depth.pixel(x, y);
      in_range = in_range && depth >= 0.0f && depth <= 1.0f && *drawn.id.pixel(x, y) <= scene.mesh.faces.size();
    }
  REQUIRE(in_range);
  drawn.hash = hash_pixels(drawn.id.view(), hash_pixels(drawn.depth.view(), hash_pixels(drawn.color.view())));
  return drawn;
}

// Draws in every shading mode, on the best instruction set and in scalar code: same hashes.
void draw_all_ways(const Scene& scene, const Camera& camera) {
  for (const Shading shading : {Shading::flat, Shading::gouraud, Shading::phong}) {
    RenderQuality quality;
    quality.shading = shading;
    quality.samples = shading == Shading::phong ? 4 : 1;
    const Drawn reference = draw(scene, camera, quality, Isa::scalar);
    REQUIRE(reference.ok);
    if (best_isa() != Isa::scalar) CHECK(draw(scene, camera, quality).hash == reference.hash);
  }
}

Scene small_room() {
  Scene scene = test_scenes::room();
  for (size_t i = 0; i < scene.materials.size(); i += 2) {  // half of it lit
    scene.materials[i].lit = true;
    scene.materials[i].specular = {0.5f, 0.5f, 0.5f};
    scene.materials[i].shininess = 20;
  }
  scene.lights.push_back({Light::Kind::point, {}, {0, 3, 0}, {0.7f, 0.7f, 0.7f}, 0});
  return scene;
}

TEST_CASE("coordinates that are not numbers, infinite, huge or tiny: the rest of the scene is drawn") {
  const float bad[] = {kNan, kInfinity, -kInfinity, 1e30f, -1e30f, 3e38f, 1e-42f, 12345678.0f};
  for (const float value : bad) {
    CAPTURE(value);
    Scene scene = small_room();
    Random random(1);
    for (Vertex& v : scene.mesh.vertices)
      if (random.bits() % 50 == 0) v.position[random.bits() % 3] = value;
    draw_all_ways(scene, test_scenes::room_camera());
    const Drawn drawn = draw(scene, test_scenes::room_camera());
    if (!std::isfinite(value)) CHECK(drawn.stats.triangles_dropped > 20);
    CHECK(drawn.stats.triangles_drawn > 500);
  }
}

TEST_CASE("normals, texture coordinates and colors of lights that are not numbers or huge draw the same everywhere") {
  const float bad[] = {kNan, kInfinity, -kInfinity, 1e20f, 1e9f, -1e9f, 1e-30f, 0.0f};
  for (const float value : bad) {
    CAPTURE(value);
    Scene scene = small_room();
    Random random(2);
    for (Vertex& v : scene.mesh.vertices) {
      if (random.bits() % 20 == 0) v.normal[random.bits() % 3] = value;
      if (random.bits() % 20 == 0) v.texcoord[random.bits() % 2] = value;
    }
    scene.materials[0].diffuse = {value, 0.5f, 0.5f};
    scene.materials[2].specular = {0.5f, value, value};
    scene.lights[0].color[0] = value;
    draw_all_ways(scene, test_scenes::room_camera());
  }
}

TEST_CASE("texture coordinates of +-1e9 wrap and clamp") {
  for (const Wrap wrap : {Wrap::repeat, Wrap::clamp}) {
    Scene scene = test_scenes::room();
    for (Material& m : scene.materials) m.wrap = wrap;
    for (size_t i = 0; i < scene.mesh.vertices.size(); ++i)
      for (float& t : scene.mesh.vertices[i].texcoord) t = i % 2 == 0 ? 1e9f : -1e9f;
    draw_all_ways(scene, test_scenes::room_camera());
  }
}

TEST_CASE("zero areas and slivers: no color outside the corners' range") {
  Scene scene;
  scene.materials.emplace_back();
  scene.materials[0].lit = false;
  scene.background = {0.5f, 0.5f, 0.5f};
  Random random(3);
  for (uint32_t i = 0; i < 3000; ++i) {
    const float x = random.between(-1, 1), y = random.between(-1, 1), dx = random.between(-1, 1),
                dy = random.between(-1, 1);
    const float thin = random.between(0, 0.002f);
    for (uint32_t k = 0; k < 3; ++k) {
      Vertex v;
      const bool repeated = k == 2 && i % 4 == 0;  // the second corner again
      v.position[0] = x + (k == 1 || repeated ? dx : k == 2 ? dx * 0.5f + thin : 0);
      v.position[1] = y + (k == 1 || repeated ? dy : k == 2 ? dy * 0.5f - thin : 0);
      v.position[2] = random.between(-0.9f, 0.9f);
      for (uint8_t& c : v.color) c = static_cast<uint8_t>(100 + random.bits() % 50);
      scene.mesh.indices.push_back(static_cast<uint32_t>(scene.mesh.vertices.size()));
      scene.mesh.vertices.push_back(v);
    }
    scene.mesh.faces.push_back({3 * i, 3, 0});
  }
  const Drawn drawn = draw(scene, Camera{});
  CHECK(drawn.stats.triangles_dropped >= 700);
  for (int y = 0; y < kSide; ++y)
    for (int i = 0; i < 3 * kSide; ++i) {
      REQUIRE(drawn.color.row(y)[i] >= 100);
      REQUIRE(drawn.color.row(y)[i] <= 150);
    }
  draw_all_ways(scene, Camera{});
}

TEST_CASE("indices, faces, materials and textures out of range are corrupt, and nothing is drawn") {
  const auto expect_corrupt = [](Scene scene) {
    RendererOptions options;
    auto renderer = Renderer::create(kSide, kSide, options);
    RgbImage color(kSide, kSide);
    const auto result = renderer->render(scene, test_scenes::room_camera(), {}, {color.view(), {}, {}});
    REQUIRE_FALSE(result.ok());
    CHECK(result.failure().error == Error::corrupt);
    for (int y = 0; y < kSide; ++y)
      for (int i = 0; i < 3 * kSide; ++i) REQUIRE(color.row(y)[i] == 0);
    return result.failure().byte_offset;
  };
  Scene scene = test_scenes::room();
  const auto n_vertices = static_cast<uint32_t>(scene.mesh.vertices.size());
  const auto with = [&](auto&& change) {
    Scene copy = scene;
    change(copy);
    return expect_corrupt(copy);
  };
  CHECK(with([&](Scene& s) { s.mesh.indices[4 * 100] = n_vertices; }) == 100);
  CHECK(with([](Scene& s) { s.mesh.indices[4 * 7] = UINT32_MAX; }) == 7);
  CHECK(with([](Scene& s) { s.mesh.faces[3].first = UINT32_MAX; }) == 3);
  CHECK(with([](Scene& s) { s.mesh.faces[3].count = UINT32_MAX; }) == 3);
  CHECK(with([](Scene& s) { s.mesh.faces[9].count = 2; }) == 9);
  CHECK(with([](Scene& s) { s.mesh.faces[9].count = 0; }) == 9);
  CHECK(with([](Scene& s) { s.mesh.faces[5].material = 6; }) == 5);
  with([](Scene& s) { s.materials[1].texture = 6; });
  with([](Scene& s) { s.materials[1].texture = -2; });
  with([](Scene& s) { s.materials.clear(); });
  with([](Scene& s) { s.textures[0].texels.resize(100); });
  with([](Scene& s) { s.textures[0].levels[0].width = 512; });
}

TEST_CASE("image sizes: 0 is legal, negative and enormous ones are refused before anything is allocated") {
  const Scene scene = test_scenes::room();
  for (const auto& [w, h] : {std::pair{0, 0}, {0, 40}, {40, 0}}) {
    auto renderer = Renderer::create(w, h);
    REQUIRE(renderer.ok());
    RgbImage color(w, h);
    CHECK(renderer->render(scene, test_scenes::room_camera(), {}, {color.view(), {}, {}}).ok());
  }
  CHECK(Renderer::create(-1, 10).failure().error == Error::bad_argument);
  CHECK(Renderer::create(32769, 10).failure().error == Error::limit_exceeded);
  CHECK(Renderer::create(10, INT32_MAX).failure().error == Error::limit_exceeded);
  RendererOptions options;
  options.max_side = 100;
  CHECK(Renderer::create(101, 10, options).failure().error == Error::limit_exceeded);
  options.threads = -1;
  CHECK(Renderer::create(10, 10, options).failure().error == Error::bad_argument);
}

TEST_CASE("the largest side is drawn exactly: edges of the guard band meet the image's") {
  constexpr int kLong = 32768;
  auto renderer = Renderer::create(kLong, 8);
  REQUIRE(renderer.ok());
  Scene scene;
  scene.materials.emplace_back();
  scene.materials[0].lit = false;
  test_scenes::add_quad(scene, {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 0}, {0, 0}, {0, 0}, {0, 0}}, 0,
                        {10, 255, 255, 10});
  RgbImage color(kLong, 8);
  IdImage id(kLong, 8);
  REQUIRE(renderer->render(scene, Camera{}, {}, {color.view(), {}, id.view()}).ok());
  int covered = 0;
  for (int x = 0; x < kLong; ++x) covered += *id.pixel(x, 4) == 1 ? 1 : 0;
  CHECK(covered >= kLong - 2);  // clipped one pixel inside the ends
  CHECK(std::abs(color.pixel(kLong / 2, 4)[0] - 132) <= 1);
}

TEST_CASE("every width and height around the tile size, odd pitches: pixels outside stay untouched") {
  const Scene scene = test_scenes::room();
  for (const int width : {1, 7, 8, 31, 32, 33, 65})
    for (const int height : {1, 31, 32, 33}) {
      auto renderer = Renderer::create(width, height);
      RgbImage canvas(width + 10, height + 2);
      DepthImage depths(width + 3, height + 1);
      const RgbView view{canvas.pixel(5, 1), width, height, canvas.stride()};
      REQUIRE(renderer
                  ->render(scene, test_scenes::room_camera(), {},
                           {view, {depths.pixel(1, 1), width, height, depths.stride()}, {}})
                  .ok());
      for (int y = 0; y < height + 2; ++y)
        for (int x = 0; x < width + 10; ++x)
          if (x < 5 || x >= width + 5 || y < 1 || y >= height + 1)
            REQUIRE(canvas.pixel(x, y)[0] + canvas.pixel(x, y)[1] == 0);
      for (int y = 0; y < height + 1; ++y)
        for (int x = 0; x < width + 3; ++x)
          if (x < 1 || x > width || y < 1) REQUIRE(*depths.pixel(x, y) == 0.0f);
    }
}

TEST_CASE("arguments outside their range are bad arguments") {
  const Scene scene = test_scenes::room();
  auto renderer = Renderer::create(32, 32);
  RgbImage color(32, 32), wrong(31, 32);
  const auto render = [&](const Camera& camera, int samples, RgbView view) {
    RenderQuality quality;
    quality.samples = samples;
    return renderer->render(scene, camera, quality, {view, {}, {}});
  };
  for (const int samples : {-1, 0, 2, 3, 8, 65, 256})
    CHECK(render(test_scenes::room_camera(), samples, color.view()).failure().error == Error::bad_argument);
  CHECK(render(test_scenes::room_camera(), 1, wrong.view()).failure().error == Error::bad_argument);
  RenderQuality one, four;
  four.samples = 4;
  CHECK(renderer->render_pair(scene, test_scenes::room_camera(), one, four, {}, {}, {}).failure().error ==
        Error::bad_argument);
}

TEST_CASE("cameras that see nothing sensible are bad arguments") {
  const Scene scene = test_scenes::room();
  const auto error = [&](const Camera& camera) {
    auto renderer = Renderer::create(16, 16);
    const auto result = renderer->render(scene, camera, {}, {});
    return result.ok() ? Error::io : result.failure().error;
  };
  CHECK(error(make_camera({1, 1, 1}, {1, 1, 1}, {0, 1, 0}, 1, 1, 0.1f, 10)) == Error::bad_argument);  // eye = target
  CHECK(error(make_camera({0, 5, 0}, {0, 0, 0}, {0, 1, 0}, 1, 1, 0.1f, 10)) ==
        Error::bad_argument);  // up along the view
  CHECK(error(make_camera({1, 1, 1}, {0, 0, 0}, {0, 1, 0}, 1, 0, 0.1f, 10)) == Error::bad_argument);    // aspect 0
  CHECK(error(make_camera({1, 1, 1}, {0, 0, 0}, {0, 1, 0}, 1, 1, 2.0f, 2.0f)) == Error::bad_argument);  // near = far
  CHECK(error(make_camera({kNan, 1, 1}, {0, 0, 0}, {0, 1, 0}, 1, 1, 0.1f, 10)) == Error::bad_argument);
  Camera singular;
  singular.clip_from_world[2] = singular.clip_from_world[1];
  CHECK(error(singular) == Error::bad_argument);
  Camera zero;
  zero.clip_from_world = glm::mat4(0.0f);
  CHECK(error(zero) == Error::bad_argument);
  Camera infinite;
  infinite.clip_from_world[3][1] = kInfinity;
  CHECK(error(infinite) == Error::bad_argument);
}

TEST_CASE("an eye that is not a number, lights at a vertex, exponents 0 and enormous: defined pictures") {
  Scene scene = small_room();
  scene.lights.push_back({Light::Kind::point, {}, {-4, 0, 4}, {1, 1, 1}, 0});  // a corner of the room
  scene.lights.push_back({Light::Kind::directional, {0, 0, 0}, {}, {1, 1, 1}, 0});
  scene.lights.push_back({Light::Kind::point, {}, {kNan, kInfinity, 1e38f}, {1, 1, 1}, 1e-30f});
  for (const int shininess : {-5, 0, 1, 1000, INT32_MAX}) {
    for (Material& m : scene.materials) m.shininess = shininess;
    draw_all_ways(scene, test_scenes::room_camera());
  }
  Camera camera = test_scenes::room_camera();
  camera.eye = {kNan, 0, kInfinity};
  draw_all_ways(scene, camera);
  scene.lights.resize(17);
  CHECK(draw(scene, test_scenes::room_camera()).error == Error::limit_exceeded);
}

TEST_CASE("camera inside geometry, triangles through the eye, on the near plane and behind: drawn in bounds") {
  Scene scene;
  scene.materials.emplace_back();
  Random random(8);
  for (uint32_t i = 0; i < 400; ++i) {
    for (int k = 0; k < 3; ++k) {
      Vertex v;
      for (float& p : v.position) p = random.between(-3, 3);
      if (i % 5 == 0 && k == 0) v.position[0] = v.position[1] = v.position[2] = 0;  // the eye itself
      if (i % 7 == 0) v.position[2] = -0.1f;                                        // the near plane
      scene.mesh.indices.push_back(static_cast<uint32_t>(scene.mesh.vertices.size()));
      scene.mesh.vertices.push_back(v);
    }
    scene.mesh.faces.push_back({3 * i, 3, 0});
  }
  const Camera camera = make_camera({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 1.3f, 1, 0.1f, 20);
  draw_all_ways(scene, camera);
  CHECK(draw(scene, camera).stats.triangles_drawn > 50);
}

TEST_CASE("a triangle on the near plane is kept") {
  Scene scene;
  scene.materials.emplace_back();
  scene.materials[0].lit = false;
  test_scenes::add_quad(scene, {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}}, {{0, 0}, {0, 0}, {0, 0}, {0, 0}},
                        0, {50, 50, 50, 50});
  const Drawn drawn = draw(scene, Camera{});  // z = -w
  CHECK(*drawn.id.pixel(10, 10) == 1);
  CHECK(*drawn.depth.pixel(10, 10) == 0.0f);
}

TEST_CASE("textures of one texel, one row, odd sizes and none") {
  for (const auto& [w, h] : {std::pair{1, 1}, {1, 9}, {9, 1}, {211, 211}, {3, 1000}}) {
    Scene scene = test_scenes::room();
    scene.textures[0] = scene.textures[2] = test_scenes::pattern_texture(w, h, 5);
    scene.textures[1] = make_texture("empty", RgbaImage());
    for (const Filter filter : {Filter::nearest, Filter::bilinear, Filter::trilinear}) {
      for (Material& m : scene.materials) m.filter = filter;
      const Drawn reference = draw(scene, test_scenes::room_camera(), {}, Isa::scalar);
      CHECK(draw(scene, test_scenes::room_camera()).hash == reference.hash);
    }
  }
}

TEST_CASE("polygons with thousands of corners, convex, concave and scrambled, are cut in bounded time") {
  for (int kind = 0; kind < 3; ++kind) {
    Scene scene;
    scene.materials.emplace_back();
    scene.materials[0].lit = false;
    constexpr uint32_t kCorners = 3000;
    Random random(4);
    for (uint32_t i = 0; i < kCorners; ++i) {
      const double angle = 2 * kPi * i / kCorners;
      const double radius = kind == 0 ? 0.9 : kind == 1 ? (i % 2 == 0 ? 0.9 : 0.5) : static_cast<double>(random.unit());
      Vertex v;
      v.position[0] = static_cast<float>(radius * exact_cos(angle));
      v.position[1] = static_cast<float>(radius * exact_sin(angle));
      if (kind == 2 && i % 100 == 0) v.position[1] = kNan;
      scene.mesh.indices.push_back(i);
      scene.mesh.vertices.push_back(v);
    }
    scene.mesh.faces.push_back({0, kCorners, 0});
    const Drawn drawn = draw(scene, Camera{});
    CHECK(drawn.stats.triangles_submitted == kCorners - 2);
    if (kind < 2) CHECK(*drawn.id.pixel(kSide / 2, kSide / 2) == 1);
  }
}

TEST_CASE("a hundred thousand triangles in one pixel, and a thousand materials") {
  Scene scene;
  for (int i = 0; i < 1000; ++i) {
    scene.materials.emplace_back();
    scene.materials.back().lit = false;
  }
  for (int i = 0; i < 3; ++i) {
    Vertex v;
    v.position[0] = i == 1 ? 0.02f : 0;
    v.position[1] = i == 2 ? 0.02f : 0;
    scene.mesh.vertices.push_back(v);
  }
  for (uint32_t i = 0; i < 100000; ++i) {
    scene.mesh.faces.push_back({3 * i, 3, i % 1000});
    scene.mesh.indices.insert(scene.mesh.indices.end(), {0, 1, 2});
  }
  const Drawn drawn = draw(scene, Camera{});
  CHECK(drawn.stats.triangles_submitted == 100000);
}

// The room with every map, masks, panes, reflections and fog.
Scene rich_room() {
  Scene scene = small_room();
  for (size_t i = 0; i < scene.materials.size(); ++i) {
    Material& m = scene.materials[i];
    m.normal_texture = static_cast<int32_t>((i + 1) % 6);
    m.specular_texture = static_cast<int32_t>((i + 2) % 6);
    m.emission_texture = static_cast<int32_t>((i + 3) % 6);
    m.emission = glm::vec3(0.3f);
    m.reflection = glm::vec3(0.2f);
    m.anisotropy = 1 + static_cast<int>(i);
    m.alpha = static_cast<AlphaMode>(i % 3);
    m.opacity = 0.7f;
  }
  scene.environment = 5;
  scene.fog = {Fog::Kind::exponential, {0.4f, 0.5f, 0.6f}, 0, 9, 0.1f};
  return scene;
}

TEST_CASE(
    "maps, masks, panes, fog and shadow maps over numbers that are not finite, or huge, draw the same everywhere") {
  const float bad[] = {kNan, kInfinity, -kInfinity, 1e30f, -1e9f, 1e-40f, 0.0f};
  for (const float value : bad) {
    CAPTURE(value);
    Scene scene = rich_room();
    Random random(6);
    for (Vertex& v : scene.mesh.vertices) {
      if (random.bits() % 20 == 0) v.normal[random.bits() % 3] = value;
      if (random.bits() % 20 == 0) v.texcoord[random.bits() % 2] = value;
      if (random.bits() % 60 == 0) v.position[random.bits() % 3] = value;
      if (random.bits() % 20 == 0) v.color[3] = 0;
    }
    draw_all_ways(scene, test_scenes::room_camera());
    Material& m = scene.materials[0];
    m.normal_scale = m.opacity = m.alpha_cutoff = m.reflection_blur = m.reflection.x = m.emission.y = value;
    scene.materials[2].opacity = scene.materials[1].alpha_cutoff = value;
    scene.fog.start = value;
    scene.fog.density = value;
    draw_all_ways(scene, test_scenes::room_camera());
    scene.fog.kind = Fog::Kind::linear;
    draw_all_ways(scene, test_scenes::room_camera());
    scene.lights.push_back({Light::Kind::directional, {value, -1, 0.2f}, {}, {1, 1, 1}, 0});
    scene.lights.push_back({Light::Kind::spot, {0.1f, -1, value}, {0, 3.5f, value}, {1, 1, 1}, 0, 0.9f, value});
    RenderQuality quality;
    quality.lighting = Lighting::shadow_maps;
    quality.shadow_map_side = 64;
    const Drawn reference = draw(scene, test_scenes::room_camera(), quality, Isa::scalar);
    REQUIRE(reference.ok);
    CHECK(draw(scene, test_scenes::room_camera(), quality).hash == reference.hash);
  }
}

TEST_CASE("texture coordinates without area, empty and one-texel maps: defined pictures") {
  Scene scene = rich_room();
  for (size_t i = 0; i < scene.mesh.vertices.size(); i += 2) scene.mesh.vertices[i].texcoord[0] = 0;
  for (Vertex& v : scene.mesh.vertices) v.texcoord[1] = 0.5f;
  draw_all_ways(scene, test_scenes::room_camera());
  scene.textures[1] = make_texture("empty", RgbaImage());
  scene.textures[2] = test_scenes::pattern_texture(1, 1, 4);
  scene.textures[5] = test_scenes::pattern_texture(1, 3, 4);
  draw_all_ways(scene, test_scenes::room_camera());
  scene.textures[5] = make_texture("empty", RgbaImage());
  draw_all_ways(scene, test_scenes::room_camera());
}

TEST_CASE("maps and environments that do not exist are corrupt; sides of shadow maps are clamped") {
  const auto error = [](auto&& change) {
    Scene scene = rich_room();
    change(scene);
    return draw(scene, test_scenes::room_camera()).error;
  };
  CHECK(error([](Scene& s) { s.materials[0].normal_texture = 6; }) == Error::corrupt);
  CHECK(error([](Scene& s) { s.materials[0].specular_texture = -2; }) == Error::corrupt);
  CHECK(error([](Scene& s) { s.materials[0].emission_texture = INT32_MAX; }) == Error::corrupt);
  CHECK(error([](Scene& s) { s.environment = 6; }) == Error::corrupt);
  Scene scene = rich_room();
  scene.lights.push_back({Light::Kind::directional, {0, -1, 0.2f}, {}, {1, 1, 1}, 0});
  RenderQuality quality;
  quality.lighting = Lighting::shadow_maps;
  for (const int side : {-5, 0, 33, 100}) {
    quality.shadow_map_side = side;
    CHECK(draw(scene, test_scenes::room_camera(), quality).ok);
  }
  scene.mesh = {};
  CHECK(draw(scene, test_scenes::room_camera(), quality).ok);
}

}  // namespace
