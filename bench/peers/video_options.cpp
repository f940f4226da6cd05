// What an option of the model's video is worth: its bytes over those without it at equal score, percent.
//   video_options SCENE SPLIT FRAMES SIZE fast|default|best [FORM] OPTION...
// SCENE: as for video_peers; SIZE: pixels of the longer side; FORM: none, block or model of halved differences instead
// of the model's full ones. OPTION, each against the same coding without it: adapted (`--adapt texture`), priced
// (pictures coded again at what their bits cost packed), ratio (`--residual ratio`); by SSIMULACRA 2, FLIP and
// PSNR-HVS-M, mean and worst 5 % of the frames.
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <vector>

#include "base/bd_rate.h"
#include "bench/peers/scene_shots.h"
#include "sim/video_scores.h"
#include "sim/video_sequence.h"

namespace {

using namespace pac;
using bench::need;

struct Point {
  double bytes = 0;
  double score[2][3] = {};  // mean, worst 5 %
};

std::vector<Point> curve(const bench::Sequence& sequence, sim::AssistedVideoOptions options, const char* name) {
  std::vector<Point> points;
  for (const double quantizer : {6.0, 10.0, 16.0, 24.0}) {
    options.quantizer_scale = quantizer;
    const sim::AssistedScene scene{sequence.width, sequence.height, &sequence.low, sequence.samples,
                                   sequence.differs_in_light};
    const double begin = bench::cpu_ms();
    const auto frames = need(sim::code_assisted_video(sequence.shots, scene, options, best_isa(), true), name);
    const double ms = (bench::cpu_ms() - begin) / static_cast<double>(frames.size());
    std::vector<sim::ScoredPair> pairs;
    for (size_t i = 0; i < frames.size(); ++i)
      pairs.push_back({sequence.shots[i].images.high.view(), frames[i].shown.view()});
    const std::vector<sim::FrameScores> scores = sim::score_frames(pairs, 1);
    Point point;
    point.bytes = static_cast<double>(sim::total_bytes(frames));
    for (size_t kind = 0; kind < 3; ++kind) {
      const FrameSummary summary = sim::summarize(scores, kind);
      point.score[0][kind] = summary.mean;
      point.score[1][kind] = summary.worst_5_percent;
    }
    std::printf("  %-10s %4.0f %9.0f bytes, the first %7llu; %6.2f %.4f %6.2f; %.1f ms a frame\n", name, quantizer,
                point.bytes, static_cast<unsigned long long>(frames[0].sent_bytes), point.score[0][0],
                point.score[0][1], point.score[0][2], ms);
    points.push_back(point);
  }
  return points;
}

void compare(const char* name, const std::vector<Point>& without, const std::vector<Point>& with) {
  std::printf("%-12s", name);
  for (const int worst : {0, 1})
    for (size_t kind = 0; kind < 3; ++kind) {
      std::vector<RatePoint> curves[2];
      for (const Point& p : without) curves[0].push_back({p.bytes, p.score[worst][kind]});
      for (const Point& p : with) curves[1].push_back({p.bytes, p.score[worst][kind]});
      const auto rate = bd_rate(curves[0], curves[1]);
      if (rate.ok())
        std::printf(" %+6.1f", rate->percent);
      else
        std::printf("      -");
      if (kind == 2 && worst == 0) std::printf(";");
    }
  std::printf("\n");
  std::fflush(stdout);
}

bool set_form(std::string_view form, sim::AssistedVideoOptions& options) {
  if (form != "none" && form != "block" && form != "model") return false;
  options.difference = sim::Difference::halved;
  options.prediction = form == "none"    ? sim::Prediction::none
                       : form == "block" ? sim::Prediction::block
                                         : sim::Prediction::model;
  return true;
}

// With the option or without it.
bool set_option(std::string_view name, bool is_on, sim::AssistedVideoOptions& options) {
  if (name == "adapted")
    options.adapts_to_texture = is_on;
  else if (name == "priced")
    options.is_priced = is_on;
  else if (name == "ratio")
    options.residual = is_on ? sim::Residual::ratio : sim::Residual::additive;
  else
    return false;
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 7) {
    std::fprintf(stderr,
                 "usage: video_options SCENE SPLIT FRAMES SIZE fast|default|best [none|block|model] OPTION...\n");
    return 2;
  }
  const std::string_view effort = argv[5];
  sim::AssistedVideoOptions options;
  options.effort = effort == "fast"   ? mpeg1::Effort::fast
                   : effort == "best" ? mpeg1::Effort::best
                                      : mpeg1::Effort::normal;
  const int first = set_form(argv[6], options) ? 7 : 6;
  bench::NamedScene named = bench::load_scene(argv[1]);
  const bench::Sequence sequence = bench::draw(named, argv[2], std::atoi(argv[3]), std::atoi(argv[4]));
  std::printf("%s %s, %d frames of %d x %d, effort %s\n", argv[1], argv[2], std::atoi(argv[3]), sequence.width,
              sequence.height, argv[5]);
  for (int i = first; i < argc; ++i) {
    sim::AssistedVideoOptions with = options, without = options;
    if (!set_option(argv[i], true, with) || !set_option(argv[i], false, without)) {
      std::fprintf(stderr, "video_options: no option %s\n", argv[i]);
      return 2;
    }
    const std::vector<Point> before = curve(sequence, without, "without"), after = curve(sequence, with, argv[i]);
    compare(argv[i], before, after);
  }
  return 0;
}
