// glTF, JSON or GLB, with the same bytes as buffers' and images' files: whatever they hold, a scene that validates and
// can be posed at any time, or a Failure.
#include "base/mesh.h"
#include "raster/load_gltf.h"
#include "raster/node_animation.h"
#include "tests/support/model_files.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::span<const uint8_t> bytes(data, size);
  const pac::raster::AssetSource assets = pac::test::assets_of_bytes(bytes);
  pac::Limits limits;
  limits.max_triangles = 1 << 16;
  limits.max_bytes = 1 << 22;
  auto loaded = pac::raster::load_gltf(bytes, assets, limits);
  if (!loaded.ok()) {
    PAC_ASSERT(loaded.failure().byte_offset <= size);
    return 0;
  }
  pac::raster::Scene& scene = loaded->scene;
  PAC_ASSERT(validate(scene.mesh, static_cast<uint32_t>(scene.materials.size()), limits).ok());
  for (const pac::raster::Material& material : scene.materials)
    PAC_ASSERT(material.texture < static_cast<int32_t>(scene.textures.size()));
  for (const pac::raster::Object& object : scene.objects)
    PAC_ASSERT(uint64_t{object.first_vertex} + object.vertex_count <= scene.mesh.vertices.size());
  if (!loaded->animation.empty())
    for (const double time : {0.0, 0.3, 1e9}) pac::raster::pose_objects(loaded->animation, time, 0.1, scene);
  return 0;
}
