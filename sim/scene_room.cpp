// The furnished room of figure 2: geometry, radiosity, the colors of its vertices, the walk through it [Levoy95 s.4.1].
#include "sim/scene_room.h"

#include "base/exact_math.h"
#include "sim/radiosity.h"
#include "sim/scene_parts.h"
#include "sim/textures_noise.h"

namespace pac::sim {

namespace {

// Places a part at (x, z), turned by `angle_rad` about y (0 = facing the camera's wall).
void place(SceneBuilder& builder, float x, float y, float z, double angle_rad = 0.0) {
  builder.place({x, y, z}, static_cast<float>(exact_cos(angle_rad)), static_cast<float>(exact_sin(angle_rad)));
}

// Exposure, then a shoulder that keeps the sun's patch below white: what a display shows of an irradiance.
double tone(double irradiance) {
  constexpr double kExposure = 1.35, kWhite = 4.0;
  const double x = irradiance * kExposure;
  return x * (1.0 + x / (kWhite * kWhite)) / (1.0 + x);
}

void encode(const glm::vec3& irradiance, const glm::vec3& surface, uint8_t* color) {
  for (int c = 0; c < 3; ++c) {
    const double level = srgb_from_linear(std::fmin(1.0, tone(static_cast<double>(irradiance[c])) * 1.25));
    color[c] = static_cast<uint8_t>(clamp01(static_cast<float>(level) * surface[c]) * 255.0f + 0.5f);
  }
  color[3] = 255;
}

// Vertex colors of `mesh` from irradiance. A textured surface's color is left to its texture; emitters shine by
// themselves.
std::vector<uint8_t> vertex_colors(const raster::Scene& scene, const std::vector<FaceOptics>& optics,
                                   const std::vector<glm::vec3>& irradiance) {
  std::vector<uint8_t> colors(irradiance.size() * 4, 255);
  for (size_t f = 0; f < scene.mesh.faces.size(); ++f) {
    const Face& face = scene.mesh.faces[f];
    const raster::Material& material = scene.materials[face.material];
    const bool emits = optics[f].emission.x > 0.0f;
    const glm::vec3 surface = material.texture >= 0 ? glm::vec3(1.0f) : material.diffuse;
    for (uint32_t k = 0; k < face.count; ++k) {
      const uint32_t vertex = scene.mesh.indices[face.first + k];
      encode(emits ? glm::vec3(50.0f) : irradiance[vertex], surface, &colors[size_t{vertex} * 4]);
    }
  }
  return colors;
}

}  // namespace

size_t furnish_room(SceneBuilder& builder, const RoomMaterials& m, uint32_t seed, std::vector<MovablePart>* parts) {
  const auto add_movable = [&](const auto& add) {
    const size_t first = builder.scene().mesh.vertices.size();
    add();
    if (parts != nullptr) parts->push_back(part_since(builder.scene(), first));
  };
  add_shell(builder, m);
  add_window(builder, m);
  add_fireplace(builder, m);
  place(builder, 3.58f, 0, 0.0f);
  add_bookshelf(builder, m, seed + 50u);
  place(builder, 0.32f, 0, 0.0f);
  add_cabinet(builder, m);
  add_book(builder, m, {0.55f, 0.78f, 0.10f}, {0.80f, 0.82f, 0.29f});
  place(builder, 4.15f, 0, 1.75f, -0.75);
  add_armchair(builder, m);
  place(builder, 4.82f, 0, 0.95f);
  add_lamp(builder, m);
  place(builder, 1.85f, 0, 4.2f, 0.12);
  add_table(builder, m);
  add_movable([&] { add_vase(builder, m, {-0.02f, 0.75f, -0.12f}); });
  add_fruit(builder, {0.28f, 0.79f, 0.05f}, 0.042f, m.apple);
  add_fruit(builder, {0.36f, 0.789f, 0.14f}, 0.040f, m.orange);
  add_book(builder, m, {0.08f, 0.75f, 0.10f}, {0.22f, 0.78f, 0.30f});
  place(builder, 2.85f, 0, 4.2f, -1.35);
  add_movable([&] { add_chair(builder, m); });
  place(builder, 1.6f, 0, 3.5f, 0.1);
  add_chair(builder, m);
  place(builder, 0, 0, 0);
  add_painting(builder, m, m.landscape, {2.4f, 1.92f, 0.46f}, {1, 0, 0}, {0, 0, 1}, 0.96f, 0.72f);
  add_painting(builder, m, m.still_life, {0.8f, 1.62f, 0.0f}, {1, 0, 0}, {0, 0, 1}, 0.62f, 0.54f);
  add_painting(builder, m, m.abstract, {0.0f, 1.58f, 0.55f}, {0, 0, -1}, {1, 0, 0}, 0.45f, 0.6f);
  add_painting(builder, m, m.seascape, {kRoomWidth, 1.6f, 3.2f}, {0, 0, 1}, {-1, 0, 0}, 1.0f, 0.75f);
  return add_rug_and_sun(builder, m);
}

SceneSet build_room(uint32_t seed) {
  SceneBuilder builder("room");
  const RoomMaterials materials = add_room_materials(builder, seed * 64u);
  SceneSet set;
  const size_t first_sunny = furnish_room(builder, materials, seed * 64u, &set.parts);

  set.fine = builder.take();
  const Mesh& mesh = set.fine.mesh;
  std::vector<FaceOptics> optics;
  for (size_t f = 0; f < mesh.faces.size(); ++f) {
    optics.push_back(builder.optics(mesh.faces[f].material));
    if (f >= first_sunny) optics[f].sun = glm::vec3(9.0f, 7.6f, 5.4f);
  }
  const Radiosity light = solve_radiosity(mesh, optics);
  const std::vector<uint8_t> colors = vertex_colors(set.fine, optics, light.vertex_irradiance);
  set.local_colors = vertex_colors(set.fine, optics, light.vertex_local);
  for (size_t v = 0; v < mesh.vertices.size(); ++v)
    for (size_t c = 0; c < 4; ++c) set.fine.mesh.vertices[v].color[c] = colors[4 * v + c];
  set.fine.background = rgb8(20, 18, 18);
  set.default_split = "texture";
  return set;
}

// The vase turns; the chair is drawn back from the table, swivels and returns. Baked light moves with them, and their
// shadows stay.
Transforms room_motion(int frame, const std::vector<MovablePart>& parts) {
  PAC_ASSERT(parts.size() == 2);
  const double phase = 2.0 * kPi * static_cast<double>(frame % 80) / 80.0;
  constexpr double kRests[3] = {0, 0, 0};
  const double drawn[3] = {0.3 * (0.5 - 0.5 * exact_cos(phase)), 0, 0};
  return {turned_about_y(parts[0].pivot, phase, kRests), turned_about_y(parts[1].pivot, 0.5 * exact_sin(phase), drawn)};
}

raster::Camera room_camera(int frame, float aspect) {
  // A walk: from the corner towards the fire and back, the gaze wandering from window to shelf.
  const double phase = 2.0 * kPi * static_cast<double>(frame % 240) / 240.0;
  const auto near = static_cast<float>(0.5 - 0.5 * exact_cos(phase)), side = static_cast<float>(exact_sin(phase));
  const glm::vec3 eye(4.35f - 1.0f * near + 0.35f * side, 1.55f, 6.15f - 1.3f * near);
  const glm::vec3 target(2.13f + 0.25f * near - 0.6f * side, 1.0f, 1.0f);
  return raster::make_camera(eye, target, {0, 1, 0}, 1.06f, aspect, 0.1f, 20.0f);
}

}  // namespace pac::sim
