#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "sim/loaded_scene.h"
#include "sim/split.h"
#include "tests/support/small_scene.h"

namespace {

using namespace pac;

sim::Split split(const char* names, const sim::SceneSet& scene) {
  auto result = sim::make_split(names, scene);
  REQUIRE(result.ok());
  return *result;
}

std::string failure_text(const char* names, const sim::SceneSet& scene, int samples = 16) {
  const auto result = sim::make_split(names, scene, {samples});
  if (result.ok()) return "";
  CHECK(result.failure().error == Error::bad_argument);
  return result.failure().text;
}

TEST_CASE("texture: the sides differ by texture alone, and one traversal draws both") {
  const sim::SceneSet scene = test::small_scene(false);
  const sim::Split texture = split("texture", scene);
  CHECK(texture.high.texture);
  CHECK(!texture.low.texture);
  CHECK(texture.high.samples == 16);
  CHECK(texture.low.samples == 16);
  CHECK(texture.high.shading == texture.low.shading);
  CHECK(texture.single_pass());
}

TEST_CASE("shading: antialiased Phong with texture against aliased Gouraud without") {
  const sim::Split shading = split("shading", test::small_scene(true));
  CHECK(shading.high == raster::RenderQuality{raster::Shading::phong, true, 16, true});
  CHECK(shading.low == raster::RenderQuality{raster::Shading::gouraud, false, 1, true});
  CHECK(!shading.single_pass());
}

TEST_CASE("antialiasing: off on both sides, the client untextured") {
  const sim::Split aliased = split("antialiasing", test::small_scene(false));
  CHECK(aliased.high.samples == 1);
  CHECK(aliased.low.samples == 1);
  CHECK(aliased.high.texture);
  CHECK(!aliased.low.texture);
  CHECK(aliased.single_pass());
}

TEST_CASE("tessellation and lighting change the model that the client draws, not its quality") {
  const sim::SceneSet scene = test::small_scene(false);
  const sim::Split tessellation = split("tessellation", scene);
  CHECK(tessellation.high == tessellation.low);
  CHECK(sim::low_polygon_count(scene, tessellation) == scene.coarse.mesh.faces.size());
  CHECK(sim::low_scene(scene, tessellation).mesh.vertices.size() == scene.coarse.mesh.vertices.size());
  const sim::Split lighting = split("lighting", scene);
  CHECK(lighting.high == lighting.low);
  const raster::Scene low = sim::low_scene(scene, lighting);
  CHECK(low.mesh.vertices.size() == scene.fine.mesh.vertices.size());
  for (size_t i = 0; i < low.mesh.vertices.size(); ++i)
    REQUIRE(low.mesh.vertices[i].color[0] == scene.local_colors[4 * i]);
  CHECK(low.textures[0].width() == 64);
}

TEST_CASE("an untextured client is given no texels, only mean colors") {
  const sim::SceneSet scene = test::small_scene(false);
  const raster::Scene low = sim::low_scene(scene, split("texture", scene));
  REQUIRE(low.textures.size() == 1);
  CHECK(low.textures[0].width() == 1);
  CHECK(low.textures[0].mean_color() == scene.fine.textures[0].mean_color());
}

TEST_CASE("parts combine in any order, repeats ignored, the lower quality winning") {
  const sim::SceneSet scene = test::small_scene(false);
  const sim::Split both = split("tessellation,texture,texture", scene);
  CHECK(both.name == "texture,tessellation");
  CHECK(both.low_model == sim::Model::coarse);
  CHECK(!both.low.texture);
  const sim::Split aliased = split("antialiasing,shading", scene);
  CHECK(aliased.name == "shading,antialiasing");
  CHECK(aliased.high.samples == 1);
}

TEST_CASE("figure 5's letter is Phong-shaded on both sides, baked scenes are Gouraud-shaded") {
  CHECK(split("texture", test::small_scene(true)).low.shading == raster::Shading::phong);
  CHECK(split("texture", test::small_scene(false)).low.shading == raster::Shading::gouraud);
}

TEST_CASE("the lighting split of lit materials casts shadows in H alone, in one traversal") {
  sim::SceneSet lit = test::small_scene(true);
  lit.local_colors.clear();
  const sim::Split made = split("lighting", lit);
  CHECK(made.high.lighting == raster::Lighting::full);
  CHECK(made.low.lighting == raster::Lighting::local);
  CHECK(made.low_lighting == sim::Lighting::full);
  CHECK(made.single_pass());
  CHECK(split("texture", lit).high.lighting == raster::Lighting::local);
}

TEST_CASE("a split that the scene cannot do says why") {
  sim::SceneSet bare = test::small_scene(false);
  bare.coarse = {};
  bare.local_colors.clear();
  CHECK(failure_text("tessellation", bare).find("no coarse model") != std::string::npos);
  CHECK(failure_text("lighting", bare).find("neither lit materials nor baked lighting") != std::string::npos);
  const sim::SceneSet scene = test::small_scene(false);
  CHECK(failure_text("lighting,tessellation", scene).find("do not combine") != std::string::npos);
  for (const char* unknown : {"", ",", "texture,", "Texture", "textures", " texture", "texture;shading"})
    CHECK(failure_text(unknown, scene).find("unknown split") != std::string::npos);
  for (const int samples : {0, -1, 2, 3, 8, 65}) CHECK(!failure_text("texture", scene, samples).empty());
}

TEST_CASE("each part has a summary") {
  int parts = 0;
  for (const char* const* name = sim::split_names(); *name != nullptr; ++name, ++parts)
    CHECK(sim::split_summary(*name) != nullptr);
  CHECK(parts == 5);
  CHECK(sim::split_summary("none") == nullptr);
}

TEST_CASE("vertex clustering gives a loaded model a coarse twin with fewer polygons and valid indices") {
  sim::SceneSet scene = test::small_scene(true);
  const size_t fine = scene.fine.mesh.faces.size();
  REQUIRE(sim::add_coarse_model(scene, 12));
  CHECK(scene.coarse.mesh.faces.size() < fine);
  CHECK(scene.coarse.mesh.faces.size() > 10);
  CHECK(validate(scene.coarse.mesh, static_cast<uint32_t>(scene.coarse.materials.size())).ok());
  CHECK(sim::make_split("tessellation", scene).ok());
}

TEST_CASE("a model without extent has no coarse twin, but a camera") {
  sim::SceneSet scene;
  CHECK(!sim::add_coarse_model(scene));
  const raster::Camera camera = sim::fit_camera(scene.fine, 0, 1);
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) CHECK(std::isfinite(camera.clip_from_world[column][row]));
}

TEST_CASE("the fitted camera sees every vertex, in every frame of its orbit and at any aspect") {
  const sim::SceneSet scene = test::small_scene(true);
  for (const float aspect : {0.3f, 1.0f, 2.5f})
    for (int frame = 0; frame < 120; frame += 17) {
      const raster::Camera camera = sim::fit_camera(scene.fine, frame, aspect);
      for (const Vertex& vertex : scene.fine.mesh.vertices) {
        const glm::vec4 clip =
            camera.clip_from_world * glm::vec4(vertex.position[0], vertex.position[1], vertex.position[2], 1.0f);
        REQUIRE(clip.w > 0);
        for (int axis = 0; axis < 3; ++axis) REQUIRE(std::fabs(clip[axis]) <= clip.w);
      }
    }
}

TEST_CASE("a loaded scene without lights gets some, and a split that suits it") {
  raster::Scene loaded = test::small_scene(true).fine;
  loaded.lights.clear();
  const sim::SceneSet set = sim::scene_set_from(loaded);
  CHECK(set.fine.lights.size() == 2);
  CHECK(std::string(set.default_split) == "texture");
}

}  // namespace
