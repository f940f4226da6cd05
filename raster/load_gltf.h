// glTF 2.0 [Khronos glTF 2.0, ISO/IEC 12113]: .gltf (JSON) and .glb (binary container).
#pragma once

#include <cstdint>
#include <span>

#include "base/result.h"
#include "raster/load_obj.h"

namespace pac::raster {

// Whether the bytes are a GLB container, or JSON (first character `{` behind white space and a byte order mark).
bool is_gltf(std::span<const uint8_t> bytes);

// Whether this build can read glTF at all (it needs a JSON parser, found when the build is configured).
bool has_gltf();

// Reads the default scene (else the first, else every root node): meshes (triangles, strips, fans; all component types,
// normalized, strided and sparse accessors), the node hierarchy, animations of nodes (the first one; LoadedScene::
// animation, which moves Scene::objects; the scene comes posed at time 0), vertex colors, metallic-roughness materials
// (mapping in raster/README.md), PNG and JPEG textures in data URIs, buffer views or files of `assets`, perspective
// cameras, KHR_lights_punctual, KHR_materials_unlit, KHR_mesh_quantization, KHR_texture_transform. Points and lines,
// further UV sets, skins and morph targets are left out with a warning. Vertices without normals stay so: their faces
// are drawn flat [s.3.7.2.1]. Fails, byte_offset being where the value that is wrong ends in the JSON (an array or
// object: where it begins), with
// - truncated, corrupt: the GLB container ("chunk is longer than the file", ...), "malformed JSON", "accessor reaches
//   outside its buffer view", "index out of range", "nodes form a cycle", "number is not finite", ...;
// - unsupported: an extension in extensionsRequired that is not one of the above, by its name; Draco and meshopt
//   compression; another version than 2; no triangles; a build without a JSON parser;
// - limit_exceeded: more bytes, triangles or pixels than `limits`.
Result<LoadedScene> load_gltf(std::span<const uint8_t> bytes, const AssetSource& assets, const Limits& limits = {});

}  // namespace pac::raster
