// `pac compare`: one still through both arms at matched bytes.
#include <cstdio>
#include <optional>
#include <string>

#include "base/cambi.h"
#include "base/edge_band.h"
#include "base/image_io.h"
#include "base/metrics.h"
#include "sim/cli/command.h"
#include "sim/cli/image_files.h"
#include "sim/cli/report_files.h"
#include "sim/cli/scene_source.h"
#include "sim/experiment.h"
#include "sim/loaded_scene.h"
#include "sim/packet.h"
#include "sim/report_demo.h"

namespace pac::cli {
namespace {

struct Request {
  std::string scene, out, weights, foreground;
  int frame = 0, bytes = 0;
  sim::StillOptions still;
  sim::Codec codec = sim::Codec::jpeg;
};

void declare(Options& options, Request& request) {
  using sim::TableFamily;
  sim::RenderOptions& render = request.still.render;
  sim::CodingOptions& coding = request.still.coding;
  options.positional("SCENE", request.scene, kSceneHelp);
  options.text("--split", "NAMES", render.split,
               "texture, tessellation, shading, antialiasing, lighting, or several joined by commas (the scene's own)");
  options.real("-q|--quality", "Q", request.still.quality, 0.01, 100,
               "of the image-based arm; the other is matched to its bytes (15)");
  options.integer("--bytes", "N", request.bytes, 1, 2147483647,
                  "match both arms to this size instead, a transmitted model included");
  options.choice<bool>("--model", render.transmit_model, {{"resident", false}, {"transmitted", true}},
                       "transmitted: its bytes count, and L is drawn from the decoded model (resident)");
  options.integer("--position-bits", "N", render.position_bits, 1, 16,
                  "of the transmitted model (16; with --bytes what divides them best between model and image)");
  options.choice<TableFamily>("--tables", coding.tables,
                              {{"annex-k", TableFamily::annex_k}, {"adapted", TableFamily::adapted}},
                              "quantization tables of both arms (annex-k)");
  options.choice<jpeg::Huffman>("--huffman", coding.huffman,
                                {{"standard", jpeg::Huffman::standard},
                                 {"optimal", jpeg::Huffman::optimal},
                                 {"difference", jpeg::Huffman::difference}},
                                "codes of both arms; difference: fixed ones for D, standard ones for H (standard, as "
                                "the paper)");
  options.choice<jpeg::Tune>("--masking", coding.masking,
                             {{"none", jpeg::Tune::psnr}, {"ssim", jpeg::Tune::ssim}, {"visual", jpeg::Tune::visual}},
                             "with adapted tables: a trellis puts errors of both arms where H is busy (none)");
  options.text(
      "--weights", "CLASS=W,...", request.weights,
      "with adapted tables: an error in blocks of that class counts W times, 1/16..16: flat, textured, specular, "
      "edge, silhouette (1)");
  options.text("--foreground", "NAMES", request.foreground,
               "with adapted tables: materials of H, or \"moving\" objects, that come before the rest");
  options.real("--worth", "W", render.importance.foreground.worth, 1.0 / 16, 16,
               "--foreground: how many times an error there counts; below 1: less than elsewhere (4)");
  options.choice<sim::Codec>("--codec", request.codec, {{"jpeg", sim::Codec::jpeg}}, "of both arms (jpeg)");
  options.integer("--width", "W", render.width, 1, 32768, "pixels (the scene's own)");
  options.integer("--height", "H", render.height, 1, 32768, "pixels (the scene's own)");
  options.choice<int>("--samples", render.samples, {{"1", 1}, {"4", 4}, {"16", 16}, {"64", 64}},
                      "a pixel, of an antialiased side (16)");
  options.integer("--frame", "N", request.frame, 0, 1000000, "of the camera path (0)");
  options.text("-o|--output", "DIR", request.out, "index.html and the pictures go there");
}

// --weights, --foreground and --worth; a code where they make no sense.
std::optional<int> read_importance(const Options& options, Request& request) {
  sim::ImportanceOptions& importance = request.still.render.importance;
  if (options.given("--worth") && !options.given("--foreground"))
    return options.usage_error("--worth says nothing without --foreground");
  const auto read = sim::read_class_weights(request.weights, importance.of_class);
  if (!read.ok()) return options.usage_error(std::string("--weights: ") + read.failure().text);
  sim::read_foreground(request.foreground, importance.foreground);
  if (importance.is_on() && request.still.coding.tables != sim::TableFamily::adapted)
    return options.usage_error("--weights and --foreground go with --tables adapted");
  return {};
}

void json_arm(sim::JsonWriter& json, const char* name, const sim::Arm& arm, const sim::Renderings& renderings) {
  const ConstRgbView high = renderings.high.view();
  const Metrics metrics = measure(high, arm.shown.view());
  json.begin_object(name);
  json.field("bytes", arm.total_bytes);
  json.field("image_bytes", arm.image_bytes);
  json.field("model_bytes", arm.model_bytes);
  json.field("quality", arm.coded.quality);
  json.field("quality_division_undone", arm.coded.equivalent_quality);
  json.field("compression_ratio", arm.compression_ratio);
  json.field("budget_share", arm.budget_share);
  json.field("rms", metrics.rms);
  json.field("psnr_rgb_db", metrics.psnr_rgb_db);
  json.field("psnr_luma_db", metrics.psnr_luma_db);
  json.field("ssim", metrics.ssim);
  json.field("ms_ssim", metrics.ms_ssim);
  json.field("ssimulacra2", metrics.ssimulacra2);
  json.field("flip", metrics.flip);
  json.field("psnr_hvs_m_db", metrics.psnr_hvs_m_db);
  json.field("cambi", cambi_luma(arm.shown.view()));
  json.field("edge_band_rms", masked_rms(high, arm.shown.view(), renderings.blocks.edge_band.view()).rms);
  json.field("max_error", metrics.max_error);
  json.end_object();
}

void json_entropies(sim::JsonWriter& json, const char* name, const sim::Entropies& entropies) {
  json.begin_object(name);
  json.field("luma", entropies.luma);
  json.field("mean_rgb", entropies.mean_rgb);
  json.field("joint_rgb", entropies.joint_rgb);
  json.end_object();
}

void json_divisions(sim::JsonWriter& json, const std::vector<sim::Division>& divisions) {
  json.begin_array("divisions");
  for (const sim::Division& division : divisions) {
    json.begin_object();
    json.field("position_bits", division.position_bits);
    json.field("model_bytes", division.model_bytes);
    json.field("image_bytes", division.image_bytes);
    json.field("quality", division.image_quality);
    json.field("rms", division.rms);
    json.end_object();
  }
  json.end_array();
}

int print_as_json(const std::string& scene, const sim::DividedStill& divided) {
  const sim::Still& still = divided.still;
  const sim::Renderings& renderings = still.renderings;
  sim::JsonWriter json;
  json.begin_object();
  json.field("scene", scene);
  json.field("split", renderings.split.name);
  json.field("codec", "jpeg");
  json.field("width", renderings.high.width());
  json.field("height", renderings.high.height());
  json.field("high_polygons", renderings.high_polygons);
  json.field("low_polygons", renderings.low_polygons);
  json.begin_object("entropy_bits");
  json_entropies(json, "high", renderings.high_entropy);
  json_entropies(json, "low", renderings.low_entropy);
  json_entropies(json, "difference", renderings.difference_entropy);
  json.end_object();
  json.begin_object("model");
  json.field("transmitted", renderings.model_transmitted);
  json.field("bytes", renderings.model_bytes);
  if (renderings.model_transmitted) json.field("position_bits", renderings.position_bits);
  json.field("estimated_bytes", renderings.estimated_model_bytes);
  json.field("visible_polygons", renderings.visible_low_polygons);
  json.field("resident_bytes", renderings.resident_model_bytes);
  json.end_object();
  if (!divided.divisions.empty()) json_divisions(json, divided.divisions);
  json_arm(json, "image_based", still.image_based, renderings);
  json_arm(json, "polygon_assisted", still.polygon_assisted, renderings);
  json.end_object();
  return print_json(json);
}

void print_divisions(const std::vector<sim::Division>& divisions) {
  if (divisions.empty()) return;
  std::printf("\n%-14s %12s %12s %12s %8s\n", "position bits", "model bytes", "image bytes", "JPEG quality", "rms");
  for (const sim::Division& division : divisions)
    std::printf("%-14d %12s %12s %12.1f %8.2f\n", division.position_bits, grouped(division.model_bytes).c_str(),
                grouped(division.image_bytes).c_str(), division.image_quality, division.rms);
}

void print_text(const std::string& scene, const sim::Still& still) {
  const sim::Renderings& renderings = still.renderings;
  std::printf("%s, split %s, %d x %d, %s -> %s polygons\n", scene.c_str(), renderings.split.name.c_str(),
              renderings.high.width(), renderings.high.height(), grouped(renderings.high_polygons).c_str(),
              grouped(renderings.low_polygons).c_str());
  std::printf("entropy of H %.2f, of D %.2f bits (mean of R, G, B)\n\n", renderings.high_entropy.mean_rgb,
              renderings.difference_entropy.mean_rgb);
  std::printf("%-26s %14s %18s\n", "", "image-based", "polygon-assisted");
  const sim::Arm &image = still.image_based, &polygon = still.polygon_assisted;
  const auto row = [](const char* label, double a, double b, int digits) {
    std::printf("%-26s %14.*f %18.*f\n", label, digits, a, digits, b);
  };
  row("JPEG quality factor", image.coded.quality, polygon.coded.quality, 1);
  row("  division by two undone", image.coded.equivalent_quality, polygon.coded.equivalent_quality, 1);
  std::printf("%-26s %14s %18s\n", "bytes", grouped(image.total_bytes).c_str(), grouped(polygon.total_bytes).c_str());
  if (polygon.model_bytes > 0)
    std::printf("%-26s %14s %18s\n",
                ("  of it the model, " + std::to_string(renderings.position_bits) + " bits").c_str(), "",
                grouped(polygon.model_bytes).c_str());
  row("compression ratio (:1)", image.compression_ratio, polygon.compression_ratio, 1);
  row("% of 2 Mb/s at 20/s", 100 * image.budget_share, 100 * polygon.budget_share, 0);
  row("rms", image.scores.rms, polygon.scores.rms, 2);
  row("PSNR (dB)", image.scores.psnr_db, polygon.scores.psnr_db, 2);
  row("SSIM", image.scores.ssim, polygon.scores.ssim, 4);
  const auto edge_rms = [&](const sim::Arm& arm) {
    return masked_rms(renderings.high.view(), arm.shown.view(), renderings.blocks.edge_band.view()).rms;
  };
  row("rms within 2 of an edge", edge_rms(image), edge_rms(polygon), 2);
}

// Both arms; where a transmitted model shares --bytes with the image, at the best division unless the bits are given.
Result<sim::DividedStill> run(const sim::SceneSet& scene, const raster::Camera& camera, sim::StillOptions options,
                              bool bits_given) {
  const bool shares = options.render.transmit_model && options.target_bytes > 0;
  if (shares && !bits_given) return sim::divide_budget(scene, camera, options);
  options.charge_model = shares;
  sim::DividedStill result;
  PAC_TRY(result.still, sim::run_still(scene, camera, options));
  return result;
}

// The command line that makes the page again.
std::string command_line(Args args) {
  std::string line = "pac compare";
  for (const char* argument : args) line += std::string(" ") + argument;
  return line;
}

}  // namespace

int run_compare(Args args) {
  Options options("compare", "one still, image-based and polygon-assisted at matched bytes",
                  "pac compare room --quality 15 -o room-compared");
  Request request;
  declare(options, request);
  if (const auto code = options.parse(args)) return *code;
  if (options.given("--bytes") && options.given("--quality"))
    return options.usage_error("--bytes chooses the quality itself: leave --quality out");
  if (options.given("--position-bits") && !request.still.render.transmit_model)
    return options.usage_error("--position-bits is of a transmitted model: add --model transmitted");
  if (request.still.coding.masking != jpeg::Tune::psnr && request.still.coding.tables != sim::TableFamily::adapted)
    return options.usage_error("--masking goes with --tables adapted");
  if (const auto code = read_importance(options, request)) return *code;
  auto source = load_scene(request.scene, options);
  if (!source) return kBadData;
  source->pose(request.frame, kStillFramesPerSecond);
  if (request.still.render.split.find("tessellation") != std::string::npos && source->builtin == nullptr)
    sim::add_coarse_model(source->set);
  request.still.target_bytes = static_cast<uint64_t>(request.bytes);
  request.still.render.find_blocks = true;
  request.still.render.threads = request.still.coding.threads = options.threads;
  request.still.render.isa = request.still.coding.isa = options.isa;
  const auto size = [](int given, int own) { return static_cast<float>(given > 0 ? given : own); };
  const float aspect =
      size(request.still.render.width, source->set.width) / size(request.still.render.height, source->set.height);
  const auto divided =
      run(source->set, source->camera(request.frame, aspect), request.still, options.given("--position-bits"));
  if (!divided.ok()) return data_error(request.scene, divided.failure());
  const sim::Still& still = divided->still;
  if (!request.out.empty()) {
    const auto page = sim::compare_report(source->name.substr(source->name.rfind('/') + 1), still, command_line(args));
    if (const int code = write_report(request.out, page, options); code != kDone) return code;
  }
  if (options.json) return print_as_json(source->name, *divided);
  print_text(source->name, still);
  print_divisions(divided->divisions);
  if (!request.out.empty() && !options.quiet) std::fprintf(stderr, "\nlook at %s/index.html\n", request.out.c_str());
  return kDone;
}

}  // namespace pac::cli
