// Small pictures for tests of the renderer: drawn on any instruction set and thread count.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <array>

#include "base/hash.h"
#include "raster/renderer.h"

namespace pac::raster::test_pictures {

inline constexpr int kSide = 96;  // of every picture here

inline RgbImage draw(const Scene& scene, const Camera& camera, const RenderQuality& quality = {}, Isa isa = best_isa(),
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

inline uint64_t hash(const RgbImage& image) {
  return hash_pixels(image.view());
}

// The picture, after checking that scalar code and three threads give the same one.
inline RgbImage draw_everywhere(const Scene& scene, const Camera& camera, const RenderQuality& quality = {}) {
  RgbImage image = draw(scene, camera, quality);
  CHECK(hash(draw(scene, camera, quality, Isa::scalar)) == hash(image));
  CHECK(hash(draw(scene, camera, quality, best_isa(), 3)) == hash(image));
  return image;
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

// The square [-1, 1]^2 at depth z of Camera{}, which looks along +z of clip space: (u, v) = (0, 0) at the top left.
inline void add_square(Scene& scene, float z, uint32_t material, std::array<uint8_t, 4> color, float low = -1,
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

inline uint32_t add_material(Scene& scene, bool lit = false) {
  scene.materials.emplace_back();
  scene.materials.back().lit = lit;
  return static_cast<uint32_t>(scene.materials.size() - 1);
}

// Of rows [first_row, last_row): the sum over all channels.
inline double squared_error(const RgbImage& a, const RgbImage& b, int first_row, int last_row) {
  double sum = 0;
  for (int y = first_row; y < last_row; ++y)
    for (int i = 0; i < 3 * kSide; ++i) {
      const double d = a.view().row(y)[i] - b.view().row(y)[i];
      sum += d * d;
    }
  return sum;
}

inline RenderQuality phong() {
  RenderQuality quality;
  quality.shading = Shading::phong;
  return quality;
}

}  // namespace pac::raster::test_pictures
