#include "tests/support/mock_results.h"

#include <cmath>

#include "sim/difference.h"

namespace pac::test {
namespace {

using namespace sim;

// A smooth ramp with a disc; `texture` adds checks, `noise` an error.
RgbImage picture(int side, bool texture, int noise) {
  RgbImage image(side, side);
  uint32_t state = 1;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const double radius = std::hypot(x - side / 2.0, y - side / 2.0) / side;
      int value = radius < 0.3 ? 60 + 150 * x / side : 200 - 120 * y / side;
      if (texture && radius < 0.3) value += ((x / 7 + y / 5) & 1) != 0 ? 25 : -25;
      state = state * 1664525u + 1013904223u;
      if (noise > 0) value += static_cast<int>(state >> 16) % noise - noise / 2;
      for (int c = 0; c < 3; ++c)
        image.pixel(x, y)[c] = static_cast<uint8_t>(std::min(255, std::max(0, value - 12 * c)));
    }
  return image;
}

Renderings renderings(int side, const char* split) {
  Renderings made;
  made.split.name = split;
  made.high = picture(side, true, 0);
  made.low = picture(side, false, 0);
  made.difference = RgbImage(side, side);
  for (int y = 0; y < side; ++y)
    for (int i = 0; i < 3 * side; ++i)
      made.difference.row(y)[i] = static_cast<uint8_t>(127 + (made.high.row(y)[i] - made.low.row(y)[i]) / 2);
  made.high_entropy = {6.41, 6.53, 11.2};
  made.low_entropy = {5.1, 5.3, 8.8};
  made.difference_entropy = {4.0, 4.03, 7.1};
  made.high_polygons = made.low_polygons = 1131;
  made.visible_low_polygons = 800;
  made.estimated_model_bytes = 3770;
  made.model_bytes = 3412;
  return made;
}

Arm arm(int side, ArmKind kind, double quality, uint64_t bytes) {
  const bool polygon = kind == ArmKind::polygon_assisted;
  Arm made;
  made.coded.quality = quality;
  made.coded.equivalent_quality = polygon ? quality / 2 : quality;
  made.shown = picture(side, true, polygon ? 14 : 40);
  made.scores = polygon ? Scores{5.5, 33.3, 0.931} : Scores{6.8, 31.5, 0.874};
  made.image_bytes = made.total_bytes = bytes;
  made.compression_ratio = 3.0 * side * side / static_cast<double>(bytes);
  made.budget_share = static_cast<double>(bytes) / kBudgetBytesPerFrame;
  return made;
}

RateCurve curve(int side, double head_start) {
  RateCurve made;
  for (const double quality : {5.0, 10.0, 15.0, 25.0, 40.0, 60.0, 80.0, 95.0}) {
    RatePoint& point = made.points.emplace_back();
    point.quality = quality;
    point.bytes = static_cast<uint64_t>(2000 + 12 * quality * quality);
    point.compression_ratio = 3.0 * side * side / static_cast<double>(point.bytes);
    point.scores = {12 - quality / 10, 26 + quality / 7 + head_start,
                    1 - (0.2 - head_start / 20) * (1 - quality / 110)};
  }
  return made;
}

FigureSet figure(int side, const char* key, const char* scene, const char* split, int n_pairs) {
  FigureSet set;
  set.key = key;
  set.scene = scene;
  set.title = "made up";
  set.finding = "Polygon assistance wins <every> pair of this made-up scene.";
  set.renderings = renderings(side, split);
  for (int i = 0; i < n_pairs; ++i) {
    MatchedPair& pair = set.pairs.emplace_back();
    pair.image_label = std::string("2") + "defgl"[i];
    pair.assisted_label = std::string("2") + "hijkm"[i];
    const auto bytes = static_cast<uint64_t>(15000 / (i + 1));
    pair.image_based = arm(side, ArmKind::image_based, 30.0 / (i + 1), bytes);
    pair.polygon_assisted = arm(side, ArmKind::polygon_assisted, 61.4 / (i + 1), bytes - 20);
  }
  return set;
}

Still still(int side, const char* split) {
  Still made;
  made.renderings = renderings(side, split);
  made.image_based = arm(side, ArmKind::image_based, 15, 9836);
  made.polygon_assisted = arm(side, ArmKind::polygon_assisted, 36.2, 9810);
  return made;
}

Table1Column column(const char* scene) {
  Table1Column made;
  made.scene = scene;
  made.width = made.height = 512;
  made.rows = {{'A', "polygons", "number of polygons", "", 0, 1131.0, 1131, ""},
               {'A', "entropy", "entropy", "bits/pixel", 1, 5.8, 6.53, "mean over R, G and B"},
               {'D', "ratio", "compression ratio", ":1", 0, 80.0, 80.1, ""},
               {'D', "ssim", "SSIM", "", 3, std::nullopt, 0.874, "not in the paper"}};
  made.claims = {{"rms", "Polygon-assisted has the lower rms", false, true},
                 {"q", "Polygon-assisted has the higher quality factor", true, true}};
  return made;
}

}  // namespace

PaperResults mock_results(int side) {
  PaperResults results;
  results.table1.columns = {column("room"), column("pin")};
  results.room = still(side, "texture");
  results.pin = still(side, "tessellation");
  results.room_transmitted = still(side, "texture");
  results.pin_transmitted = still(side, "tessellation");
  results.figures.push_back(figure(side, "figure2", "room", "texture", 5));
  results.figures.push_back(figure(side, "figure3", "pin", "tessellation", 1));
  results.figures.push_back(figure(side, "figure4", "letter", "shading", 1));
  results.figures.push_back(figure(side, "figure5", "letter-texture", "texture", 1));
  results.figures.push_back(figure(side, "lighting", "room", "lighting", 1));
  for (FigureSet& set : results.figures) {
    set.image_curve = curve(side, 0);
    set.assisted_curve = curve(side, 1.5);
    set.ssim_crossing.assisted_wins_at_high_ratio = true;
    set.ssim_crossing.ratio = 21;
  }
  results.figures[0].equal_ssim_gain = 1.9;
  results.figures[0].timings.render_high = 100;
  results.figures[0].timings.render_low = 70;
  results.figures[0].timings.render_pair = 128;
  return results;
}

}  // namespace pac::test
