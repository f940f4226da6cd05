#include "sim/cli/scene_source.h"

#include <vector>

#include "raster/load_ply.h"
#include "sim/cli/image_files.h"
#include "sim/loaded_scene.h"

namespace pac::cli {
namespace {

constexpr size_t kMostWarnings = 20;  // of one file, on stderr

std::string folder_of(const std::string& path) {
  const size_t slash = path.rfind('/');
  return slash == std::string::npos ? "" : path.substr(0, slash + 1);
}

Result<raster::LoadedScene> read_model(const std::string& path, std::span<const uint8_t> bytes, Isa isa) {
  raster::AssetSource assets;
  assets.read = [folder = folder_of(path)](const std::string& name) {
    return read_file(name.starts_with('/') ? name : folder + name);
  };
  assets.decode_image = [isa](std::span<const uint8_t> image) { return decode_picture_rgba(image, isa); };
  return raster::load_model(bytes, assets);
}

void print_warnings(const std::string& path, const std::vector<raster::Warning>& warnings) {
  for (size_t i = 0; i < warnings.size() && i < kMostWarnings; ++i) {
    std::string text = warnings[i].text;
    if (!warnings[i].name.empty()) text += ": " + warnings[i].name;
    warn(path, text + " (at byte " + std::to_string(warnings[i].byte_offset) + ")");
  }
  if (warnings.size() > kMostWarnings)
    warn(path, std::string("and ") + std::to_string(warnings.size() - kMostWarnings) + " more warnings");
}

std::string nearest_scene(const std::string& name) {
  std::vector<std::string> names;
  for (const sim::BuiltinScene& scene : sim::builtin_scenes()) names.emplace_back(scene.name);
  return nearest(name, names);
}

}  // namespace

raster::Camera SceneSource::camera(int frame, float aspect) const {
  return builtin != nullptr ? builtin->camera(frame, aspect) : sim::fit_camera(set.fine, frame, aspect);
}

void SceneSource::pose(int frame, int frames_per_second) {
  if (animation.empty()) return;
  const double step = 1.0 / frames_per_second;
  raster::pose_objects(animation, frame * step, (frame - 1) * step, set.fine);
}

bool SceneSource::can_move() const {
  return builtin != nullptr ? builtin->part_motion != nullptr : !animation.empty();
}

sim::Transforms SceneSource::transforms(int frame, int frames_per_second) {
  if (builtin != nullptr) return builtin->part_motion(frame, set.parts);
  pose(frame, frames_per_second);
  return sim::transforms_of(set.fine);
}

std::optional<SceneSource> load_scene(const std::string& name, const Options& options) {
  SceneSource source;
  source.name = name;
  source.builtin = sim::find_scene(name);
  if (source.builtin != nullptr) {
    source.set = source.builtin->build(kSceneSeed);
    return source;
  }
  const auto bytes = read_file(name);
  if (!bytes.ok()) {
    const bool could_be_name = name.find_first_of("./-") == std::string::npos || !nearest_scene(name).empty();
    const std::string suggestion = could_be_name ? nearest_scene(name) : "";
    std::string problem = bytes.failure().text;
    if (!suggestion.empty()) problem += ", and no built-in scene; did you mean '" + suggestion + "'?";
    data_error(name, problem);
    return std::nullopt;
  }
  auto loaded = read_model(name, *bytes, options.isa);
  if (!loaded.ok()) {
    data_error(name, loaded.failure());
    return std::nullopt;
  }
  if (!options.quiet) print_warnings(name, loaded->warnings);
  source.set = sim::scene_set_from(std::move(loaded->scene));
  source.animation = std::move(loaded->animation);
  return source;
}

}  // namespace pac::cli
