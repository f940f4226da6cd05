// OBJ, with the same bytes as MTL and as texture names' source: whatever they hold, a scene that validates or a
// Failure.
#include "base/mesh.h"
#include "raster/load_mtl.h"
#include "raster/load_obj.h"
#include "tests/support/model_files.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::span<const uint8_t> bytes(data, size);
  const pac::raster::AssetSource assets = pac::test::assets_of_bytes(bytes);
  pac::Limits limits;
  limits.max_triangles = 1 << 16;
  const auto loaded = pac::raster::load_obj(bytes, assets, limits);
  if (loaded.ok()) {
    const auto& scene = loaded->scene;
    PAC_ASSERT(validate(scene.mesh, static_cast<uint32_t>(scene.materials.size()), limits).ok());
    for (const pac::raster::Material& material : scene.materials)
      PAC_ASSERT(material.texture < static_cast<int32_t>(scene.textures.size()));
  } else {
    PAC_ASSERT(loaded.failure().byte_offset <= size);
  }
  return 0;
}
