// `pac render`: one picture of a scene.
#include <cstdio>

#include "base/image_io.h"
#include "raster/renderer.h"
#include "sim/cli/command.h"
#include "sim/cli/image_files.h"
#include "sim/cli/scene_source.h"
#include "sim/difference.h"
#include "sim/split.h"

namespace pac::cli {
namespace {

using raster::RenderQuality;
using raster::Shading;

enum class Level : uint8_t { high, low };
enum class LightingChoice : uint8_t { full, maps, local };

struct Request {
  std::string scene, out, depth_out, id_out;
  int width = 0, height = 0, frame = 0;
  Level quality = Level::high;
  bool texture = true;
  Shading shading = Shading::gouraud;
  LightingChoice lighting = LightingChoice::full;
  int samples = 16, shading_samples = 0;
  sim::Model tessellation = sim::Model::fine;
  int anisotropy = 1;
  raster::Filter filter = raster::Filter::trilinear;
  double fog = 0;
};

struct Drawn {
  RgbImage color;
  DepthImage depth;  // empty where not asked for
  IdImage id;
  raster::RenderStats stats;
  uint64_t polygons = 0;
  double ms = 0;
};

void declare(Options& options, Request& request) {
  options.positional("SCENE", request.scene, kSceneHelp);
  options.text("-o|--output", "OUT.png", request.out, ".png or .ppm; - is stdout (PNG)");
  options.integer("--width", "W", request.width, 1, 32768, "pixels (the scene's own)");
  options.integer("--height", "H", request.height, 1, 32768, "pixels (the scene's own)");
  options.integer("--frame", "N", request.frame, 0, 1000000,
                  "of the camera path, and of the file's animation at 20 a second (0)");
  options.choice<Level>("--quality", request.quality, {{"high", Level::high}, {"low", Level::low}},
                        "H or L of the scene's own split; the options below change it further");
  options.choice<bool>("--texture", request.texture, {{"on", true}, {"off", false}}, "off: mean colors");
  options.choice<Shading>("--shading", request.shading,
                          {{"flat", Shading::flat}, {"gouraud", Shading::gouraud}, {"phong", Shading::phong}},
                          "where lights are lit: polygon, vertex or sample");
  options.choice<LightingChoice>(
      "--lighting", request.lighting,
      {{"full", LightingChoice::full}, {"maps", LightingChoice::maps}, {"local", LightingChoice::local}},
      "full: shadows, ambient occlusion or the baked solution; maps: shadows by depth maps; local: without "
      "(the baked solution)");
  options.choice<int>("--samples", request.samples, {{"1", 1}, {"4", 4}, {"16", 16}, {"64", 64}},
                      "a pixel (16; quality low: the split's)");
  options.choice<int>("--shading-samples", request.shading_samples, {{"0", 0}, {"1", 1}, {"4", 4}},
                      "places where a pixel of several samples is shaded; 0: at each sample (0)");
  options.choice<sim::Model>("--tessellation", request.tessellation,
                             {{"fine", sim::Model::fine}, {"coarse", sim::Model::coarse}}, "which of two models");
  options.integer("--anisotropy", "N", request.anisotropy, 1, 8,
                  "most texture probes along a pixel's longer side (the file's, or 1)");
  using raster::Filter;
  options.choice<Filter>(
      "--filter", request.filter,
      {{"nearest", Filter::nearest}, {"bilinear", Filter::bilinear}, {"trilinear", Filter::trilinear}},
      "of textures (the file's)");
  options.real("--fog", "D", request.fog, 0, 1e9, "grey fog that at distance D leaves 2 % of a color (0: none)");
  options.text("--depth", "OUT.pfm", request.depth_out, "window depth, 0 near to 1 far and background");
  options.text("--id", "OUT.png", request.id_out, "polygons as colors; background black");
}

// The split's own H or L, changed by what the command line names.
Result<sim::Split> quality_of(const Options& options, const Request& request, const sim::SceneSet& set) {
  PAC_TRY(sim::Split split, sim::make_split(set.default_split, set, {request.samples}));
  RenderQuality& quality = request.quality == Level::high ? split.high : split.low;
  if (request.quality == Level::high) {
    split.low_model = sim::Model::fine;
    split.low_lighting = sim::Lighting::full;
  }
  if (options.given("--texture")) quality.texture = request.texture;
  if (options.given("--shading")) quality.shading = request.shading;
  if (options.given("--samples")) quality.samples = request.samples;
  quality.shading_samples = request.shading_samples;
  if (options.given("--tessellation")) split.low_model = request.tessellation;
  if (options.given("--lighting")) {
    const bool full = request.lighting != LightingChoice::local;
    quality.lighting = request.lighting == LightingChoice::maps ? raster::Lighting::shadow_maps
                       : full                                   ? raster::Lighting::full
                                                                : raster::Lighting::local;
    if (full && !options.given("--shading") && sim::has_lit_materials(set)) quality.shading = Shading::phong;
    split.low_lighting = full || set.local_colors.empty() ? sim::Lighting::full : sim::Lighting::local;
  }
  split.low = quality;
  return split;
}

// What the scene cannot do, or empty.
std::string scene_problem(const sim::Split& split, const sim::SceneSet& set) {
  if (split.low_model == sim::Model::coarse && set.coarse.mesh.faces.empty()) return "has no coarse model";
  return "";
}

// What the command line says about the scene itself.
void change_scene(const Options& options, const Request& request, raster::Scene& scene) {
  for (raster::Material& material : scene.materials) {
    if (options.given("--anisotropy")) material.anisotropy = request.anisotropy;
    if (options.given("--filter")) material.filter = request.filter;
  }
  if (request.fog == 0) return;
  scene.fog.kind = raster::Fog::Kind::exponential_squared;
  scene.fog.color = scene.background = glm::vec3(0.75f);
  scene.fog.density = static_cast<float>(2 / request.fog);  // exp(-2^2) = 0.018
}

Result<Drawn> draw(const Options& options, const Request& request, const SceneSource& source, const sim::Split& split) {
  Drawn drawn;
  drawn.color = RgbImage(request.width, request.height);
  if (!request.depth_out.empty()) drawn.depth = DepthImage(request.width, request.height);
  if (!request.id_out.empty()) drawn.id = IdImage(request.width, request.height);
  raster::RendererOptions renderer_options;
  renderer_options.threads = options.threads;
  renderer_options.isa = options.isa;
  PAC_TRY(raster::Renderer renderer, raster::Renderer::create(request.width, request.height, renderer_options));
  raster::Scene scene = sim::low_scene(source.set, split);
  change_scene(options, request, scene);
  drawn.polygons = scene.mesh.faces.size();
  const float aspect = static_cast<float>(request.width) / static_cast<float>(request.height);
  const raster::Camera camera = source.camera(request.frame, aspect);
  const Stopwatch clock;
  PAC_TRY(drawn.stats,
          renderer.render(scene, camera, split.low, {drawn.color.view(), drawn.depth.view(), drawn.id.view()}));
  drawn.ms = clock.ms();
  return drawn;
}

// Distinct neighboring polygons get distinct colors: the number times an odd constant, three bytes of it.
RgbImage id_colors(const IdImage& ids) {
  RgbImage image(ids.width(), ids.height());
  for (int y = 0; y < ids.height(); ++y)
    for (int x = 0; x < ids.width(); ++x) {
      const uint32_t hash = *ids.pixel(x, y) * 2654435761u;
      for (int c = 0; c < 3; ++c) image.pixel(x, y)[c] = static_cast<uint8_t>(hash >> (8 + 8 * c));
    }
  return image;
}

int write_outputs(const Request& request, const Drawn& drawn) {
  if (!request.depth_out.empty())
    if (const int code = write_output(request.depth_out, encode_pfm(drawn.depth.view())); code != kDone) return code;
  if (!request.id_out.empty())
    if (const int code = write_picture(request.id_out, id_colors(drawn.id).view()); code != kDone) return code;
  return request.out.empty() ? kDone : write_picture(request.out, drawn.color.view());
}

int print_summary(const Options& options, const Request& request, const Drawn& drawn) {
  char hash[20];
  std::snprintf(hash, sizeof hash, "%016llx", static_cast<unsigned long long>(sim::image_hash(drawn.color.view())));
  if (options.json) {
    sim::JsonWriter json;
    json.begin_object();
    json.field("scene", request.scene);
    json.field("width", request.width);
    json.field("height", request.height);
    json.field("polygons", drawn.polygons);
    json.field("triangles", drawn.stats.triangles_submitted);
    json.field("triangles_drawn", drawn.stats.triangles_drawn);
    json.field("triangles_dropped", drawn.stats.triangles_dropped);
    json.fixed_field("ms", drawn.ms, 3);
    json.field("hash", hash);
    json.end_object();
    return print_json(json);
  }
  if (!options.quiet)
    std::fprintf(stderr, "%s: %d x %d, %s polygons, %s triangles, %.1f ms, hash %s\n", request.scene.c_str(),
                 request.width, request.height, grouped(drawn.polygons).c_str(),
                 grouped(drawn.stats.triangles_submitted).c_str(), drawn.ms, hash);
  return kDone;
}

std::string usage_problem(const Options& options, const Request& request) {
  if (request.out.empty() && !options.json) return "missing -o OUT.png (only --json works without)";
  if (options.json && request.out == "-") return "--json and -o - both want stdout";
  for (const std::string& path : {request.out, request.id_out})
    if (!path.empty() && !picture_name_problem(path).empty()) return picture_name_problem(path);
  if (!request.depth_out.empty() && extension(request.depth_out) != ".pfm") return "--depth writes .pfm files";
  return "";
}

}  // namespace

int run_render(Args args) {
  Options options("render", "draws one picture of a scene", "pac render room -o room.png");
  Request request;
  declare(options, request);
  if (const auto code = options.parse(args)) return *code;
  if (const std::string problem = usage_problem(options, request); !problem.empty())
    return options.usage_error(problem);
  auto source = load_scene(request.scene, options);
  if (!source) return kBadData;
  source->pose(request.frame, kStillFramesPerSecond);
  if (!options.given("--width")) request.width = source->set.width;
  if (!options.given("--height")) request.height = source->set.height;
  const auto split = quality_of(options, request, source->set);
  if (!split.ok()) return data_error(request.scene, split.failure());
  if (const std::string problem = scene_problem(*split, source->set); !problem.empty())
    return data_error(request.scene, problem);
  const auto drawn = draw(options, request, *source, *split);
  if (!drawn.ok()) return data_error(request.scene, drawn.failure());
  if (const int code = write_outputs(request, *drawn); code != kDone) return code;
  return print_summary(options, request, *drawn);
}

}  // namespace pac::cli
