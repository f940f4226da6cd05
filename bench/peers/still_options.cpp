// What weights of the model's classes of blocks are worth in stills: bytes over those without them at equal score,
// percent, of the image-based and of the polygon-assisted JPEG.
//   still_options SCENE SPLIT SIZE none|ssim|visual WEIGHTS...
// SCENE: as for video_peers; SIZE: pixels of the longer side; then the masking of both. WEIGHTS as for `pac compare
// --weights`, each against the same coding (adapted tables, optimal Huffman codes, trellis) without them: by SSIMULACRA
// 2, FLIP, PSNR-HVS-M and the rms of the edge band, mean over four pictures of the scene's camera path.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "base/bd_rate.h"
#include "base/edge_band.h"
#include "base/metrics.h"
#include "bench/peers/scene_shots.h"
#include "sim/experiment.h"

namespace {

using namespace pac;
using bench::need;

constexpr size_t kScores = 4;
constexpr int kFrames = 4, kFrameStep = 12;

// The pictures with and without importance differ in Renderings::blocks only.
std::vector<sim::Renderings> draw(bench::NamedScene& scene, const char* split, int side) {
  std::vector<sim::Renderings> out;
  sim::RenderOptions options;
  options.split = split;
  options.find_blocks = true;
  const double scale = static_cast<double>(side) / std::max(scene.set.width, scene.set.height);
  options.width = static_cast<int>(std::lround(scene.set.width * scale));
  options.height = static_cast<int>(std::lround(scene.set.height * scale));
  const float aspect = static_cast<float>(options.width) / static_cast<float>(options.height);
  for (int frame = 0; frame < kFrames; ++frame)
    out.push_back(need(sim::render_split(scene.set, scene.camera(frame * kFrameStep, aspect), options), "picture"));
  return out;
}

// At each of the qualities, of all pictures together.
struct Point {
  double bytes = 0, score[kScores] = {};
};
std::vector<Point> curve(const std::vector<sim::Renderings>& pictures, sim::ArmKind kind,
                         const sim::CodingOptions& coding) {
  std::vector<Point> points;
  for (const double equivalent : {8.0, 15.0, 30.0, 60.0}) {
    const sim::Content content = kind == sim::ArmKind::image_based ? sim::Content::image : sim::Content::difference;
    Point point;
    for (const sim::Renderings& picture : pictures) {
      const sim::Arm arm =
          need(sim::code_arm_at_quality(picture, kind, sim::coded_quality(equivalent, content), coding), "arm");
      const Metrics metrics = measure(picture.high.view(), arm.shown.view());
      const MaskedError edges = masked_rms(picture.high.view(), arm.shown.view(), picture.blocks.edge_band.view());
      const double scores[kScores] = {metrics.ssimulacra2, -metrics.flip, metrics.psnr_hvs_m_db, -edges.rms};
      point.bytes += static_cast<double>(arm.image_bytes) / kFrames;
      for (size_t i = 0; i < kScores; ++i) point.score[i] += scores[i] / kFrames;
    }
    points.push_back(point);
  }
  return points;
}

void compare(const char* weights, const char* arm, const std::vector<Point>& without, const std::vector<Point>& with) {
  std::printf("%-40s %-17s", weights, arm);
  for (size_t i = 0; i < kScores; ++i) {
    std::vector<RatePoint> curves[2];
    for (const Point& p : without) curves[0].push_back({p.bytes, p.score[i]});
    for (const Point& p : with) curves[1].push_back({p.bytes, p.score[i]});
    const auto rate = bd_rate(curves[0], curves[1]);
    if (rate.ok())
      std::printf(" %+6.1f", rate->percent);
    else
      std::printf("      -");
  }
  std::printf("\n");
  std::fflush(stdout);
}

// What the weights say of each block; without text: 1.
void weigh(std::vector<sim::Renderings>& pictures, const char* text) {
  std::array<double, sim::kBlockClasses> weights;
  weights.fill(1);
  if (!sim::read_class_weights(text, weights).ok()) {
    std::fprintf(stderr, "still_options: no weights: %s\n", text);
    std::exit(2);
  }
  for (sim::Renderings& picture : pictures) {
    std::vector<float>& importance = picture.blocks.importance;
    importance.clear();
    double sum = 0;
    for (const sim::BlockClass block : picture.blocks.classes) sum += weights[static_cast<size_t>(block)];
    const double mean = sum / static_cast<double>(picture.blocks.classes.size());
    for (const sim::BlockClass block : picture.blocks.classes)
      importance.push_back(static_cast<float>(weights[static_cast<size_t>(block)] / mean));
  }
}

void print_classes(const std::vector<sim::Renderings>& pictures) {
  size_t counts[sim::kBlockClasses] = {}, all = 0;
  for (const sim::Renderings& picture : pictures)
    for (const sim::BlockClass block : picture.blocks.classes) ++counts[static_cast<size_t>(block)], ++all;
  for (size_t i = 0; i < sim::kBlockClasses; ++i)
    std::printf(" %s %.0f %%", sim::kBlockClassNames[i].data(),
                100 * static_cast<double>(counts[i]) / static_cast<double>(all));
  std::printf("\n");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 6) {
    std::fprintf(stderr, "usage: still_options SCENE SPLIT SIZE none|ssim|visual WEIGHTS...\n");
    return 2;
  }
  const std::string_view masking = argv[4];
  sim::CodingOptions coding;
  coding.tables = sim::TableFamily::adapted;
  coding.huffman = jpeg::Huffman::optimal;
  coding.masking = masking == "ssim" ? jpeg::Tune::ssim : masking == "visual" ? jpeg::Tune::visual : jpeg::Tune::psnr;
  bench::NamedScene scene = bench::load_scene(argv[1]);
  std::vector<sim::Renderings> pictures = draw(scene, argv[2], std::atoi(argv[3]));
  std::printf("%s %s, %d pictures of %d x %d, masking %s; blocks:", argv[1], argv[2], kFrames, pictures[0].high.width(),
              pictures[0].high.height(), argv[4]);
  print_classes(pictures);
  constexpr sim::ArmKind kArms[] = {sim::ArmKind::image_based, sim::ArmKind::polygon_assisted};
  weigh(pictures, "");
  const std::vector<Point> without[] = {curve(pictures, kArms[0], coding), curve(pictures, kArms[1], coding)};
  for (int i = 5; i < argc; ++i) {
    weigh(pictures, argv[i]);
    compare(argv[i], "image-based", without[0], curve(pictures, kArms[0], coding));
    compare(argv[i], "polygon-assisted", without[1], curve(pictures, kArms[1], coding));
  }
  return 0;
}
