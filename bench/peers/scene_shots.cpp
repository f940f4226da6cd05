#include "bench/peers/scene_shots.h"

#include <sys/resource.h>

#include <algorithm>
#include <cstring>
#include <ctime>

#include "base/file_io.h"
#include "base/image_io.h"
#include "jpeg/jpeg.h"
#include "raster/load_ply.h"
#include "raster/renderer.h"
#include "sim/loaded_scene.h"
#include "sim/packet.h"
#include "sim/scene_builder.h"
#include "sim/split.h"
#include "sim/textures.h"

namespace pac::bench {

namespace {

constexpr const char* kFence = "fence";
constexpr const char *kMoving = "+moving", *kLights = "+lights";

Result<RgbaImage> decode_picture(std::span<const uint8_t> bytes) {
  if (bytes.size() < 2 || bytes[0] != 0xFF || bytes[1] != 0xD8) return decode_rgba(bytes);
  PAC_TRY(const RgbImage opaque, jpeg::decode(bytes));
  RgbaImage image(opaque.width(), opaque.height());
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      std::memcpy(image.pixel(x, y), opaque.pixel(x, y), 3);
      image.pixel(x, y)[3] = 255;
    }
  return image;
}

sim::SceneSet load_file(const std::string& path) {
  raster::AssetSource assets;
  const std::string folder = path.substr(0, path.rfind('/') + 1);
  assets.read = [folder](const std::string& name) { return read_file(folder + name); };
  assets.decode_image = decode_picture;
  const Bytes bytes = need(read_file(path), path.c_str());
  return sim::scene_set_from(std::move(need(raster::load_model(bytes, assets), path.c_str()).scene));
}

// Four rows of bars, 2 mm wide, 12 mm apart and 0.8 m high, behind each other on bricks: seen from 3 m a bar is about a
// third of a pixel of 512 wide, and rows slide over each other as the camera goes by.
sim::SceneSet fence() {
  constexpr int kRows = 4, kBars = 180;
  constexpr float kApart = 0.012f, kHalfWidth = 0.001f, kHeight = 0.8f;
  sim::SceneBuilder builder("fence");
  const uint32_t ground = builder.add_texture("bricks", sim::brick_wall(256, 256, 3));
  const uint32_t bark = builder.add_texture("wood", sim::oak_planks(128, 128, 4));
  builder.patch({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, 8, 8, ground, {0, 0, 4, 4});
  for (int row = 0; row < kRows; ++row)
    for (int bar = 0; bar < kBars; ++bar) {
      const float x = (static_cast<float>(bar) - 0.5f * kBars) * kApart + 0.003f * static_cast<float>(row);
      const float z = 0.25f * static_cast<float>(row) - 0.4f;
      builder.box({x - kHalfWidth, 0, z - kHalfWidth}, {x + kHalfWidth, kHeight, z + kHalfWidth}, bark,
                  sim::SceneBuilder::kAll, glm::ivec3(1), glm::vec2(0.05f, 0.2f));
    }
  return sim::scene_set_from(builder.take());
}

sim::Transforms transforms_at(const NamedScene& scene, int frame) {
  if (!scene.moves && !scene.has_moving_lights) return sim::transforms_of(scene.set.fine);
  sim::Transforms transforms;
  if (scene.moves) transforms = scene.builtin->part_motion(frame, scene.set.parts);
  if (scene.has_moving_lights) sim::add_light_transforms(frame, scene.set.fine.lights.size(), transforms);
  return transforms;
}

double ms_of(const timeval& time) {
  return 1e3 * static_cast<double>(time.tv_sec) + 1e-3 * static_cast<double>(time.tv_usec);
}

// One more drawing of L alone, as a client does it.
double draw_low_alone(const Sequence& sequence, const sim::Split& split, raster::Renderer& renderer) {
  RgbImage low(sequence.width, sequence.height);
  DepthImage depth(sequence.width, sequence.height);
  IdImage id(sequence.width, sequence.height);
  const double begin = cpu_ms();
  for (const sim::Shot& shot : sequence.shots)
    if (const auto drawn = renderer.render(sequence.low, shot.camera, split.low, {low.view(), depth.view(), id.view()});
        !drawn.ok())
      return 0;
  return (cpu_ms() - begin) / static_cast<double>(sequence.shots.size());
}

}  // namespace

double cpu_ms() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

double children_cpu_ms() {
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  return ms_of(usage.ru_utime) + ms_of(usage.ru_stime);
}

raster::Camera NamedScene::camera(int frame, float aspect) const {
  return builtin != nullptr ? builtin->camera(frame, aspect) : sim::fit_camera(set.fine, frame, aspect);
}

NamedScene load_scene(const std::string& name) {
  NamedScene scene;
  scene.name = name;
  std::string plain = name;
  const auto ends_with = [&plain](const char* suffix) {
    if (!plain.ends_with(suffix)) return false;
    plain.resize(plain.size() - std::strlen(suffix));
    return true;
  };
  scene.has_moving_lights = ends_with(kLights);
  scene.moves = ends_with(kMoving);
  scene.builtin = sim::find_scene(plain);
  if (scene.builtin != nullptr)
    scene.set = scene.builtin->build(1);
  else
    scene.set = plain == kFence ? fence() : load_file(plain);
  if (scene.moves && (scene.builtin == nullptr || scene.builtin->part_motion == nullptr)) {
    std::fprintf(stderr, "%s: nothing in this scene moves\n", name.c_str());
    std::exit(1);
  }
  if (scene.moves) sim::move_parts(scene.set);
  if (scene.has_moving_lights) sim::move_lights(scene.set.fine);
  return scene;
}

Sequence draw(NamedScene& scene, const std::string& split_name, int frames, int longer_side, int samples) {
  const sim::Split split = need(sim::make_split(split_name, scene.set, {samples, true}), scene.name.c_str());
  Sequence out;
  out.width = scene.set.width;
  out.height = scene.set.height;
  const int longer = std::max(out.width, out.height);
  if (longer_side > 0) {
    out.width = std::max(1, out.width * longer_side / longer);
    out.height = std::max(1, out.height * longer_side / longer);
  }
  out.samples = split.low.samples;
  out.differs_in_light = split.differs_in_light();
  if (!sim::move_objects(transforms_at(scene, 0), scene.set.fine).ok()) std::exit(1);
  sim::FrameRenderer renderer = need(
      sim::FrameRenderer::create(scene.set, split, false, out.width, out.height, 1, best_isa()), scene.name.c_str());
  out.low = renderer.low_scene();
  out.resident_model_bytes = sim::serialize_model(out.low, split.low.texture).size();
  const float aspect = static_cast<float>(out.width) / static_cast<float>(out.height);
  for (int i = 0; i < frames; ++i) {
    if (!sim::move_objects(transforms_at(scene, i), scene.set.fine).ok()) std::exit(1);
    const raster::Camera camera = scene.camera(i, aspect);
    out.shots.push_back({camera, need(renderer.render(scene.set, camera, true), scene.name.c_str())});
  }
  out.draw_low_ms = draw_low_alone(out, split, renderer.renderer());
  return out;
}

}  // namespace pac::bench
