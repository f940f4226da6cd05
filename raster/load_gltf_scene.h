// From the objects of a glTF file to those of a Scene: materials, nodes, and the geometry that hangs on them.
#pragma once

#include <cstdint>
#include <vector>

#include "raster/load_gltf_file.h"
#include "raster/load_texture.h"
#include "raster/node_animation.h"

namespace pac::raster {

// A material and what its texture asks of the vertices.
struct GltfMaterial {
  Material material;
  uint32_t texcoord_set = 0;
  // Rows of the affine map from the file's texture coordinates to ours: KHR_texture_transform, then halves where the
  // texture was mirrored into one twice as large.
  double texcoord_map[2][3] = {{1, 0, 0}, {0, 1, 0}};
  float base_color[3] = {1, 1, 1};  // sRGB-encoded; goes into the vertices' colors of unlit materials
};

// One for each of file.materials, then the default material. Textures go into the scene, warnings beside it.
Result<std::vector<GltfMaterial>> load_gltf_materials(const GltfFile& file, const AssetSource& assets,
                                                      LoadedScene& loaded);

// The hierarchy: number i of `order` is the file's node order[i]; parents come first.
struct GltfNodes {
  std::vector<uint32_t> order;
  std::vector<uint8_t> drawn;     // by the default scene; parallel to `order`
  std::vector<uint8_t> animated;  // itself or an ancestor
  NodeAnimation animation;        // nodes and channels; no mounts yet
};
Result<GltfNodes> load_gltf_nodes(const GltfFile& file, const Limits& limits, LoadedScene& loaded);

// Lights and cameras of the drawn nodes, whose transforms to the world are parallel to nodes.order.
Result<void> load_gltf_lights(const GltfFile& file, const GltfNodes& nodes, const std::vector<Affine>& world,
                              LoadedScene& loaded);

// Adds the primitives of mesh number `mesh`, moved by `world_from_mesh`, to the scene.
Result<void> add_gltf_mesh(const GltfFile& file, uint32_t mesh, const Affine& world_from_mesh,
                           const std::vector<GltfMaterial>& materials, const Limits& limits, LoadedScene& loaded);

}  // namespace pac::raster
