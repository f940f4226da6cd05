// `pac animate`: a sequence through both arms.
#include <algorithm>
#include <cstdio>
#include <utility>

#include "base/verdict.h"
#include "sim/animation.h"
#include "sim/cli/animate_files.h"
#include "sim/cli/command.h"
#include "sim/cli/scene_source.h"
#include "sim/loaded_scene.h"

namespace pac::cli {
namespace {

struct Request {
  std::string scene, out, foreground;
  int first = 0, bit_rate_bps = 0;
  bool moving = false, moving_lights = false;
  sim::AnimationOptions animation;
};

// What mpeg1 alone takes.
void declare_video(Options& options, Request& request) {
  using sim::Difference;
  using sim::Prediction;
  sim::AssistedVideoOptions& video = request.animation.video;
  options.choice<Prediction>(
      "--prediction", video.prediction,
      {{"none", Prediction::none}, {"block", Prediction::block}, {"model", Prediction::model}},
      "of the polygon-assisted pictures: from nothing, by moved blocks (mpeg1), by the model (mpeg1: model; mjpeg: "
      "none)");
  options.choice<Difference>("--difference", video.difference,
                             {{"halved", Difference::halved}, {"full", Difference::full}},
                             "mpeg1: 127+(H-L)/2 as the paper, or H predicted from L (full; block: halved)");
  options.choice<sim::Residual>(
      "--residual", video.residual,
      {{"auto", sim::Residual::by_scene}, {"additive", sim::Residual::additive}, {"ratio", sim::Residual::ratio}},
      "mpeg1, difference full: of samples or of their logarithms (auto: ratio where the split is lighting)");
  options.real("--quantizer-scale", "Q", request.animation.quantizer_scale, 1, 31,
               "mpeg1: of the image-based arm; the other is matched to its bytes (8)");
  options.integer(
      "--bit-rate", "BPS", request.bit_rate_bps, 1000, 100000000,
      "mpeg1: of the polygon-assisted arm, every packet and picture by picture, through a leaky bucket; the "
      "image-based arm is matched to its bytes");
  options.real("--buffer", "SECONDS", request.animation.buffer_seconds, 0.1, 60,
               "--bit-rate: that the full bucket takes to run dry (1)");
  options.integer("--gop", "N", video.key_interval, 0, 132,
                  "pictures from one that stands alone to the next, 0: the first only (132; --bit-rate: 0)");
  options.choice<bool>("--adapt", video.adapts_to_texture, {{"off", false}, {"texture", true}},
                       "mpeg1: texture: polygon-assisted pictures that stand alone are quantized finer where H is "
                       "smooth, coarser where its texture hides errors (off)");
  options.text(
      "--foreground", "NAMES", request.foreground,
      "mpeg1: materials, joined by commas, or `moving` objects, that the polygon-assisted arm quantizes finer");
  options.real("--worth", "W", video.foreground.worth, 1.0 / 16, 16,
               "--foreground: how many times an error there counts; below 1: less than elsewhere (4)");
  options.choice<mpeg1::Effort>(
      "--effort", video.effort,
      {{"fast", mpeg1::Effort::fast}, {"default", mpeg1::Effort::normal}, {"best", mpeg1::Effort::best}},
      "mpeg1: of both encoders (default)");
}

void declare(Options& options, Request& request) {
  using sim::TableFamily;
  using sim::VideoCodec;
  sim::RenderOptions& render = request.animation.render;
  sim::CodingOptions& coding = request.animation.coding;
  options.positional("SCENE", request.scene, kSceneHelp);
  options.integer("--frames", "N", request.animation.frames, 1, 100000, "of the camera path (48)");
  options.integer("--first", "N", request.first, 0, 1000000, "frame of the path to start with (0)");
  options.integer("--fps", "F", request.animation.frames_per_second, 1, 60, "frames a second (20, as Table I)");
  options.choice<bool>("--objects", request.moving, {{"still", false}, {"moving", true}},
                       "moving: things move, too (a glTF file's animation: moving; room, cubes: still)");
  options.choice<bool>("--lights", request.moving_lights, {{"still", false}, {"moving", true}},
                       "moving: the lights of a lit scene go round the vertical through the origin (still)");
  options.text("--split", "NAMES", render.split,
               "texture, tessellation, shading, antialiasing, lighting, or several joined by commas (the scene's own)");
  options.choice<VideoCodec>("--codec", request.animation.codec,
                             {{"mjpeg", VideoCodec::mjpeg}, {"mpeg1", VideoCodec::mpeg1}}, "of both arms (mjpeg)");
  declare_video(options, request);
  options.real("-q|--quality", "Q", request.animation.quality, 0.01, 100,
               "of the image-based motion JPEG; the other arm is matched to its bytes, frame by frame (15)");
  options.choice<bool>("--model", render.transmit_model, {{"resident", false}, {"transmitted", true}},
                       "transmitted: its bytes count, and L is drawn from the decoded model (resident)");
  options.choice<TableFamily>("--tables", coding.tables,
                              {{"annex-k", TableFamily::annex_k}, {"adapted", TableFamily::adapted}},
                              "quantization tables of both arms' JPEG (annex-k)");
  options.choice<jpeg::Huffman>("--huffman", coding.huffman,
                                {{"standard", jpeg::Huffman::standard},
                                 {"optimal", jpeg::Huffman::optimal},
                                 {"difference", jpeg::Huffman::difference}},
                                "codes of both arms' JPEG; difference: fixed ones for D, standard ones for H "
                                "(standard, as the paper)");
  options.choice<jpeg::Tune>("--masking", coding.masking,
                             {{"none", jpeg::Tune::psnr}, {"ssim", jpeg::Tune::ssim}, {"visual", jpeg::Tune::visual}},
                             "with adapted tables: a trellis puts errors of both arms where H is busy (none)");
  options.integer("--width", "W", render.width, 1, 32768, "pixels (the scene's own)");
  options.integer("--height", "H", render.height, 1, 32768, "pixels (the scene's own)");
  options.choice<int>("--samples", render.samples, {{"1", 1}, {"4", 4}, {"16", 16}, {"64", 64}},
                      "a pixel, of an antialiased side (16)");
  options.text("-o|--output", "DIR", request.out, "streams and sequences go there");
}

double kilobits_a_second(uint64_t bytes, const Request& request) {
  return 8e-3 * static_cast<double>(bytes) * request.animation.frames_per_second / request.animation.frames;
}

sim::BitRate rate_of(const Request& request) {
  const sim::AnimationOptions& animation = request.animation;
  return {animation.bit_rate_bps, animation.frames_per_second, animation.buffer_seconds};
}

void json_arm(sim::JsonWriter& json, const char* name, const sim::VideoArm& arm, const Request& request) {
  std::vector<sim::FrameScores> scores;
  for (const sim::ArmFrame& frame : arm.frames) scores.push_back(frame.scores);
  json.begin_object(name);
  json.field("bytes", arm.bytes);
  json.field("kilobits_per_second", kilobits_a_second(arm.bytes, request));
  for (size_t kind = 0; kind < sim::kScoreCount; ++kind) {
    const FrameSummary summary = sim::summarize(scores, kind);
    json.begin_object(sim::kScores[kind].key);
    json.field("mean", summary.mean);
    json.field("worst_5_percent", summary.worst_5_percent);
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

// The image-based arm is the first.
Verdict verdict(const sim::Animation& animation) {
  std::vector<QualityScores> scores[2];
  for (const sim::ArmFrame& frame : animation.image_based.frames)
    scores[0].push_back(sim::quality_scores(frame.scores));
  for (const sim::ArmFrame& frame : animation.polygon_assisted.frames)
    scores[1].push_back(sim::quality_scores(frame.scores));
  return compare_quality({animation.image_based.bytes, scores[0]}, {animation.polygon_assisted.bytes, scores[1]});
}

const char* verdict_of_arms(const sim::Animation& animation) {
  switch (verdict(animation)) {
    case Verdict::first_better:
      return "the image-based arm is better";
    case Verdict::second_better:
      return "the polygon-assisted arm is better";
    case Verdict::disagree:
      return "metrics disagree";
    default:
      return "bytes differ: no comparison";
  }
}

int print_as_json(const Request& request, const sim::Animation& animation) {
  sim::JsonWriter json;
  json.begin_object();
  json.field("scene", request.scene);
  json.field("split", animation.split.name);
  json.field("codec", request.animation.codec == sim::VideoCodec::mpeg1 ? "mpeg1" : "mjpeg");
  json.field("width", animation.width);
  json.field("height", animation.height);
  json.field("frames", request.animation.frames);
  json.field("frames_per_second", request.animation.frames_per_second);
  json.field("objects", request.moving ? "moving" : "still");
  json.field("resident_model_bytes", animation.resident_model_bytes);
  json.field("packet_bytes", animation.packet_bytes);
  if (animation.bucket_bytes > 0) {
    const sim::BitRate rate = rate_of(request);
    json.begin_object("bit_rate");
    json.field("bits_per_second", rate.bits_per_second);
    json.field("bucket_bytes", animation.bucket_bytes);
    json.field("fullest_bucket_bytes", animation.fullest_bucket_bytes);
    json.field("startup_seconds", rate.startup_seconds(animation.resident_model_bytes));
    json.end_object();
  }
  json_arm(json, "image_based", animation.image_based, request);
  json_arm(json, "polygon_assisted", animation.polygon_assisted, request);
  json.field("verdict", verdict_of_arms(animation));
  json.end_object();
  return print_json(json);
}

void print_text(const Request& request, const sim::Animation& animation) {
  const sim::VideoArm &image = animation.image_based, &polygon = animation.polygon_assisted;
  std::printf("%s, split %s, %d x %d, %d frames at %d a second\n\n", request.scene.c_str(),
              animation.split.name.c_str(), animation.width, animation.height, request.animation.frames,
              request.animation.frames_per_second);
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
    const FrameSummary a = sim::summarize(scores[0], kind), b = sim::summarize(scores[1], kind);
    row(sim::kScores[kind].label, a.mean, b.mean, sim::kScores[kind].digits);
    row("  worst 5 % of frames", a.worst_5_percent, b.worst_5_percent, sim::kScores[kind].digits);
  }
  if (animation.bucket_bytes > 0)
    std::printf("\nbucket of %.0f bytes, fullest with %.0f; the model's %s bytes take %.1f s before the first frame\n",
                animation.bucket_bytes, animation.fullest_bucket_bytes, grouped(animation.resident_model_bytes).c_str(),
                rate_of(request).startup_seconds(animation.resident_model_bytes));
  std::printf("\n%s\n", verdict_of_arms(animation));
}

}  // namespace

int run_animate(Args args) {
  Options options("animate", "a sequence, image-based and polygon-assisted at matched bytes",
                  "pac animate cubes --frames 4 --codec mpeg1 --width 128 --height 128 -o cubes-animated");
  Request request;
  declare(options, request);
  if (const auto code = options.parse(args)) return *code;
  if (request.animation.coding.masking != jpeg::Tune::psnr &&
      request.animation.coding.tables != sim::TableFamily::adapted)
    return options.usage_error("--masking goes with --tables adapted");
  auto source = load_scene(request.scene, options);
  if (!source) return kBadData;
  sim::AnimationOptions& animation = request.animation;
  if (options.given("--bit-rate") && options.given("--quantizer-scale"))
    return options.usage_error("--bit-rate chooses the quantizer itself: leave --quantizer-scale out");
  if (options.given("--buffer") && !options.given("--bit-rate"))
    return options.usage_error("--buffer says nothing without --bit-rate");
  if (options.given("--bit-rate") && animation.codec != sim::VideoCodec::mpeg1)
    return options.usage_error("--bit-rate needs --codec mpeg1");
  if (options.given("--foreground") && animation.codec != sim::VideoCodec::mpeg1)
    return options.usage_error("--foreground needs --codec mpeg1");
  if (options.given("--worth") && !options.given("--foreground"))
    return options.usage_error("--worth says nothing without --foreground");
  sim::read_foreground(request.foreground, animation.video.foreground);
  if (options.given("--prediction")) animation.still_prediction = animation.video.prediction;
  if (animation.codec == sim::VideoCodec::mjpeg && animation.still_prediction == sim::Prediction::block)
    return options.usage_error("--prediction block needs --codec mpeg1");
  if (options.given("--bit-rate") && animation.video.prediction != sim::Prediction::model)
    return options.usage_error("--bit-rate needs --prediction model");
  animation.bit_rate_bps = static_cast<uint64_t>(request.bit_rate_bps);
  if (options.given("--bit-rate") && !options.given("--gop")) animation.video.key_interval = 0;
  if (animation.video.prediction == sim::Prediction::block && !options.given("--difference"))
    animation.video.difference = sim::Difference::halved;
  if (animation.video.residual == sim::Residual::ratio && animation.video.difference != sim::Difference::full)
    return options.usage_error("--residual ratio needs --difference full");
  if (request.moving && !source->can_move())
    return options.usage_error("--objects moving: nothing in this scene can move");
  if (!options.given("--objects")) request.moving = source->builtin == nullptr && source->can_move();
  if (request.moving && source->builtin != nullptr) sim::move_parts(source->set);
  const size_t n_moved = source->set.fine.objects.size();
  const size_t n_lights = request.moving_lights ? source->set.fine.lights.size() : 0;
  if (request.moving_lights && (n_lights == 0 || !sim::has_lit_materials(source->set) ||
                                animation.render.split.find("tessellation") != std::string::npos))
    return options.usage_error("--lights moving: the scene must be lit by lights, and its split not be tessellation");
  if (request.moving_lights) sim::move_lights(source->set.fine);
  if (animation.render.split.find("tessellation") != std::string::npos && source->builtin == nullptr)
    sim::add_coarse_model(source->set);
  animation.render.threads = animation.coding.threads = options.threads;
  animation.render.isa = animation.coding.isa = options.isa;

  AnimationFiles files(request.out, animation.codec, animation.frames_per_second, options.isa);
  if (const int code = files.open(); code != kDone) return code;
  Progress progress(options.quiet);
  sim::AnimationSink sink;
  sink.session = [&](std::span<const uint8_t> session) { files.add_session(session); };
  sink.frame = [&](const sim::AnimationFrame& frame) {
    files.add_frame(frame);
    progress.show(static_cast<double>(frame.number + 1) / animation.frames, "frames");
  };
  // The animation takes the scene over; a copy of its mesh stays behind, which the path of a loaded model frames, and
  // what moves its objects.
  SceneSource framed;
  framed.builtin = source->builtin;
  framed.animation = source->animation;
  framed.set.parts = source->set.parts;
  framed.set.fine.mesh = source->set.fine.mesh;
  framed.set.fine.objects = source->set.fine.objects;
  if (request.moving || request.moving_lights)
    animation.objects = [&](int frame) {
      const int number = request.first + frame;
      sim::Transforms all =
          request.moving ? framed.transforms(number, animation.frames_per_second) : sim::transforms_of(framed.set.fine);
      all.resize(n_moved);
      sim::add_light_transforms(number, n_lights, all);
      return all;
    };
  const auto path = [&](int frame, float aspect) { return framed.camera(request.first + frame, aspect); };
  const auto result = sim::run_animation(std::move(source->set), path, animation, sink);
  if (!result.ok()) return data_error(request.scene, result.failure());
  if (const int code = files.write(); code != kDone) return code;
  if (options.json) return print_as_json(request, *result);
  print_text(request, *result);
  return kDone;
}

}  // namespace pac::cli
