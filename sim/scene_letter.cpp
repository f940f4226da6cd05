// Figures 4 and 5: an extruded letter of a few large polygons, lit, glossy and textured [Levoy95 s.4.3].
#include <vector>

#include "sim/scene_builder.h"
#include "sim/scene_parts.h"
#include "sim/textures.h"
#include "sim/textures_noise.h"

namespace pac::sim {

namespace {

// The outline of a bold S with cut corners, counter-clockwise seen from the front, about 4 x 6.
constexpr float kOutline[][2] = {
    {-1.35f, -3.0f},  {1.30f, -3.0f},   {2.0f, -2.3f},   {2.0f, -0.20f},   {1.45f, 0.60f},  {-0.70f, 0.60f},
    {-0.70f, 1.70f},  {0.70f, 1.70f},   {0.70f, 1.25f},  {2.0f, 1.25f},    {2.0f, 2.3f},    {1.35f, 3.0f},
    {-1.30f, 3.0f},   {-2.0f, 2.3f},    {-2.0f, 0.25f},  {-1.45f, -0.60f}, {0.70f, -0.60f}, {0.70f, -1.70f},
    {-0.70f, -1.70f}, {-0.70f, -1.15f}, {-2.0f, -1.15f}, {-2.0f, -2.35f},
};
constexpr float kHalfDepth = 0.75f, kBevel = 0.16f;

using Outline = std::vector<glm::vec2>;

// The outline moved inwards by `distance` (each corner along its miter).
Outline inset(const Outline& outline, float distance) {
  Outline moved;
  const size_t n = outline.size();
  for (size_t i = 0; i < n; ++i) {
    const glm::vec2 before = glm::normalize(outline[i] - outline[(i + n - 1) % n]);
    const glm::vec2 after = glm::normalize(outline[(i + 1) % n] - outline[i]);
    const glm::vec2 a(-before.y, before.x), b(-after.y, after.x);  // inward normals
    moved.push_back(outline[i] + (a + b) * (distance / (1.0f + glm::dot(a, b))));
  }
  return moved;
}

void extrude_letter(SceneBuilder& builder, uint32_t face, uint32_t side) {
  Outline outer;
  for (const auto& corner : kOutline) outer.push_back({corner[0], corner[1]});
  const Outline inner = inset(outer, kBevel);
  const size_t n = outer.size();
  constexpr float kScale = 1.0f / 3.0f;  // texture repeats a unit of length
  std::vector<glm::vec3> front, back;
  std::vector<glm::vec2> front_texture, back_texture;
  for (size_t i = 0; i < n; ++i) {
    front.push_back({inner[i].x, inner[i].y, kHalfDepth});
    front_texture.push_back({inner[i].x * kScale, -inner[i].y * kScale});
    const glm::vec2 turned = inner[n - 1 - i];
    back.push_back({turned.x, turned.y, -kHalfDepth});
    back_texture.push_back({turned.x * kScale, -turned.y * kScale});
  }
  builder.polygon(front, front_texture, face);
  builder.polygon(back, back_texture, face);
  float along = 0.0f;
  for (size_t i = 0; i < n; ++i) {
    const size_t k = (i + 1) % n;
    const glm::vec2 a = outer[i], b = outer[k], c = inner[i], d = inner[k];
    const float from = along * kScale;
    along += glm::length(b - a);
    const float to = along * kScale;
    const auto band = [&](glm::vec3 p, glm::vec3 q, glm::vec3 r, glm::vec3 s, float v_low, float v_high) {
      builder.polygon({p, q, r, s}, {{from, v_low}, {to, v_low}, {to, v_high}, {from, v_high}}, side);
    };
    const float edge = kHalfDepth - kBevel;
    band({a.x, a.y, edge}, {b.x, b.y, edge}, {d.x, d.y, kHalfDepth}, {c.x, c.y, kHalfDepth}, 0.08f, 0.0f);
    band({a.x, a.y, -edge}, {b.x, b.y, -edge}, {b.x, b.y, edge}, {a.x, a.y, edge}, 0.5f, 0.08f);
    band({c.x, c.y, -kHalfDepth}, {d.x, d.y, -kHalfDepth}, {b.x, b.y, -edge}, {a.x, a.y, -edge}, 0.58f, 0.5f);
  }
}

raster::Light point_light(glm::vec3 position, glm::vec3 color) {
  raster::Light light;
  light.kind = raster::Light::Kind::point;
  light.position = position;
  light.color = color;
  light.radius = 0.5f;  // soft boxes
  return light;
}

SceneSet letter(uint32_t seed, const char* split) {
  SceneBuilder builder("letter");
  const uint32_t face =
      builder.add_texture("walnut burl", wood_grain(512, 512, rgb8(226, 164, 98), rgb8(118, 62, 28), seed + 2u));
  const uint32_t side =
      builder.add_texture("veined marble", marble(256, 256, rgb8(206, 196, 186), rgb8(92, 78, 84), seed + 3u));
  for (const uint32_t index : {face, side}) {
    raster::Material& material = builder.material(index);
    material.lit = true;
    material.ambient = glm::vec3(0.22f);
    material.diffuse = glm::vec3(0.80f);
    material.specular = glm::vec3(0.65f);
    material.shininess = 28;
    material.two_sided = false;
  }
  extrude_letter(builder, face, side);
  SceneSet set;
  set.fine = builder.take();
  set.fine.lights = {point_light({-3.2f, 4.4f, 6.5f}, {0.85f, 0.82f, 0.78f}),
                     point_light({6.0f, 1.0f, 4.5f}, {0.22f, 0.26f, 0.34f})};
  set.fine.background = rgb8(38, 44, 58);
  set.default_split = split;
  return set;
}

}  // namespace

SceneSet build_letter(uint32_t seed) {
  return letter(seed, "shading");
}

SceneSet build_letter_texture(uint32_t seed) {
  return letter(seed, "texture");
}

raster::Camera letter_camera(int frame, float aspect) {
  return orbit_camera(frame, aspect, {0.0f, 0.0f, 0.0f}, 9.6f, 2.2f, 0.52, 120, 0.70f);
}

}  // namespace pac::sim
