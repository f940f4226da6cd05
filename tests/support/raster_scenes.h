// Procedural scenes for the rasterizer's tests and benchmarks. Only exact arithmetic: same bits everywhere.
#pragma once

#include <cmath>
#include <cstdint>

#include "base/exact_math.h"
#include "base/image.h"
#include "raster/scene.h"

namespace pac::test_scenes {

// A small generator with one state word (Numerical Recipes' ranqd1).
class Random {
 public:
  explicit Random(uint32_t seed) : state_(seed) {}
  uint32_t bits() {
    state_ = state_ * 1664525u + 1013904223u;
    return state_ >> 8;
  }
  float unit() { return static_cast<float>(bits()) * (1.0f / 16777216.0f); }
  float between(float low, float high) { return low + (high - low) * unit(); }

 private:
  uint32_t state_;
};

// Bricks, noise and a gradient: something to see at every mip level.
inline raster::Texture pattern_texture(int width, int height, uint32_t seed) {
  RgbaImage image(width, height);
  Random random(seed);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const int course = y * 8 / height;
      const bool mortar = (y * 8) % height < height / 6 || (x * 4 + course % 2 * width / 2) % width < width / 12;
      const auto noise = static_cast<int>(random.bits() % 48);
      uint8_t* p = image.pixel(x, y);
      p[0] = static_cast<uint8_t>((mortar ? 190 : 140 + static_cast<int>((seed * 37) % 60)) + noise);
      p[1] = static_cast<uint8_t>((mortar ? 185 : 60 + static_cast<int>((seed * 71) % 80)) + noise);
      p[2] = static_cast<uint8_t>((mortar ? 170 : 40 + static_cast<int>((seed * 13) % 90)) + x * 30 / width);
      p[3] = 255;
    }
  return raster::make_texture("pattern", image);
}

inline void add_quad(raster::Scene& scene, const glm::vec3 (&corner)[4], const float (&uv)[4][2], uint32_t material,
                     const uint8_t (&shade)[4]) {
  Mesh& mesh = scene.mesh;
  mesh.faces.push_back({static_cast<uint32_t>(mesh.indices.size()), 4, material});
  for (int i = 0; i < 4; ++i) {
    Vertex v;
    for (int c = 0; c < 3; ++c) v.position[c] = corner[i][c];
    v.texcoord[0] = uv[i][0];
    v.texcoord[1] = uv[i][1];
    for (int c = 0; c < 3; ++c) v.color[c] = shade[i];
    mesh.indices.push_back(static_cast<uint32_t>(mesh.vertices.size()));
    mesh.vertices.push_back(v);
  }
}

// A rectangle origin + s * across + t * up cut into n x m quads, with a smooth made-up radiosity.
inline void add_panel(raster::Scene& scene, glm::vec3 origin, glm::vec3 across, glm::vec3 up, int n, int m,
                      uint32_t material, float repeats) {
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < n; ++i) {
      glm::vec3 corner[4];
      float uv[4][2];
      uint8_t shade[4];
      for (int k = 0; k < 4; ++k) {
        const float s = static_cast<float>(i + (k == 1 || k == 2)) / static_cast<float>(n);
        const float t = static_cast<float>(j + (k >= 2)) / static_cast<float>(m);
        corner[k] = origin + across * s + up * t;
        uv[k][0] = s * repeats;
        uv[k][1] = (1 - t) * repeats;
        const float light = 0.35f + 0.6f * static_cast<float>(exact_sin(3.0 * static_cast<double>(s))) *
                                        static_cast<float>(exact_cos(1.3 * static_cast<double>(t)));
        shade[k] = static_cast<uint8_t>(255.0f * (light < 0 ? 0 : light > 1 ? 1 : light));
      }
      add_quad(scene, corner, uv, material, shade);
    }
}

inline void add_box(raster::Scene& scene, glm::vec3 low, glm::vec3 high, int n, uint32_t material) {
  const glm::vec3 size = high - low;
  const glm::vec3 x{size.x, 0, 0}, y{0, size.y, 0}, z{0, 0, size.z};
  add_panel(scene, low + z, x, y, n, n, material, 1);
  add_panel(scene, low + x, -x, y, n, n, material, 1);
  add_panel(scene, low, z, y, n, n, material, 1);
  add_panel(scene, low + x + z, -z, y, n, n, material, 1);
  add_panel(scene, low + y + z, x, -z, n, n, material, 1);
}

// A furnished box: 1131 quads, pre-lit vertex colors, six 256 x 256 textures.
inline raster::Scene room() {
  raster::Scene scene;
  scene.name = "test room";
  for (uint32_t i = 0; i < 6; ++i) {
    scene.textures.push_back(pattern_texture(256, 256, i + 1));
    raster::Material material;
    material.lit = false;
    material.texture = static_cast<int32_t>(i);
    scene.materials.push_back(material);
  }
  const glm::vec3 x{8, 0, 0}, y{0, 4, 0}, z{0, 0, 8};
  add_panel(scene, {-4, 0, 4}, x, -z, 16, 16, 0, 6);          // floor
  add_panel(scene, {-4, 4, -4}, x, z, 12, 12, 1, 3);          // ceiling
  add_panel(scene, {-4, 0, -4}, x, y, 14, 8, 2, 4);           // back
  add_panel(scene, {-4, 0, 4}, -z, y, 14, 8, 3, 4);           // left
  add_panel(scene, {4, 0, -4}, z, y, 14, 8, 4, 4);            // right
  add_box(scene, {-1.5f, 0.9f, -2}, {1.5f, 1.05f, 0}, 4, 5);  // table
  for (int leg = 0; leg < 4; ++leg) {
    const float lx = leg % 2 == 0 ? -1.4f : 1.3f, lz = leg < 2 ? -1.9f : -0.2f;
    add_box(scene, {lx, 0, lz}, {lx + 0.1f, 0.9f, lz + 0.1f}, 2, 5);
  }
  add_box(scene, {-3.6f, 0, -3.6f}, {-2.4f, 2.4f, -2.8f}, 4, 2);  // cupboard
  add_box(scene, {2.2f, 0, -3.2f}, {3.4f, 0.8f, -1.0f}, 3, 1);    // chest
  const size_t missing = 1131 - scene.mesh.faces.size();
  add_panel(scene, {-1.6f, 1.4f, -3.99f}, {3.2f, 0, 0}, {0, 1.8f, 0}, static_cast<int>(missing), 1, 0, 1);  // painting
  return scene;
}

inline raster::Camera room_camera(float aspect = 1, float step = 0) {
  return raster::make_camera({2.2f - step, 1.9f, 3.8f}, {-0.4f + step, 1.1f, -2.0f}, {0, 1, 0}, 1.1f, aspect, 0.1f,
                             50.0f);
}

// A bumpy surface of revolution of 2 * n * m triangles with normals and colors.
inline raster::Scene bumpy_pin(int n, int m) {
  raster::Scene scene;
  scene.name = "test pin";
  raster::Material material;
  material.specular = {0.5f, 0.5f, 0.5f};
  material.shininess = 40;
  material.two_sided = false;
  scene.materials.push_back(material);
  scene.ambient_light = {0.4f, 0.4f, 0.4f};
  scene.lights.push_back({raster::Light::Kind::point, {0, 0, -1}, {3, 4, 5}, {0.8f, 0.8f, 0.75f}, 0});
  scene.lights.push_back({raster::Light::Kind::directional, {0.8f, -0.4f, -0.45f}, {0, 0, 0}, {0.3f, 0.3f, 0.4f}, 0});
  Mesh& mesh = scene.mesh;
  for (int j = 0; j <= m; ++j)
    for (int i = 0; i < n; ++i) {
      const double t = static_cast<double>(j) / m, angle = 2 * kPi * i / n;
      const double profile = 0.08 + 0.5 * exact_sin(kPi * t) * (1.0 + 0.45 * exact_cos(5 * t)) +
                             0.02 * exact_sin(9 * angle) * exact_sin(17 * t);
      const double slope = (0.5 * kPi * exact_cos(kPi * t) * (1.0 + 0.45 * exact_cos(5 * t)) -
                            0.5 * exact_sin(kPi * t) * 0.45 * 5 * exact_sin(5 * t)) /
                           3.0;
      Vertex v;
      v.position[0] = static_cast<float>(profile * exact_cos(angle));
      v.position[1] = static_cast<float>(3 * t - 1.5);
      v.position[2] = static_cast<float>(profile * exact_sin(angle));
      const double length = std::sqrt(1 + slope * slope);
      v.normal[0] = static_cast<float>(exact_cos(angle) / length);
      v.normal[1] = static_cast<float>(-slope / length);
      v.normal[2] = static_cast<float>(exact_sin(angle) / length);
      v.texcoord[0] = static_cast<float>(i) / static_cast<float>(n) * 4;
      v.texcoord[1] = static_cast<float>(t) * 4;
      const bool stripe = t > 0.62 && t < 0.68;
      v.color[0] = 240;
      v.color[1] = stripe ? 40 : 235;
      v.color[2] = stripe ? 40 : 220;
      mesh.vertices.push_back(v);
    }
  const auto add = [&](uint32_t a, uint32_t b, uint32_t c) {
    mesh.faces.push_back({static_cast<uint32_t>(mesh.indices.size()), 3, 0});
    mesh.indices.insert(mesh.indices.end(), {a, b, c});
  };
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < n; ++i) {
      const auto a = static_cast<uint32_t>(j * n + i), b = static_cast<uint32_t>(j * n + (i + 1) % n);
      const auto c = a + static_cast<uint32_t>(n), d = b + static_cast<uint32_t>(n);
      add(a, d, b);
      add(a, c, d);
    }
  return scene;
}

inline raster::Camera pin_camera(float aspect = 1) {
  return raster::make_camera({0.6f, 0.7f, 4.2f}, {0, 0, 0}, {0, 1, 0}, 0.75f, aspect, 0.1f, 50.0f);
}

}  // namespace pac::test_scenes
