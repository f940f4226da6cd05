#include "raster/corner_attributes.h"

#include <algorithm>
#include <cmath>

namespace pac::raster {
namespace {

// NaN and infinities -> 0; bounded so that differences and squares stay finite.
float sanitized(float value, float limit) {
  if (std::fabs(value) <= limit) return value;
  if (!(std::fabs(value) <= INFINITY) || std::fabs(value) == INFINITY) return 0.0f;
  return std::min(std::max(value, -limit), limit);
}

inline bool usable_normal(const Vertex& vertex, CornerNormal& normal) {
  normal = {sanitized(vertex.normal[0], 0x1p40f), sanitized(vertex.normal[1], 0x1p40f),
            sanitized(vertex.normal[2], 0x1p40f)};
  const float squared = (normal.x * normal.x + normal.y * normal.y) + normal.z * normal.z;
  return squared >= 0x1p-100f && squared <= 0x1p120f;
}

// The vertex's normal, or the face's where it has none, on the side of the face that is seen. `own`: the vertex's,
// not turned.
CornerNormal seen_normal(const Vertex& vertex, const FaceNormal& face, bool front, bool& own) {
  const float side = front ? 1.0f : -1.0f;
  CornerNormal n;
  own = usable_normal(vertex, n);
  if (!own) return {face.x * side, face.y * side, face.z * side};
  const float along = ((n.x * face.x + n.y * face.y) + n.z * face.z) * side;
  own = !(along < 0);
  return own ? n : CornerNormal{-n.x, -n.y, -n.z};
}

// seen_normal() would keep the vertex's own normal whatever rounding does to the face's unit normal: the cosine between
// them is far more than the few 2^-24 by which either sum is off.
bool is_on_seen_side(const CornerNormal& n, const FaceNormal& face, bool front) {
  const float x = n.x * face.x, y = n.y * face.y, z = n.z * face.z;
  const float along = front ? (x + y) + z : -((x + y) + z);
  const float magnitude = (std::fabs(x) + std::fabs(y)) + std::fabs(z);
  return magnitude <= 0x1p100f && along >= 0x1p-80f && along >= 0x1p-16f * magnitude;  // false for NaN
}

// The normals of the corners on the side that is seen; the face's unit normal is computed only where it decides.
// True if all are the vertices' own.
bool seen_normals(const Vertex* const vertices[3], const FaceNormal& face, bool front, CornerNormal normals[3]) {
  bool has_unit = false, all_own = true;
  FaceNormal unit{};
  for (int i = 0; i < 3; ++i) {
    if (usable_normal(*vertices[i], normals[i]) && is_on_seen_side(normals[i], face, front)) continue;
    if (!has_unit) unit = unit_normal(face);
    has_unit = true;
    bool own;
    normals[i] = seen_normal(*vertices[i], unit, front, own);
    all_own = all_own && own;
  }
  return all_own;
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

// Directions in which u grows and v falls, the same for the whole triangle: positions are affine in u and v, so with
// e_i = p_i - p_0 and likewise du_i, dv_i, dp/du = (e_1 dv_2 - e_2 dv_1) / (du_1 dv_2 - du_2 dv_1). Zero where the
// texture coordinates span no area.
void set_tangents(const Surface& surface, const Vertex* const vertices[3], CornerAttributes& out) {
  double e[2][3], du[2], dv[2];
  for (int k = 0; k < 2; ++k) {
    const Vertex &from = *vertices[0], &to = *vertices[k + 1];
    for (int c = 0; c < 3; ++c)
      e[k][c] = double{sanitized(to.position[c], 0x1p60f)} - double{sanitized(from.position[c], 0x1p60f)};
    du[k] = double{sanitized(to.texcoord[0], 0x1p24f)} - double{sanitized(from.texcoord[0], 0x1p24f)};
    dv[k] = double{sanitized(to.texcoord[1], 0x1p24f)} - double{sanitized(from.texcoord[1], 0x1p24f)};
  }
  const double area = du[0] * dv[1] - du[1] * dv[0];
  const double sign = area > 0 ? 1.0 : area < 0 ? -1.0 : 0.0;
  float along_u[3], against_v[3];
  for (int c = 0; c < 3; ++c) {
    along_u[c] = static_cast<float>(sign * (e[0][c] * dv[1] - e[1][c] * dv[0]));
    against_v[c] = static_cast<float>(sign * (e[0][c] * du[1] - e[1][c] * du[0]));
  }
  const FaceNormal right = unit_normal({along_u[0], along_u[1], along_u[2]});
  const FaceNormal up = unit_normal({against_v[0], against_v[1], against_v[2]});
  const float both[6] = {right.x, right.y, right.z, up.x, up.y, up.z};
  for (int i = 0; i < 3; ++i) std::copy_n(both, 6, out.value[i] + surface.layout.tangents);
}

struct LitPoint {
  CornerNormal normal;
  const Vertex* vertex;
};

void light_corners(const Surface& surface, const TileKernels& kernels, int n, const LitPoint* points,
                   float (*out)[kLitFloats]) {
  LitRows rows;
  for (int i = 0; i < (n + 7) / 8 * 8; ++i) {
    const LitPoint& point = points[std::min(i, n - 1)];
    rows.normal[0][i] = point.normal.x;
    rows.normal[1][i] = point.normal.y;
    rows.normal[2][i] = point.normal.z;
    for (int c = 0; c < 3; ++c) {
      rows.position[c][i] = sanitized(point.vertex->position[c], 0x1p60f);
      rows.color[c][i] = static_cast<float>(point.vertex->color[c]);
    }
  }
  light_points(surface, kernels, n, rows, out);
}

void set_lit_colors(const Surface& surface, int corner, const float* lit, CornerAttributes& out) {
  std::copy_n(lit, 3, out.value[corner]);
  if (surface.layout.specular >= 0) std::copy_n(lit + kLitSpecular, 3, out.value[corner] + surface.layout.specular);
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

FaceNormal unit_normal(const FaceNormal& normal) {
  const double x = sanitized(normal.x, 3e38f), y = sanitized(normal.y, 3e38f), z = sanitized(normal.z, 3e38f);
  const double length = std::sqrt((x * x + y * y) + z * z);
  if (!(length > 0)) return {0, 0, 0};
  return {static_cast<float>(x / length), static_cast<float>(y / length), static_cast<float>(z / length)};
}

void light_points(const Surface& surface, const TileKernels& kernels, int n, LitRows& rows, float (*out)[kLitFloats]) {
  const int n_groups = (n + 7) / 8;
  alignas(32) float visibility[kMaxKernelLights + 1][kBatchLanes];
  if (surface.shadows != nullptr) {
    uint8_t masks[kBatchPacks];
    std::fill_n(masks, n_groups, uint8_t{0xFF});
    masks[n_groups - 1] = static_cast<uint8_t>(0xFF >> (8 * n_groups - n));
    cast_shadows(*surface.shadows, kernels, surface.lighting, n_groups, masks, {0, surface.shadows->samples.count},
                 rows.normal[0], rows.position[0], visibility[0]);
  }
  const bool has_specular = surface.lighting.has_specular != 0, apart = surface.layout.specular >= 0;
  kernels.light(surface.lighting, n, rows.normal[0], rows.position[0],
                surface.shadows != nullptr ? visibility[0] : nullptr, rows.color[0], rows.specular[0]);
  for (int i = 0; i < n; ++i)
    for (int c = 0; c < 3; ++c) {
      const float color = rows.color[c][i], specular = has_specular ? rows.specular[c][i] : 0.0f;
      out[i][c] = apart ? color : color + specular;
      if (apart) out[i][kLitSpecular + c] = specular;
    }
}

void corner_attributes(const Surface& surface, const TileKernels& kernels, const FaceNormal& face,
                       const Vertex* const vertices[3], const float* const cached[3], const Vertex& first, bool front,
                       CornerAttributes& out) {
  const AttributeLayout& layout = surface.layout;
  if (layout.uv >= 0) set_uv(surface, vertices, out);
  for (int i = 0; i < 3 && layout.alpha >= 0; ++i)
    out.value[i][layout.alpha] = static_cast<float>(vertices[i]->color[3]);
  for (int i = 0; i < 3 && layout.position >= 0; ++i)
    for (int c = 0; c < 3; ++c) out.value[i][layout.position + c] = sanitized(vertices[i]->position[c], 0x1p60f);
  if (layout.tangents >= 0) set_tangents(surface, vertices, out);
  if (surface.lit == Surface::Lit::no) {
    set_vertex_colors(surface, vertices, out);
    return;
  }
  CornerNormal normals[3];
  float lit[3][kLitFloats];
  if (surface.lit == Surface::Lit::per_face) {
    const float side = front ? 1.0f : -1.0f;
    const FaceNormal unit = unit_normal(face);
    const CornerNormal flat{unit.x * side, unit.y * side, unit.z * side};
    std::fill_n(normals, 3, flat);
    const LitPoint point{flat, &first};
    light_corners(surface, kernels, 1, &point, lit);
    for (int i = 0; i < 3; ++i) set_lit_colors(surface, i, lit[0], out);
  } else {
    const bool all_own = seen_normals(vertices, face, front, normals);
    const bool all_cached = all_own && cached[0] != nullptr && cached[1] != nullptr && cached[2] != nullptr;
    if (surface.lit == Surface::Lit::per_sample) {
      set_vertex_colors(surface, vertices, out);
    } else {
      if (!all_cached) {
        const LitPoint points[3] = {{normals[0], vertices[0]}, {normals[1], vertices[1]}, {normals[2], vertices[2]}};
        light_corners(surface, kernels, 3, points, lit);
      }
      for (int i = 0; i < 3; ++i) set_lit_colors(surface, i, all_cached ? cached[i] : lit[i], out);
    }
  }
  for (int i = 0; i < 3 && layout.normal >= 0; ++i) {
    float* value = out.value[i] + layout.normal;
    value[0] = normals[i].x;
    value[1] = normals[i].y;
    value[2] = normals[i].z;
  }
}

bool write_normal_record(const Vertex* const v[3], float record[27]) {
  bool bounded = true;
  for (int c = 0; c < 3; ++c) {
    const auto color = static_cast<float>(v[0]->color[c]);
    const float normal = v[0]->normal[c], position = v[0]->position[c];
    bounded = bounded && std::fabs(position) <= 0x1p60f;
    float* const at[3] = {record + 3 * c, record + 9 + 3 * c, record + 18 + 3 * c};
    at[0][0] = color;
    at[1][0] = normal;
    at[2][0] = position;
    for (int i = 1; i < 3; ++i) {
      bounded = bounded && std::fabs(v[i]->position[c]) <= 0x1p60f;
      at[0][i] = static_cast<float>(v[i]->color[c]) - color;
      at[1][i] = v[i]->normal[c] - normal;
      at[2][i] = v[i]->position[c] - position;
    }
  }
  return bounded;
}

void write_whole_record(const CornerAttributes& corners, const int order[3], int n_attributes, float* record) {
  const float* const values[3] = {corners.value[order[0]], corners.value[order[1]], corners.value[order[2]]};
  for (int j = 0; j < n_attributes; ++j) {
    record[3 * j] = values[0][j];
    record[3 * j + 1] = values[1][j] - values[0][j];
    record[3 * j + 2] = values[2][j] - values[0][j];
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
