// Whole pictures: the same bits from every instruction set, thread count, compiler and optimization level.
#include <doctest/doctest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "base/hash.h"
#include "base/kernels/kernels.h"
#include "raster/renderer.h"
#include "tests/support/raster_scenes.h"

namespace {

using namespace pac;
using namespace pac::raster;

struct Case {
  const char* name;
  Scene scene;
  Camera camera;
  RenderQuality quality;
  int width, height;
  uint64_t golden;  // color, depth and id
};

RenderQuality quality(Shading shading, bool texture, int samples, bool cull = false, int shading_samples = 0) {
  RenderQuality q;
  q.shading = shading;
  q.texture = texture;
  q.samples = samples;
  q.cull_back_faces = cull;
  q.shading_samples = shading_samples;
  return q;
}

Scene textured_pin() {
  Scene scene = test_scenes::bumpy_pin(32, 32);
  scene.textures.push_back(test_scenes::pattern_texture(61, 47, 3));
  scene.materials[0].texture = 0;
  return scene;
}

Scene room_with(Filter filter, Wrap wrap) {
  Scene scene = test_scenes::room();
  for (Material& m : scene.materials) {
    m.filter = filter;
    m.wrap = wrap;
  }
  return scene;
}

std::vector<Case> cases() {
  std::vector<Case> list;
  const Camera room = test_scenes::room_camera(), pin = test_scenes::pin_camera();
  list.push_back(
      {"room Gouraud", test_scenes::room(), room, quality(Shading::gouraud, false, 1), 96, 80, 0xf78c266b6df94edeu});
  list.push_back(
      {"room trilinear", test_scenes::room(), room, quality(Shading::gouraud, true, 1), 96, 80, 0x35804c6c6311afdbu});
  list.push_back({"room trilinear, 16 samples shaded once", test_scenes::room(), room,
                  quality(Shading::gouraud, true, 16, false, 1), 96, 80, 0x6366fff7958628fbu});
  list.push_back({"room Phong, 64 samples shaded at four places", test_scenes::room(), room,
                  quality(Shading::phong, true, 64, false, 4), 60, 50, 0xf34f90a4832d0a89u});
  list.push_back({"room Gouraud, 4 samples shaded once", test_scenes::room(), room,
                  quality(Shading::gouraud, false, 4, true, 1), 70, 40, 0x8f4a93ba0eca60bdu});
  list.push_back({"room bilinear clamped", room_with(Filter::bilinear, Wrap::clamp), room,
                  quality(Shading::gouraud, true, 1), 70, 40, 0x5b4afc533e91e006u});
  list.push_back({"room nearest, 4 samples", room_with(Filter::nearest, Wrap::repeat), room,
                  quality(Shading::gouraud, true, 4), 48, 48, 0xc733ef8b612dfc99u});
  list.push_back({"room trilinear, 16 samples", test_scenes::room(), room, quality(Shading::gouraud, true, 16), 33, 35,
                  0xe3cad722aa75bce3u});
  list.push_back({"pin flat, culled", test_scenes::bumpy_pin(40, 40), pin, quality(Shading::flat, false, 1, true), 64,
                  64, 0x6faf0298bace45c4u});
  list.push_back({"pin Gouraud, 64 samples", test_scenes::bumpy_pin(24, 24), pin, quality(Shading::gouraud, false, 64),
                  32, 32, 0x9440ae319d991282u});
  list.push_back({"pin Phong", test_scenes::bumpy_pin(40, 40), pin, quality(Shading::phong, false, 1), 64, 64,
                  0x5ad340efa949f863u});
  list.push_back({"textured pin Phong, 4 samples", textured_pin(), pin, quality(Shading::phong, true, 4), 48, 48,
                  0x5d7ae7929d373c50u});
  list.push_back({"textured pin Gouraud with specular", textured_pin(), pin, quality(Shading::gouraud, true, 1), 64, 64,
                  0xe20ba4e26aee28c7u});
  return list;
}

uint64_t render_hash(Renderer& renderer, const Case& c) {
  RgbImage color(c.width, c.height);
  DepthImage depth(c.width, c.height);
  IdImage id(c.width, c.height);
  REQUIRE(renderer.render(c.scene, c.camera, c.quality, {color.view(), depth.view(), id.view()}).ok());
  return hash_pixels(id.view(), hash_pixels(depth.view(), hash_pixels(color.view())));
}

TEST_CASE("pictures equal their golden hashes on every instruction set and thread count") {
  for (const Case& c : cases()) {
    INFO(std::string(c.name));
    for (int i = 0; i < kIsaCount; ++i) {
      RendererOptions options;
      options.isa = static_cast<Isa>(i);
      if (kernels_for(options.isa) == nullptr) continue;
      INFO(std::string(isa_name(options.isa)));
      for (const int threads : {1, 2, 3, 7}) {
        if (threads > 1 && options.isa != best_isa()) continue;
        CAPTURE(threads);
        options.threads = threads;
        auto renderer = Renderer::create(c.width, c.height, options);
        REQUIRE(renderer.ok());
        CHECK(render_hash(*renderer, c) == c.golden);
      }
    }
  }
}

TEST_CASE("a renderer that is used again, for other scenes in between, draws the same") {
  const std::vector<Case> list = cases();
  auto renderer = Renderer::create(64, 64);
  std::vector<uint64_t> first;
  for (int round = 0; round < 2; ++round)
    for (size_t i = 0; i < list.size(); i += 3) {
      Case c = list[i];
      c.width = c.height = 64;
      const uint64_t hash = render_hash(*renderer, c);
      if (round == 0)
        first.push_back(hash);
      else
        CHECK(hash == first[i / 3]);
    }
}

TEST_CASE(
    "depth and ids drawn without colors are those of a frame with colors; tiles that nothing touches are far and 0") {
  constexpr int kWidth = 100, kHeight = 70;  // tiles cut at both ends, most of them beside the pin
  const Scene scene = test_scenes::bumpy_pin(24, 24);
  const Camera camera = test_scenes::pin_camera(static_cast<float>(kWidth) / kHeight);
  for (const int samples : {1, 4, 16}) {
    RenderQuality quality;
    quality.samples = samples;
    auto renderer = Renderer::create(kWidth, kHeight);
    RgbImage color(kWidth, kHeight);
    DepthImage depth[2] = {DepthImage(kWidth, kHeight), DepthImage(kWidth, kHeight)};
    IdImage id[2] = {IdImage(kWidth, kHeight), IdImage(kWidth, kHeight)};
    REQUIRE(renderer->render(scene, camera, quality, {color.view(), depth[0].view(), id[0].view()}).ok());
    REQUIRE(renderer->render(scene, camera, quality, {{}, depth[1].view(), id[1].view()}).ok());
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        REQUIRE(*depth[0].pixel(x, y) == *depth[1].pixel(x, y));
        REQUIRE(*id[0].pixel(x, y) == *id[1].pixel(x, y));
      }
    CHECK(*id[1].pixel(kWidth / 2, kHeight / 2) != 0);
    CHECK(*id[1].pixel(1, 1) == 0);
    CHECK(*depth[1].pixel(1, 1) == 1.0f);
  }
}

bool equal(const RgbImage& a, const RgbImage& b) {
  return hash_pixels(a.view()) == hash_pixels(b.view());
}

TEST_CASE("H, L and D in one traversal equal two renderings and their difference") {
  struct Split {
    Scene scene;
    Camera camera;
    RenderQuality high, low;
  };
  std::vector<Split> splits;
  splits.push_back({test_scenes::room(), test_scenes::room_camera(), quality(Shading::gouraud, true, 4),
                    quality(Shading::gouraud, false, 4)});
  splits.push_back({textured_pin(), test_scenes::pin_camera(), quality(Shading::phong, true, 1, true),
                    quality(Shading::flat, false, 1, true)});
  splits.push_back({textured_pin(), test_scenes::pin_camera(), quality(Shading::gouraud, true, 1),
                    quality(Shading::phong, true, 1)});
  constexpr int kWidth = 75, kHeight = 50;
  for (const Split& s : splits)
    for (const int threads : {1, 3}) {
      RendererOptions options;
      options.threads = threads;
      auto renderer = Renderer::create(kWidth, kHeight, options);
      RgbImage h(kWidth, kHeight), l(kWidth, kHeight), d(kWidth, kHeight), h2(kWidth, kHeight), l2(kWidth, kHeight);
      DepthImage depth(kWidth, kHeight), depth2(kWidth, kHeight);
      REQUIRE(renderer->render(s.scene, s.camera, s.high, {h.view(), depth.view(), {}}).ok());
      REQUIRE(renderer->render(s.scene, s.camera, s.low, {l.view(), {}, {}}).ok());
      REQUIRE(
          renderer->render_pair(s.scene, s.camera, s.high, s.low, {h2.view(), depth2.view(), {}}, l2.view(), d.view())
              .ok());
      CHECK(equal(h, h2));
      CHECK(equal(l, l2));
      CHECK_FALSE(equal(h, l));
      CHECK(hash_pixels(depth.view()) == hash_pixels(depth2.view()));
      for (int y = 0; y < kHeight; ++y)
        for (int i = 0; i < 3 * kWidth; ++i) REQUIRE(d.row(y)[i] == 127 + (h.row(y)[i] - l.row(y)[i]) / 2);
    }
}

TEST_CASE("bands, as they are drawn, hold the rows of the whole picture") {
  const Scene scene = test_scenes::room();
  constexpr int kWidth = 75, kHeight = 2 * kBandRows + 9;
  const Camera camera = test_scenes::room_camera();
  for (const int threads : {1, 3})
    for (const int samples : {1, 16}) {
      const RenderQuality wanted = quality(Shading::gouraud, samples == 1, samples, true, samples == 1 ? 0 : 1);
      auto renderer = Renderer::create(kWidth, kHeight, {.threads = threads});
      REQUIRE(renderer.ok());
      RgbImage color(kWidth, kHeight), band_color(kWidth, kHeight);
      DepthImage depth(kWidth, kHeight), band_depth(kWidth, kBandRows);
      IdImage id(kWidth, kHeight), band_id(kWidth, kBandRows);
      REQUIRE(renderer->render(scene, camera, wanted, {color.view(), depth.view(), id.view()}).ok());
      int next = 0;
      bool equal = true;
      const auto drawn = [&](int first, int last) {
        equal = equal && first == next && last == std::min(first + kBandRows, kHeight);
        next = last;
        for (int y = first; y < last; ++y)
          equal = equal && std::equal(color.row(y), color.row(y) + 3 * kWidth, band_color.row(y)) &&
                  std::equal(depth.row(y), depth.row(y) + kWidth, band_depth.row(y - first)) &&
                  std::equal(id.row(y), id.row(y) + kWidth, band_id.row(y - first));
      };
      const RenderTargets bands{band_color.view(), band_depth.view(), band_id.view()};
      REQUIRE(renderer->render_bands(scene, camera, wanted, bands, drawn).ok());
      CHECK(equal);
      CHECK(next == kHeight);
      const RenderTargets whole{band_color.view(), depth.view(), id.view()};
      CHECK(!renderer->render_bands(scene, camera, wanted, whole, drawn).ok());
    }
}

TEST_CASE("an empty scene is its background, at depth 1 and id 0") {
  Scene scene;
  scene.background = {1.0f, 0.5f, 0.0f};
  for (const int samples : {1, 16}) {
    auto renderer = Renderer::create(33, 17);
    REQUIRE(renderer.ok());
    RgbImage color(33, 17);
    DepthImage depth(33, 17);
    IdImage id(33, 17);
    REQUIRE(renderer
                ->render(scene, test_scenes::room_camera(), quality(Shading::gouraud, true, samples),
                         {color.view(), depth.view(), id.view()})
                .ok());
    for (int y = 0; y < 17; ++y)
      for (int x = 0; x < 33; ++x) {
        REQUIRE(color.pixel(x, y)[0] == 255);
        REQUIRE(color.pixel(x, y)[1] == 128);
        REQUIRE(color.pixel(x, y)[2] == 0);
        REQUIRE(*depth.pixel(x, y) == 1.0f);
        REQUIRE(*id.pixel(x, y) == 0);
      }
  }
}

}  // namespace
