#include "sim/paper_figures.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <memory>
#include <span>
#include <string_view>
#include <utility>

namespace pac::sim {

namespace {

// One wanted pair: image-based quality and the paper's labels. The captions with the qualities of 2d-2g are lost in
// the text that we have; these keep its order and its remarks: 2d is the largest, 13,529 bytes lie between 2e and 2f.
struct PairPlan {
  double image_quality;
  const char* image_label;
  const char* assisted_label;
};
constexpr PairPlan kFigure2Pairs[] = {
    {80, "2d", "2h"}, {40, "2e", "2i"}, {20, "2f", "2j"}, {8, "2g", "2k"}, {15, "2l", "2m"}};
constexpr PairPlan kFigure3Pairs[] = {{15, "3d", "3e"}};
constexpr PairPlan kFigure4Pairs[] = {{15, "", "4j"}};
constexpr PairPlan kOnePair[] = {{15, "", ""}};

struct FigurePlan {
  const char* key;
  const char* title;
  const char* scene;
  const char* split;
  std::span<const PairPlan> pairs;
};
const FigurePlan kFigures[] = {
    {"figure2", "Textured versus untextured surfaces", "room", "texture", kFigure2Pairs},
    {"figure3", "Fine versus coarse tessellation of curved surfaces", "pin", "tessellation", kFigure3Pairs},
    {"figure4", "Antialiased Phong-shaded versus nonantialiased Gouraud-shaded: the split that does not work well",
     "letter", "shading", kFigure4Pairs},
    {"figure5", "The same letter, only texture omitted", "letter-texture", "texture", kOnePair},
    {"antialiasing", "No antialiasing on either side", "letter-texture", "antialiasing", kOnePair},
    {"lighting", "Full versus local lighting, textures on both sides", "room", "lighting", kOnePair},
    {"cubes", "Rotating textured cubes", "cubes", "texture", kOnePair},
};
constexpr double kCurveQuality = 15;  // of the equal-quality comparison

std::string decimal(double number, int decimals) {
  if (!std::isfinite(number)) return "-";
  char text[64];
  const auto end = std::to_chars(text, text + sizeof text, number, std::chars_format::fixed, decimals).ptr;
  return std::string(text, end);
}

std::string winner(bool assisted, const char* metric) {
  return std::string(assisted ? "polygon-assisted" : "image-based") + " has the better " + metric;
}

// What the first pair and the crossing say, in one sentence.
std::string finding_of(const FigureSet& set) {
  const MatchedPair& pair = set.pairs.back();
  const Scores& image = pair.image_based.scores;
  const Scores& assisted = pair.polygon_assisted.scores;
  std::string text = "At " + std::to_string(pair.image_based.image_bytes) + " and " +
                     std::to_string(pair.polygon_assisted.image_bytes) + " bytes " +
                     winner(assisted.ssim > image.ssim, "SSIM") + " (" + decimal(assisted.ssim, 4) + " against " +
                     decimal(image.ssim, 4) + ") and " + winner(assisted.rms < image.rms, "rms") + " (" +
                     decimal(assisted.rms, 2) + " against " + decimal(image.rms, 2) + ")";
  if (set.ssim_crossing.ratio) text += "; by SSIM the curves cross at " + decimal(*set.ssim_crossing.ratio, 0) + ":1";
  return text + ".";
}

// The scenes that the figures share, each built once, and the running count of steps.
class PaperRun {
 public:
  explicit PaperRun(const PaperOptions& options) : options_(options) {
    coding_.threads = options.threads;
    coding_.isa = options.isa;
  }

  Result<PaperResults> run() {
    PaperResults results;
    PAC_CHECK(table_column("room", "texture", results.room, results.room_transmitted, results.table1));
    PAC_CHECK(table_column("pin", "tessellation", results.pin, results.pin_transmitted, results.table1));
    for (const FigurePlan& plan : kFigures) {
      step(plan.title);
      PAC_TRY(FigureSet set, figure(plan));
      results.figures.push_back(std::move(set));
    }
    return results;
  }

 private:
  struct NamedScene {
    const BuiltinScene* builtin;
    SceneSet set;
  };

  void step(const char* what) {
    const int total = 2 + static_cast<int>(std::size(kFigures));
    if (options_.progress) options_.progress(what, done_, total);
    ++done_;
  }

  Result<const NamedScene*> scene(const char* name) {
    for (const auto& known : scenes_)
      if (std::string_view(known->builtin->name) == name) return known.get();
    const BuiltinScene* builtin = find_scene(name);
    if (builtin == nullptr) return Failure{Error::bad_argument, 0, "a scene of the paper is missing"};
    scenes_.push_back(std::make_unique<NamedScene>(NamedScene{builtin, builtin->build(options_.seed)}));
    return scenes_.back().get();
  }

  RenderOptions render_options(const SceneSet& set, const char* split) const {
    RenderOptions render;
    render.split = split;
    render.width = std::max(16, set.width / options_.size_divisor);
    render.height = std::max(16, set.height / options_.size_divisor);
    render.time_renders = true;
    render.threads = options_.threads;
    render.isa = options_.isa;
    return render;
  }

  static raster::Camera still_camera(const NamedScene& named, const RenderOptions& render) {
    return named.builtin->camera(0, static_cast<float>(render.width) / static_cast<float>(render.height));
  }

  Result<void> table_column(const char* name, const char* split, Still& still, Still& transmitted, Table1& table) {
    step(name);
    PAC_TRY(const NamedScene* named, scene(name));
    StillOptions options;
    options.render = render_options(named->set, split);
    options.coding = coding_;
    const raster::Camera camera = still_camera(*named, options.render);
    PAC_TRY(still, run_still(named->set, camera, options));
    PAC_TRY(transmitted, run_transmitted(named->set, camera, options, still.polygon_assisted.coded.quality));
    table.columns.push_back(make_table1_column(name, still, transmitted));
    return {};
  }

  Result<FigureSet> figure(const FigurePlan& plan) {
    PAC_TRY(const NamedScene* named, scene(plan.scene));
    const RenderOptions render = render_options(named->set, plan.split);
    FigureSet set;
    set.key = plan.key;
    set.title = plan.title;
    set.scene = plan.scene;
    PAC_TRY(set.renderings, render_split(named->set, still_camera(*named, render), render));
    set.timings = set.renderings.timings;
    for (const PairPlan& pair_plan : plan.pairs) {
      MatchedPair pair;
      pair.image_label = pair_plan.image_label;
      pair.assisted_label = pair_plan.assisted_label;
      PAC_TRY(pair.image_based, code_arm_at_quality(set.renderings, ArmKind::image_based, pair_plan.image_quality,
                                                    coding_, &set.timings));
      PAC_TRY(pair.polygon_assisted, code_arm_at_size(set.renderings, ArmKind::polygon_assisted,
                                                      pair.image_based.image_bytes, coding_, &set.timings));
      set.pairs.push_back(std::move(pair));
    }
    PAC_CHECK(add_curves(set));
    set.finding = finding_of(set);
    return set;
  }

  Result<void> add_curves(FigureSet& set) const {
    CodingOptions optimal = coding_;
    optimal.huffman = jpeg::Huffman::optimal;
    const auto image_qualities = plotted_qualities(ArmKind::image_based);
    PAC_TRY(set.image_curve, rate_curve(set.renderings, ArmKind::image_based, image_qualities, optimal));
    PAC_TRY(set.assisted_curve, rate_curve(set.renderings, ArmKind::polygon_assisted,
                                           plotted_qualities(ArmKind::polygon_assisted), optimal));
    set.rms_crossing = find_crossing(set.image_curve, set.assisted_curve, Metric::rms);
    set.ssim_crossing = find_crossing(set.image_curve, set.assisted_curve, Metric::ssim);
    const auto found = std::find(image_qualities.begin(), image_qualities.end(), kCurveQuality);
    const auto point = static_cast<size_t>(found - image_qualities.begin());
    set.equal_rms_gain = equal_quality_gain(set.image_curve, set.assisted_curve, Metric::rms, point);
    set.equal_ssim_gain = equal_quality_gain(set.image_curve, set.assisted_curve, Metric::ssim, point);
    return {};
  }

  const PaperOptions& options_;
  CodingOptions coding_;
  std::vector<std::unique_ptr<NamedScene>> scenes_;
  int done_ = 0;
};

}  // namespace

Result<PaperResults> run_paper(const PaperOptions& options) {
  if (options.size_divisor < 1) return Failure{Error::bad_argument, 0, "size divisor must be at least 1"};
  return PaperRun(options).run();
}

}  // namespace pac::sim
