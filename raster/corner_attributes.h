// Attributes at the three corners of a triangle, lit there where the shading mode says so.
#pragma once

#include "base/kernels/tile_kernels.h"
#include "base/mesh.h"
#include "raster/surface.h"
#include "raster/triangulate.h"

namespace pac::raster {

struct CornerAttributes {
  float value[3][kMaxAttributes];
};

// `normal` is the face's (any length), `vertices` the triangle's corners, `first` the face's first corner. `front`: the
// front is seen; normals on the far side of the face are turned toward the viewer, so that lighting is two-sided.
void corner_attributes(const Surface& surface, const TileKernels& kernels, const FaceNormal& normal,
                       const Vertex* const vertices[3], const Vertex& first, bool front, CornerAttributes& out);

// The record that the kernels read, for a triangle whose corner i is the mean of the given corners with weights[i]:
// a0, a1 - a0, a2 - a0 for each attribute.
void write_record(const CornerAttributes& corners, const float* const weights[3], int n_attributes, float* record);

}  // namespace pac::raster
