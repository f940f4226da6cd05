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

struct CornerNormal {
  float x, y, z;
};

// Unit length, or zero where there is none: then every normal of a vertex keeps its own side.
FaceNormal unit_normal(const FaceNormal& normal);

// What lighting gives for a point: three floats of color and, from the fourth on, three of specular color. Where the
// surface's layout does not keep that apart, the color is the sum of both and nothing else is set.
constexpr int kLitSpecular = 4, kLitFloats = 8;

// Lights n <= kBatchLanes points of one surface, rounded up to 8. Uses color and specular up.
struct LitRows {
  alignas(32) float normal[3][kBatchLanes];
  alignas(32) float position[3][kBatchLanes];
  alignas(32) float color[3][kBatchLanes];
  alignas(32) float specular[3][kBatchLanes];
};
void light_points(const Surface& surface, const TileKernels& kernels, int n, LitRows& rows, float (*out)[kLitFloats]);

// `normal` is the face's normal of any length, `vertices` the triangle's corners, `first` the face's first corner.
// `front`: the front is seen; normals on the far side of the face are turned toward the viewer, so that lighting is
// two-sided. cached[i]: what light_points() gives corner i by its own normal, or null.
void corner_attributes(const Surface& surface, const TileKernels& kernels, const FaceNormal& normal,
                       const Vertex* const vertices[3], const float* const cached[3], const Vertex& first, bool front,
                       CornerAttributes& out);

// The record that the kernels read, for a triangle whose corner i is the mean of the given corners with weights[i]:
// a0, a1 - a0, a2 - a0 for each attribute. write_whole_record: corner i is the given corner order[i].
// write_normal_record: from the vertices at once, for surfaces lit at each sample without texture coordinates or
// opacity (false: positions are too large for it), in the record's order. The normals are the vertices' own.
bool write_normal_record(const Vertex* const vertices[3], float record[27]);
void write_whole_record(const CornerAttributes& corners, const int order[3], int n_attributes, float* record);
void write_record(const CornerAttributes& corners, const float* const weights[3], int n_attributes, float* record);

}  // namespace pac::raster
