// The bowling pin of figure 3: a surface of revolution of bicubic Bezier patches, diced twice as REYES dices, each
// micropolygon vertex shaded on its own [Levoy95 s.4.2, Cook87].
#include <array>

#include "base/exact_math.h"
#include "sim/scene_parts.h"
#include "sim/textures_noise.h"

namespace pac::sim {

namespace {

constexpr int kRings = 6;      // patches up the profile
constexpr int kQuadrants = 4;  // patches around
// Micropolygons a patch side. 24 patches: 75,264 fine and 3,168 coarse; the paper has 75,467 and 3,153.
constexpr int kFineRate = 56;
constexpr int kCoarseAround = 12, kCoarseUp = 11;

// Half the regulation pin's profile in inches, (radius, height), as cubic Bezier segments that meet smoothly.
constexpr float kProfile[kRings][4][2] = {
    {{1.014f, 0.00f}, {1.300f, 0.33f}, {1.706f, 1.52f}, {1.953f, 2.25f}},
    {{1.953f, 2.25f}, {2.200f, 2.98f}, {2.383f, 3.70f}, {2.383f, 4.50f}},
    {{2.383f, 4.50f}, {2.383f, 6.05f}, {1.710f, 7.40f}, {1.236f, 8.625f}},
    {{1.236f, 8.625f}, {1.062f, 9.075f}, {0.899f, 9.50f}, {0.899f, 10.00f}},
    {{0.899f, 10.00f}, {0.899f, 11.25f}, {1.274f, 12.30f}, {1.274f, 13.50f}},
    {{1.274f, 13.50f}, {1.274f, 14.34f}, {0.700f, 15.00f}, {0.000f, 15.00f}},
};
constexpr float kPinHeight = 15.0f;

// Control points of one quadrant of a unit circle.
constexpr float kArc = 0.5522847f;

struct Patch {
  glm::vec3 control[4][4];  // [along the profile][around]
};

struct Micropoint {
  glm::vec3 position, normal;
};

Patch make_patch(int ring, int quadrant) {
  static constexpr float kQuarter[4][2] = {{1, 0}, {1, kArc}, {kArc, 1}, {0, 1}};
  Patch patch;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      float x = kQuarter[j][0], z = -kQuarter[j][1];  // turning x towards -z: counter-clockwise seen from above
      for (int turn = 0; turn < quadrant; ++turn) {
        const float old_x = x;
        x = z;
        z = -old_x;
      }
      const float radius = kProfile[ring][i][0];
      patch.control[i][j] = {radius * x, kProfile[ring][i][1], radius * z};
    }
  }
  return patch;
}

// Cubic Bernstein polynomials and their derivatives.
struct Basis {
  float value[4], slope[4];
  explicit Basis(float t) {
    const float s = 1.0f - t;
    const float values[4] = {s * s * s, 3.0f * s * s * t, 3.0f * s * t * t, t * t * t};
    const float slopes[4] = {-3.0f * s * s, 3.0f * s * s - 6.0f * s * t, 6.0f * s * t - 3.0f * t * t, 3.0f * t * t};
    for (int k = 0; k < 4; ++k) {
      value[k] = values[k];
      slope[k] = slopes[k];
    }
  }
};

glm::vec3 place(const Patch& patch, float along, float around) {
  const Basis a(along), b(around);
  glm::vec3 position(0.0f);
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) position += patch.control[i][j] * (a.value[i] * b.value[j]);
  return position;
}

Micropoint evaluate(const Patch& patch, float along, float around) {
  const Basis a(along), b(around);
  glm::vec3 position(0.0f), d_along(0.0f), d_around(0.0f);
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      position += patch.control[i][j] * (a.value[i] * b.value[j]);
      d_along += patch.control[i][j] * (a.slope[i] * b.value[j]);
      d_around += patch.control[i][j] * (a.value[i] * b.slope[j]);
    }
  }
  const glm::vec3 normal = glm::cross(d_around, d_along);
  const float length = glm::length(normal);
  return {position, length > 1e-6f ? normal / length : glm::vec3(0, 1, 0)};  // the pole's tangent around vanishes
}

float softbox(float x, float low, float high, float soft) {
  return smooth_step(low - soft, low + soft, x) * smooth_step(high + soft, high - soft, x);
}

// What the lacquer mirrors: a dark studio with two tall soft boxes, one strip light overhead and a pale floor.
glm::vec3 studio(const glm::vec3& d) {
  const float azimuth = angle_turns(d.z, d.x);  // 0 = towards the viewer, growing to the right
  glm::vec3 light = blend(rgb8(10, 11, 14), rgb8(70, 62, 54), smooth_step(-0.1f, -1.0f, d.y));
  light += glm::vec3(2.6f, 2.5f, 2.3f) * softbox(azimuth, 0.80f, 0.87f, 0.012f) * softbox(d.y, -0.30f, 0.62f, 0.04f);
  light +=
      glm::vec3(0.75f, 0.85f, 1.1f) * softbox(azimuth, 0.205f, 0.235f, 0.010f) * softbox(d.y, -0.35f, 0.70f, 0.05f);
  light += glm::vec3(1.4f, 1.35f, 1.25f) * softbox(d.y, 0.80f, 0.93f, 0.03f);
  return light;
}

// The crown on the belly: 1 inside. x, y in inches from its center.
float crown(float x, float y) {
  const float ax = std::fabs(x);
  if (ax > 0.78f || y < -0.50f || y > 0.62f) return 0.0f;
  if (y < -0.22f) return y < -0.32f || y > -0.27f ? 1.0f : 0.0f;  // the band, with a slit
  // Five points: a zigzag whose inner valleys are lower, with a ball on each tip.
  const float lobe = std::fabs(fraction(ax / 0.39f + 0.5f) - 0.5f) * 2.0f;
  const float tip = 0.48f - 0.14f * ax * ax;
  const float height = tip - (tip + 0.02f) * lobe;
  if (y < height - 0.06f) return 1.0f;
  const float bx = (fraction(ax / 0.39f + 0.5f) - 0.5f) * 0.39f, by = y - tip;
  return bx * bx + by * by < 0.0075f ? 1.0f : 0.0f;
}

// Diffuse color (linear light) of the painted wood and how glossy it still is.
struct Paint {
  glm::vec3 color;
  float gloss;
};

Paint surface_pattern(const glm::vec3& p, uint32_t seed) {
  const float turns = angle_turns(p.z, p.x);  // 0 faces the still's camera
  const float signed_turns = turns > 0.5f ? turns - 1.0f : turns;
  const float radius = std::sqrt(p.x * p.x + p.z * p.z);
  const float arc = signed_turns * 6.2831853f * radius;  // inches around from the front
  const float cloud = fractal_noise(turns * 6.0f, p.y * 0.7f, 6, 1 << 16, 4, seed);
  Paint paint{blend(glm::vec3(0.86f, 0.83f, 0.75f), glm::vec3(0.80f, 0.74f, 0.60f), 0.4f + 0.7f * cloud), 1.0f};
  const glm::vec3 red(0.50f, 0.018f, 0.022f);
  const bool stripe = (p.y > 9.10f && p.y < 9.62f) || (p.y > 10.15f && p.y < 10.67f);
  if (stripe || crown(arc, p.y - 6.9f) > 0.5f) paint.color = red * (1.0f + 0.25f * cloud);
  const bool line = std::fabs(p.y - 5.85f) < 0.045f || std::fabs(p.y - 7.95f) < 0.04f;
  if (line && std::fabs(arc) < 0.95f) paint.color = red;
  // Wear where pins and balls hit: the belly's scuffs, streaks across it, and grime towards the base.
  const float belly = smooth_step(2.2f, 0.0f, std::fabs(p.y - 4.4f)), base = smooth_step(2.0f, 0.0f, p.y);
  const float streak = gradient_noise(turns * 14.0f + 0.35f * p.y, p.y * 5.5f, 14, 1 << 16, seed + 31u);
  const float patchy = fractal_noise(turns * 9.0f, p.y * 0.9f, 9, 1 << 16, 3, seed + 37u);
  const float scuff = smooth_step(0.42f, 0.75f, streak + 0.55f * patchy) * (0.15f + 0.85f * belly);
  const float grime = base * clamp01(0.35f + 1.2f * patchy);
  paint.color = blend(paint.color, glm::vec3(0.16f, 0.14f, 0.12f), 0.75f * scuff);
  paint.color = blend(paint.color, glm::vec3(0.20f, 0.16f, 0.11f), 0.6f * grime);
  paint.gloss = (1.0f - 0.75f * scuff) * (1.0f - 0.6f * grime);
  return paint;
}

struct Shaded {
  glm::vec3 full, local;  // local: without what the lacquer mirrors
};

// The surface shader: three diffuse lights, their highlights, and a Fresnel-weighted mirror of the studio.
Shaded shade(const Micropoint& point, const Paint& paint, const glm::vec3& eye) {
  struct PinLight {
    glm::vec3 direction, color;  // towards the light
  };
  const PinLight lights[] = {{glm::normalize(glm::vec3(-0.75f, 0.62f, 0.80f)), {0.92f, 0.88f, 0.80f}},
                             {glm::normalize(glm::vec3(0.95f, 0.15f, 0.25f)), {0.16f, 0.20f, 0.28f}},
                             {glm::normalize(glm::vec3(0.35f, 0.80f, -0.75f)), {0.30f, 0.30f, 0.34f}}};
  const glm::vec3& n = point.normal;
  const glm::vec3 to_eye = glm::normalize(eye - point.position);
  const float sky = 0.5f + 0.5f * n.y;
  glm::vec3 radiance = paint.color * (glm::vec3(0.030f, 0.028f, 0.030f) + glm::vec3(0.035f, 0.038f, 0.045f) * sky);
  glm::vec3 highlight(0.0f);
  for (const PinLight& light : lights) {
    const float cosine = glm::dot(n, light.direction);
    const float wrapped = clamp01((cosine + 0.12f) / 1.12f);  // a soft box is never a point
    radiance += paint.color * light.color * wrapped;
    const float along_half = clamp01(glm::dot(n, glm::normalize(light.direction + to_eye)));
    float lobe = along_half;
    for (int k = 0; k < 6; ++k) lobe *= lobe;  // exponent 64
    highlight += light.color * lobe;
  }
  const float facing = clamp01(glm::dot(n, to_eye)), grazing = 1.0f - facing;
  const float fresnel = 0.045f + 0.955f * grazing * grazing * grazing * grazing * grazing;
  const glm::vec3 mirrored = n * (2.0f * glm::dot(n, to_eye)) - to_eye;
  return {radiance + (0.28f * highlight + (0.25f + fresnel) * 0.55f * studio(mirrored)) * paint.gloss,
          radiance + 0.28f * highlight * paint.gloss};
}

void encode_color(const glm::vec3& radiance, uint8_t* color) {
  for (int c = 0; c < 3; ++c) {
    const double mapped = static_cast<double>(radiance[c]) / (1.0 + 0.18 * static_cast<double>(radiance[c]));
    const double encoded = srgb_from_linear(mapped < 1.0 ? mapped : 1.0);
    color[c] = static_cast<uint8_t>(encoded * 255.0 + 0.5);
  }
  color[3] = 255;
}

glm::vec3 still_eye() {
  return {0.0f, 9.0f, 42.0f};
}

// The pattern's mean over the micropolygon around a vertex, cell_along x cell_around in patch parameters: as shaders
// filter what is finer than their sampling.
Paint filtered_pattern(const Patch& patch, float along, float around, float cell_along, float cell_around, int n,
                       uint32_t seed) {
  Paint mean{glm::vec3(0.0f), 0.0f};
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const float s = (static_cast<float>(i) + 0.5f) / static_cast<float>(n) - 0.5f;
      const float t = (static_cast<float>(j) + 0.5f) / static_cast<float>(n) - 0.5f;
      // Cells at a patch's rim reach a little into the next one; the Bezier form continues there closely enough.
      const Paint paint = surface_pattern(place(patch, along + s * cell_along, around + t * cell_around), seed);
      mean.color += paint.color;
      mean.gloss += paint.gloss;
    }
  }
  const float scale = 1.0f / static_cast<float>(n * n);
  return {mean.color * scale, mean.gloss * scale};
}

// Dices every patch into n_up x n_around micropolygons. Patches share the vertices of their common edges. The pattern
// is filtered by filter x filter samples a micropolygon. `local_colors`: RGBA a vertex without the mirrored studio.
Mesh dice(int n_up, int n_around, int filter, uint32_t seed, std::vector<uint8_t>* local_colors) {
  Mesh mesh;
  const auto columns = static_cast<uint32_t>(kQuadrants * n_around);
  const int rows = kRings * n_up;
  std::array<std::array<Patch, kQuadrants>, kRings> patches;
  for (int ring = 0; ring < kRings; ++ring)
    for (int quadrant = 0; quadrant < kQuadrants; ++quadrant)
      patches[static_cast<size_t>(ring)][static_cast<size_t>(quadrant)] = make_patch(ring, quadrant);
  for (int row = 0; row <= rows; ++row) {
    const int ring = row < rows ? row / n_up : kRings - 1;
    const float along = static_cast<float>(row - ring * n_up) / static_cast<float>(n_up);
    const uint32_t n_vertices = row == rows ? 1 : columns;  // the pole is one vertex
    for (uint32_t column = 0; column < n_vertices; ++column) {
      const uint32_t quadrant = column / static_cast<uint32_t>(n_around);
      const float around =
          static_cast<float>(column - quadrant * static_cast<uint32_t>(n_around)) / static_cast<float>(n_around);
      const Patch& patch = patches[static_cast<size_t>(ring)][quadrant];
      const Micropoint point = evaluate(patch, along, around);
      const Paint paint = filtered_pattern(patch, along, around, 1.0f / static_cast<float>(n_up),
                                           1.0f / static_cast<float>(n_around), filter, seed);
      Vertex vertex;
      for (int c = 0; c < 3; ++c) {
        vertex.position[c] = point.position[c];
        vertex.normal[c] = point.normal[c];
      }
      vertex.texcoord[0] = static_cast<float>(column) / static_cast<float>(columns);
      vertex.texcoord[1] = 1.0f - static_cast<float>(row) / static_cast<float>(rows);
      const Shaded shaded = shade(point, paint, still_eye());
      encode_color(shaded.full, vertex.color);
      mesh.vertices.push_back(vertex);
      if (local_colors == nullptr) continue;
      uint8_t local[4];
      encode_color(shaded.local, local);
      local_colors->insert(local_colors->end(), local, local + 4);
    }
  }
  for (int row = 0; row < rows; ++row) {
    const uint32_t below = static_cast<uint32_t>(row) * columns, above = below + columns;
    for (uint32_t column = 0; column < columns; ++column) {
      const uint32_t next = (column + 1) % columns;
      const auto first = static_cast<uint32_t>(mesh.indices.size());
      if (row + 1 == rows) {
        mesh.indices.insert(mesh.indices.end(), {below + column, below + next, above});
        mesh.faces.push_back({first, 3, 0});
      } else {
        mesh.indices.insert(mesh.indices.end(), {below + column, below + next, above + next, above + column});
        mesh.faces.push_back({first, 4, 0});
      }
    }
  }
  return mesh;
}

raster::Scene pin_scene(const char* name, Mesh mesh) {
  raster::Scene scene;
  scene.name = name;
  scene.mesh = std::move(mesh);
  raster::Material lacquer;
  lacquer.name = "lacquered maple";
  lacquer.lit = false;
  scene.materials.push_back(lacquer);
  return scene;
}

}  // namespace

SceneSet build_pin(uint32_t seed) {
  SceneSet set;
  set.fine = pin_scene("pin", dice(kFineRate, kFineRate, 2, seed, &set.local_colors));
  set.coarse = pin_scene("pin-coarse", dice(kCoarseUp, kCoarseAround, 6, seed, nullptr));
  set.width = 320;
  set.height = 800;
  set.default_split = "tessellation";
  return set;
}

raster::Camera pin_camera(int frame, float aspect) {
  return orbit_camera(frame, aspect, {0.0f, kPinHeight * 0.5f, 0.0f}, still_eye().z, still_eye().y - kPinHeight * 0.5f,
                      0.0, 120, 0.375f);
}

}  // namespace pac::sim
