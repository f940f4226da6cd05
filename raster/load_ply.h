// Polygon File Format (PLY): ascii and binary of either byte order.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/mesh.h"
#include "base/result.h"
#include "raster/load_obj.h"

namespace pac::raster {

// Reads element vertex (x y z; nx ny nz; red green blue alpha, also diffuse_*; s t, u v, texture_u texture_v) and
// element face (list vertex_indices or vertex_index, of any types; any number of corners); everything else is skipped.
// Integer colors are 8-bit, 16-bit ones reduced, float ones in [0, 1]. Missing normals are generated as for OBJ (crease
// angle). `comment TextureFile NAME` names a texture. One material: light gray, or white where there are colors or a
// texture. The scene gets the light rig of fit_camera.h. Fails, byte_offset being where it shows, with
// - corrupt: "not a PLY file", "malformed header line", "number is not finite", "malformed number", "index out of
// range",
//   "list with a negative length", "header without x, y and z", "element or property of an unknown type", a repeated
//   one;
// - truncated: the header or an element's data ends too early (told from the counts before anything is allocated);
// - unsupported: a version other than 1.0; no faces (point clouds, triangle strips);
// - limit_exceeded: the file is longer than limits.max_bytes, more than limits.max_triangles.
Result<LoadedScene> load_ply(std::span<const uint8_t> bytes, const AssetSource& assets, const Limits& limits = {});

// By content: PLY if the file starts with "ply", glTF if with "glTF" or "{", else OBJ.
Result<LoadedScene> load_model(std::span<const uint8_t> bytes, const AssetSource& assets, const Limits& limits = {});

// Little-endian binary PLY: positions, normals and texture coordinates if any vertex has one, RGBA, faces with their
// material numbers if any is not 0. mesh must pass validate() for some number of materials.
std::vector<uint8_t> write_ply(const Mesh& mesh);

}  // namespace pac::raster
