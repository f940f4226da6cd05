#include "raster/fit_camera.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/exact_math.h"

namespace pac::raster {
namespace {

constexpr double kFovY = 35.0 * kPi / 180.0;
constexpr double kAzimuth = 35.0 * kPi / 180.0;    // from the front (+z) towards the right (+x)
constexpr double kElevation = 20.0 * kPi / 180.0;  // above the horizon
constexpr double kMargin = 1.06;
constexpr double kHuge = 1e18;  // coordinates beyond it do not take part: distances must stay in the range of float

struct Point {
  double v[3] = {0, 0, 0};
};

double dot(const Point& a, const Point& b) {
  return (a.v[0] * b.v[0] + a.v[1] * b.v[1]) + a.v[2] * b.v[2];
}

// The positions that faces use, about the middle of their bounding box.
struct Cloud {
  Point center;
  std::vector<Point> points;
};

Cloud used_points(const Mesh& mesh) {
  Cloud cloud;
  std::vector<uint8_t> used(mesh.vertices.size());
  for (const uint32_t index : mesh.indices)
    if (index < used.size()) used[index] = 1;
  double low[3] = {kHuge, kHuge, kHuge}, high[3] = {-kHuge, -kHuge, -kHuge};
  for (size_t v = 0; v < used.size(); ++v) {
    const float* p = mesh.vertices[v].position;
    if (used[v] == 0 || !(std::fabs(p[0]) < kHuge && std::fabs(p[1]) < kHuge && std::fabs(p[2]) < kHuge)) continue;
    cloud.points.push_back({{p[0], p[1], p[2]}});
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::min<double>(low[axis], p[axis]);
      high[axis] = std::max<double>(high[axis], p[axis]);
    }
  }
  if (cloud.points.empty()) return cloud;
  for (int axis = 0; axis < 3; ++axis) cloud.center.v[axis] = 0.5 * (low[axis] + high[axis]);
  for (Point& point : cloud.points)
    for (int axis = 0; axis < 3; ++axis) point.v[axis] -= cloud.center.v[axis];
  return cloud;
}

struct Axes {
  Point right, up, back;  // back: from the model to the eye
};

Axes axes_at(double azimuth) {
  const double sa = exact_sin(azimuth), ca = exact_cos(azimuth), se = exact_sin(kElevation), ce = exact_cos(kElevation);
  return {{{ca, 0, -sa}}, {{-se * sa, ce, -se * ca}}, {{ce * sa, se, ce * ca}}};
}

// The shortest distance from the center at which every point is inside the frustum.
double fitting_distance(const Cloud& cloud, const Axes& axes, double tan_x, double tan_y) {
  double distance = 0;
  for (const Point& point : cloud.points) {
    const double side = std::max(std::fabs(dot(point, axes.right)) / tan_x, std::fabs(dot(point, axes.up)) / tan_y);
    distance = std::max(distance, side * kMargin + dot(point, axes.back));
  }
  return distance;
}

Camera camera_at(const Cloud& cloud, const Axes& axes, double distance, float aspect) {
  double radius = 0;
  for (const Point& point : cloud.points) radius = std::max(radius, dot(point, point));
  radius = std::sqrt(radius);
  if (!(radius > 1e-18)) radius = 1;
  if (!(distance > 0.01 * radius)) distance = 3 * radius;  // a single point, or none
  glm::vec3 eye, target, up;
  for (int axis = 0; axis < 3; ++axis) {
    target[axis] = static_cast<float>(cloud.center.v[axis]);
    eye[axis] = static_cast<float>(cloud.center.v[axis] + distance * axes.back.v[axis]);
    up[axis] = static_cast<float>(axes.up.v[axis]);
  }
  // Near and far enclose the bounding sphere.
  const double near_plane = std::max(distance - 1.05 * radius, 0.005 * distance);
  return make_camera(eye, target, up, static_cast<float>(kFovY), aspect, static_cast<float>(near_plane),
                     static_cast<float>(distance + 1.05 * radius));
}

double usable(float aspect) {
  return aspect > 1e-3f && aspect < 1e3f ? aspect : 1.0;
}

}  // namespace

Camera fit_camera(const Scene& scene, float aspect) {
  const Cloud cloud = used_points(scene.mesh);
  const Axes axes = axes_at(kAzimuth);
  const double tan_y = exact_tan(kFovY / 2), tan_x = tan_y * usable(aspect);
  return camera_at(cloud, axes, fitting_distance(cloud, axes, tan_x, tan_y), static_cast<float>(usable(aspect)));
}

Camera orbit_camera(const Scene& scene, float aspect, int frame) {
  const Cloud cloud = used_points(scene.mesh);
  const double tan_y = exact_tan(kFovY / 2), tan_x = tan_y * usable(aspect);
  constexpr int kSamples = 36;  // of the turn; the margin covers what lies between
  double distance = 0;
  for (int i = 0; i < kSamples; ++i)
    distance = std::max(distance, fitting_distance(cloud, axes_at(kAzimuth + 2 * kPi * i / kSamples), tan_x, tan_y));
  const int step = (frame % kOrbitFrames + kOrbitFrames) % kOrbitFrames;
  return camera_at(cloud, axes_at(kAzimuth + 2 * kPi * step / kOrbitFrames), distance,
                   static_cast<float>(usable(aspect)));
}

void set_default_lights(Scene& scene) {
  const auto light = [](glm::vec3 from, glm::vec3 color, float radius) {
    const float length = std::sqrt(from.x * from.x + from.y * from.y + from.z * from.z);
    Light result;
    result.direction = -from / length;
    result.color = color;
    result.radius = radius;
    return result;
  };
  scene.lights = {light({-0.4f, 1.0f, 1.0f}, {0.80f, 0.78f, 0.74f}, 0.10f),
                  light({1.0f, 0.3f, 0.3f}, {0.22f, 0.25f, 0.30f}, 0.25f),
                  light({0.2f, 0.6f, -1.0f}, {0.25f, 0.25f, 0.25f}, 0.10f)};
  scene.ambient_light = glm::vec3(0.25f);
  scene.background = glm::vec3(0.86f, 0.88f, 0.90f);
}

}  // namespace pac::raster
