#include "sim/split.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace pac::sim {

namespace {

enum Part : uint8_t { kTexture, kTessellation, kShading, kAntialiasing, kLighting, kPartCount };

constexpr const char* kNames[kPartCount + 1] = {"texture",      "tessellation", "shading",
                                                "antialiasing", "lighting",     nullptr};
constexpr const char* kSummaries[kPartCount] = {
    "the server sends texture; the client draws untextured, antialiased surfaces",
    "the server sends fine tessellation and its shading; the client draws the coarse model",
    "the server sends texture, Phong shading and antialiasing; the client draws aliased Gouraud surfaces",
    "the server sends texture; neither side antialiases",
    "the server sends global illumination; the client draws textures under local light",
};

int part_number(std::string_view name) {
  for (int part = 0; part < kPartCount; ++part)
    if (name == kNames[part]) return part;
  return -1;
}

// The set of parts that a comma-joined list names, as bits 1 << Part.
Result<uint32_t> parse_parts(std::string_view names) {
  uint32_t parts = 0;
  for (size_t begin = 0; begin <= names.size();) {
    const size_t end = std::min(names.find(',', begin), names.size());
    const int part = part_number(names.substr(begin, end - begin));
    if (part < 0)
      return Failure{Error::bad_argument, begin,
                     "unknown split; the parts are texture, tessellation, shading, antialiasing and lighting"};
    parts |= 1u << part;
    begin = end + 1;
  }
  return parts;
}

bool has_baked_lighting(const SceneSet& scene) {
  return !scene.local_colors.empty() && scene.local_colors.size() == scene.fine.mesh.vertices.size() * 4;
}

Result<void> check_scene(uint32_t parts, const SceneSet& scene) {
  const bool tessellation = (parts & 1u << kTessellation) != 0, lighting = (parts & 1u << kLighting) != 0;
  if (tessellation && scene.coarse.mesh.faces.empty())
    return Failure{Error::bad_argument, 0, "split tessellation: this scene has no coarse model"};
  if (lighting && tessellation && !scene.local_colors.empty())
    return Failure{Error::bad_argument, 0, "splits lighting and tessellation do not combine: coarse colors are baked"};
  if (lighting && !has_baked_lighting(scene) && !has_lit_materials(scene))
    return Failure{Error::bad_argument, 0, "split lighting: this scene has neither lit materials nor baked lighting"};
  return {};
}

void apply(Part part, const SceneSet& scene, Split& split) {
  switch (part) {
    case kTexture:
      split.low.texture = false;
      break;
    case kTessellation:
      split.low_model = Model::coarse;
      break;
    case kShading:
      split.high.shading = raster::Shading::phong;
      split.low.shading = raster::Shading::gouraud;
      split.low.samples = 1;
      split.low.texture = false;
      break;
    case kAntialiasing:
      split.high.samples = split.low.samples = 1;
      split.low.texture = false;
      break;
    default:
      if (has_lit_materials(scene)) split.high.lighting = raster::Lighting::full;
      if (has_baked_lighting(scene)) split.low_lighting = Lighting::local;
  }
}

// A texture that is only ever drawn by its mean color.
raster::Texture mean_color_of(const raster::Texture& texture) {
  RgbaImage mean(1, 1);
  const auto color = texture.mean_color();
  std::copy(color.begin(), color.end(), mean.pixel(0, 0));
  return raster::make_texture(texture.name, std::move(mean));
}

// The scene without its textures' texels, or a whole copy.
raster::Scene copy_of(const raster::Scene& scene, bool textured) {
  if (textured) return scene;
  raster::Scene copy;
  copy.name = scene.name;
  copy.mesh = scene.mesh;
  copy.materials = scene.materials;
  for (const raster::Texture& texture : scene.textures) copy.textures.push_back(mean_color_of(texture));
  copy.objects = scene.objects;
  copy.lights = scene.lights;
  copy.ambient_light = scene.ambient_light;
  copy.ambient_reach = scene.ambient_reach;
  copy.background = scene.background;
  return copy;
}

}  // namespace

bool has_lit_materials(const SceneSet& scene) {
  return std::any_of(scene.fine.materials.begin(), scene.fine.materials.end(),
                     [](const raster::Material& material) { return material.lit; });
}

const char* const* split_names() {
  return kNames;
}

const char* split_summary(std::string_view part) {
  const int number = part_number(part);
  return number < 0 ? nullptr : kSummaries[number];
}

Result<Split> make_split(std::string_view names, const SceneSet& scene, const SplitOptions& options) {
  const int samples = options.samples;
  if (samples != 1 && samples != 4 && samples != 16 && samples != 64)
    return Failure{Error::bad_argument, 0, "samples a pixel must be 1, 4, 16 or 64"};
  PAC_TRY(const uint32_t parts, parse_parts(names));
  PAC_CHECK(check_scene(parts, scene));

  Split split;
  split.high.shading = has_lit_materials(scene) ? raster::Shading::phong : raster::Shading::gouraud;
  split.high.samples = samples;
  split.high.cull_back_faces = true;
  split.low = split.high;
  for (int part = 0; part < kPartCount; ++part) {
    if ((parts & 1u << part) == 0) continue;
    apply(static_cast<Part>(part), scene, split);
    if (!split.name.empty()) split.name += ',';
    split.name += kNames[part];
  }
  if (options.quick_low && !split.low.texture && split.low.samples > 1) split.low.shading_samples = 1;
  return split;
}

raster::Scene low_scene(const SceneSet& scene, const Split& split) {
  raster::Scene low = copy_of(split.low_model == Model::coarse ? scene.coarse : scene.fine, split.low.texture);
  if (split.low_lighting == Lighting::local)
    for (size_t i = 0; i < low.mesh.vertices.size(); ++i)
      std::copy_n(scene.local_colors.data() + 4 * i, 4, low.mesh.vertices[i].color);
  return low;
}

uint64_t high_polygon_count(const SceneSet& scene) {
  return scene.fine.mesh.faces.size();
}

uint64_t low_polygon_count(const SceneSet& scene, const Split& split) {
  return (split.low_model == Model::coarse ? scene.coarse : scene.fine).mesh.faces.size();
}

}  // namespace pac::sim
