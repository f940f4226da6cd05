// Camera matrices, in double precision with exact_math, rounded to float once.
#include "base/exact_math.h"
#include "raster/scene.h"

namespace pac::raster {
namespace {

struct Direction {
  double x, y, z;
};

Direction cross(const Direction& a, const Direction& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
double dot(const Direction& a, const Direction& b) {
  return (a.x * b.x + a.y * b.y) + a.z * b.z;
}
// (0, 0, 0) stays (0, 0, 0), which makes the matrix singular.
Direction normalized(const Direction& v) {
  const double length = std::sqrt(dot(v, v));
  if (!(length > 0)) return {0, 0, 0};
  return {v.x / length, v.y / length, v.z / length};
}

}  // namespace

Camera make_camera(glm::vec3 eye, glm::vec3 target, glm::vec3 up, float fov_y_rad, float aspect, float near_plane,
                   float far_plane) {
  const Direction at{eye.x, eye.y, eye.z};
  const Direction back = normalized({at.x - target.x, at.y - target.y, at.z - target.z});
  const Direction right = normalized(cross({up.x, up.y, up.z}, back));
  const Direction above = cross(back, right);
  const double n = near_plane, f = far_plane;
  const double scale_y = 1.0 / exact_tan(0.5 * fov_y_rad), scale_x = scale_y / aspect;
  const double z_scale = (f + n) / (n - f), z_offset = 2.0 * f * n / (n - f);

  // Rows of view_from_world, scaled by the perspective matrix.
  const double rows[4][4] = {
      {scale_x * right.x, scale_x * right.y, scale_x * right.z, -scale_x * dot(right, at)},
      {scale_y * above.x, scale_y * above.y, scale_y * above.z, -scale_y * dot(above, at)},
      {z_scale * back.x, z_scale * back.y, z_scale * back.z, z_offset - z_scale * dot(back, at)},
      {-back.x, -back.y, -back.z, dot(back, at)},
  };
  Camera camera;
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) camera.clip_from_world[column][row] = static_cast<float>(rows[row][column]);
  camera.eye = eye;
  return camera;
}

}  // namespace pac::raster
