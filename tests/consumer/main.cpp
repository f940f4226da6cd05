// Compresses a gradient with the installed codec and decodes it again; draws a triangle; codes its mesh.
#include <cstdio>

#include "geomcodec/geomcodec.h"
#include "jpeg/jpeg.h"
#include "raster/renderer.h"

int main() {
  pac::raster::Scene scene;
  scene.materials.emplace_back();
  scene.mesh.vertices.resize(3);
  scene.mesh.vertices[0].position[0] = -1;
  scene.mesh.vertices[1].position[0] = 1;
  scene.mesh.vertices[2].position[1] = 1;
  scene.mesh.indices = {0, 1, 2};
  scene.mesh.faces = {{0, 3, 0}};
  pac::RgbImage image(64, 48);
  auto renderer = pac::raster::Renderer::create(64, 48);
  if (!renderer) return 1;
  pac::raster::RenderTargets targets;
  targets.color = image.view();
  if (!renderer->render(scene, {}, {}, targets)) return 1;

  const auto bytes = pac::jpeg::encode(image.view());
  if (!bytes) return 1;
  const auto decoded = pac::jpeg::decode(*bytes);
  if (!decoded || decoded->width() != 64 || decoded->height() != 48) return 1;

  const auto quantized = pac::geomcodec::quantize(scene.mesh, 12);
  if (!quantized) return 1;
  const auto model = pac::geomcodec::encode(*quantized);
  if (!model) return 1;
  std::printf("%zu bytes of image, %zu bytes of model\n", bytes->size(), model->size());
  return 0;
}
