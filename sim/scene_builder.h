// Builds a raster::Scene polygon by polygon: grids of quads with shared vertices, boxes, tubes; a frame to place them.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "raster/scene.h"
#include "sim/radiosity.h"

namespace pac::sim {

// A rectangle of texture: (u, v) = (u0 + s * du, v0 + (1 - t) * dv) at parameters s, t in [0, 1] of a patch.
struct TextureWindow {
  float u0 = 0, v0 = 0, du = 1, dv = 1;
  bool turned = false;  // exchange s and t: the texture's v runs along the patch's s
};

class SceneBuilder {
 public:
  explicit SceneBuilder(std::string name) { scene_.name = std::move(name); }

  // Materials. Unlit unless changed afterwards through material(). `color` is sRGB-encoded; a textured material's color
  // is its texture's mean.
  uint32_t add_color(std::string name, glm::vec3 color);
  uint32_t add_texture(std::string name, RgbaImage image, raster::Wrap wrap = raster::Wrap::repeat);
  raster::Material& material(uint32_t index) { return scene_.materials[index]; }
  void set_emission(uint32_t index, glm::vec3 radiosity) { optics_[index].emission = radiosity; }

  // Where the following shapes go: world = origin + right * x + up * y + forward * z, the axes turned about y by the
  // angle whose cosine and sine are given (the same bits everywhere, if the caller's are).
  void place(glm::vec3 origin, float cosine = 1.0f, float sine = 0.0f);

  // A grid of quads over the parallelogram origin + s * edge_s + t * edge_t, facing cross(edge_s, edge_t), with lines
  // at the given parameters (ascending in [0, 1]). Skips cells for which skip(i, j) is true.
  template <class Skip>
  void grid(glm::vec3 origin, glm::vec3 edge_s, glm::vec3 edge_t, const std::vector<float>& lines_s,
            const std::vector<float>& lines_t, uint32_t material, const TextureWindow& window, Skip&& skip);
  // The same with n_s by n_t equal cells.
  void patch(glm::vec3 origin, glm::vec3 edge_s, glm::vec3 edge_t, int n_s, int n_t, uint32_t material,
             const TextureWindow& window = {});

  // Which sides of a box to make, and how finely its sides are cut along each axis.
  enum Sides : unsigned { kLeft = 1, kRight = 2, kBottom = 4, kTop = 8, kBack = 16, kFront = 32, kAll = 63 };
  // An axis-parallel box (in the current frame). `repeat` = metres a repeat of the texture across and along the longer
  // side of each face.
  void box(glm::vec3 low, glm::vec3 high, uint32_t material, unsigned sides = kAll, glm::ivec3 cuts = glm::ivec3(1),
           glm::vec2 repeat = glm::vec2(0.25f, 1.0f));

  // A surface of revolution about the vertical through `center`: profile points (radius, height) from the lowest up,
  // outside seen from outside (`inward`: from the axis). A radius of 0 makes triangles.
  void revolve(glm::vec3 center, const std::vector<glm::vec2>& profile, int n_around, uint32_t material,
               bool inward = false, float repeats = 1.0f);

  // One planar polygon, counter-clockwise from its front, with its own vertices.
  void polygon(const std::vector<glm::vec3>& corners, const std::vector<glm::vec2>& texcoords, uint32_t material);

  // Raw access for shapes of their own.
  uint32_t add_vertex(glm::vec3 position, glm::vec3 normal, glm::vec2 texcoord);
  void add_face(std::initializer_list<uint32_t> corners, uint32_t material);

  size_t face_count() const { return scene_.mesh.faces.size(); }
  // How light leaves a material, for the radiosity solver.
  const FaceOptics& optics(uint32_t material) const { return optics_[material]; }
  void set_thin(uint32_t material) { optics_[material].thin = true; }
  raster::Scene& scene() { return scene_; }
  raster::Scene take() { return std::move(scene_); }

 private:
  glm::vec3 to_world(glm::vec3 p) const { return origin_ + direction(p); }
  glm::vec3 direction(glm::vec3 d) const { return {cosine_ * d.x + sine_ * d.z, d.y, cosine_ * d.z - sine_ * d.x}; }

  raster::Scene scene_;
  std::vector<FaceOptics> optics_;  // a material
  glm::vec3 origin_{0.0f};
  float cosine_ = 1.0f, sine_ = 0.0f;
};

// n + 1 lines from 0 to 1, equally far apart.
std::vector<float> equal_lines(int n);

template <class Skip>
void SceneBuilder::grid(glm::vec3 origin, glm::vec3 edge_s, glm::vec3 edge_t, const std::vector<float>& lines_s,
                        const std::vector<float>& lines_t, uint32_t material, const TextureWindow& window,
                        Skip&& skip) {
  const glm::vec3 normal = glm::normalize(glm::cross(edge_s, edge_t));
  const auto columns = static_cast<uint32_t>(lines_s.size());
  std::vector<uint32_t> made(lines_s.size() * lines_t.size(), UINT32_MAX);
  const auto vertex = [&](size_t i, size_t j) {
    uint32_t& index = made[j * columns + i];
    if (index == UINT32_MAX) {
      const float s = lines_s[i], t = lines_t[j];
      const float a = window.turned ? t : s, b = window.turned ? 1.0f - s : 1.0f - t;
      index =
          add_vertex(origin + edge_s * s + edge_t * t, normal, {window.u0 + a * window.du, window.v0 + b * window.dv});
    }
    return index;
  };
  for (size_t j = 0; j + 1 < lines_t.size(); ++j) {
    for (size_t i = 0; i + 1 < lines_s.size(); ++i) {
      if (skip(static_cast<int>(i), static_cast<int>(j))) continue;
      const uint32_t a = vertex(i, j), b = vertex(i + 1, j), c = vertex(i + 1, j + 1), d = vertex(i, j + 1);
      add_face({a, b, c, d}, material);
    }
  }
}

}  // namespace pac::sim
