// Polygon-assisted MPEG-1 against today's video codecs on the same frames H, by Debian's ffmpeg (libx264, libx265,
// libsvtav1).
//   video_peers SCENE [SPLIT] [FRAMES] [all]      SCENE: a built-in name or an OBJ file; `all` adds the peers' best:
//                                                 two passes, B pictures, SVT-AV1 preset 4 with random access
// Every arm at several rates, scored against H in RGB; then our bytes over each peer's at equal score, metric by
// metric. Charged: every frame from the first on, ours as whole packets with camera, hash and checksum. Not charged:
// containers' boxes (raw H.264 and H.265 streams, IVF less its headers), and the resident model.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "base/bd_rate.h"
#include "bench/peers/peer_codecs.h"
#include "bench/peers/scene_shots.h"
#include "sim/video_scores.h"
#include "sim/video_sequence.h"

namespace {

using namespace pac;
using bench::need;
using bench::Sequence;

constexpr int kFramesPerSecond = 20;

struct Point {
  uint64_t bytes = 0;
  double score[3] = {};  // means of SSIMULACRA 2, FLIP, PSNR-HVS-M
  double worst[3] = {};  // of the worst 5 %
};

struct Arm {
  std::string name;
  std::vector<Point> points;
};

// ---- Scores
// ----------------------------------------------------------------------------------------------------------

Point score(const Sequence& sequence, const std::vector<RgbImage>& shown, uint64_t bytes) {
  std::vector<sim::ScoredPair> pairs;
  for (size_t i = 0; i < shown.size(); ++i) pairs.push_back({sequence.shots[i].images.high.view(), shown[i].view()});
  const std::vector<sim::FrameScores> scores = sim::score_frames(pairs, 0);
  Point point;
  point.bytes = bytes;
  for (size_t kind = 0; kind < 3; ++kind) {
    const FrameSummary summary = sim::summarize(scores, kind);
    point.score[kind] = summary.mean;
    point.worst[kind] = summary.worst_5_percent;
  }
  return point;
}

void print(const std::string& name, const std::string& setting, const Point& p, size_t frames) {
  std::printf("%-30s %8s %9llu %8.1f   %7.2f %7.4f %6.2f   %7.2f %7.4f %6.2f\n", name.c_str(), setting.c_str(),
              static_cast<unsigned long long>(p.bytes),
              8e-3 * static_cast<double>(p.bytes) * kFramesPerSecond / static_cast<double>(frames), p.score[0],
              p.score[1], p.score[2], p.worst[0], p.worst[1], p.worst[2]);
  std::fflush(stdout);
}

// ---- Arms
// ------------------------------------------------------------------------------------------------------------

Arm our_arm(const Sequence& sequence, sim::Prediction prediction, sim::Difference difference, const char* name,
            const std::vector<double>& quantizers) {
  Arm arm{name, {}};
  for (const double quantizer : quantizers) {
    sim::AssistedVideoOptions options;
    options.prediction = prediction;
    options.difference = difference;
    options.quantizer_scale = quantizer;
    options.effort = mpeg1::Effort::best;
    const sim::AssistedScene scene{sequence.width, sequence.height, &sequence.low, sequence.samples,
                                   sequence.differs_in_light};
    auto frames = need(sim::code_assisted_video(sequence.shots, scene, options, best_isa(), true), name);
    std::vector<RgbImage> shown;
    for (sim::VideoFrame& frame : frames) shown.push_back(std::move(frame.shown));
    arm.points.push_back(score(sequence, shown, sim::total_bytes(frames)));
    print(name, std::to_string(quantizer).substr(0, 4), arm.points.back(), shown.size());
  }
  return arm;
}

Arm plain_arm(const Sequence& sequence, const std::vector<double>& quantizers) {
  Arm arm{"MPEG-1 of H", {}};
  for (const double quantizer : quantizers) {
    sim::ImageVideoOptions options;
    options.quantizer_scale = quantizer;
    options.effort = mpeg1::Effort::best;
    auto frames = need(sim::code_image_video(sequence.shots, options, true), "MPEG-1");
    std::vector<RgbImage> shown;
    for (sim::VideoFrame& frame : frames) shown.push_back(std::move(frame.shown));
    arm.points.push_back(score(sequence, shown, sim::total_bytes(frames)));
    print(arm.name, std::to_string(quantizer).substr(0, 4), arm.points.back(), shown.size());
  }
  return arm;
}

Arm peer_arm(const Sequence& sequence, const bench::VideoPeer& peer, bench::PeerRunner& runner) {
  Arm arm{peer.label, {}};
  for (const int setting : peer.settings) {
    const auto code = runner.video(peer, setting);
    if (!code) {
      std::printf("%-30s not there\n", peer.label);
      return {peer.label, {}};
    }
    arm.points.push_back(score(sequence, code->shown, code->bytes));
    print(peer.label, std::to_string(setting) + (peer.two_pass ? "k" : ""), arm.points.back(), code->shown.size());
  }
  return arm;
}

// Our bytes over the peer's at equal score, over the scores that both reach.
void compare(const Arm& ours, const Arm& peer) {
  if (peer.points.empty()) return;
  const char* metrics[] = {"SSIMULACRA 2", "FLIP", "PSNR-HVS-M"};
  std::printf("%s / %s:", ours.name.c_str(), peer.name.c_str());
  for (int worst = 0; worst < 2; ++worst)
    for (size_t kind = 0; kind < 3; ++kind) {
      std::vector<RatePoint> curves[2];
      for (int side = 0; side < 2; ++side)
        for (const Point& p : (side == 0 ? peer : ours).points)
          curves[side].push_back({static_cast<double>(p.bytes), worst != 0 ? p.worst[kind] : p.score[kind]});
      const auto rate = bd_rate(curves[0], curves[1]);
      std::printf("%s %s ", kind == 0 ? (worst != 0 ? "; worst 5 %:" : " mean:") : ",", metrics[kind]);
      if (rate.ok())
        std::printf("%.3f (%.3g..%.3g)", 1 + rate->percent / 100, rate->lowest_quality, rate->highest_quality);
      else
        std::printf("no common range");
    }
  std::printf("\n");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: video_peers SCENE [SPLIT] [FRAMES] [all]\n");
    return 2;
  }
  const std::string scene = argv[1], split = argc > 2 ? argv[2] : "texture";
  const int frames = argc > 3 ? std::atoi(argv[3]) : 48;
  const bool all = argc > 4 && std::strcmp(argv[4], "all") == 0;
  bench::NamedScene named = bench::load_scene(scene);
  const Sequence sequence = bench::draw(named, split, frames);
  std::vector<ConstRgbView> pictures;
  for (const sim::Shot& shot : sequence.shots) pictures.push_back(shot.images.high.view());
  bench::PeerRunner runner(pictures, kFramesPerSecond);

  std::printf("%s, split %s, %d x %d, %zu frames at %d a second\n%-30s %8s %9s %8s   %7s %7s %6s   %s\n", scene.c_str(),
              split.c_str(), sequence.width, sequence.height, sequence.shots.size(), kFramesPerSecond, "", "setting",
              "bytes", "kb/s", "SSIMU2", "FLIP", "HVS-M", "worst 5 % of each");
  const std::vector<double> quantizers = {6, 10, 16, 24, 31};
  const Arm ours =
      our_arm(sequence, sim::Prediction::model, sim::Difference::full, "polygons + MPEG-1, model", quantizers);
  std::vector<Arm> others;
  others.push_back(
      our_arm(sequence, sim::Prediction::block, sim::Difference::halved, "polygons + MPEG-1, block", quantizers));
  others.push_back(plain_arm(sequence, {6, 10, 16, 31}));
  constexpr size_t kUsual = 2;  // the first of them
  for (size_t i = 0; i < bench::video_peers().size(); ++i)
    if (all || i < kUsual) others.push_back(peer_arm(sequence, bench::video_peers()[i], runner));
  std::printf("\nbytes of the first over the second's at equal score\n");
  for (const Arm& other : others) compare(ours, other);
  return 0;
}
