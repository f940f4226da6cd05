// The front end in scalar code; what it computes is in front_one_simd.inc.
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

}  // namespace

void fill_front_scalar(FrontKernels& table) {
  table.transform_vertices = transform_vertices;
  table.setup_triangles = setup_one_by_one;
}

}  // namespace pac
