// The geometry codec beside other codecs: what the parts of geom_peers share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "base/mesh.h"
#include "geomcodec/geomcodec.h"

namespace pac::peers {

struct NamedMesh {
  std::string name;
  Mesh mesh;
  bool has_texcoords = false;
};
// Built-in scenes, Debian's assimp-testmodels, generated meshes: `size` 0 small ones only, 1 also those of 75,000 and
// more triangles.
std::vector<NamedMesh> test_meshes(int size);
// Any file that raster/ loads, shaded.
bool load_file(const std::string& path, NamedMesh& out);

// What is coded of a mesh.
struct Attributes {
  bool colors = false, normals = false, texcoords = false;
};

struct Measured {
  size_t bytes = 0;  // 0: refused
  double encode_seconds = 0, decode_seconds = 0;
};
// All get the same integers; Draco and meshoptimizer as triangles over vertices that are distinct. `repeats` 0: bytes
// only.
Measured measure_pac(const geomcodec::QuantizedMesh& mesh, int repeats);
Measured measure_draco(const geomcodec::QuantizedMesh& mesh, const Attributes& attributes, int level, int repeats);
Measured measure_meshoptimizer_zstd(const geomcodec::QuantizedMesh& mesh, const Attributes& attributes);

}  // namespace pac::peers
