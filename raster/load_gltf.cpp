#include "raster/load_gltf.h"

#include <utility>

#include "raster/fit_camera.h"
#include "raster/load_gltf_scene.h"

namespace pac::raster {
namespace {

constexpr uint64_t kMostPrimitives = uint64_t{1}
                                     << 20;  // drawn: nodes share meshes, so that a small file could ask for more

// What moves keeps coordinates of its own, see NodeAnimation::Mount.
Affine mount(size_t i, const Affine& world, uint32_t first_vertex, LoadedScene& loaded) {
  NodeAnimation::Mount mount;
  mount.node = static_cast<uint32_t>(i);
  const bool undone = inverse(world, mount.node_from_object);
  if (!undone) mount.node_from_object = Affine{};
  loaded.animation.mounts.push_back(mount);
  Object object;
  object.first_vertex = first_vertex;
  loaded.scene.objects.push_back(object);
  return undone ? world : Affine{};
}

Result<void> add_meshes(const GltfFile& file, const GltfNodes& nodes, const std::vector<Affine>& world,
                        const std::vector<GltfMaterial>& materials, const Limits& limits, LoadedScene& loaded) {
  uint64_t n_primitives = 0;
  for (size_t i = 0; i < nodes.order.size(); ++i) {
    const Json node = file.nodes[nodes.order[i]];
    PAC_TRY(const uint32_t mesh, get_index(file, node, "mesh", file.meshes.size()));
    if (nodes.drawn[i] == 0 || mesh == kNoIndex) continue;
    n_primitives += file.meshes[mesh]["primitives"].elements().size();
    if (n_primitives > kMostPrimitives)
      return file.failure(Error::limit_exceeded, node, "more primitives are drawn than the limit");
    if (node["skin"].exists()) loaded.warnings.push_back({"skin is not applied", "", file.json_offset + node.offset()});
    const uint32_t first_vertex = static_cast<uint32_t>(loaded.scene.mesh.vertices.size());
    const Affine place = nodes.animated[i] != 0 ? mount(i, world[i], first_vertex, loaded) : world[i];
    PAC_CHECK(add_gltf_mesh(file, mesh, place, materials, limits, loaded));
    if (nodes.animated[i] != 0)
      loaded.scene.objects.back().vertex_count =
          static_cast<uint32_t>(loaded.scene.mesh.vertices.size()) - first_vertex;
  }
  return {};
}

}  // namespace

bool has_gltf() {
  return has_json_parser();
}

bool is_gltf(std::span<const uint8_t> bytes) {
  if (bytes.size() >= 4 && bytes[0] == 'g' && bytes[1] == 'l' && bytes[2] == 'T' && bytes[3] == 'F') return true;
  size_t at = bytes.size() >= 3 && bytes[0] == 0xEF && bytes[1] == 0xBB && bytes[2] == 0xBF ? 3 : 0;
  while (at < bytes.size() && (bytes[at] == ' ' || bytes[at] == '\t' || bytes[at] == '\r' || bytes[at] == '\n')) ++at;
  return at < bytes.size() && bytes[at] == '{';
}

Result<LoadedScene> load_gltf(std::span<const uint8_t> bytes, const AssetSource& assets, const Limits& limits) {
  if (!has_gltf()) return Failure{Error::unsupported, 0, "built without glTF (Debian: rapidjson-dev)"};
  PAC_TRY(const GltfFile file, read_gltf_file(bytes, assets, limits));
  LoadedScene loaded;
  PAC_TRY(const auto materials, load_gltf_materials(file, assets, loaded));
  for (const GltfMaterial& material : materials) loaded.scene.materials.push_back(material.material);
  PAC_TRY(GltfNodes nodes, load_gltf_nodes(file, limits, loaded));
  const std::vector<Affine> world = world_transforms(nodes.animation, 0);
  PAC_CHECK(add_meshes(file, nodes, world, materials, limits, loaded));
  if (loaded.scene.mesh.faces.empty())
    return file.failure(Error::unsupported, file.root(), "no triangles: points and lines alone are not drawn");
  set_default_lights(loaded.scene);
  PAC_CHECK(load_gltf_lights(file, nodes, world, loaded));
  if (!loaded.scene.objects.empty()) {
    loaded.animation.nodes = std::move(nodes.animation.nodes);
    loaded.animation.channels = std::move(nodes.animation.channels);
    loaded.animation.duration_s = nodes.animation.duration_s;
    pose_objects(loaded.animation, 0, 0, loaded.scene);
  }
  return loaded;
}

}  // namespace pac::raster
