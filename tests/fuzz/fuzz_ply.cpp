// PLY: whatever the bytes, a scene that validates (and that write_ply and load_ply carry over) or a Failure.
#include "base/mesh.h"
#include "raster/load_ply.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  pac::Limits limits;
  limits.max_triangles = 1 << 16;
  const auto loaded = pac::raster::load_ply(std::span<const uint8_t>(data, size), {}, limits);
  if (!loaded.ok()) {
    PAC_ASSERT(loaded.failure().byte_offset <= size);
    return 0;
  }
  const pac::Mesh& mesh = loaded->scene.mesh;
  PAC_ASSERT(validate(mesh, static_cast<uint32_t>(loaded->scene.materials.size()), limits).ok());
  const auto again = pac::raster::load_ply(pac::raster::write_ply(mesh), {}, limits);
  PAC_ASSERT(again.ok());
  PAC_ASSERT(again->scene.mesh.faces.size() == mesh.faces.size());
  return 0;
}
