#include "sim/scenes.h"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdlib>
#include <glm/glm.hpp>
#include <map>
#include <string>

#include "base/hash.h"
#include "base/metrics.h"
#include "raster/renderer.h"
#include "sim/scene_room.h"

namespace {

using namespace pac;
using namespace pac::sim;

// Each scene at seed 1, built once for all test cases.
const SceneSet& scene_set(const BuiltinScene& scene) {
  static std::map<std::string, SceneSet> built;
  const auto [entry, is_new] = built.try_emplace(scene.name);
  if (is_new) entry->second = scene.build(1);
  return entry->second;
}

const SceneSet& scene_set(const char* name) {
  const BuiltinScene* scene = find_scene(name);
  REQUIRE(scene != nullptr);
  return scene_set(*scene);
}

uint64_t hash_scene(const raster::Scene& scene, uint64_t hash) {
  static_assert(sizeof(Vertex) == 36 && sizeof(Face) == 12);  // no padding
  hash = hash_bytes(scene.mesh.vertices.data(), scene.mesh.vertices.size() * sizeof(Vertex), hash);
  hash = hash_bytes(scene.mesh.indices.data(), scene.mesh.indices.size() * sizeof(uint32_t), hash);
  hash = hash_bytes(scene.mesh.faces.data(), scene.mesh.faces.size() * sizeof(Face), hash);
  for (const raster::Texture& texture : scene.textures) hash = hash_pixels(texture.level(0), hash);
  return hash;
}

glm::vec3 position(const Mesh& mesh, const Face& face, uint32_t corner) {
  const float* p = mesh.vertices[mesh.indices[face.first + corner % face.count]].position;
  return {p[0], p[1], p[2]};
}

glm::vec3 newell_normal(const Mesh& mesh, const Face& face) {
  glm::vec3 sum(0.0f);
  for (uint32_t k = 0; k < face.count; ++k) sum += glm::cross(position(mesh, face, k), position(mesh, face, k + 1));
  return sum;
}

TEST_CASE("room has exactly the paper's 1131 polygons, whatever the seed") {
  CHECK(scene_set("room").fine.mesh.faces.size() == 1131);
  SceneBuilder builder("plain");
  builder.add_color("any", glm::vec3(0.5f));
  for (uint32_t seed = 0; seed < 100; ++seed) {
    const size_t before = builder.face_count();
    furnish_room(builder, RoomMaterials{}, seed);
    REQUIRE(builder.face_count() - before == 1131);
  }
}

TEST_CASE("pin has the paper's 75,467 and 3,153 polygons within one percent") {
  const SceneSet& pin = scene_set("pin");
  CHECK(std::abs(static_cast<double>(pin.fine.mesh.faces.size()) - 75467) <= 754.67);
  CHECK(std::abs(static_cast<double>(pin.coarse.mesh.faces.size()) - 3153) <= 31.53);
  CHECK(pin.width == 320);
  CHECK(pin.height == 800);
}

TEST_CASE("both dicings of the pin are closed but for the foot: every other edge has two faces, run opposite ways") {
  for (const Mesh* mesh : {&scene_set("pin").fine.mesh, &scene_set("pin").coarse.mesh}) {
    std::map<std::pair<uint32_t, uint32_t>, int> edges;
    for (const Face& face : mesh->faces)
      for (uint32_t k = 0; k < face.count; ++k)
        ++edges[{mesh->indices[face.first + k], mesh->indices[face.first + (k + 1) % face.count]}];
    size_t n_open = 0;
    for (const auto& [edge, count] : edges) {
      REQUIRE(count == 1);
      if (edges.count({edge.second, edge.first}) == 0) {
        ++n_open;
        REQUIRE(mesh->vertices[edge.first].position[1] == 0.0f);
        REQUIRE(mesh->vertices[edge.second].position[1] == 0.0f);
      }
    }
    CHECK(n_open == (mesh == &scene_set("pin").fine.mesh ? 224 : 48));
  }
}

TEST_CASE("every scene is valid, complete and faces outwards") {
  REQUIRE(builtin_scenes().size() >= 5);
  for (const BuiltinScene& builtin : builtin_scenes()) {
    CAPTURE(std::string(builtin.name));
    const SceneSet& set = scene_set(builtin);
    CHECK(set.width > 0);
    CHECK(set.height > 0);
    CHECK((set.local_colors.empty() || set.local_colors.size() == 4 * set.fine.mesh.vertices.size()));
    CHECK((std::string(set.default_split) != "tessellation" || !set.coarse.mesh.faces.empty()));
    REQUIRE_FALSE(set.fine.mesh.faces.empty());
    for (const raster::Scene* scene : {&set.fine, &set.coarse}) {
      const Mesh& mesh = scene->mesh;
      REQUIRE(validate(mesh, static_cast<uint32_t>(scene->materials.size())).ok());
      for (const raster::Material& material : scene->materials)
        REQUIRE(material.texture < static_cast<int32_t>(scene->textures.size()));
      for (const raster::Texture& texture : scene->textures) {
        REQUIRE_FALSE(texture.levels.empty());
        REQUIRE(texture.levels.back().width == 1);
        REQUIRE(texture.levels.back().height == 1);
      }
      int n_bad = 0;
      for (const Face& face : mesh.faces) {
        const glm::vec3 normal = newell_normal(mesh, face);
        n_bad += glm::length(normal) > 0.0f ? 0 : 1;
        for (uint32_t k = 0; k < face.count; ++k) {
          const Vertex& vertex = mesh.vertices[mesh.indices[face.first + k]];
          for (const float x : vertex.position) n_bad += std::isfinite(x) ? 0 : 1;
          for (const float x : vertex.texcoord) n_bad += std::isfinite(x) ? 0 : 1;
          const glm::vec3 n(vertex.normal[0], vertex.normal[1], vertex.normal[2]);
          n_bad += glm::dot(n, normal) > 0.0f && std::fabs(glm::length(n) - 1.0f) < 1e-3f ? 0 : 1;
        }
      }
      CHECK(n_bad == 0);
    }
  }
}

TEST_CASE("every frame of every camera path is finite and repeats after a while") {
  for (const BuiltinScene& builtin : builtin_scenes()) {
    CAPTURE(std::string(builtin.name));
    for (int frame = -3; frame < 500; ++frame) {
      const raster::Camera camera = builtin.camera(frame, 1.5f);
      int n_bad = 0;
      for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r) n_bad += std::isfinite(camera.clip_from_world[c][r]) ? 0 : 1;
      REQUIRE(n_bad == 0);
    }
    CHECK(builtin.camera(480, 1.0f).clip_from_world == builtin.camera(0, 1.0f).clip_from_world);
    CHECK(builtin.camera(1, 1.0f).clip_from_world != builtin.camera(0, 1.0f).clip_from_world);
  }
}

TEST_CASE("no frame of the walk sees out of the room through a crack") {
  const SceneSet& room = scene_set("room");
  constexpr int kSide = 192;
  auto renderer = raster::Renderer::create(kSide, kSide);
  REQUIRE(renderer.ok());
  RgbImage color(kSide, kSide);
  IdImage id(kSide, kSide);
  raster::RenderTargets targets;
  targets.color = color.view();
  targets.id = id.view();
  for (int frame = 0; frame < 240; frame += 12) {
    REQUIRE(renderer->render(room.fine, find_scene("room")->camera(frame, 1.0f), {}, targets).ok());
    int n_background = 0;
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) n_background += *id.pixel(x, y) == 0 ? 1 : 0;
    CHECK(n_background == 0);
  }
}

TEST_CASE(
    "the still of each scene shows its model whole (room: fills the picture), and textures carry most of the bits") {
  for (const BuiltinScene& builtin : builtin_scenes()) {
    CAPTURE(std::string(builtin.name));
    const SceneSet& set = scene_set(builtin);
    const int width = set.width / 2, height = set.height / 2;
    auto renderer = raster::Renderer::create(width, height);
    REQUIRE(renderer.ok());
    RgbImage high(width, height), low(width, height), difference(width, height);
    IdImage id(width, height);
    raster::RenderTargets targets;
    targets.color = high.view();
    targets.id = id.view();
    const raster::Camera camera = builtin.camera(0, static_cast<float>(set.width) / static_cast<float>(set.height));
    raster::RenderQuality quality;
    REQUIRE(renderer->render(set.fine, camera, quality, targets).ok());
    const bool is_room = std::string(builtin.name) == "room";
    int n_rim = 0;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        if (x == 0 || y == 0 || x == width - 1 || y == height - 1) n_rim += *id.pixel(x, y) != 0 ? 1 : 0;
    CHECK(n_rim == (is_room ? 2 * (width + height) - 4 : 0));
    quality.texture = false;
    targets = {};
    targets.color = low.view();
    const raster::Scene& client = set.coarse.mesh.faces.empty() ? set.fine : set.coarse;
    REQUIRE(renderer->render(client, camera, quality, targets).ok());
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < 3 * width; ++x)
        difference.row(y)[x] = static_cast<uint8_t>(127 + (high.row(y)[x] - low.row(y)[x]) / 2);
    CHECK(entropy_per_channel(difference.view()) < entropy_per_channel(high.view()) - 0.5);
  }
}

TEST_CASE("another seed gives other textures on the same letter") {
  const SceneSet other = find_scene("letter")->build(2);
  const SceneSet& one = scene_set("letter");
  CHECK(hash_pixels(other.fine.textures[0].level(0)) != hash_pixels(one.fine.textures[0].level(0)));
  CHECK(other.fine.mesh.vertices.size() == one.fine.mesh.vertices.size());
}

TEST_CASE("scenes are the same bits on every machine and compiler") {
  const std::map<std::string, uint64_t> golden = {
      {"room", 0x6dcc3a4086e2d623u},           {"pin", 0x4d0bff36e515ae0cu},   {"letter", 0xae1cdb6c43801082u},
      {"letter-texture", 0xae1cdb6c43801082u}, {"cubes", 0x1fe5ee55db970da9u},
  };
  for (const auto& entry : golden) {
    const std::string name = entry.first;
    CAPTURE(name);
    const SceneSet& set = scene_set(name.c_str());
    uint64_t actual = hash_scene(set.coarse, hash_scene(set.fine, kHashStart));
    actual = hash_bytes(set.local_colors.data(), set.local_colors.size(), actual);
    CHECK(actual == entry.second);
  }
}

}  // namespace
