#include "tests/support/small_scene.h"

#include <cstdint>
#include <utility>
#include <vector>

#include "base/exact_math.h"

namespace pac::test {

namespace {

enum MaterialNumber : uint32_t { kTextured, kPlain, kShiny };

uint32_t add_vertex(Mesh& mesh, double x, double y, double z, glm::vec3 normal, double u, double v, int shade) {
  Vertex vertex;
  vertex.position[0] = static_cast<float>(x);
  vertex.position[1] = static_cast<float>(y);
  vertex.position[2] = static_cast<float>(z);
  for (int i = 0; i < 3; ++i) vertex.normal[i] = normal[i];
  vertex.texcoord[0] = static_cast<float>(u);
  vertex.texcoord[1] = static_cast<float>(v);
  for (int i = 0; i < 3; ++i) vertex.color[i] = static_cast<uint8_t>(shade - 20 * i);
  mesh.vertices.push_back(vertex);
  return static_cast<uint32_t>(mesh.vertices.size() - 1);
}

void add_face(Mesh& mesh, const std::vector<uint32_t>& corners, uint32_t material) {
  mesh.faces.push_back({static_cast<uint32_t>(mesh.indices.size()), static_cast<uint32_t>(corners.size()), material});
  mesh.indices.insert(mesh.indices.end(), corners.begin(), corners.end());
}

// A floor of n x n quads, brighter in the middle, and a wall behind it.
void add_floor_and_wall(Mesh& mesh, int n) {
  for (int part = 0; part < 2; ++part) {
    const auto first = static_cast<uint32_t>(mesh.vertices.size());
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) {
        const double x = -2 + 4.0 * i / n, t = -2 + 4.0 * j / n;
        const int shade = 230 - static_cast<int>(25 * (x * x + t * t));
        if (part == 0)
          add_vertex(mesh, x, -0.7, t, {0, 1, 0}, 2.0 * i / n, 2.0 * j / n, shade);
        else
          add_vertex(mesh, x, t + 1, -2, {0, 0, 1}, 2.0 * i / n, 2.0 * j / n, shade);
      }
    const auto row = static_cast<uint32_t>(n + 1);
    for (uint32_t j = 0; j < static_cast<uint32_t>(n); ++j)
      for (uint32_t i = 0; i < static_cast<uint32_t>(n); ++i) {
        const uint32_t a = first + j * row + i;
        if (part == 0)
          add_face(mesh, {a, a + row, a + row + 1, a + 1}, kTextured);
        else
          add_face(mesh, {a, a + 1, a + row + 1, a + row}, kTextured);
      }
  }
}

// A ball of `rings` rings; its colors are shaded as if lit from above, so that no light is needed.
void add_ball(Mesh& mesh, int rings, uint32_t material) {
  const auto first = static_cast<uint32_t>(mesh.vertices.size());
  const int sectors = 2 * rings;
  for (int j = 0; j <= rings; ++j)
    for (int i = 0; i <= sectors; ++i) {
      const double theta = kPi * j / rings, phi = 2 * kPi * i / sectors;
      const double x = exact_sin(theta) * exact_cos(phi), y = exact_cos(theta), z = -exact_sin(theta) * exact_sin(phi);
      add_vertex(mesh, 0.7 * x, 0.7 * y, 0.7 * z, {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)},
                 3.0 * i / sectors, 1.0 * j / rings, 140 + static_cast<int>(60 * y + 40 * x));
    }
  const auto row = static_cast<uint32_t>(sectors + 1);
  for (uint32_t j = 0; j < static_cast<uint32_t>(rings); ++j)
    for (uint32_t i = 0; i < static_cast<uint32_t>(sectors); ++i) {
      const uint32_t a = first + j * row + i;
      add_face(mesh, {a, a + row, a + row + 1, a + 1}, material);
    }
}

raster::Texture speckle() {
  RgbaImage image(64, 64);
  uint32_t state = 12345;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      state = state * 1664525u + 1013904223u;
      const int noise = static_cast<int>(state >> 27);
      const int check = ((x / 8 + y / 8) & 1) != 0 ? 190 : 90;
      for (int c = 0; c < 3; ++c) image.pixel(x, y)[c] = static_cast<uint8_t>(check + noise - 15 * c);
      image.pixel(x, y)[3] = 255;
    }
  return raster::make_texture("speckle", std::move(image));
}

raster::Scene model(bool lit, int rings) {
  raster::Scene scene;
  scene.name = "small";
  add_floor_and_wall(scene.mesh, 6);
  add_ball(scene.mesh, rings, lit ? kShiny : kPlain);
  scene.materials.resize(3);
  for (raster::Material& material : scene.materials) material.lit = lit;
  scene.materials[kTextured].texture = 0;
  scene.materials[kPlain].two_sided = false;
  scene.materials[kShiny].specular = glm::vec3(0.6f);
  scene.materials[kShiny].shininess = 20;
  scene.materials[kShiny].texture = 0;
  scene.textures.push_back(speckle());
  raster::Light light;
  light.direction = glm::vec3(-0.36f, -0.8f, -0.48f);
  scene.lights.push_back(light);
  scene.ambient_light = glm::vec3(0.5f);
  scene.background = glm::vec3(0.2f, 0.3f, 0.4f);
  return scene;
}

}  // namespace

sim::SceneSet small_scene(bool lit) {
  sim::SceneSet set;
  set.fine = model(lit, 24);
  set.coarse = model(lit, 6);
  for (const Vertex& vertex : set.fine.mesh.vertices)
    for (int i = 0; i < 4; ++i)
      set.local_colors.push_back(static_cast<uint8_t>(i < 3 ? 255 - (255 - vertex.color[i]) / 2 : 255));
  set.width = set.height = 96;
  return set;
}

raster::Camera small_camera(int frame, float aspect) {
  const double angle = 0.4 + 0.1 * frame;
  const glm::vec3 eye(static_cast<float>(3.2 * exact_sin(angle)), 0.8f, static_cast<float>(3.2 * exact_cos(angle)));
  return raster::make_camera(eye, glm::vec3(0, 0, 0), glm::vec3(0, 1, 0), 0.8f, aspect, 0.5f, 10.0f);
}

}  // namespace pac::test
