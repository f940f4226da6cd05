// The OBJ, PLY and glTF models of Debian's assimp-testmodels: each loads or is refused by name, and those that load are
// drawn.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>

#include "base/file_io.h"
#include "base/image_io.h"
#include "geomcodec/geomcodec.h"
#include "jpeg/jpeg.h"
#include "raster/fit_camera.h"
#include "raster/load_gltf.h"
#include "raster/load_ply.h"
#include "raster/renderer.h"
#include "tests/support/mesh_zoo.h"

namespace {

const std::string kModels = "/usr/share/assimp/models";

bool have_models() {
  if (std::filesystem::is_directory(kModels)) return true;
  const char* ci = std::getenv("CI");
  if (ci != nullptr && std::strcmp(ci, "true") == 0)
    FAIL_CHECK("assimp-testmodels is not installed");
  else
    MESSAGE("assimp-testmodels is not installed: skipped");
  return false;
}

pac::Result<pac::RgbaImage> decode_image(std::span<const uint8_t> bytes) {
  if (bytes.size() < 2 || bytes[0] != 0xFF || bytes[1] != 0xD8) return pac::decode_rgba(bytes);
  PAC_TRY(const pac::RgbImage rgb, pac::jpeg::decode(bytes));
  pac::RgbaImage rgba(rgb.width(), rgb.height());
  for (int y = 0; y < rgb.height(); ++y) {
    for (int x = 0; x < rgb.width(); ++x) {
      std::copy_n(rgb.pixel(x, y), 3, rgba.pixel(x, y));
      rgba.pixel(x, y)[3] = 255;
    }
  }
  return rgba;
}

pac::Result<pac::raster::LoadedScene> load(const std::filesystem::path& path) {
  const auto bytes = pac::read_file(path.string());
  REQUIRE(bytes.ok());
  pac::raster::AssetSource assets;
  assets.read = [folder = path.parent_path().string()](const std::string& name) {
    return pac::read_file(folder + "/" + name);
  };
  assets.decode_image = decode_image;
  return pac::raster::load_model(*bytes, assets);
}

struct Expected {
  const char* file;
  size_t n_faces;  // 0: refused
  size_t n_textures;
  const char* message;  // why it is refused
};

// Faces as the files write them.
const Expected kExpected[] = {
    {"OBJ/WusonOBJ.obj", 3732, 0, ""},
    {"OBJ/box.obj", 6, 1, ""},
    {"OBJ/box_UTF16BE.obj", 0, 0, "UTF-16 text: save the model as UTF-8"},
    {"OBJ/box_longline.obj", 6, 1, ""},
    {"OBJ/box_mat_with_spaces.obj", 6, 0, ""},
    {"OBJ/box_without_lineending.obj", 6, 1, ""},
    {"OBJ/concave_polygon.obj", 1, 0, ""},
    {"OBJ/cube_mtllib_after_g.obj", 12, 1, ""},
    {"OBJ/cube_usemtl.obj", 12, 1, ""},
    {"OBJ/cube_with_vertexcolors.obj", 12, 0, ""},
    {"OBJ/cube_with_vertexcolors_uni.obj", 12, 0, ""},
    {"OBJ/empty_mat.obj", 256, 0, ""},
    {"OBJ/multiple_spaces.obj", 1, 0, ""},
    {"OBJ/number_formats.obj", 1, 0, ""},  // 3.1+e2 is 3.1, as assimp and strtod read it
    {"OBJ/point_cloud.obj", 0, 0, "no faces: points and lines alone are not drawn"},
    {"OBJ/regr01.obj", 2710, 0, ""},
    {"OBJ/regr_3429812.obj", 3, 0, ""},
    {"OBJ/space_in_material_name.obj", 1, 0, ""},
    {"OBJ/spider.obj", 1368, 4, ""},
    {"OBJ/testline.obj", 0, 0, "no faces: points and lines alone are not drawn"},
    {"OBJ/testmixed.obj", 6, 1, ""},
    {"OBJ/testpoints.obj", 0, 0, "no faces: points and lines alone are not drawn"},
    {"PLY/Wuson.ply", 3732, 0, ""},
    {"PLY/cube.ply", 6, 0, ""},
    {"PLY/cube_binary.ply", 12, 0, ""},
    {"PLY/cube_uv.ply", 6, 0, ""},
    {"PLY/float-color.ply", 1, 0, ""},
    {"PLY/issue623.ply", 0, 0, "no faces: point clouds are not drawn"},
    {"PLY/points.ply", 0, 0, "no faces: point clouds are not drawn"},
    {"PLY/pond.0.ply", 0, 0, "no faces: point clouds are not drawn"},
    {"glTF/BoxTextured-glTF-Binary/BoxTextured.glb", 0, 0, "version of the GLB container is not 2"},
    {"glTF/BoxTextured-glTF/BoxTextured.gltf", 0, 0, "version of glTF is not 2"},
    {"glTF/CesiumMilkTruck/CesiumMilkTruck.gltf", 0, 0, "no asset version: not glTF 2.0"},
    {"glTF2/2CylinderEngine-glTF-Binary/2CylinderEngine.glb", 121496, 0, ""},
    {"glTF2/BoxBadNormals-glTF-Binary/BoxBadNormals.glb", 12, 0, ""},
    {"glTF2/BoxTexcoords-glTF/boxTexcoords.gltf", 12, 1, ""},
    {"glTF2/BoxTextured-glTF-Binary/BoxTextured.glb", 12, 1, ""},
    {"glTF2/BoxTextured-glTF-Embedded/BoxTextured.gltf", 12, 1, ""},
    {"glTF2/BoxTextured-glTF-techniqueWebGL/BoxTextured.gltf", 0, 0, "requires an unknown extension"},
    {"glTF2/BoxTextured-glTF/BoxTextured.gltf", 12, 1, ""},
    {"glTF2/BoxWithInfinites-glTF-Binary/BoxWithInfinites.glb", 0, 0, "number is not finite"},
    {"glTF2/ClearCoat-glTF/ClearCoatTest.gltf", 37116, 6, ""},
    {"glTF2/IndexOutOfRange/AllIndicesOutOfRange.gltf", 0, 0, "index out of range"},
    {"glTF2/IndexOutOfRange/IndexOutOfRange.gltf", 0, 0, "index out of range"},
    {"glTF2/MissingBin/BoxTextured.gltf", 0, 0, "buffer's file cannot be read"},
    {"glTF2/RecursiveNodes/RecursiveNodes.gltf", 0, 0, "nodes form a cycle"},
    {"glTF2/TestNoRootNode/NoScene.gltf", 0, 0, "names something that the file does not have"},
    {"glTF2/draco/2CylinderEngine.gltf", 0, 0, "requires the extension KHR_draco_mesh_compression"},
    {"glTF2/glTF-Sample-Models/AnimatedMorphCube-glTF/AnimatedMorphCube.gltf", 12, 0, ""},
    {"glTF2/issue_3269/texcoord_crash.gltf", 10, 1, ""},
    {"glTF2/textureTransform/TextureTransformTest.gltf", 24, 5, ""},
    {"glTF2/wrongTypes/badUint.gltf", 0, 0, "not a whole number of at least 0"},
    {"invalid/empty.obj", 0, 0, "no faces: points and lines alone are not drawn"},
    {"invalid/empty.ply", 0, 0, "no faces: points and lines alone are not drawn"},
    {"invalid/malformed.obj", 0, 0, "index 0: indices start at 1"},
    {"invalid/malformed2.obj", 5, 1, ""},
};

bool is_model(const std::filesystem::path& path) {
  const bool is_gltf = path.extension() == ".gltf" || path.extension() == ".glb";
  return path.extension() == ".obj" || path.extension() == ".ply" || (is_gltf && pac::raster::has_gltf());
}

TEST_CASE("every OBJ, PLY and glTF model of assimp loads with its faces and textures, or is refused by a named error") {
  if (!have_models()) return;
  size_t n_files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(kModels)) {
    if (!is_model(entry.path())) continue;
    const std::string name = std::filesystem::relative(entry.path(), kModels).string();
    CAPTURE(name);
    ++n_files;
    const auto expected =
        std::find_if(std::begin(kExpected), std::end(kExpected), [&](const Expected& e) { return name == e.file; });
    const auto loaded = load(entry.path());
    if (loaded.ok()) {
      REQUIRE(validate(loaded->scene.mesh, static_cast<uint32_t>(loaded->scene.materials.size())).ok());
      if (expected == std::end(kExpected)) continue;  // another version of the package
      REQUIRE(loaded->scene.mesh.faces.size() == expected->n_faces);
      REQUIRE(loaded->scene.textures.size() == expected->n_textures);
    } else {
      REQUIRE(loaded.failure().text[0] != 0);
      if (expected != std::end(kExpected)) REQUIRE(std::string(loaded.failure().text) == expected->message);
    }
  }
  REQUIRE(n_files >= 30);
}

TEST_CASE("what loads is drawn: the fitted camera shows all of it, every frame of the orbit at least a part") {
  if (!have_models()) return;
  constexpr int kWidth = 96, kHeight = 72;
  auto renderer = pac::raster::Renderer::create(kWidth, kHeight);
  REQUIRE(renderer.ok());
  for (const Expected& expected : kExpected) {
    const std::filesystem::path path = kModels + "/" + expected.file;
    if (expected.n_faces == 0 || !std::filesystem::exists(path) || !is_model(path)) continue;
    if (std::string(expected.file) == "OBJ/number_formats.obj") continue;  // its one triangle has no area
    CAPTURE(expected.file);
    const auto loaded = load(path);
    REQUIRE(loaded.ok());
    const float aspect = static_cast<float>(kWidth) / kHeight;
    for (const int frame : {-1, 0, 50}) {
      const pac::raster::Camera camera = frame < 0 ? pac::raster::fit_camera(loaded->scene, aspect)
                                                   : pac::raster::orbit_camera(loaded->scene, aspect, frame);
      pac::RgbImage picture(kWidth, kHeight);
      pac::IdImage id(kWidth, kHeight);
      pac::raster::RenderTargets targets;
      targets.color = picture.view();
      targets.id = id.view();
      REQUIRE(renderer->render(loaded->scene, camera, {}, targets).ok());
      size_t n_covered = 0, n_at_border = 0;
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          if (*id.pixel(x, y) == 0) continue;
          ++n_covered;
          n_at_border += x == 0 || y == 0 || x == kWidth - 1 || y == kHeight - 1 ? 1 : 0;
        }
      }
      // Flat models may stand edge-on in one frame of the orbit.
      REQUIRE((n_covered > (frame < 0 ? kWidth * kHeight / 40 : 20)));
      REQUIRE(n_at_border == 0);
    }
  }
}

TEST_CASE("models keep their faces through the geometry codec") {
  if (!have_models()) return;
  for (const char* name : {"OBJ/spider.obj", "OBJ/WusonOBJ.obj", "OBJ/regr01.obj", "PLY/cube_uv.ply",
                           "glTF2/BoxTextured-glTF/BoxTextured.gltf"}) {
    if (!is_model(name)) continue;
    CAPTURE(name);
    const auto loaded = load(kModels + "/" + name);
    REQUIRE(loaded.ok());
    const auto quantized = pac::geomcodec::quantize(loaded->scene.mesh, 14).value();
    const std::vector<uint8_t> bytes = pac::geomcodec::encode(quantized, {.keep_order = true}).value();
    REQUIRE(pac::test::same(pac::geomcodec::decode(bytes).value(), quantized));
  }
}

}  // namespace
