// Meshes that geometry code must survive: regular, degenerate and hostile ones, on an integer grid.
#pragma once

#include <string>
#include <vector>

#include "geomcodec/geomcodec.h"

namespace pac::test {

struct NamedMesh {
  std::string name;
  geomcodec::QuantizedMesh mesh;
};

// Deterministic; the largest has a few 10^4 faces.
std::vector<NamedMesh> mesh_zoo();

// A grid of quads, columns x rows, cut into triangles if asked, with a smooth height and color.
geomcodec::QuantizedMesh wave_mesh(uint32_t columns, uint32_t rows, bool triangles);

// A closed body of revolution of 2 * segments * rings triangles or segments * rings quads plus caps, shaded.
// Copies of two things in turn and some odd ones, moved by no whole steps.
geomcodec::QuantizedMesh copies_mesh(uint32_t count);
// A grid of side x side points on a curved surface under triangles whose edges were flipped at random.
geomcodec::QuantizedMesh irregular_mesh(uint32_t side);
geomcodec::QuantizedMesh pin_mesh(uint32_t segments, uint32_t rings, int position_bits);

// indices follow one another in the order of the faces.
geomcodec::QuantizedMesh packed(const geomcodec::QuantizedMesh& mesh);

bool same(const geomcodec::QuantizedMesh& one, const geomcodec::QuantizedMesh& other);

}  // namespace pac::test
