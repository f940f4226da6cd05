// The front end of the rasterizer: vertices to the screen, triangles to what the tile kernels read.
//
// Like those, every float result is a fixed sequence of IEEE single-precision operations in each lane; whatever is
// decided about coverage is decided by integers.
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/kernels/tile_kernels.h"

namespace pac {

// A corner on the screen.
struct ScreenVertex {
  int32_t x, y;     // 24.8 pixels
  float z;          // window depth, >= 0; up to 8.5 beyond the far plane
  float inverse_w;  // > 0
};

// Sides of the clipping planes and of the view volume on which a vertex lies.
enum Outcode : uint32_t {
  kOutNear = 1,      // z < -w
  kOutFarGuard = 2,  // z > 16 w: beyond the far plane the depth test rejects; this keeps depth bounded
  kOutGuardRight = 4,
  kOutGuardLeft = 8,
  kOutGuardTop = 16,
  kOutGuardBottom = 32,
  kOutClip = 63,  // crossing any of these needs clipping
  kOutRight = 64,
  kOutLeft = 128,
  kOutTop = 256,
  kOutBottom = 512,
  kOutFar = 1024,
  kOutView = kOutNear | 1984,  // all three corners beyond one of these: nothing to see
  kNotFinite = 2048,           // not a number, infinite or beyond 2^100: the triangle is dropped
};

// From world space to the screen. Clip coordinate i of (x, y, z) is ((m[i][0] x + m[i][1] y) + m[i][2] z) + m[i][3].
struct ScreenTransform {
  float m[4][4];
  float guard_x, guard_y;    // the guard band: |x| <= guard_x w, |y| <= guard_y w
  float center_x, center_y;  // of the image, in 1/256 pixel; whole numbers
};

// Where samples are, and what is not wanted.
struct SetupRules {
  int32_t width, height;               // of the image
  int32_t min_x, min_y, max_x, max_y;  // the hull of the sample offsets of a pixel
};

constexpr int kSetupLanes = 8;

// A triangle of a mesh: the numbers of its corners among the vertices, of its face and of the face's material. The
// kernels read the corners.
struct MeshTriangle {
  uint32_t vertices[3];
  uint32_t face, material;
};

// The corners of kSetupLanes triangles, by their numbers among the vertices, corner i of triangle k at [i][k].
using CornerNumbers = uint32_t[3][kSetupLanes];

// Planar triangles: width and height together are at least so many 1/256 pixel, as planes do not pay for fewer pixels,
// and area2 times the least of the corners' w is at least 1 / kPlanarRatio of their product.
constexpr float kSmallestPlanar = 8 * 256, kPlanarRatio = 128;

// Bit k: triangle k of the group. Not a result by value: put into registers, its parts would wait for their stores.
struct SetupMasks {
  uint32_t drawn;       // set up
  uint32_t front;       // counter-clockwise on the screen: corners 1 and 2 are exchanged
  uint32_t degenerate;  // zero area after snapping
};

struct FrontKernels {
  // Vertex i's position is positions[i * stride], ..., of which four floats are readable. screen[i] is {0, 0, 0, 1}
  // where the outcode has a bit of kOutClip or kNotFinite (also: w too small to divide by).
  void (*transform_vertices)(const ScreenTransform& transform, const float* positions, size_t stride, int n,
                             ScreenVertex* screen, uint32_t* outcodes);

  // Sets up n <= kSetupLanes triangles of the vertices on the screen: all fields of RasterTriangle but id, state and
  // attributes. Not drawn are those without area, those in `drop_back` (bits) that are clockwise on the screen, and
  // those that no sample can see: whose bounds hold no pixel, or, where a pixel has one sample, at most 2 x 2 pixels
  // none of whose samples is inside; those that have some of such samples inside say which in `covered`. `out`: room
  // for n; the drawn ones, in order.
  void (*setup_triangles)(const SetupRules& rules, int n, const MeshTriangle* triangles, const ScreenVertex* vertices,
                          uint32_t drop_back, RasterTriangle* out, SetupMasks& masks);

  // Bit k, for those of kSetupLanes triangles whose bit is in `asked`, 0 for others: the vertices' own normals surely
  // lie on the seen side of triangle k, none near its plane: the side where its corners are counter-clockwise, or the
  // other where bit k of `front` is 0. Vertex i is at vertices + i * stride: three floats of position, three of a
  // normal of any length, and two more that are readable.
  uint32_t (*keeps_normals)(uint32_t asked, const MeshTriangle* triangles, const float* vertices, size_t stride,
                            uint32_t front);

  // Vertices to be lit by their own normals as they are. Vertex i is at vertices + i * stride: three floats of
  // position, three of the normal and two more that are readable. Bit k of n <= 8: no component of the normal is beyond
  // 2^40 nor of the position beyond 2^60, the normal's squared length is at least 2^-100 and it does not point away
  // from `eye`.
  uint32_t (*faces_eye)(const float eye[3], const float* vertices, size_t stride, int n);

  // Rows of kBatchLanes for TileKernels::light() from n <= kBatchLanes such vertices, rounded up to 8 (the last one is
  // repeated): 3 of normals, 3 of positions and 3 of colors, the first three of four bytes 8 floats after the position.
  void (*gather_vertices)(int n, const float* const* vertices, float* normal, float* position, float* color);

  // Records of color alone of n <= kSetupLanes triangles, nine floats each, one after the other: a0, a1 - a0, a2 - a0
  // of each of three colors. All lanes of `corners` are numbers of vertices. color_records: the first three of four
  // bytes at float 8 of vertices + i * stride, times `mean`; lit_records: of four floats at lit + i * stride the first
  // three.
  void (*color_records)(int n, const CornerNumbers& corners, const float* vertices, size_t stride, const float mean[3],
                        float* records);
  void (*lit_records)(int n, const CornerNumbers& corners, const float* lit, size_t stride, float* records);
};

// front_scalar.cpp; the others stand beside the tile kernels, whose operations they use.
void fill_front_scalar(FrontKernels& table);
void fill_front_sse41(FrontKernels& table);
void fill_front_avx2(FrontKernels& table);
void fill_front_neon(FrontKernels& table);

}  // namespace pac
