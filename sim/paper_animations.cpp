#include "sim/paper_animations.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "base/bd_rate.h"
#include "base/parallel.h"
#include "sim/pacs.h"
#include "sim/scenes.h"

namespace pac::sim {
namespace {

constexpr int kFrames = 16, kFramesPerSecond = 20, kSide = 256;
constexpr size_t kRateCount = 4;
constexpr double kQualities[kRateCount] = {40, 20, 10, 5};       // of motion JPEG
constexpr double kQuantizerScales[kRateCount] = {4, 7, 12, 20};  // of MPEG-1

struct PaperAnimation {
  const char *scene, *title;
  bool moving;  // its parts, besides the camera
};

// A scene, built once: textures take longer than a small sequence.
struct Stage {
  const BuiltinScene& scene;
  SceneSet set;
  ObjectPath objects;
};

Stage set_up(const BuiltinScene& scene, const PaperAnimation& what, uint32_t seed) {
  Stage stage{scene, scene.build(seed), {}};
  if (what.moving) {
    move_parts(stage.set);
    stage.objects = [&scene, parts = stage.set.parts](int frame) { return scene.part_motion(frame, parts); };
  }
  return stage;
}

constexpr PaperAnimation kAnimations[] = {{"room", "A walk through the room of figure 2", false},
                                          {"cubes", "Rotating textured cubes, as on the paper’s web page", true}};

// A polygon-assisted arm and the image-based one whose bytes it takes.
struct Run {
  AnimationArm image, assisted;
  const char* step;
};

constexpr Run kRuns[] = {{AnimationArm::mjpeg, AnimationArm::mjpeg_assisted, "motion JPEG"},
                         {AnimationArm::mpeg1, AnimationArm::mpeg1_assisted, "MPEG-1"},
                         {AnimationArm::mpeg1, AnimationArm::mpeg1_predicted, "MPEG-1, predicted by the model"}};

AnimationOptions options_of(const Run& run, size_t rate, const SceneSet& set, const PaperOptions& paper) {
  AnimationOptions options;
  options.render.split = set.default_split;
  options.render.width = options.render.height = std::max(32, kSide / paper.size_divisor);
  options.render.isa = options.coding.isa = paper.isa;
  options.render.threads = options.coding.threads = 1;  // the rates run side by side
  options.frames = kFrames;
  options.frames_per_second = kFramesPerSecond;
  options.codec = run.image == AnimationArm::mjpeg ? VideoCodec::mjpeg : VideoCodec::mpeg1;
  options.quality = kQualities[rate];
  options.quantizer_scale = kQuantizerScales[rate];
  if (run.assisted == AnimationArm::mpeg1_assisted) {
    options.video.prediction = Prediction::block;
    options.video.difference = Difference::halved;
  }
  return options;
}

void append(Bytes& out, std::span<const uint8_t> bytes) {
  out.insert(out.end(), bytes.begin(), bytes.end());
}

// Frame `number` of a film of kFrames.
void add_to_film(RgbImage& film, const RgbImage& frame, int number) {
  if (film.empty()) film = RgbImage(frame.width(), frame.height() * kFrames);
  for (int y = 0; y < frame.height(); ++y)
    std::memcpy(film.row(number * frame.height() + y), frame.row(y), 3 * static_cast<size_t>(frame.width()));
}

// Everything of one run at one rate.
struct Outcome {
  Result<Animation> animation = Failure{Error::bad_argument, 0, "not run"};
  RgbImage high, image, composite;  // films
  AnimationStreams streams;
};

Outcome run_once(const Stage& stage, const Run& run, size_t rate, const PaperOptions& paper) {
  Outcome outcome;
  AnimationOptions options = options_of(run, rate, stage.set, paper);
  options.objects = stage.objects;
  outcome.streams.assisted = run.assisted;
  outcome.streams.codec = options.codec;
  AnimationSink sink;
  if (rate == kShownRate) {
    sink.session = [&](std::span<const uint8_t> session) { append_pacs_message(outcome.streams.session, session); };
    sink.frame = [&](const AnimationFrame& frame) {
      append(outcome.streams.image, frame.image_code);
      append(outcome.streams.difference, frame.difference_code);
      append_pacs_message(outcome.streams.session, frame.packet);
      add_to_film(outcome.high, frame.high, frame.number);
      add_to_film(outcome.image, frame.image_based, frame.number);
      add_to_film(outcome.composite, frame.composite, frame.number);
    };
  }
  outcome.animation = run_animation(stage.set, stage.scene.camera, options, sink);
  return outcome;
}

// The rates of a run, side by side, into `set`.
Result<void> run_rates(const Stage& stage, size_t run_number, const PaperOptions& paper, AnimationSet& set) {
  const Run& run = kRuns[run_number];
  std::vector<Outcome> outcomes(kRateCount);
  parallel_for(paper.threads, static_cast<int64_t>(kRateCount), [&](int64_t rate) {
    outcomes[static_cast<size_t>(rate)] = run_once(stage, run, static_cast<size_t>(rate), paper);
  });
  AnimationCurve& image = set.curves[static_cast<size_t>(run.image)];
  AnimationCurve& assisted = set.curves[static_cast<size_t>(run.assisted)];
  const bool first_of_image = image.points.empty();
  for (size_t rate = 0; rate < kRateCount; ++rate) {
    if (!outcomes[rate].animation.ok()) return outcomes[rate].animation.failure();
    Animation& animation = *outcomes[rate].animation;
    const double setting = run.image == AnimationArm::mjpeg ? kQualities[rate] : kQuantizerScales[rate];
    set.split = animation.split;
    set.width = animation.width;
    set.height = animation.height;
    if (first_of_image) image.points.push_back({setting, std::move(animation.image_based)});
    assisted.points.push_back({setting, std::move(animation.polygon_assisted)});
  }
  Outcome& shown = outcomes[kShownRate];
  set.high_film = std::move(shown.high);
  image.film = std::move(shown.image);
  assisted.film = std::move(shown.composite);
  set.streams[run_number] = std::move(shown.streams);
  return {};
}

std::vector<pac::RatePoint> rate_points(const AnimationCurve& curve, size_t kind) {
  std::vector<pac::RatePoint> points;
  for (const AnimationPoint& point : curve.points) {
    std::vector<FrameScores> scores;
    for (const ArmFrame& frame : point.arm.frames) scores.push_back(frame.scores);
    points.push_back({static_cast<double>(point.arm.bytes), summarize(scores, kind).mean});
  }
  return points;
}

}  // namespace

Result<std::vector<AnimationSet>> run_paper_animations(const PaperOptions& options) {
  if (options.size_divisor < 1) return Failure{Error::bad_argument, 0, "size divisor must be at least 1"};
  std::vector<AnimationSet> sets;
  const int total = static_cast<int>(std::size(kAnimations) * std::size(kRuns));
  int done = 0;
  for (const PaperAnimation& what : kAnimations) {
    const BuiltinScene* scene = find_scene(what.scene);
    if (scene == nullptr) return Failure{Error::bad_argument, 0, "a scene of the paper's animations is missing"};
    const Stage stage = set_up(*scene, what, options.seed);
    AnimationSet& set = sets.emplace_back();
    set.key = what.scene;
    set.title = what.title;
    set.frames = kFrames;
    set.frames_per_second = kFramesPerSecond;
    for (size_t run = 0; run < std::size(kRuns); ++run) {
      const std::string step = std::string(what.scene) + " moving, " + kRuns[run].step;
      if (options.progress) options.progress(step.c_str(), done++, total);
      PAC_CHECK(run_rates(stage, run, options, set));
    }
  }
  if (options.progress) options.progress("animations", total, total);
  return sets;
}

std::optional<double> bytes_saved_percent(const AnimationCurve& reference, const AnimationCurve& test, size_t kind) {
  const auto result = bd_rate(rate_points(reference, kind), rate_points(test, kind));
  if (!result.ok()) return std::nullopt;
  return -result->percent;
}

}  // namespace pac::sim
