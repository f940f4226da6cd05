#include "sim/screen_model.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

#include "raster/triangulate.h"
#include "sim/vertex_color.h"

namespace pac::sim {

namespace {

// A corner on its way through the clipper: homogeneous clip coordinates and color 0..255, perspective-correct because
// both are linear in clip space.
struct ClipCorner {
  double position[4];
  double color[3];
};
using Polygon = std::vector<ClipCorner>;

// Signed distances to the six planes of the view; inside where >= 0. A tiny w keeps the division defined.
constexpr int kPlanes = 7;
double plane_distance(const ClipCorner& corner, int plane) {
  const double* p = corner.position;
  if (plane == 6) return p[3] - 1e-9;
  const double coordinate = p[plane / 2];
  return plane % 2 == 0 ? p[3] + coordinate : p[3] - coordinate;
}

// Always from the inside corner towards the outside one, so that both polygons at an edge get the same point.
ClipCorner intersect(const ClipCorner& inside, double d_inside, const ClipCorner& outside, double d_outside) {
  const double t = d_inside / (d_inside - d_outside);
  ClipCorner corner;
  for (int i = 0; i < 4; ++i) corner.position[i] = inside.position[i] + t * (outside.position[i] - inside.position[i]);
  for (int i = 0; i < 3; ++i) corner.color[i] = inside.color[i] + t * (outside.color[i] - inside.color[i]);
  return corner;
}

// Sutherland-Hodgman against one plane.
void clip_against(int plane, const Polygon& in, Polygon& out) {
  out.clear();
  for (size_t i = 0; i < in.size(); ++i) {
    const ClipCorner& from = in[i];
    const ClipCorner& to = in[(i + 1) % in.size()];
    const double d_from = plane_distance(from, plane), d_to = plane_distance(to, plane);
    if (d_from >= 0) out.push_back(from);
    if (d_from >= 0 && d_to < 0) out.push_back(intersect(from, d_from, to, d_to));
    if (d_from < 0 && d_to >= 0) out.push_back(intersect(to, d_to, from, d_from));
  }
}

void clip_to_view(Polygon& polygon) {
  Polygon clipped;
  for (int plane = 0; plane < kPlanes && polygon.size() >= 3; ++plane) {
    clip_against(plane, polygon, clipped);
    std::swap(polygon, clipped);
  }
}

struct WindowCorner {
  double position[3];  // pixels, pixels, window depth in [0, 1]
  double color[3];
};

WindowCorner to_window(const ClipCorner& corner, int width, int height) {
  const double* p = corner.position;
  WindowCorner out;
  out.position[0] = (0.5 + 0.5 * p[0] / p[3]) * width;
  out.position[1] = (0.5 - 0.5 * p[1] / p[3]) * height;
  out.position[2] = 0.5 + 0.5 * p[2] / p[3];
  std::copy_n(corner.color, 3, out.color);
  return out;
}

// What is visible of the scene, as polygons of window corners.
struct WindowPolygons {
  std::vector<WindowCorner> corners;
  std::vector<uint32_t> counts;
};

ClipCorner to_clip(const glm::mat4& m, const Vertex& vertex, const CornerColor& color) {
  ClipCorner corner;
  for (int row = 0; row < 4; ++row)
    corner.position[row] = double{m[0][row]} * vertex.position[0] + double{m[1][row]} * vertex.position[1] +
                           double{m[2][row]} * vertex.position[2] + double{m[3][row]};
  for (int i = 0; i < 3; ++i) corner.color[i] = color.rgb[i];
  return corner;
}

bool finite(const ClipCorner& corner) {
  return std::isfinite(corner.position[0]) && std::isfinite(corner.position[1]) && std::isfinite(corner.position[2]) &&
         std::isfinite(corner.position[3]);
}

// Twice the area on the screen; positive where the corners run clockwise as seen (y down): a back face.
double signed_area(const std::vector<WindowCorner>& corners, size_t first) {
  double area = 0;
  for (size_t i = first; i < corners.size(); ++i) {
    const double* a = corners[i].position;
    const double* b = corners[i + 1 < corners.size() ? i + 1 : first].position;
    area += a[0] * b[1] - a[1] * b[0];
  }
  return area;
}

// A convex polygon stays convex under the clipper; others would fold.
bool is_convex(const Mesh& mesh, const Face& face) {
  const raster::FaceNormal n = raster::face_normal(mesh, face);
  const auto corner = [&](uint32_t k) { return mesh.vertices[mesh.indices[face.first + k % face.count]].position; };
  for (uint32_t k = 0; k < face.count; ++k) {
    const float* a = corner(k);
    const float* b = corner(k + 1);
    const float* c = corner(k + 2);
    const double u[3] = {double{b[0]} - a[0], double{b[1]} - a[1], double{b[2]} - a[2]};
    const double v[3] = {double{c[0]} - b[0], double{c[1]} - b[1], double{c[2]} - b[2]};
    if ((u[1] * v[2] - u[2] * v[1]) * n.x + (u[2] * v[0] - u[0] * v[2]) * n.y + (u[0] * v[1] - u[1] * v[0]) * n.z < 0)
      return false;
  }
  return true;
}

bool inside_view(const Polygon& polygon) {
  for (const ClipCorner& corner : polygon)
    for (int plane = 0; plane < kPlanes; ++plane)
      if (plane_distance(corner, plane) < 0) return false;
  return true;
}

// Gathers what of each face is visible.
class ViewClipper {
 public:
  ViewClipper(const raster::Scene& scene, const raster::Camera& camera, const raster::RenderQuality& quality, int width,
              int height)
      : scene_(scene), camera_(camera), quality_(quality), width_(width), height_(height) {}

  void add(const Face& face, const std::vector<CornerColor>& colors) {
    Polygon whole;
    for (uint32_t k = 0; k < face.count; ++k) {
      const Vertex& vertex = scene_.mesh.vertices[scene_.mesh.indices[face.first + k]];
      whole.push_back(to_clip(camera_.clip_from_world, vertex, colors[k]));
      if (!finite(whole.back())) return;
    }
    const bool culled = quality_.cull_back_faces && !scene_.materials[face.material].two_sided;
    if (inside_view(whole) || is_convex(scene_.mesh, face)) {
      add_convex(whole, culled);
      return;
    }
    for (const raster::CornerTriple& triangle : cutter_.cut(scene_.mesh, face)) {
      Polygon part;
      for (const uint32_t k : triangle.corner) part.push_back(whole[k]);
      add_convex(part, culled);
    }
  }
  const WindowPolygons& result() const { return result_; }

 private:
  void add_convex(Polygon& polygon, bool cull_back) {
    clip_to_view(polygon);
    if (polygon.size() < 3) return;
    const size_t first = result_.corners.size();
    for (const ClipCorner& corner : polygon) result_.corners.push_back(to_window(corner, width_, height_));
    if (cull_back && signed_area(result_.corners, first) >= 0) {
      result_.corners.resize(first);
      return;
    }
    result_.counts.push_back(static_cast<uint32_t>(polygon.size()));
  }

  const raster::Scene& scene_;
  const raster::Camera& camera_;
  const raster::RenderQuality& quality_;
  int width_, height_;
  raster::PolygonCutter cutter_;
  WindowPolygons result_;
};

Result<WindowPolygons> visible_polygons(const raster::Scene& scene, const raster::Camera& camera,
                                        const raster::RenderQuality& quality, int width, int height) {
  PAC_TRY(const VertexLighter lighter, VertexLighter::create(scene, camera));
  ViewClipper clipper(scene, camera, quality, width, height);
  std::vector<CornerColor> colors;
  for (const Face& face : scene.mesh.faces) {
    lighter.light_face(scene.mesh, face, colors);
    clipper.add(face, colors);
  }
  return clipper.result();
}

double highest_of(int bits) {
  return (1 << bits) - 1;
}

// 1/16 pixel in x and y, the rasterizer's order of magnitude, or the next power of two that still spans the window; in
// z the whole range of `bits` over the depths that occur.
geomcodec::Grid choose_grid(const std::vector<WindowCorner>& corners, int width, int height, int bits) {
  float step = 0.0625f;
  while (static_cast<double>(step) * highest_of(bits) < std::max(width, height)) step *= 2;
  double low = 1, high = 0;
  for (const WindowCorner& corner : corners) {
    low = std::min(low, corner.position[2]);
    high = std::max(high, corner.position[2]);
  }
  geomcodec::Grid grid;
  grid.bits = bits;
  grid.step[0] = grid.step[1] = step;
  grid.origin[2] = high > low ? static_cast<float>(low) : 0.0f;
  grid.step[2] = high > low ? static_cast<float>((high - low) / highest_of(bits)) : 1.0f;
  return grid;
}

geomcodec::QuantizedVertex quantize_corner(const WindowCorner& corner, const geomcodec::Grid& grid) {
  geomcodec::QuantizedVertex vertex;
  for (int axis = 0; axis < 3; ++axis) {
    const double steps = (corner.position[axis] - double{grid.origin[axis]}) / double{grid.step[axis]};
    vertex.position[axis] = static_cast<uint16_t>(std::clamp(std::floor(steps + 0.5), 0.0, highest_of(grid.bits)));
  }
  for (int i = 0; i < 3; ++i)
    vertex.color[i] = static_cast<uint8_t>(std::clamp(std::floor(corner.color[i] + 0.5), 0.0, 255.0));
  vertex.color[3] = 255;
  return vertex;
}

struct VertexHash {
  size_t operator()(const geomcodec::QuantizedVertex& vertex) const {
    uint64_t hash = 0xCBF29CE484222325u;
    for (const uint16_t p : vertex.position) hash = (hash ^ p) * 0x100000001B3u;
    for (const uint8_t c : vertex.color) hash = (hash ^ c) * 0x100000001B3u;
    return static_cast<size_t>(hash);
  }
};

// Grid points of equal position and color become one vertex, whichever polygons they come from: that is where the
// connectivity of the model survives the clipping.
class Welder {
 public:
  uint32_t number_of(const geomcodec::QuantizedVertex& vertex) {
    const auto [entry, added] = numbers_.try_emplace(vertex, static_cast<uint32_t>(vertices.size()));
    if (added) vertices.push_back(vertex);
    return entry->second;
  }
  std::vector<geomcodec::QuantizedVertex> vertices;

 private:
  std::unordered_map<geomcodec::QuantizedVertex, uint32_t, VertexHash> numbers_;
};

bool has_area(const std::vector<uint32_t>& corners, const std::vector<geomcodec::QuantizedVertex>& vertices) {
  int64_t area = 0;
  for (size_t i = 0; i < corners.size(); ++i) {
    const uint16_t* a = vertices[corners[i]].position;
    const uint16_t* b = vertices[corners[(i + 1) % corners.size()]].position;
    area += int64_t{a[0]} * b[1] - int64_t{a[1]} * b[0];
  }
  return area != 0;
}

geomcodec::QuantizedMesh quantize_polygons(const WindowPolygons& polygons, const geomcodec::Grid& grid) {
  geomcodec::QuantizedMesh mesh;
  mesh.position_bits = grid.bits;
  std::copy_n(grid.origin, 3, mesh.origin);
  std::copy_n(grid.step, 3, mesh.step);
  Welder welder;
  std::vector<uint32_t> corners;
  size_t next = 0;
  for (const uint32_t count : polygons.counts) {
    corners.clear();
    for (uint32_t k = 0; k < count; ++k) {
      const uint32_t number = welder.number_of(quantize_corner(polygons.corners[next + k], grid));
      if (corners.empty() || corners.back() != number) corners.push_back(number);
    }
    next += count;
    while (corners.size() > 1 && corners.back() == corners.front()) corners.pop_back();
    // A polygon that lost its area on the grid covers no sample: the fill rule gives it no pixel.
    if (corners.size() < 3 || !has_area(corners, welder.vertices)) continue;
    mesh.faces.push_back({static_cast<uint32_t>(mesh.indices.size()), static_cast<uint32_t>(corners.size()), 0});
    mesh.indices.insert(mesh.indices.end(), corners.begin(), corners.end());
  }
  mesh.vertices = std::move(welder.vertices);
  return mesh;
}

// Vertices that only dropped polygons used would cost bytes and draw nothing.
void drop_unused_vertices(geomcodec::QuantizedMesh& mesh) {
  constexpr uint32_t kUnused = UINT32_MAX;
  std::vector<uint32_t> renumbered(mesh.vertices.size(), kUnused);
  std::vector<geomcodec::QuantizedVertex> kept;
  for (uint32_t& index : mesh.indices) {
    uint32_t& number = renumbered[index];
    if (number == kUnused) {
      number = static_cast<uint32_t>(kept.size());
      kept.push_back(mesh.vertices[index]);
    }
    index = number;
  }
  mesh.vertices = std::move(kept);
}

// Window coordinates to clip space with w = 1: affine, so that colors are interpolated linearly on the screen.
raster::Camera window_camera(int width, int height) {
  raster::Camera camera;
  camera.clip_from_world = glm::mat4(0.0f);
  camera.clip_from_world[0][0] = 2.0f / static_cast<float>(width);
  camera.clip_from_world[1][1] = -2.0f / static_cast<float>(height);
  camera.clip_from_world[2][2] = 2.0f;
  camera.clip_from_world[3] = glm::vec4(-1.0f, 1.0f, -1.0f, 1.0f);
  return camera;
}

}  // namespace

Result<ScreenModel> encode_screen_model(const raster::Scene& scene, const raster::Camera& camera,
                                        const raster::RenderQuality& quality, int width, int height,
                                        int position_bits) {
  if (position_bits < 1 || position_bits > 16) return Failure{Error::bad_argument, 0, "position bits must be in 1..16"};
  PAC_CHECK(validate(scene.mesh, static_cast<uint32_t>(scene.materials.size())));
  PAC_TRY(const WindowPolygons polygons, visible_polygons(scene, camera, quality, width, height));
  geomcodec::QuantizedMesh mesh =
      quantize_polygons(polygons, choose_grid(polygons.corners, width, height, position_bits));
  drop_unused_vertices(mesh);
  ScreenModel model;
  model.polygons = mesh.faces.size();
  model.vertices = mesh.vertices.size();
  PAC_TRY(model.bytes, geomcodec::encode(mesh, {.effort = geomcodec::Effort::best}, &model.parts));
  return model;
}

Result<void> draw_screen_model(raster::Renderer& renderer, std::span<const uint8_t> bytes,
                               const raster::RenderQuality& quality, glm::vec3 background, RgbView low,
                               const Limits& limits) {
  PAC_TRY(const geomcodec::QuantizedMesh mesh, geomcodec::decode(bytes, limits));
  raster::Scene scene;
  scene.mesh = geomcodec::dequantize(mesh);
  scene.background = background;
  raster::Material material;
  material.lit = false;
  scene.materials.push_back(material);
  PAC_CHECK(validate(scene.mesh, 1, limits));
  PAC_CHECK(renderer.render(scene, window_camera(low.width, low.height), quality, {low, {}, {}}));
  return {};
}

}  // namespace pac::sim
