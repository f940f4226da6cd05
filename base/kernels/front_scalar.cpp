// The front end in scalar code; what it computes is in front_one_simd.inc.
#include <cmath>
#include <cstring>

#include "base/kernels/front_kernels.h"

namespace pac {
namespace {

#include "base/kernels/front_one_simd.inc"

void transform_vertices(const ScreenTransform& transform, const float* positions, size_t stride, int n,
                        ScreenVertex* screen, uint32_t* outcodes) {
  float clip[4];
  for (int i = 0; i < n; ++i)
    outcodes[i] = one_vertex(transform, positions + static_cast<size_t>(i) * stride, clip, screen[i]);
}

// The cross product in single precision and, for each component, the sum of the magnitudes of its two terms, of which
// it is off by less than 2^-21 times as much: differences, products and their difference are each off by 2^-24. Where
// its dot product with a normal exceeds 2^-16 of such magnitudes it has the sign of that with the face's normal.
bool keeps_normals_of(const float* const vertices[3], bool front) {
  float e1[3], e2[3], cross[3], size[3];
  for (int c = 0; c < 3; ++c) {
    e1[c] = vertices[1][c] - vertices[0][c];
    e2[c] = vertices[2][c] - vertices[0][c];
  }
  constexpr int kNext[3] = {1, 2, 0}, kLast[3] = {2, 0, 1};
  for (int c = 0; c < 3; ++c) {
    const float p = e1[kNext[c]] * e2[kLast[c]], q = e1[kLast[c]] * e2[kNext[c]];
    cross[c] = front ? p - q : q - p;
    size[c] = std::fabs(p) + std::fabs(q);
  }
  bool all = true;
  for (int i = 0; i < 3; ++i) {
    const float* const n = vertices[i] + 3;
    const float x = std::fabs(n[0]), y = std::fabs(n[1]), z = std::fabs(n[2]);
    const float along = (n[0] * cross[0] + n[1] * cross[1]) + n[2] * cross[2];
    const float magnitude = (x * size[0] + y * size[1]) + z * size[2];
    const float squared = (n[0] * n[0] + n[1] * n[1]) + n[2] * n[2];
    // False for NaN. The first four: lighting takes these components as they are and calls them usable.
    all = all && x <= 0x1p40f && y <= 0x1p40f && z <= 0x1p40f && squared >= 0x1p-100f && magnitude <= 0x1p100f &&
          along >= 0x1p-80f && along >= 0x1p-16f * magnitude;
  }
  return all;
}

uint32_t keeps_normals(uint32_t asked, const MeshTriangle* triangles, const float* vertices, size_t stride,
                       uint32_t front) {
  uint32_t kept = 0;
  for (int k = 0; k < kSetupLanes; ++k) {
    if ((asked >> k & 1) == 0) continue;
    const float* corners[3];
    for (int i = 0; i < 3; ++i) corners[i] = vertices + stride * triangles[k].vertices[i];
    kept |= (keeps_normals_of(corners, (front >> k & 1) != 0) ? 1u : 0u) << k;
  }
  return kept;
}

uint32_t faces_eye(const float eye[3], const float* vertices, size_t stride, int n) {
  uint32_t facing = 0;
  for (int k = 0; k < n; ++k) {
    const float *const p = vertices + static_cast<size_t>(k) * stride, *const normal = p + 3;
    bool usable = true;
    for (int c = 0; c < 3; ++c)
      usable = usable && std::fabs(p[c]) <= 0x1p60f && std::fabs(normal[c]) <= 0x1p40f;  // false for NaN
    const float squared = (normal[0] * normal[0] + normal[1] * normal[1]) + normal[2] * normal[2];
    const float towards = (normal[0] * (eye[0] - p[0]) + normal[1] * (eye[1] - p[1])) + normal[2] * (eye[2] - p[2]);
    facing |= (usable && squared >= 0x1p-100f && towards >= 0 ? 1u : 0u) << k;
  }
  return facing;
}

void gather_vertices(int n, const float* const* vertices, float* normal, float* position, float* color) {
  for (int i = 0; i < (n + 7) / 8 * 8; ++i) {
    const float* const p = vertices[i < n ? i : n - 1];
    uint8_t bytes[4];
    std::memcpy(bytes, p + 8, 4);
    for (int c = 0; c < 3; ++c) {
      position[c * kBatchLanes + i] = p[c];
      normal[c * kBatchLanes + i] = p[3 + c];
      color[c * kBatchLanes + i] = static_cast<float>(bytes[c]);
    }
  }
}

void color_records(int n, const CornerNumbers& corners, const float* vertices, size_t stride, const float mean[3],
                   float* records) {
  for (int k = 0; k < n; ++k, records += 9) {
    uint8_t bytes[3][4];
    for (int i = 0; i < 3; ++i) std::memcpy(bytes[i], vertices + stride * corners[i][k] + 8, 4);
    for (int c = 0; c < 3; ++c) {
      const float a0 = static_cast<float>(bytes[0][c]) * mean[c];
      records[3 * c] = a0;
      for (int i = 1; i < 3; ++i) records[3 * c + i] = static_cast<float>(bytes[i][c]) * mean[c] - a0;
    }
  }
}

void lit_records(int n, const CornerNumbers& corners, const float* lit, size_t stride, float* records) {
  for (int k = 0; k < n; ++k, records += 9) {
    const float* const corner0 = lit + stride * corners[0][k];
    for (int c = 0; c < 3; ++c) {
      records[3 * c] = corner0[c];
      for (int i = 1; i < 3; ++i)
        records[3 * c + i] = lit[stride * corners[i][k] + static_cast<size_t>(c)] - corner0[c];
    }
  }
}

}  // namespace

void fill_front_scalar(FrontKernels& table) {
  table.transform_vertices = transform_vertices;
  table.setup_triangles = setup_one_by_one;
  table.keeps_normals = keeps_normals;
  table.faces_eye = faces_eye;
  table.gather_vertices = gather_vertices;
  table.color_records = color_records;
  table.lit_records = lit_records;
}

}  // namespace pac
