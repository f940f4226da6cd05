#include "raster/corner_attributes.h"

#include <algorithm>
#include <cmath>

namespace pac::raster {
namespace {

// NaN and infinities -> 0; bounded so that differences and squares stay finite.
float sanitized(float value, float limit) {
  if (!(std::fabs(value) <= INFINITY) || std::fabs(value) == INFINITY) return 0.0f;
  return std::min(std::max(value, -limit), limit);
}

struct Normal {
  float x, y, z;
};

bool usable(const Normal& n) {
  const float squared = (n.x * n.x + n.y * n.y) + n.z * n.z;
  return squared >= 0x1p-100f && squared <= 0x1p120f;
}

// The vertex's normal, or the face's where it has none, on the side of the face that is seen.
Normal seen_normal(const float given[3], const FaceNormal& face, bool front) {
  const float side = front ? 1.0f : -1.0f;
  Normal n{sanitized(given[0], 0x1p40f), sanitized(given[1], 0x1p40f), sanitized(given[2], 0x1p40f)};
  if (!usable(n)) return {face.x * side, face.y * side, face.z * side};
  const float along = ((n.x * face.x + n.y * face.y) + n.z * face.z) * side;
  return along < 0 ? Normal{-n.x, -n.y, -n.z} : n;
}

// Unit length, or zero where it has none: then every normal() above keeps its own side.
FaceNormal unit_face_normal(const FaceNormal& face) {
  const double x = sanitized(face.x, 3e38f), y = sanitized(face.y, 3e38f), z = sanitized(face.z, 3e38f);
  const double length = std::sqrt((x * x + y * y) + z * z);
  if (!(length > 0)) return {0, 0, 0};
  return {static_cast<float>(x / length), static_cast<float>(y / length), static_cast<float>(z / length)};
}

// Texture coordinates. Repeating ones are moved by whole periods so that the smallest lies in [0, 1): more digits for
// what is left.
void set_uv(const Surface& surface, const Vertex* const vertices[3], CornerAttributes& out) {
  constexpr float kLimit = 0x1p24f;
  for (int axis = 0; axis < 2; ++axis) {
    float uv[3];
    for (int i = 0; i < 3; ++i) uv[i] = sanitized(vertices[i]->texcoord[axis], kLimit);
    const float period = surface.sampler.clamp != 0 ? 0.0f : std::floor(std::min(uv[0], std::min(uv[1], uv[2])));
    for (int i = 0; i < 3; ++i) out.value[i][surface.layout.uv + axis] = uv[i] - period;
  }
}

// Lights n corners (8 lanes at most) and stores color and specular color.
void light_corners(const Surface& surface, const TileKernels& kernels, int n, const Normal* normals,
                   const Vertex* const* vertices, const uint8_t* const* colors, float out[][6]) {
  alignas(32) float normal[3][kBatchLanes], position[3][kBatchLanes], color[3][kBatchLanes], specular[3][kBatchLanes];
  for (int i = 0; i < 8; ++i) {
    const int from = std::min(i, n - 1);
    normal[0][i] = normals[from].x;
    normal[1][i] = normals[from].y;
    normal[2][i] = normals[from].z;
    for (int c = 0; c < 3; ++c) {
      position[c][i] = sanitized(vertices[from]->position[c], 0x1p60f);
      color[c][i] = static_cast<float>(colors[from][c]);
    }
  }
  alignas(32) float visibility[kMaxKernelLights + 1][kBatchLanes];
  const uint8_t mask = static_cast<uint8_t>((1 << n) - 1);
  if (surface.shadows != nullptr)
    cast_shadows(*surface.shadows, kernels, surface.lighting, 1, &mask, {0, surface.shadows->samples.count}, normal[0],
                 position[0], visibility[0]);
  kernels.light(surface.lighting, n, normal[0], position[0], surface.shadows != nullptr ? visibility[0] : nullptr,
                color[0], specular[0]);
  for (int i = 0; i < n; ++i)
    for (int c = 0; c < 3; ++c) {
      out[i][c] = color[c][i];
      out[i][c + 3] = surface.lighting.has_specular != 0 ? specular[c][i] : 0.0f;
    }
}

void set_lit_colors(const Surface& surface, int corner, const float lit[6], CornerAttributes& out) {
  float* value = out.value[corner];
  for (int c = 0; c < 3; ++c) {
    if (surface.layout.specular >= 0) {
      value[c] = lit[c];
      value[surface.layout.specular + c] = lit[c + 3];
    } else {
      value[c] = lit[c] + lit[c + 3];
    }
  }
}

void set_vertex_colors(const Surface& surface, const Vertex* const vertices[3], CornerAttributes& out) {
  const bool scaled = surface.lit == Surface::Lit::no;  // lighting has the mean texel in its parameters
  for (int i = 0; i < 3; ++i)
    for (int c = 0; c < 3; ++c) {
      const auto color = static_cast<float>(vertices[i]->color[c]);
      out.value[i][c] = scaled ? color * surface.mean[c] : color;
    }
}

}  // namespace

void corner_attributes(const Surface& surface, const TileKernels& kernels, const FaceNormal& normal,
                       const Vertex* const vertices[3], const Vertex& first, bool front, CornerAttributes& out) {
  if (surface.layout.uv >= 0) set_uv(surface, vertices, out);
  if (surface.lit == Surface::Lit::no) {
    set_vertex_colors(surface, vertices, out);
    return;
  }
  const FaceNormal face = unit_face_normal(normal);
  float lit[3][6];
  if (surface.lit == Surface::Lit::per_face) {
    const float side = front ? 1.0f : -1.0f;
    const Normal flat{face.x * side, face.y * side, face.z * side};
    const Vertex* const corner = &first;
    const uint8_t* const color = first.color;
    light_corners(surface, kernels, 1, &flat, &corner, &color, lit);
    for (int i = 0; i < 3; ++i) set_lit_colors(surface, i, lit[0], out);
    return;
  }
  Normal normals[3];
  const uint8_t* colors[3];
  for (int i = 0; i < 3; ++i) {
    normals[i] = seen_normal(vertices[i]->normal, face, front);
    colors[i] = vertices[i]->color;
  }
  if (surface.lit == Surface::Lit::per_corner) {
    light_corners(surface, kernels, 3, normals, vertices, colors, lit);
    for (int i = 0; i < 3; ++i) set_lit_colors(surface, i, lit[i], out);
    return;
  }
  set_vertex_colors(surface, vertices, out);
  for (int i = 0; i < 3; ++i) {
    float* value = out.value[i];
    value[surface.layout.normal] = normals[i].x;
    value[surface.layout.normal + 1] = normals[i].y;
    value[surface.layout.normal + 2] = normals[i].z;
    for (int c = 0; c < 3; ++c) value[surface.layout.position + c] = sanitized(vertices[i]->position[c], 0x1p60f);
  }
}

void write_record(const CornerAttributes& corners, const float* const weights[3], int n_attributes, float* record) {
  for (int j = 0; j < n_attributes; ++j) {
    float a[3];
    for (int i = 0; i < 3; ++i)
      a[i] = (weights[i][0] * corners.value[0][j] + weights[i][1] * corners.value[1][j]) +
             weights[i][2] * corners.value[2][j];
    record[3 * j] = a[0];
    record[3 * j + 1] = a[1] - a[0];
    record[3 * j + 2] = a[2] - a[0];
  }
}

}  // namespace pac::raster
