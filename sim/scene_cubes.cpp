// The cubes of the paper's web page: lit, textured, seen from a camera that circles them.
#include "base/exact_math.h"
#include "sim/scene_builder.h"
#include "sim/scene_parts.h"
#include "sim/textures.h"
#include "sim/textures_noise.h"

namespace pac::sim {

namespace {

// Three axes of a cube, each half an edge long, turned about y and then about x.
struct CubeFrame {
  glm::vec3 x, y, z;
  CubeFrame(double yaw_rad, double pitch_rad, float half) {
    const auto cy = static_cast<float>(exact_cos(yaw_rad)), sy = static_cast<float>(exact_sin(yaw_rad));
    const auto cp = static_cast<float>(exact_cos(pitch_rad)), sp = static_cast<float>(exact_sin(pitch_rad));
    x = glm::vec3(cy, 0, -sy) * half;
    y = glm::vec3(sp * sy, cp, sp * cy) * half;
    z = glm::vec3(cp * sy, -sp, cp * cy) * half;
  }
};

void add_cube(SceneBuilder& builder, glm::vec3 center, const CubeFrame& frame, uint32_t material) {
  constexpr int kCuts = 4;  // a side: enough for highlights to survive Gouraud shading
  const glm::vec3 &x = frame.x, &y = frame.y, &z = frame.z;
  const auto side = [&](glm::vec3 out, glm::vec3 right, glm::vec3 up) {
    builder.patch(center + out - right - up, right * 2.0f, up * 2.0f, kCuts, kCuts, material);
  };
  side(z, x, y);
  side(-z, -x, y);
  side(x, -z, y);
  side(-x, z, y);
  side(y, x, -z);
  side(-y, x, z);
}

}  // namespace

SceneSet build_cubes(uint32_t seed) {
  SceneBuilder builder("cubes");
  const uint32_t materials[] = {
      builder.add_texture("brick", brick_wall(256, 256, seed + 1u)),
      builder.add_texture("oak", oak_planks(256, 256, seed + 2u)),
      builder.add_texture("marble", marble(256, 256, rgb8(226, 220, 208), rgb8(96, 92, 100), seed + 3u)),
      builder.add_texture("tartan", tartan(256, 256, seed + 4u)),
      builder.add_texture("flagstone", flagstones(256, 256, seed + 5u)),
      builder.add_texture("seascape", painted_seascape(256, 256, seed + 6u), raster::Wrap::clamp),
      builder.add_texture("composition", painted_abstract(256, 256, seed + 7u), raster::Wrap::clamp),
  };
  for (const uint32_t index : materials) {
    raster::Material& material = builder.material(index);
    material.lit = true;
    material.ambient = glm::vec3(0.25f);
    material.diffuse = glm::vec3(0.80f);
    material.specular = glm::vec3(0.35f);
    material.shininess = 24;
    material.two_sided = false;
  }
  SceneSet set;
  add_cube(builder, {0, 0, 0}, CubeFrame(0.3, 0.35, 1.2f), materials[0]);
  constexpr int kSatellites = 6;
  for (int k = 0; k < kSatellites; ++k) {
    const double angle = 2.0 * kPi * k / kSatellites + 0.35;
    const glm::vec3 center(2.6f * static_cast<float>(exact_sin(angle)), (k & 1) != 0 ? 1.55f : -1.55f,
                           2.6f * static_cast<float>(exact_cos(angle)));
    const size_t first = builder.scene().mesh.vertices.size();
    add_cube(builder, center, CubeFrame(0.7 * k + 0.2, 0.5 - 0.31 * k, 0.80f), materials[1 + k]);
    set.parts.push_back(part_since(builder.scene(), first));
  }
  set.fine = builder.take();
  raster::Light sun, fill, back;
  sun.direction = glm::normalize(glm::vec3(0.45f, -0.75f, -0.55f));
  sun.color = {0.85f, 0.82f, 0.76f};
  fill.direction = glm::normalize(glm::vec3(-0.8f, 0.25f, 0.3f));
  fill.color = {0.18f, 0.21f, 0.28f};
  back.direction = glm::normalize(glm::vec3(-0.35f, -0.45f, 0.85f));
  back.color = {0.50f, 0.46f, 0.42f};
  sun.radius = fill.radius = back.radius = 0.04f;
  set.fine.lights = {sun, fill, back};
  set.fine.background = rgb8(30, 34, 46);
  set.default_split = "texture";
  return set;
}

// Every second satellite turns about itself and bobs, neighbors against each other; the others rest.
Transforms cubes_motion(int frame, const std::vector<MovablePart>& parts) {
  Transforms transforms(parts.size(), glm::mat4(1.0f));
  const double phase = 2.0 * kPi * static_cast<double>(frame % 96) / 96.0;
  for (size_t k = 0; k < parts.size(); k += 2) {
    const double side = (k & 2) != 0 ? -1.0 : 1.0, shift[3] = {0, 0.35 * side * exact_sin(2.0 * phase), 0};
    transforms[k] = turned_about_y(parts[k].pivot, side * phase, shift);
  }
  return transforms;
}

raster::Camera cubes_camera(int frame, float aspect) {
  return orbit_camera(frame, aspect, {0.0f, -0.25f, 0.0f}, 10.6f, 2.6f, 0.12, 96, 0.76f);
}

}  // namespace pac::sim
