// Colors against references in double precision.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <vector>

#include "raster/renderer.h"
#include "tests/support/raster_scenes.h"

namespace {

using namespace pac;
using namespace pac::raster;

using Vec = std::array<double, 3>;
Vec operator-(const Vec& a, const Vec& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Vec operator+(const Vec& a, const Vec& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
Vec operator*(double s, const Vec& a) {
  return {s * a[0], s * a[1], s * a[2]};
}
double dot(const Vec& a, const Vec& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Vec unit(const Vec& a) {
  return 1 / std::sqrt(dot(a, a)) * a;
}

RgbImage draw(const Scene& scene, const Camera& camera, const RenderQuality& quality, int width, int height) {
  auto renderer = Renderer::create(width, height);
  REQUIRE(renderer.ok());
  RgbImage image(width, height);
  REQUIRE(renderer->render(scene, camera, quality, {image.view(), {}, {}}).ok());
  return image;
}

// Weights of a triangle's corners at a point of the screen in [-1, 1]: sum l_i clip_i is proportional to (x, y, ., 1).
bool weights_at(const Camera& camera, const Vec (&corner)[3], double x, double y, Vec& weights) {
  double a[3], b[3];  // sum l_i a_i = 0, sum l_i b_i = 0
  for (int i = 0; i < 3; ++i) {
    double clip[4];
    for (int row = 0; row < 4; ++row) {
      clip[row] = camera.clip_from_world[3][row];
      for (int k = 0; k < 3; ++k)
        clip[row] += static_cast<double>(camera.clip_from_world[k][row]) * corner[i][static_cast<size_t>(k)];
    }
    a[i] = clip[0] - x * clip[3];
    b[i] = clip[1] - y * clip[3];
  }
  weights = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  const double sum = weights[0] + weights[1] + weights[2];
  weights = 1 / sum * weights;
  return weights[0] >= 0 && weights[1] >= 0 && weights[2] >= 0;
}

Scene one_triangle(const Vec (&corner)[3], const uint8_t (&colors)[3][3]) {
  Scene scene;
  scene.materials.emplace_back();
  scene.materials[0].lit = false;
  for (uint32_t i = 0; i < 3; ++i) {
    Vertex v;
    for (size_t c = 0; c < 3; ++c) {
      v.position[c] = static_cast<float>(corner[i][c]);
      v.color[c] = colors[i][c];
    }
    scene.mesh.vertices.push_back(v);
    scene.mesh.indices.push_back(i);
  }
  scene.mesh.faces.push_back({0, 3, 0});
  return scene;
}

constexpr int kSide = 96;
double screen_x(int x) {
  return (x + 0.5) * 2 / kSide - 1;
}
double screen_y(int y) {
  return 1 - (y + 0.5) * 2 / kSide;
}

TEST_CASE("colors are interpolated perspective-correctly, to the rounding") {
  const Vec corners[3] = {{-1.5, -1, 0.5}, {2, -1.2, -9}, {0.3, 3, -4}};
  const uint8_t colors[3][3] = {{255, 0, 10}, {0, 255, 20}, {0, 30, 255}};
  const Scene scene = one_triangle(corners, colors);
  const Camera camera = make_camera({0, 0.2f, 2.5f}, {0, 0, -3}, {0, 1, 0}, 1.2f, 1, 0.1f, 100);
  const RgbImage image = draw(scene, camera, {}, kSide, kSide);
  int inside = 0;
  double error_if_affine = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      Vec w;
      if (!weights_at(camera, corners, screen_x(x), screen_y(y), w)) continue;
      if (std::min({w[0], w[1], w[2]}) < 0.01) continue;  // the snapped edge is somewhere here
      ++inside;
      for (size_t c = 0; c < 3; ++c) {
        const double expected = w[0] * colors[0][c] + w[1] * colors[1][c] + w[2] * colors[2][c];
        REQUIRE(std::fabs(image.pixel(x, y)[c] - expected) < 1.3);  // half a level, and 1/512 pixel of snapping
        error_if_affine = std::max(error_if_affine, std::fabs(expected - 85.0));
      }
    }
  CHECK(inside > 800);
  CHECK(error_if_affine > 50);
}

TEST_CASE("depth is linear on the screen and between the planes' 0 and 1") {
  const Vec corners[3] = {{-1.5, -1, 0.5}, {2, -1.2, -9}, {0.3, 3, -4}};
  const uint8_t colors[3][3] = {{255, 0, 10}, {0, 255, 20}, {0, 30, 255}};
  const Scene scene = one_triangle(corners, colors);
  const Camera camera = make_camera({0, 0.2f, 2.5f}, {0, 0, -3}, {0, 1, 0}, 1.2f, 1, 0.1f, 100);
  auto renderer = Renderer::create(kSide, kSide);
  DepthImage depth(kSide, kSide);
  IdImage id(kSide, kSide);
  REQUIRE(renderer->render(scene, camera, {}, {{}, depth.view(), id.view()}).ok());
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      REQUIRE((*id.pixel(x, y) == 0) == (*depth.pixel(x, y) == 1.0f));
      Vec w;
      if (*id.pixel(x, y) == 0 || !weights_at(camera, corners, screen_x(x), screen_y(y), w)) continue;
      double z = camera.clip_from_world[3][2], cw = camera.clip_from_world[3][3];
      for (size_t i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) {
          z += w[i] * camera.clip_from_world[k][2] * corners[i][static_cast<size_t>(k)];
          cw += w[i] * camera.clip_from_world[k][3] * corners[i][static_cast<size_t>(k)];
        }
      REQUIRE(*depth.pixel(x, y) == doctest::Approx(z / cw * 0.5 + 0.5).epsilon(0.0005));
    }
}

// A floor whose mip level i has the constant color 24 i.
Scene level_floor(int size, Filter filter) {
  Scene scene;
  RgbaImage image(size, size);
  Texture texture = make_texture("levels", image);
  for (size_t i = 0; i < texture.levels.size(); ++i) {
    const Texture::Level& level = texture.levels[i];
    std::fill_n(texture.texels.begin() + static_cast<ptrdiff_t>(4 * level.offset), 4 * level.pitch * level.height,
                static_cast<uint8_t>(24 * i));
  }
  scene.textures.push_back(texture);
  scene.materials.emplace_back();
  scene.materials[0].lit = false;
  scene.materials[0].texture = 0;
  scene.materials[0].filter = filter;
  test_scenes::add_quad(scene, {{-40, 0, 40}, {40, 0, 40}, {40, 0, -40}, {-40, 0, -40}},
                        {{0, 0}, {10, 0}, {10, 14}, {0, 14}}, 0, {255, 255, 255, 255});
  return scene;
}

// log2 of the texels a pixel covers along the longer axis, by central differences.
double reference_lod(const Camera& camera, int size, double x, double y) {
  const auto uv = [&](double sx, double sy, double(&out)[2]) {
    const Vec corners[3] = {{-40, 0, 40}, {40, 0, 40}, {40, 0, -40}};
    Vec w;
    weights_at(camera, corners, sx, sy, w);
    out[0] = size * (w[1] * 10 + w[2] * 10);
    out[1] = size * (w[2] * 14);
  };
  constexpr double kStep = 1e-4;
  double longest = 0;
  for (int axis = 0; axis < 2; ++axis) {
    const double dx = axis == 0 ? kStep : 0, dy = axis == 0 ? 0 : kStep;
    double a[2], b[2];
    uv(x + dx, y + dy, a);
    uv(x - dx, y - dy, b);
    longest = std::max(longest, std::hypot(a[0] - b[0], a[1] - b[1]) / (2 * kStep) * 2 / kSide);
  }
  return std::log2(longest);
}

TEST_CASE("mip levels follow the longer footprint axis within 1/16 level") {
  constexpr int kSize = 256;
  const Camera camera = make_camera({1, 1.5f, 8}, {0.5f, 0, 0}, {0.1f, 1, 0}, 1.0f, 1, 0.1f, 200);
  for (const int samples : {1, 4, 16}) {
    const Scene scene = level_floor(kSize, Filter::trilinear);
    RenderQuality quality;
    quality.samples = samples;
    const RgbImage image = draw(scene, camera, quality, kSide, kSide);
    std::set<int> seen;
    for (int y = kSide / 2; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        const double bias = samples == 1 ? 0 : samples == 4 ? 1 : 2;
        const double lod = std::clamp(reference_lod(camera, kSize, screen_x(x), screen_y(y)) - bias, 0.0, 8.0);
        if (samples == 1) REQUIRE(std::fabs(image.pixel(x, y)[0] / 24.0 - lod) < 0.0625);
        if (samples > 1 && lod > 0.1)
          REQUIRE(std::fabs(image.pixel(x, y)[0] / 24.0 - lod) < 0.2);  // the box filter curves
        seen.insert(static_cast<int>(lod));
      }
    if (samples == 1) CHECK(seen.size() >= 3);
  }
  const RgbImage nearest = draw(level_floor(kSize, Filter::nearest), camera, {}, kSide, kSide);
  for (int y = kSide / 2; y < kSide; ++y) {
    const double lod = std::max(reference_lod(camera, kSize, screen_x(40), screen_y(y)), 0.0);
    if (std::fabs(lod - std::floor(lod) - 0.5) > 0.06)
      REQUIRE(nearest.pixel(40, y)[0] == 24 * static_cast<int>(lod + 0.5));
  }
}

// A texture seen face on, one texel on `scale` pixels.
RgbImage face_on(const Texture& texture, Filter filter, Wrap wrap, float u0, float v0, float span, int side) {
  Scene scene;
  scene.textures.push_back(texture);
  scene.materials.emplace_back();
  scene.materials[0].lit = false;
  scene.materials[0].texture = 0;
  scene.materials[0].filter = filter;
  scene.materials[0].wrap = wrap;
  test_scenes::add_quad(scene, {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}},
                        {{u0, v0 + span}, {u0 + span, v0 + span}, {u0 + span, v0}, {u0, v0}}, 0, {255, 255, 255, 255});
  Camera camera;  // x, y straight through
  camera.eye = {0, 0, -1};
  return draw(scene, camera, {}, side, side);
}

TEST_CASE("bilinear filtering equals the textbook within 2 levels, wrapped and clamped, for odd sizes") {
  const int sizes[][2] = {{16, 16}, {5, 9}, {1, 4}, {1, 1}};
  for (const auto& size : sizes)
    for (const Wrap wrap : {Wrap::repeat, Wrap::clamp}) {
      const Texture texture = test_scenes::pattern_texture(size[0], size[1], 4);
      constexpr int kPixels = 128;
      const float u0 = -0.4f, v0 = -0.3f, span = 1.7f;
      const RgbImage image = face_on(texture, Filter::bilinear, wrap, u0, v0, span, kPixels);
      const ConstRgbaView level = texture.level(0);
      const auto index = [&](double i, int n) {
        const auto k = static_cast<int>(i);
        return wrap == Wrap::clamp ? std::clamp(k, 0, n - 1) : ((k % n) + n) % n;
      };
      for (int y = 0; y < kPixels; ++y)
        for (int x = 0; x < kPixels; ++x) {
          const double u = (static_cast<double>(u0) + static_cast<double>(span) * (x + 0.5) / kPixels) * size[0] - 0.5;
          const double v = (static_cast<double>(v0) + static_cast<double>(span) * (y + 0.5) / kPixels) * size[1] - 0.5;
          const double fx = u - std::floor(u), fy = v - std::floor(v);
          for (int c = 0; c < 3; ++c) {
            const auto texel = [&](double i, double j) {
              return level.pixel(index(std::floor(i), size[0]), index(std::floor(j), size[1]))[c];
            };
            const double expected = (1 - fy) * ((1 - fx) * texel(u, v) + fx * texel(u + 1, v)) +
                                    fy * ((1 - fx) * texel(u, v + 1) + fx * texel(u + 1, v + 1));
            REQUIRE(std::fabs(image.pixel(x, y)[c] - expected) < 2.0);
          }
        }
    }
}

TEST_CASE("nearest filtering shows each texel as a square, the first one in the top left corner") {
  const Texture texture = test_scenes::pattern_texture(8, 8, 2);
  const RgbImage image = face_on(texture, Filter::nearest, Wrap::clamp, 0, 0, 1, 64);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x)
      for (int c = 0; c < 3; ++c) REQUIRE(image.pixel(x, y)[c] == texture.level(0).pixel(x / 8, y / 8)[c]);
}

TEST_CASE("each mip level keeps the mean, for odd sizes too, and the last is one texel") {
  for (const auto& [w, h] : {std::pair{64, 64}, {37, 53}, {7, 1}, {1, 1}, {211, 16}}) {
    const Texture texture = test_scenes::pattern_texture(w, h, 9);
    double first = 0;
    for (size_t i = 0; i < texture.levels.size(); ++i) {
      const ConstRgbaView level = texture.level(i);
      double sum = 0;
      for (int y = 0; y < level.height; ++y)
        for (int x = 0; x < level.width; ++x) sum += level.pixel(x, y)[1];
      const double mean = sum / (level.width * level.height);
      if (i == 0) first = mean;
      CHECK(std::fabs(mean - first) < 0.6);
    }
    CHECK(texture.levels.back().width == 1);
    CHECK(texture.levels.back().height == 1);
    CHECK(std::fabs(texture.mean_color()[1] - first) < 0.6);
  }
}

TEST_CASE("without texturing the picture is the local mean of the textured one") {
  const Scene scene = test_scenes::room();
  RenderQuality high, low;
  high.samples = low.samples = 4;
  low.texture = false;
  const RgbImage h = draw(scene, test_scenes::room_camera(), high, 128, 128);
  const RgbImage l = draw(scene, test_scenes::room_camera(), low, 128, 128);
  double difference = 0;
  for (int y = 0; y < 128; ++y)
    for (int i = 0; i < 3 * 128; ++i) difference += h.row(y)[i] - l.row(y)[i];
  CHECK(std::fabs(difference / (3 * 128 * 128)) < 1.5);
}

// Lit quad in the plane z = 0, seen at an angle.
Scene lit_quad(bool two_quads_turned_over = false) {
  Scene scene;
  scene.materials.emplace_back();
  Material& m = scene.materials[0];
  m.ambient = {0.1f, 0.2f, 0.1f};
  m.diffuse = {0.5f, 0.4f, 0.3f};
  m.specular = {0.6f, 0.5f, 0.4f};
  m.emission = {0.02f, 0, 0.05f};
  m.shininess = 30;
  scene.ambient_light = {0.5f, 0.6f, 0.7f};
  scene.lights.push_back({Light::Kind::point, {}, {0.5f, 0.7f, 1.5f}, {0.8f, 0.9f, 1.0f}, 2.0f});
  scene.lights.push_back({Light::Kind::directional, {0.6f, 0.0f, -0.8f}, {}, {0.3f, 0.2f, 0.1f}, 0});
  test_scenes::add_quad(scene, {{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}}, {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, 0,
                        {255, 204, 255, 204});
  for (Vertex& v : scene.mesh.vertices) v.normal[2] = two_quads_turned_over ? -1.0f : 1.0f;
  if (two_quads_turned_over) std::reverse(scene.mesh.indices.begin(), scene.mesh.indices.end());
  return scene;
}

const Camera& quad_camera() {
  static const Camera camera = make_camera({0.3f, -1.0f, 3.5f}, {0, 0, 0}, {0, 1, 0}, 0.9f, 1, 0.1f, 50);
  return camera;
}

TEST_CASE("Phong shading evaluates the lighting formula at each pixel") {
  const Scene scene = lit_quad();
  const Material& m = scene.materials[0];
  RenderQuality quality;
  quality.shading = Shading::phong;
  const RgbImage image = draw(scene, quad_camera(), quality, kSide, kSide);
  const Vec corners[3] = {{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}},
            eye{quad_camera().eye.x, quad_camera().eye.y, quad_camera().eye.z};
  const double color[3] = {1, 0.8, 1};
  int brightest = 0, checked = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      Vec w;
      if (!weights_at(quad_camera(), corners, screen_x(x), screen_y(y), w) || std::min({w[0], w[1], w[2]}) < 0.01)
        continue;
      const Vec at = w[0] * corners[0] + w[1] * corners[1] + w[2] * corners[2], n{0, 0, 1}, v = unit(eye - at);
      const double vertex = w[0] * color[0] + w[1] * color[1] + w[2] * color[2];
      const Vec point{0.5, 0.7, 1.5};
      const Vec l[2] = {unit(point - at), {-0.6, 0, 0.8}};
      const double intensity[2] = {1 / (1 + dot(point - at, point - at) / 4), 1};
      for (int c = 0; c < 3; ++c) {
        double base = static_cast<double>(m.ambient[c] * scene.ambient_light[c]), gloss = 0;
        for (size_t i = 0; i < 2; ++i) {
          const double light = static_cast<double>(scene.lights[i].color[c]) * intensity[i];
          const double n_dot_l = std::max(dot(n, l[i]), 0.0), n_dot_h = std::max(dot(n, unit(l[i] + v)), 0.0);
          base += static_cast<double>(m.diffuse[c]) * light * n_dot_l;
          if (n_dot_l > 0) gloss += static_cast<double>(m.specular[c]) * light * std::pow(n_dot_h, 30);
        }
        const double expected = std::min(static_cast<double>(m.emission[c]) + vertex * base + gloss, 1.0) * 255;
        REQUIRE(std::fabs(image.pixel(x, y)[c] - expected) < 1.2);
        brightest = std::max(brightest, static_cast<int>(image.pixel(x, y)[c]));
      }
      ++checked;
    }
  CHECK(checked > 1500);
  CHECK(brightest > 170);  // the highlight is in the picture
}

TEST_CASE("Phong shows a highlight inside a polygon, Gouraud cannot, flat is one color a polygon") {
  const Scene scene = lit_quad();
  int peak[3], colors[3];
  const Shading modes[3] = {Shading::flat, Shading::gouraud, Shading::phong};
  for (int i = 0; i < 3; ++i) {
    RenderQuality quality;
    quality.shading = modes[i];
    const RgbImage image = draw(scene, quad_camera(), quality, kSide, kSide);
    std::set<int> seen;
    peak[i] = 0;
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        peak[i] = std::max(peak[i], static_cast<int>(image.pixel(x, y)[0]));
        if (image.pixel(x, y)[0] != 0)
          seen.insert(image.pixel(x, y)[0] << 16 | image.pixel(x, y)[1] << 8 | image.pixel(x, y)[2]);
      }
    colors[i] = static_cast<int>(seen.size());
  }
  CHECK(colors[0] == 1);
  CHECK(colors[1] > 20);
  CHECK(peak[2] > peak[1] + 40);
}

TEST_CASE("lighting is two-sided: turning winding or normals over changes nothing") {
  for (const Shading shading : {Shading::flat, Shading::gouraud, Shading::phong}) {
    RenderQuality quality;
    quality.shading = shading;
    Scene scene = lit_quad();
    if (shading == Shading::flat) continue;  // lit at the first corner, which the winding changes
    const RgbImage front = draw(scene, quad_camera(), quality, kSide, kSide);
    for (Vertex& v : scene.mesh.vertices) v.normal[2] = -1;
    const RgbImage turned = draw(scene, quad_camera(), quality, kSide, kSide);
    for (Vertex& v : scene.mesh.vertices) v.normal[2] = 0;  // none: the face's
    const RgbImage none = draw(scene, quad_camera(), quality, kSide, kSide);
    for (int y = 0; y < kSide; ++y) {
      REQUIRE(std::equal(front.row(y), front.row(y) + 3 * kSide, turned.row(y)));
      REQUIRE(std::equal(front.row(y), front.row(y) + 3 * kSide, none.row(y)));
    }
  }
}

TEST_CASE("back faces vanish only where the material and the quality both say so") {
  Scene scene = lit_quad(true);
  const auto is_black = [&](bool two_sided, bool cull) {
    scene.materials[0].two_sided = two_sided;
    RenderQuality quality;
    quality.cull_back_faces = cull;
    const RgbImage image = draw(scene, quad_camera(), quality, 32, 32);
    return image.pixel(16, 16)[0] == 0;
  };
  CHECK(is_black(false, true));
  CHECK_FALSE(is_black(true, true));
  CHECK_FALSE(is_black(false, false));
  CHECK_FALSE(is_black(true, false));
}

TEST_CASE("a texture modulates everything but the specular term, in every shading mode") {
  Scene scene = lit_quad();
  RgbaImage black(4, 4);
  scene.textures.push_back(make_texture("black", black));
  scene.materials[0].texture = 0;
  scene.materials[0].ambient = scene.materials[0].emission = {1, 1, 1};
  for (const bool texture : {true, false})
    for (const Shading shading : {Shading::gouraud, Shading::phong}) {
      RenderQuality quality;
      quality.shading = shading;
      quality.texture = texture;
      scene.materials[0].specular = {0.6f, 0.5f, 0.4f};
      const RgbImage glossy = draw(scene, quad_camera(), quality, kSide, kSide);
      int peak = 0;
      for (int y = 0; y < kSide; ++y)
        peak = std::max<int>(peak, *std::max_element(glossy.row(y), glossy.row(y) + 3 * kSide));
      if (shading == Shading::phong) CHECK(peak > 60);
      scene.materials[0].specular = {0, 0, 0};
      const RgbImage dull = draw(scene, quad_camera(), quality, kSide, kSide);
      for (int y = 0; y < kSide; ++y) REQUIRE(*std::max_element(dull.row(y), dull.row(y) + 3 * kSide) == 0);
    }
}

TEST_CASE("at equal depth the earlier face of the scene stays") {
  Scene scene;
  scene.materials.emplace_back();
  scene.materials[0].lit = false;
  const glm::vec3 corners[4] = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  test_scenes::add_quad(scene, {corners[0], corners[1], corners[2], corners[3]}, {{0, 0}, {0, 0}, {0, 0}, {0, 0}}, 0,
                        {200, 200, 200, 200});
  test_scenes::add_quad(scene, {corners[0], corners[1], corners[2], corners[3]}, {{0, 0}, {0, 0}, {0, 0}, {0, 0}}, 0,
                        {90, 90, 90, 90});
  const RgbImage image = draw(scene, quad_camera(), {}, 32, 32);
  CHECK(image.pixel(16, 16)[0] == 200);
}

}  // namespace
