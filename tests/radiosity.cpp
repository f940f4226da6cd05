#include "sim/radiosity.h"

#include <doctest/doctest.h>

#include <glm/glm.hpp>
#include <utility>

#include "sim/scene_builder.h"
#include "sim/textures_noise.h"

namespace {

using namespace pac;
using namespace pac::sim;

std::vector<FaceOptics> optics_of(SceneBuilder& builder) {
  std::vector<FaceOptics> optics;
  for (const Face& face : builder.scene().mesh.faces) optics.push_back(builder.optics(face.material));
  return optics;
}

// The inside of a unit cube, each side cut n by n; materials: floor (y = 0), ceiling, the four walls.
void add_closed_box(SceneBuilder& builder, int n, uint32_t floor, uint32_t ceiling, uint32_t walls) {
  const glm::vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1), o(0.0f);
  builder.patch(z, x, -z, n, n, floor);
  builder.patch(y, x, z, n, n, ceiling);
  builder.patch(o, x, y, n, n, walls);
  builder.patch(x + z, -x, y, n, n, walls);
  builder.patch(z, -z, y, n, n, walls);
  builder.patch(x, z, y, n, n, walls);
}

float brightness(const glm::vec3& color) {
  return color.x + color.y + color.z;
}

// The vertex nearest to a point.
size_t nearest_vertex(const Mesh& mesh, glm::vec3 point, glm::vec3 normal) {
  size_t best = 0;
  float best_distance = 1e30f;
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    const float *p = mesh.vertices[v].position, *n = mesh.vertices[v].normal;
    if (glm::dot(normal, glm::vec3(n[0], n[1], n[2])) < 0.9f) continue;
    const float d = glm::distance(point, glm::vec3(p[0], p[1], p[2]));
    if (d < best_distance) {
      best_distance = d;
      best = v;
    }
  }
  return best;
}

TEST_CASE("the ray caster finds the same first face as trying every triangle") {
  SceneBuilder builder("soup");
  const uint32_t grey = builder.add_color("grey", glm::vec3(0.5f));
  Random random(7);
  const auto point = [&](float size) {
    glm::vec3 p;
    for (int c = 0; c < 3; ++c) p[c] = random.range(-size, size);
    return p;
  };
  std::vector<Mesh> alone;
  for (int i = 0; i < 300; ++i) {
    const glm::vec3 at = point(1.0f), a = point(0.2f), b = point(0.2f);
    builder.polygon({at, at + a, at + b}, {{0, 0}, {0, 0}, {0, 0}}, grey);
    SceneBuilder single("one");
    single.add_color("grey", glm::vec3(0.5f));
    single.polygon({at, at + a, at + b}, {{0, 0}, {0, 0}, {0, 0}}, 0);
    alone.push_back(single.take().mesh);
  }
  std::vector<RayCaster> casters;
  for (const Mesh& mesh : alone) casters.emplace_back(mesh);
  const RayCaster caster(builder.scene().mesh);
  int n_hits = 0;
  for (int i = 0; i < 1000; ++i) {
    const glm::vec3 origin = point(1.5f), direction = point(1.0f);
    RayCaster::Hit expected, hit;
    bool any = false;
    for (uint32_t f = 0; f < casters.size(); ++f) {
      RayCaster::Hit one;
      if (casters[f].closest(origin, direction, any ? expected.distance : 1e30f, &one)) {
        expected = {one.distance, f, one.from_back};
        any = true;
      }
    }
    REQUIRE(caster.closest(origin, direction, 1e30f, &hit) == any);
    REQUIRE(caster.occluded(origin, direction, 1e30f) == any);
    if (!any) continue;
    ++n_hits;
    REQUIRE(hit.face == expected.face);
    REQUIRE(hit.distance == expected.distance);
    REQUIRE(hit.from_back == expected.from_back);
    REQUIRE_FALSE(caster.occluded(origin, direction, hit.distance));
  }
  CHECK(n_hits > 100);
}

TEST_CASE("form factors of a closed box sum to one in every row, and never to more") {
  SceneBuilder builder("box");
  const uint32_t grey = builder.add_color("grey", glm::vec3(0.5f));
  add_closed_box(builder, 4, grey, grey, grey);
  const Mesh& mesh = builder.scene().mesh;
  const FormFactors factors = form_factors(mesh, RayCaster(mesh), optics_of(builder), 256);
  REQUIRE(factors.row.size() == mesh.faces.size() + 1);
  for (size_t i = 0; i < mesh.faces.size(); ++i) {
    CHECK(factors.row_sum(i) <= 1.00001f);
    CHECK(factors.row_sum(i) >= 0.99f);
    CHECK(factors.between(i, static_cast<uint32_t>(i)) == 0.0f);
  }
}

TEST_CASE("form factors between unit squares match the analytic values, and are reciprocal") {
  SceneBuilder builder("squares");
  const uint32_t grey = builder.add_color("grey", glm::vec3(0.5f));
  const glm::vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  builder.patch(z, x, -z, 1, 1, grey);            // floor
  builder.patch(y, x, z, 1, 1, grey);             // facing it from one edge length above: 0.19982
  builder.patch(glm::vec3(0), x, y, 1, 1, grey);  // standing on its edge: 0.20004
  const Mesh& mesh = builder.scene().mesh;
  const FormFactors factors = form_factors(mesh, RayCaster(mesh), optics_of(builder), 8192);
  CHECK(factors.between(0, 1) == doctest::Approx(0.19982).epsilon(0.02));
  CHECK(factors.between(1, 0) == doctest::Approx(0.19982).epsilon(0.02));
  CHECK(factors.between(0, 2) == doctest::Approx(0.20004).epsilon(0.02));
  CHECK(factors.between(2, 0) == doctest::Approx(0.20004).epsilon(0.02));
}

TEST_CASE("a screen between two squares cuts their form factor to nothing") {
  SceneBuilder builder("screen");
  const uint32_t grey = builder.add_color("grey", glm::vec3(0.5f));
  const glm::vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  builder.patch(z, x, -z, 1, 1, grey);
  builder.patch(y, x, z, 1, 1, grey);
  builder.patch({-20, 0.5f, -20}, x * 41.0f, z * 41.0f, 1, 1, grey);
  builder.patch({-20, 0.5f, 21}, x * 41.0f, z * -41.0f, 1, 1, grey);
  const Mesh& mesh = builder.scene().mesh;
  const FormFactors factors = form_factors(mesh, RayCaster(mesh), optics_of(builder), 256);
  CHECK(factors.between(0, 1) == 0.0f);
  CHECK(factors.between(1, 0) == 0.0f);
}

TEST_CASE("in a closed box the light absorbed equals the light emitted") {
  SceneBuilder builder("box");
  const uint32_t grey = builder.add_color("grey", glm::vec3(0.6f)), lamp = builder.add_color("lamp", glm::vec3(0.6f));
  builder.set_emission(lamp, {3.0f, 2.0f, 1.0f});
  add_closed_box(builder, 5, grey, lamp, grey);
  const Mesh& mesh = builder.scene().mesh;
  const std::vector<FaceOptics> optics = optics_of(builder);
  RadiosityOptions options;
  options.rays_per_face = 512;
  options.samples_per_emitter = 400;
  const Radiosity light = solve_radiosity(mesh, optics, options);
  CHECK(light.residual < options.residual);
  CHECK(light.iterations >= 3);
  // All faces are equally large. Arriving = (B - E) / rho; absorbed = (1 - rho) * arriving.
  glm::dvec3 emitted(0.0), absorbed(0.0);
  for (size_t i = 0; i < optics.size(); ++i) {
    emitted += glm::dvec3(optics[i].emission);
    absorbed += glm::dvec3((1.0f - optics[i].reflectance) * (light.face_radiosity[i] - optics[i].emission) /
                           optics[i].reflectance);
  }
  for (int c = 0; c < 3; ++c) CHECK(absorbed[c] == doctest::Approx(emitted[c]).epsilon(0.03));
}

TEST_CASE("a box on the floor casts a shadow that local lighting does not know") {
  SceneBuilder builder("shadow");
  const uint32_t grey = builder.add_color("grey", glm::vec3(0.5f)), lamp = builder.add_color("lamp", glm::vec3(0.5f));
  builder.set_emission(lamp, glm::vec3(20.0f));
  add_closed_box(builder, 8, grey, grey, grey);
  builder.patch({0.45f, 0.98f, 0.45f}, {0.1f, 0, 0}, {0, 0, 0.1f}, 1, 1, lamp);  // under the ceiling, facing down
  builder.box({0.4f, 0.5f, 0.4f}, {0.6f, 0.55f, 0.6f}, grey);                    // a board half way down
  const Mesh& mesh = builder.scene().mesh;
  const Radiosity light = solve_radiosity(mesh, optics_of(builder));
  const size_t under = nearest_vertex(mesh, {0.5f, 0, 0.5f}, {0, 1, 0});
  const size_t beside = nearest_vertex(mesh, {0.125f, 0, 0.5f}, {0, 1, 0});
  CHECK(brightness(light.vertex_irradiance[under]) < 0.6f * brightness(light.vertex_irradiance[beside]));
  CHECK(brightness(light.vertex_irradiance[under]) > 0.0f);  // the walls' light reaches it
  CHECK(brightness(light.vertex_local[under]) > brightness(light.vertex_local[beside]));
}

TEST_CASE("a red wall colors the white floor beside it") {
  SceneBuilder builder("bleeding");
  const uint32_t white = builder.add_color("white", glm::vec3(0.9f)), lamp = builder.add_color("lamp", glm::vec3(0.9f));
  const uint32_t red = builder.add_color("red", {0.9f, 0.1f, 0.1f});
  builder.set_emission(lamp, glm::vec3(2.0f));
  const glm::vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  builder.patch(z, x, -z, 6, 6, white);
  builder.patch(y, x, z, 2, 2, lamp);
  builder.patch(z, -z, y, 4, 4, red);  // at x = 0
  builder.patch(x, z, y, 4, 4, white);
  const Mesh& mesh = builder.scene().mesh;
  const Radiosity light = solve_radiosity(mesh, optics_of(builder));
  const glm::vec3 near_red = light.vertex_irradiance[nearest_vertex(mesh, {0, 0, 0.5f}, y)];
  const glm::vec3 near_white = light.vertex_irradiance[nearest_vertex(mesh, {1, 0, 0.5f}, y)];
  CHECK(near_red.x / near_red.y > 1.1f * near_white.x / near_white.y);
}

TEST_CASE("floor vertices inside a solid take their neighbors' light instead of black") {
  SceneBuilder builder("solid");
  const uint32_t grey = builder.add_color("grey", glm::vec3(0.5f)), lamp = builder.add_color("lamp", glm::vec3(0.5f));
  builder.set_emission(lamp, glm::vec3(2.0f));
  add_closed_box(builder, 8, grey, lamp, grey);
  builder.box({0.3f, 0.0f, 0.3f}, {0.7f, 0.4f, 0.7f}, grey, SceneBuilder::kAll & ~SceneBuilder::kBottom);
  const Mesh& mesh = builder.scene().mesh;
  const Radiosity light = solve_radiosity(mesh, optics_of(builder));
  const glm::vec3 inside = light.vertex_irradiance[nearest_vertex(mesh, {0.5f, 0, 0.5f}, {0, 1, 0})];
  const glm::vec3 outside = light.vertex_irradiance[nearest_vertex(mesh, {0.25f, 0, 0.5f}, {0, 1, 0})];
  CHECK(brightness(inside) > 0.5f * brightness(outside));
}

TEST_CASE("the sun adds exactly its irradiance to the faces it reaches, and reflects from them") {
  SceneBuilder builder("sun");
  const uint32_t white = builder.add_color("white", glm::vec3(0.9f));
  const glm::vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  builder.patch(z, x, -z, 1, 1, white);
  builder.patch(y, x, z, 1, 1, white);
  const Mesh& mesh = builder.scene().mesh;
  std::vector<FaceOptics> optics = optics_of(builder);
  optics[0].sun = {1.0f, 0.5f, 0.25f};
  const Radiosity light = solve_radiosity(mesh, optics);
  const glm::vec3 sunny = light.vertex_irradiance[mesh.indices[mesh.faces[0].first]];
  const glm::vec3 above = light.vertex_irradiance[mesh.indices[mesh.faces[1].first]];
  CHECK(sunny.x > 1.0f);
  CHECK(sunny.x < 1.1f);
  CHECK(above.x > 0.05f);
  CHECK(above.x == doctest::Approx(2.0f * above.y).epsilon(0.01));
}

TEST_CASE("a model without faces or without light is dark, not an error") {
  CHECK(solve_radiosity(Mesh{}, {}).vertex_irradiance.empty());
  SceneBuilder builder("dark");
  add_closed_box(builder, 1, builder.add_color("grey", glm::vec3(0.5f)), 0, 0);
  const Radiosity light = solve_radiosity(builder.scene().mesh, optics_of(builder));
  for (const glm::vec3& irradiance : light.vertex_irradiance) CHECK(irradiance == glm::vec3(0.0f));
}

}  // namespace
