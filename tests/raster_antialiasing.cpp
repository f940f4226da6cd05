// Shading once a pixel under many coverage samples, against supersampling.
#include <doctest/doctest.h>

#include <cmath>
#include <utility>

#include "raster/renderer.h"
#include "tests/support/raster_scenes.h"

namespace {

using namespace pac;
using namespace pac::raster;

constexpr int kSide = 160;

struct Picture {
  RgbImage color{kSide, kSide};
  DepthImage depth{kSide, kSide};
  IdImage id{kSide, kSide};
};

Picture draw(const Scene& scene, const Camera& camera, bool texture, int samples, int shading_samples) {
  RenderQuality quality;
  quality.texture = texture;
  quality.samples = samples;
  quality.shading_samples = shading_samples;
  Picture picture;
  auto renderer = Renderer::create(kSide, kSide);
  REQUIRE(renderer.ok());
  REQUIRE(
      renderer->render(scene, camera, quality, {picture.color.view(), picture.depth.view(), picture.id.view()}).ok());
  return picture;
}

double psnr_db(const RgbImage& a, const RgbImage& b) {
  double sum = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      for (int c = 0; c < 3; ++c) {
        const double difference = a.pixel(x, y)[c] - b.pixel(x, y)[c];
        sum += difference * difference;
      }
  return 10 * std::log10(255.0 * 255.0 * 3 * kSide * kSide / sum);
}

TEST_CASE("edges are as smooth shaded once as supersampled, textures need four places a pixel") {
  const Scene scene = test_scenes::room();
  const Camera camera = test_scenes::room_camera(1);
  const RgbImage plain = draw(scene, camera, false, 64, 0).color, textured = draw(scene, camera, true, 64, 0).color;
  const double aliased = psnr_db(plain, draw(scene, camera, false, 1, 0).color);
  CHECK(psnr_db(plain, draw(scene, camera, false, 16, 1).color) > aliased + 7);
  CHECK(psnr_db(plain, draw(scene, camera, false, 16, 4).color) > aliased + 11);
  const double once = psnr_db(textured, draw(scene, camera, true, 16, 1).color);
  const double four = psnr_db(textured, draw(scene, camera, true, 16, 4).color);
  CHECK(once > psnr_db(textured, draw(scene, camera, true, 1, 0).color) + 3);
  CHECK(four > once + 3);
}

TEST_CASE("depth, ids and a flat picture do not depend on where colors are computed") {
  const Scene scene = test_scenes::room();
  const Camera camera = test_scenes::room_camera(1);
  const Picture every = draw(scene, camera, true, 16, 0), once = draw(scene, camera, true, 16, 1);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      REQUIRE(*every.depth.pixel(x, y) == *once.depth.pixel(x, y));
      REQUIRE(*every.id.pixel(x, y) == *once.id.pixel(x, y));
    }
  // One color a face and no texture: coverage alone makes the picture.
  Scene flat = scene;
  uint32_t state = 1;
  for (const Face& face : flat.mesh.faces) {
    state = state * 1664525 + 1013904223;
    for (uint32_t k = 0; k < face.count; ++k)
      for (uint32_t c = 0; c < 3; ++c)
        flat.mesh.vertices[flat.mesh.indices[face.first + k]].color[c] = static_cast<uint8_t>(state >> (8 + 8 * c));
  }
  flat.materials.resize(1);
  flat.materials[0] = Material{};
  flat.materials[0].lit = false;
  for (Face& face : flat.mesh.faces) face.material = 0;
  const RgbImage reference = draw(flat, camera, false, 16, 0).color;
  CHECK(psnr_db(reference, draw(flat, camera, false, 16, 1).color) > 45);
}

TEST_CASE("H supersampled and L shaded once come from one traversal as from two") {
  const Scene scene = test_scenes::room();
  const Camera camera = test_scenes::room_camera(1);
  RenderQuality high, low;
  high.samples = low.samples = 16;
  low.shading_samples = 1;
  low.texture = false;
  Picture h;
  RgbImage l(kSide, kSide);
  auto renderer = Renderer::create(kSide, kSide);
  REQUIRE(renderer.ok());
  RenderTargets targets;
  targets.color = h.color.view();
  REQUIRE(renderer->render_pair(scene, camera, high, low, targets, l.view(), {}).ok());
  const RgbImage high_alone = draw(scene, camera, true, 16, 0).color;
  const RgbImage low_alone = draw(scene, camera, false, 16, 1).color;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      for (int c = 0; c < 3; ++c) {
        REQUIRE(h.color.pixel(x, y)[c] == high_alone.pixel(x, y)[c]);
        REQUIRE(l.pixel(x, y)[c] == low_alone.pixel(x, y)[c]);
      }
}

TEST_CASE("places that are no fewer than the samples, or no quarter of a pixel, are bad arguments") {
  auto renderer = Renderer::create(8, 8);
  REQUIRE(renderer.ok());
  RgbImage image(8, 8);
  for (const auto& [samples, places] : {std::pair{1, 1}, {4, 4}, {16, 2}, {16, 16}, {16, -1}, {64, 5}}) {
    RenderQuality quality;
    quality.samples = samples;
    quality.shading_samples = places;
    const auto drawn =
        renderer->render(test_scenes::room(), test_scenes::room_camera(1), quality, {image.view(), {}, {}});
    REQUIRE(!drawn.ok());
    REQUIRE(drawn.failure().error == Error::bad_argument);
  }
}

}  // namespace
