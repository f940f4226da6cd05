#include "raster/shadow_maps.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "raster/sample_pattern.h"

namespace pac::raster {
namespace {

using Row = double[4];

// Clip coordinates x, y, z, w as rows over (p, 1), and the size of a texel.
struct LightView {
  Row row[4] = {};
  double texel = 0;       // in units of the world, at the middle of the scene
  double depth_step = 0;  // window depth of one texel's size along the light, there
};

struct Box {
  double low[3] = {0, 0, 0}, high[3] = {0, 0, 0};
};

constexpr float kLargest = 0x1p50f;  // vertices beyond, and those that are not numbers, do not count

bool bounds_of(const Mesh& mesh, Box& box) {
  bool any = false;
  for (const Vertex& vertex : mesh.vertices) {
    const float* p = vertex.position;
    if (!(std::fabs(p[0]) <= kLargest && std::fabs(p[1]) <= kLargest && std::fabs(p[2]) <= kLargest)) continue;
    for (int c = 0; c < 3; ++c) {
      box.low[c] = any ? std::min(box.low[c], double{p[c]}) : double{p[c]};
      box.high[c] = any ? std::max(box.high[c], double{p[c]}) : double{p[c]};
    }
    any = true;
  }
  return any;
}

double dot(const double a[3], const double b[3]) {
  return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
}

bool normalize(double v[3]) {
  const double length = std::sqrt(dot(v, v));
  if (!(length > 1e-30 && length < 1e30)) return false;
  for (int c = 0; c < 3; ++c) v[c] /= length;
  return true;
}

void cross(const double a[3], const double b[3], double out[3]) {
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}

// Right, up and forward of a light's view.
bool axes_of(const Light& light, double axis[3][3]) {
  for (int c = 0; c < 3; ++c) axis[2][c] = static_cast<double>(light.direction[c]);
  if (!normalize(axis[2])) return false;
  const double y[3] = {0, 1, 0}, x[3] = {1, 0, 0};
  cross(axis[2], std::fabs(axis[2][1]) < 0.9 ? y : x, axis[0]);
  if (!normalize(axis[0])) return false;
  cross(axis[0], axis[2], axis[1]);
  return true;
}

// Least and greatest of axis . corner over the box.
void extent(const Box& box, const double axis[3], double& low, double& high) {
  low = high = 0;
  for (int c = 0; c < 3; ++c) {
    const double a = axis[c] * box.low[c], b = axis[c] * box.high[c];
    low += std::min(a, b);
    high += std::max(a, b);
  }
}

// The whole scene, seen in parallel.
bool directional_view(const Light& light, const Box& box, int side, LightView& view) {
  double axis[3][3], half[3];
  if (!axes_of(light, axis)) return false;
  double largest = 1e-6;
  for (int i = 0; i < 3; ++i) {
    double low, high;
    extent(box, axis[i], low, high);
    half[i] = 0.5 * (high - low);
    largest = std::max(largest, half[i]);
    view.row[i][3] = -0.5 * (low + high);
  }
  for (int i = 0; i < 3; ++i) {
    half[i] = 1.02 * std::max(half[i], 1e-3 * largest);  // nothing touches the border
    for (int c = 0; c < 3; ++c) view.row[i][c] = axis[i][c] / half[i];
    view.row[i][3] /= half[i];
  }
  std::fill_n(view.row[3], 3, 0.0);
  view.row[3][3] = 1;
  view.texel = 2 * std::max(half[0], half[1]) / side;
  view.depth_step = view.texel / (2 * half[2]);
  return true;
}

// What a cone of up to 80 degrees to each side holds.
bool spot_view(const Light& light, const Box& box, int side, LightView& view) {
  double axis[3][3], eye[3];
  if (!axes_of(light, axis)) return false;
  for (int c = 0; c < 3; ++c) {
    eye[c] = static_cast<double>(light.position[c]);
    if (!(std::fabs(eye[c]) <= double{kLargest})) return false;
  }
  double low, high;
  extent(box, axis[2], low, high);
  const double far_plane = 1.01 * (high - dot(axis[2], eye));
  if (!(far_plane > 1e-12)) return false;  // all behind it
  const double near_plane = 1e-3 * far_plane;
  const double cosine = std::min(std::max(static_cast<double>(light.cone_outer), 0.1736), 0.9999);
  const double tangent = 1.02 * std::sqrt(1 - cosine * cosine) / cosine;
  for (int i = 0; i < 3; ++i) {
    const double scale = i < 2 ? 1 / tangent : 1;
    for (int c = 0; c < 3; ++c) view.row[i == 2 ? 3 : i][c] = axis[i][c] * scale;
    view.row[i == 2 ? 3 : i][3] = -dot(axis[i], eye) * scale;
  }
  const double span = far_plane - near_plane;
  for (int c = 0; c < 4; ++c) view.row[2][c] = view.row[3][c] * ((far_plane + near_plane) / span);
  view.row[2][3] -= 2 * far_plane * near_plane / span;
  const double middle = std::max(0.5 * (low + high) - dot(axis[2], eye), 0.25 * far_plane);
  view.texel = 2 * tangent * middle / side;
  view.depth_step = far_plane * near_plane / span * view.texel / (middle * middle);
  return true;
}

// From clip coordinates to columns, rows and window depths. A point is looked up two texels off its surface and one
// nearer to the light: the filter reaches two texels to each side.
void set_lookup(const LightView& view, int side, ShadowMap& map) {
  map.side = side;
  for (int c = 0; c < 4; ++c) {
    const double x = view.row[0][c], y = view.row[1][c], z = view.row[2][c], w = view.row[3][c];
    map.m[0][c] = static_cast<float>(0.5 * side * (w + x));
    map.m[1][c] = static_cast<float>(0.5 * side * (w - y));
    map.m[2][c] = static_cast<float>(0.5 * (w + z));
    map.m[3][c] = static_cast<float>(w);
  }
  map.normal_offset = static_cast<float>(2 * view.texel);
  map.depth_bias = static_cast<float>(view.depth_step);
}

bool view_of(const Light& light, const Box& box, int side, LightView& view) {
  if (!light.casts_shadows || light.kind == Light::Kind::point) return false;
  return light.kind == Light::Kind::directional ? directional_view(light, box, side, view)
                                                : spot_view(light, box, side, view);
}

Camera camera_of(const LightView& view) {
  Camera camera;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      camera.clip_from_world[column][row] = static_cast<float>(view.row[row][column]);
  return camera;
}

}  // namespace

void paint_tiles(const PaintInput& input, const std::vector<std::unique_ptr<TilePainter>>& painters, ThreadPool& pool,
                 int first, int last) {
  std::atomic<int> next{first};
  pool.for_each(static_cast<int64_t>(painters.size()), [&](int64_t thread) {
    TilePainter& painter = *painters[static_cast<size_t>(thread)];
    for (int tile = next.fetch_add(1); tile < last; tile = next.fetch_add(1)) painter.paint(input, tile);
  });
}

Result<void> ShadowMaps::draw(const Scene& scene, const Mesh& mesh, int side, const Kernels& kernels, ThreadPool& pool,
                              const std::vector<std::unique_ptr<TilePainter>>& painters, ShadowScene& out) {
  out.by_maps = true;
  for (ShadowMap& map : out.maps) map.depths = nullptr;
  const int texels = std::clamp(side, 32, 8192) / 32 * 32;
  Box box;
  if (!bounds_of(mesh, box)) return {};
  depths_.resize(scene.lights.size());
  for (size_t i = 0; i < scene.lights.size() && i < kMaxKernelLights; ++i) {
    LightView view;
    if (!view_of(posed_light(scene, scene.lights[i]), box, texels, view)) continue;
    const Camera camera = camera_of(view);
    PAC_CHECK(prepare_depth_surfaces(scene, surfaces_));
    PaintInput input{};
    input.pattern = sample_pattern(1);
    const bool has_masks = std::any_of(surfaces_.begin(), surfaces_.end(),
                                       [](const Surface& surface) { return surface.alpha != AlphaMode::opaque; });
    const FrameInput frame{&scene,
                           &mesh,
                           &camera,
                           &kernels,
                           make_viewport(texels, texels),
                           sample_hull(input.pattern),
                           {&surfaces_, nullptr},
                           nullptr,
                           has_masks};
    const auto stats = draw_list_.build(frame, pool);
    if (!stats.ok()) return stats.failure();
    depths_[i].resize(static_cast<size_t>(texels) * static_cast<size_t>(texels));
    input.draw_list = &draw_list_;
    input.kernels = &kernels;
    input.width = input.height = texels;
    input.surfaces[0] = &surfaces_;
    input.has_transparent = true;
    input.depth = {depths_[i].data(), texels, texels, texels};
    paint_tiles(input, painters, pool, 0, draw_list_.tiles_x() * draw_list_.tiles_y());
    set_lookup(view, texels, out.maps[i]);
    out.maps[i].depths = depths_[i].data();
  }
  return {};
}

}  // namespace pac::raster
