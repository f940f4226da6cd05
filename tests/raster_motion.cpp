// Where each pixel was in the previous frame, and object transforms.
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "base/hash.h"
#include "base/kernels/kernels.h"
#include "raster/pose.h"
#include "raster/renderer.h"
#include "tests/support/raster_scenes.h"

namespace {

using namespace pac;
using namespace pac::raster;

constexpr int kWidth = 80, kHeight = 60;
using MotionImage = Image<float, 3>;

struct Frame {
  RgbImage color{kWidth, kHeight};
  DepthImage depth{kWidth, kHeight};
  IdImage id{kWidth, kHeight};
  MotionImage previous{kWidth, kHeight};
};

void draw(const Scene& scene, const Camera& camera, const Camera& previous, Frame& frame, int samples = 1,
          RendererOptions options = {}) {
  auto renderer = Renderer::create(kWidth, kHeight, options);
  REQUIRE(renderer.ok());
  RenderQuality quality;
  quality.samples = samples;
  RenderTargets targets{frame.color.view(), frame.depth.view(), frame.id.view()};
  targets.previous = frame.previous.view();
  targets.previous_camera = &previous;
  REQUIRE(renderer->render(scene, camera, quality, targets).ok());
}

Camera camera_at(float x) {
  return make_camera({x, 1.5f, 2.5f}, {0.1f * x, 1, 0}, {0, 1, 0}, 1.0f, float{kWidth} / kHeight, 0.1f, 20.0f);
}

glm::mat4 turned_about_y(double angle, glm::vec3 offset) {
  const auto c = static_cast<float>(exact_cos(angle)), s = static_cast<float>(exact_sin(angle));
  glm::mat4 m(1.0f);
  m[0] = {c, 0, -s, 0};
  m[2] = {s, 0, c, 0};
  m[3] = {offset.x, offset.y, offset.z, 1};
  return m;
}

TEST_CASE("what stands still under a camera that stands still was at its pixel's center") {
  for (const int samples : {1, 16}) {
    Frame frame;
    draw(test_scenes::room(), camera_at(0), camera_at(0), frame, samples);
    int seen = 0;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const float* p = frame.previous.pixel(x, y);
        if (*frame.id.pixel(x, y) == 0) {
          CHECK(p[0] == kNoPrevious);
          continue;
        }
        ++seen;
        CHECK(std::fabs(p[0] - (static_cast<float>(x) + 0.5f)) <= 1.0f / 256);
        CHECK(std::fabs(p[1] - (static_cast<float>(y) + 0.5f)) <= 1.0f / 256);
        CHECK(std::fabs(p[2] - *frame.depth.pixel(x, y)) < 1e-4f);
      }
    CHECK(seen > kWidth * kHeight / 2);
  }
}

// The same point by unprojecting the pixel in double precision and projecting it with the previous camera.
TEST_CASE("under a moving camera every pixel's previous position is its world point seen from there") {
  Frame frame;
  const Scene scene = test_scenes::room();
  const Camera now = camera_at(0.4f), before = camera_at(0);
  draw(scene, now, before, frame);
  int checked = 0;
  for (int y = 1; y < kHeight; y += 3)
    for (int x = 1; x < kWidth; x += 3) {
      const uint32_t id = *frame.id.pixel(x, y);
      const float* p = frame.previous.pixel(x, y);
      if (id == 0 || p[0] == kNoPrevious) continue;
      // Intersects the pixel's ray with the face's plane.
      const Mesh& mesh = scene.mesh;
      const Face& face = mesh.faces[id - 1];
      const auto corner = [&](uint32_t k) {
        const float* q = mesh.vertices[mesh.indices[face.first + k]].position;
        return glm::dvec3(q[0], q[1], q[2]);
      };
      const glm::dvec3 a = corner(0), e1 = corner(1) - a, e2 = corner(2) - a;
      const glm::dvec3 n{e1.y * e2.z - e1.z * e2.y, e1.z * e2.x - e1.x * e2.z, e1.x * e2.y - e1.y * e2.x};
      // clip.x = X w and clip.y = Y w are two planes through the eye: their intersection is the ray.
      const double X = (x + 0.5) / kWidth * 2 - 1, Y = 1 - (y + 0.5) / kHeight * 2;
      const auto row = [&](const glm::mat4& m, int r) { return glm::dvec4(m[0][r], m[1][r], m[2][r], m[3][r]); };
      const auto plane = [&](int r, double value) {
        const glm::dvec4 p1 = row(now.clip_from_world, r), p2 = row(now.clip_from_world, 3);
        return glm::dvec3(p1.x - value * p2.x, p1.y - value * p2.y, p1.z - value * p2.z);
      };
      const glm::dvec3 u = plane(0, X), v = plane(1, Y);
      const glm::dvec3 d{u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
      const glm::dvec3 eye(now.eye.x, now.eye.y, now.eye.z);
      const auto dot = [](glm::dvec3 s, glm::dvec3 t) { return s.x * t.x + s.y * t.y + s.z * t.z; };
      const double t = dot(a - eye, n) / dot(d, n);
      const glm::dvec3 world = eye + d * t;
      const auto clip = [&](int r) {
        const glm::dvec4 m = row(before.clip_from_world, r);
        return m.x * world.x + m.y * world.y + m.z * world.z + m.w;
      };
      const double px = (clip(0) / clip(3) + 1) * 0.5 * kWidth, py = (1 - clip(1) / clip(3)) * 0.5 * kHeight;
      CHECK(std::fabs(px - static_cast<double>(p[0])) < 0.03);
      CHECK(std::fabs(py - static_cast<double>(p[1])) < 0.03);
      ++checked;
    }
  CHECK(checked > 300);
}

Scene pin_on_the_move(double now, double before) {
  Scene scene = test_scenes::bumpy_pin(40, 40);
  Object object;
  object.vertex_count = static_cast<uint32_t>(scene.mesh.vertices.size());
  object.world_from_object = turned_about_y(now, {0.3f, 0, 0});
  object.previous_world_from_object = turned_about_y(before, {0, 0, 0});
  scene.objects = {object};
  return scene;
}

TEST_CASE("a moved object is drawn as its posed mesh, and its pixels were where the object was") {
  const Camera camera = test_scenes::pin_camera(float{kWidth} / kHeight);
  const Scene scene = pin_on_the_move(0.5, 0.2);
  Frame moved, posed, ids_before;
  draw(scene, camera, camera, moved);
  Scene still = scene;
  still.objects.clear();
  REQUIRE(pose_mesh(scene, still.mesh).ok());
  draw(still, camera, camera, posed);
  for (int y = 0; y < kHeight; ++y)
    REQUIRE(std::memcmp(moved.color.view().row(y), posed.color.view().row(y), 3 * kWidth) == 0);

  Scene before = scene;
  before.objects[0].world_from_object = scene.objects[0].previous_world_from_object;
  draw(before, camera, camera, ids_before);
  int same_place = 0, checked = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const float* p = moved.previous.pixel(x, y);
      if (p[0] == kNoPrevious) continue;
      const int px = static_cast<int>(std::floor(p[0])), py = static_cast<int>(std::floor(p[1]));
      if (px < 0 || px >= kWidth || py < 0 || py >= kHeight) continue;
      if (p[2] > *ids_before.depth.pixel(px, py) + 0.002f) continue;  // was hidden
      ++checked;
      // A facet is about a pixel: the same point is near the same depth.
      same_place += std::fabs(*ids_before.depth.pixel(px, py) - p[2]) < 0.004f ? 1 : 0;
    }
  CHECK(checked > 100);
  CHECK(same_place > checked * 9 / 10);
}

TEST_CASE("previous positions have the same bits on every instruction set and thread count") {
  const Scene scene = pin_on_the_move(1.0, 0.9);
  const Camera now = test_scenes::pin_camera(1.3f);
  RendererOptions options;
  options.isa = Isa::scalar;
  const auto hash = [&] {
    Frame frame;
    draw(scene, now, now, frame, 4, options);
    uint64_t h = 0;
    for (int y = 0; y < kHeight; ++y) h = hash_bytes(frame.previous.view().row(y), 3 * kWidth * sizeof(float), h);
    return h;
  };
  const uint64_t expected = hash();
  for (const Isa isa : {Isa::sse41, Isa::avx2, Isa::neon}) {
    if (kernels_for(isa) == nullptr) continue;
    options.isa = isa;
    for (const int threads : {1, 2, 7}) {
      options.threads = threads;
      CHECK(hash() == expected);
    }
  }
}

TEST_CASE("a point behind the previous camera has no previous position") {
  Frame frame;
  const Camera behind = make_camera({0, 1.5f, -30}, {0, 1.5f, -40}, {0, 1, 0}, 1.0f, 1.0f, 0.1f, 20.0f);
  draw(test_scenes::room(), camera_at(0), behind, frame);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) CHECK(frame.previous.pixel(x, y)[0] == kNoPrevious);
}

TEST_CASE("objects outside the mesh, transforms that are not finite and a missing previous camera are refused") {
  auto renderer = Renderer::create(kWidth, kHeight);
  Frame frame;
  const Camera camera = camera_at(0);
  Scene scene = pin_on_the_move(0, 0);
  const auto draws = [&] { return renderer->render(scene, camera, {}, {frame.color.view(), {}, {}}).ok(); };
  CHECK(draws());
  scene.objects[0].first_vertex = 1;
  CHECK(!draws());
  scene.objects[0].first_vertex = UINT32_MAX;
  CHECK(!draws());
  scene = pin_on_the_move(0, 0);
  scene.objects[0].previous_world_from_object[3][1] = NAN;
  CHECK(!draws());
  scene = pin_on_the_move(0, 0);
  RenderTargets targets{frame.color.view(), {}, {}};
  targets.previous = frame.previous.view();
  CHECK(!renderer->render(scene, camera, {}, targets).ok());
  Camera bad = camera;
  bad.clip_from_world[2][2] = INFINITY;
  targets.previous_camera = &bad;
  CHECK(!renderer->render(scene, camera, {}, targets).ok());
}

TEST_CASE("a mirrored or stretched object keeps its normals perpendicular to its surface and outward") {
  Scene scene;
  scene.materials.resize(1);
  Vertex v;
  v.normal[0] = v.normal[1] = 1;
  scene.mesh.vertices = {v};
  Object object;
  object.vertex_count = 1;
  object.world_from_object[0][0] = -4;
  scene.objects = {object};
  Mesh posed;
  REQUIRE(pose_mesh(scene, posed).ok());
  // The plane with normal (1, 1, 0) stretched by -4 along x has normal (-1/4, 1, 0) up to a positive factor.
  const float* n = posed.vertices[0].normal;
  CHECK(n[0] * 4 == -n[1]);
  CHECK(n[1] > 0);
}

}  // namespace
