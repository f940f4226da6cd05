// `pac animate`: a sequence through both arms.
#include <cstdio>
#include <utility>

#include "sim/animation.h"
#include "sim/cli/animate_files.h"
#include "sim/cli/command.h"
#include "sim/cli/scene_source.h"
#include "sim/loaded_scene.h"

namespace pac::cli {
namespace {

struct Request {
  std::string scene, out;
  int first = 0, fps = 20;
  sim::AnimationOptions animation;
};

void declare(Options& options, Request& request) {
  using sim::TableFamily;
  using sim::VideoCodec;
  sim::RenderOptions& render = request.animation.render;
  sim::CodingOptions& coding = request.animation.coding;
  options.positional("SCENE", request.scene, kSceneHelp);
  options.integer("--frames", "N", request.animation.frames, 1, 100000, "of the camera path (48)");
  options.integer("--first", "N", request.first, 0, 1000000, "frame of the path to start with (0)");
  options.integer("--fps", "F", request.fps, 1, 1000, "frames a second (20, as Table I)");
  options.text("--split", "NAMES", render.split,
               "texture, tessellation, shading, antialiasing, lighting, or several joined by commas (the scene's own)");
  options.choice<VideoCodec>("--codec", request.animation.codec, {{"mjpeg", VideoCodec::mjpeg}},
                             "of both arms (mjpeg)");
  options.real("-q|--quality", "Q", request.animation.quality, 0.01, 100,
               "of the image-based motion JPEG; the other arm is matched to its bytes, frame by frame (15)");
  options.choice<bool>("--model", render.transmit_model, {{"resident", false}, {"transmitted", true}},
                       "transmitted: its bytes count, and L is drawn from the decoded model (resident)");
  options.choice<TableFamily>("--tables", coding.tables,
                              {{"annex-k", TableFamily::annex_k}, {"adapted", TableFamily::adapted}},
                              "quantization tables of both arms' JPEG (annex-k)");
  options.choice<jpeg::Huffman>("--huffman", coding.huffman,
                                {{"standard", jpeg::Huffman::standard}, {"optimal", jpeg::Huffman::optimal}},
                                "codes of both arms' JPEG (standard, as the paper)");
  options.integer("--width", "W", render.width, 1, 32768, "pixels (the scene's own)");
  options.integer("--height", "H", render.height, 1, 32768, "pixels (the scene's own)");
  options.choice<int>("--samples", render.samples, {{"1", 1}, {"4", 4}, {"16", 16}, {"64", 64}},
                      "a pixel, of an antialiased side (16)");
  options.text("-o|--output", "DIR", request.out, "streams and sequences go there");
}

double kilobits_a_second(uint64_t bytes, const Request& request) {
  return 8e-3 * static_cast<double>(bytes) * request.fps / request.animation.frames;
}

void json_arm(sim::JsonWriter& json, const char* name, const sim::VideoArm& arm, const Request& request) {
  std::vector<sim::FrameScores> scores;
  for (const sim::ArmFrame& frame : arm.frames) scores.push_back(frame.scores);
  json.begin_object(name);
  json.field("bytes", arm.bytes);
  json.field("kilobits_per_second", kilobits_a_second(arm.bytes, request));
  for (size_t kind = 0; kind < sim::kScoreCount; ++kind) {
    const sim::ScoreSummary summary = sim::summarize(scores, kind);
    json.begin_object(sim::kScores[kind].key);
    json.field("mean", summary.mean);
    json.field("worst_5_percent", summary.worst);
    json.end_object();
  }
  json.begin_array("frames");
  for (const sim::ArmFrame& frame : arm.frames) {
    json.begin_object();
    json.field("bytes", frame.bytes);
    json.field("quality", frame.quality);
    for (size_t kind = 0; kind < sim::kScoreCount; ++kind) json.field(sim::kScores[kind].key, frame.scores[kind]);
    json.end_object();
  }
  json.end_array();
  json.end_object();
}

int print_as_json(const Request& request, const sim::Animation& animation) {
  sim::JsonWriter json;
  json.begin_object();
  json.field("scene", request.scene);
  json.field("split", animation.split.name);
  json.field("codec", "mjpeg");
  json.field("width", animation.width);
  json.field("height", animation.height);
  json.field("frames", request.animation.frames);
  json.field("frames_per_second", request.fps);
  json.field("resident_model_bytes", animation.resident_model_bytes);
  json.field("packet_bytes", animation.packet_bytes);
  json_arm(json, "image_based", animation.image_based, request);
  json_arm(json, "polygon_assisted", animation.polygon_assisted, request);
  json.end_object();
  return print_json(json);
}

void print_text(const Request& request, const sim::Animation& animation) {
  const sim::VideoArm &image = animation.image_based, &polygon = animation.polygon_assisted;
  std::printf("%s, split %s, %d x %d, %d frames at %d a second\n\n", request.scene.c_str(),
              animation.split.name.c_str(), animation.width, animation.height, request.animation.frames, request.fps);
  std::printf("%-26s %22s %22s\n", "", "image-based", "polygon-assisted");
  const auto row = [](const char* label, double a, double b, int digits) {
    std::printf("%-26s %22.*f %22.*f\n", label, digits, a, digits, b);
  };
  std::printf("%-26s %22s %22s\n", "bytes", grouped(image.bytes).c_str(), grouped(polygon.bytes).c_str());
  row("kb/s", kilobits_a_second(image.bytes, request), kilobits_a_second(polygon.bytes, request), 1);
  std::vector<sim::FrameScores> scores[2];
  for (const sim::ArmFrame& frame : image.frames) scores[0].push_back(frame.scores);
  for (const sim::ArmFrame& frame : polygon.frames) scores[1].push_back(frame.scores);
  for (size_t kind = 0; kind < sim::kScoreCount; ++kind) {
    const sim::ScoreSummary a = sim::summarize(scores[0], kind), b = sim::summarize(scores[1], kind);
    row(sim::kScores[kind].label, a.mean, b.mean, sim::kScores[kind].digits);
    row("  worst 5 % of frames", a.worst, b.worst, sim::kScores[kind].digits);
  }
}

}  // namespace

int run_animate(Args args) {
  Options options("animate", "a sequence, image-based and polygon-assisted at matched bytes",
                  "pac animate cubes --frames 4 --codec mjpeg --width 128 --height 128 -o cubes-animated");
  Request request;
  declare(options, request);
  if (const auto code = options.parse(args)) return *code;
  auto source = load_scene(request.scene, options);
  if (!source) return kBadData;
  sim::AnimationOptions& animation = request.animation;
  if (animation.render.split.find("tessellation") != std::string::npos && source->builtin == nullptr)
    sim::add_coarse_model(source->set);
  animation.render.threads = animation.coding.threads = options.threads;
  animation.render.isa = animation.coding.isa = options.isa;

  AnimationFiles files(request.out, request.fps, options.isa);
  if (const int code = files.open(); code != kDone) return code;
  Progress progress(options.quiet);
  sim::AnimationSink sink;
  sink.session = [&](std::span<const uint8_t> session) { files.add_session(session); };
  sink.frame = [&](const sim::AnimationFrame& frame) {
    files.add_frame(frame);
    progress.show(static_cast<double>(frame.number + 1) / animation.frames, "frames");
  };
  const auto path = [&](int frame, float aspect) { return source->camera(request.first + frame, aspect); };
  const auto result = sim::run_animation(std::move(source->set), path, animation, sink);
  if (!result.ok()) return data_error(request.scene, result.failure());
  if (const int code = files.write(); code != kDone) return code;
  if (options.json) return print_as_json(request, *result);
  print_text(request, *result);
  return kDone;
}

}  // namespace pac::cli
