// A scene and a camera made of the input's bytes, whatever numbers they are: the renderer refuses it or draws the same
// picture with the scalar and the best kernels.
#include <algorithm>
#include <cstring>

#include "base/kernels/kernels.h"
#include "raster/renderer.h"

namespace {

using namespace pac;
using namespace pac::raster;

constexpr int kWidth = 40, kHeight = 33;

// Takes bytes from the front; zeros at the end.
class Source {
 public:
  Source(const uint8_t* data, size_t size) : data_(data), left_(size) {}
  uint8_t byte() {
    if (left_ == 0) return 0;
    --left_;
    return *data_++;
  }
  // Mostly moderate numbers, now and then any bits at all.
  float number() {
    const uint8_t kind = byte();
    if (kind < 250) return (static_cast<float>(kind) - 125.0f) / 25.0f;
    uint32_t bits = 0;
    for (int i = 0; i < 4; ++i) bits = bits << 8 | byte();
    float value;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  }
  bool empty() const { return left_ == 0; }

 private:
  const uint8_t* data_;
  size_t left_;
};

glm::vec3 vector_from(Source& source) {
  const float x = source.number(), y = source.number(), z = source.number();
  return {x, y, z};
}

Scene scene_from(Source& source) {
  Scene scene;
  const int flags = source.byte();
  RgbaImage image(3, 5);
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 12; ++x) image.view().row(y)[x] = static_cast<uint8_t>(37 * x + 91 * y);  // alpha, too
  scene.textures.push_back(make_texture("t", image));
  for (int i = 0; i < 2; ++i) {
    Material material;
    material.texture = i - 1;
    material.lit = (flags >> i & 1) != 0;
    material.wrap = (flags >> 2 & 1) != 0 ? Wrap::clamp : Wrap::repeat;
    material.filter = static_cast<Filter>(flags >> 3 & 1);
    material.specular = glm::vec3((flags >> 4 & 1) != 0 ? 0.5f : 0.0f);
    material.shininess = source.byte();
    scene.materials.push_back(material);
  }
  if (const int maps = source.byte(); maps != 0) {
    for (int i = 0; i < 2; ++i) {
      Material& material = scene.materials[static_cast<size_t>(i)];
      material.anisotropy = maps & 7;
      material.alpha = static_cast<AlphaMode>((maps >> 3 & 3) % 3);
      material.normal_texture = (maps >> 5 & 1) - 1;
      material.specular_texture = material.emission_texture = (maps >> 6 & 1) - 1;
      material.emission = material.reflection = vector_from(source);
      material.opacity = source.number();
      material.alpha_cutoff = source.number();
      material.normal_scale = source.number();
      material.reflection_blur = source.number();
    }
    scene.environment = (maps >> 7 & 1) - 1;
    scene.fog.kind = static_cast<Fog::Kind>(source.byte() & 3);
    scene.fog.start = source.number();
    scene.fog.end = source.number();
    scene.fog.density = source.number();
  }
  for (int i = flags >> 5 & 3; i > 0; --i) {
    Light light;
    light.kind = static_cast<Light::Kind>(source.byte() % 3);
    light.direction = vector_from(source);
    light.position = vector_from(source);
    light.range = source.number();
    light.cone_inner = source.number();
    light.cone_outer = source.number();
    light.radius = source.number();
    scene.lights.push_back(light);
  }
  if ((flags >> 7 & 1) != 0) {
    Object object;
    object.vertex_count = source.byte() % 8;
    for (int c = 0; c < 4; ++c)
      for (int r = 0; r < 3; ++r) object.world_from_object[c][r] = source.number();
    scene.objects.push_back(object);
  }
  const uint32_t n_vertices = 3 + source.byte() % 30u;
  for (uint32_t v = 0; v < n_vertices; ++v) {
    Vertex vertex;
    for (float& f : vertex.position) f = source.number();
    for (float& f : vertex.normal) f = source.number();
    for (float& f : vertex.texcoord) f = source.number();
    for (uint8_t& c : vertex.color) c = source.byte();
    scene.mesh.vertices.push_back(vertex);
  }
  while (!source.empty() && scene.mesh.faces.size() < 40) {
    const uint32_t count = 3 + source.byte() % 4u;
    scene.mesh.faces.push_back({static_cast<uint32_t>(scene.mesh.indices.size()), count, source.byte() % 2u});
    // One index in 256 may be out of range.
    for (uint32_t k = 0; k < count; ++k) {
      const uint32_t index = source.byte();
      scene.mesh.indices.push_back(index == 255 ? n_vertices : index % n_vertices);
    }
  }
  return scene;
}

struct Picture {
  RgbImage color{kWidth, kHeight};
  DepthImage depth{kWidth, kHeight};
  IdImage id{kWidth, kHeight};
  Image<float, 3> previous{kWidth, kHeight};
  bool drawn = false;
};

void draw(const Scene& scene, const Camera& camera, const RenderQuality& quality, Isa isa, Picture& picture) {
  RendererOptions options;
  options.isa = isa;
  auto renderer = Renderer::create(kWidth, kHeight, options);
  PAC_ASSERT(renderer.ok());
  RenderTargets targets{picture.color.view(), picture.depth.view(), picture.id.view()};
  targets.previous = picture.previous.view();
  targets.previous_camera = &camera;
  picture.drawn = renderer->render(scene, camera, quality, targets).ok();
}

template <class T, int kChannels>
bool same(const Image<T, kChannels>& a, const Image<T, kChannels>& b) {
  for (int y = 0; y < kHeight; ++y)
    if (std::memcmp(a.view().row(y), b.view().row(y), sizeof(T) * kChannels * kWidth) != 0) return false;
  return true;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  Source source(data, size);
  RenderQuality quality;
  const int flags = source.byte();
  quality.shading = static_cast<Shading>(flags % 3);
  quality.samples = (flags & 4) != 0 ? 4 : 1;
  quality.texture = (flags & 8) != 0;
  quality.cull_back_faces = (flags & 16) != 0;
  quality.lighting = (flags & 32) != 0 ? Lighting::full : Lighting::local;
  quality.light_samples = 4;
  if ((flags & 96) == 96) quality.lighting = Lighting::shadow_maps;
  quality.shadow_map_side = 64;
  Camera camera = make_camera({0, 0, 6}, {0, 0, 0}, {0, 1, 0}, 0.9f, float{kWidth} / kHeight, 0.5f, 20.0f);
  if ((flags & 64) != 0) camera = make_camera(vector_from(source), {0, 0, 0}, {0, 1, 0}, 1.5f, 1.2f, 0.01f, 9.0f);
  if ((flags & 128) != 0) camera.clip_from_world[source.byte() % 4][source.byte() % 4] = source.number();
  const Scene scene = scene_from(source);
  Picture plain, best;
  draw(scene, camera, quality, Isa::scalar, plain);
  draw(scene, camera, quality, best_isa(), best);
  PAC_ASSERT(plain.drawn == best.drawn);
  PAC_ASSERT(same(plain.color, best.color) && same(plain.depth, best.depth) && same(plain.id, best.id) &&
             same(plain.previous, best.previous));
  return 0;
}
