#include <algorithm>
#include <cmath>

#include "bench/peers/experiment_page.h"
#include "sim/report_plot.h"
#include "sim/report_sweep.h"

namespace pac::bench {

namespace {

std::string slug(std::string name) {
  for (char& c : name)
    if ((c < 'a' || c > 'z') && (c < '0' || c > '9') && (c < 'A' || c > 'Z')) c = '-';
  return name;
}

// Below this a picture is a ruin, and curves that differ there say nothing.
constexpr double kLeastScore = -20;

sim::Plot rate_plot(std::span<const ExperimentRow> rows, const ExperimentGroup& group, bool is_video) {
  sim::Plot plot;
  plot.id = rate_plot_name(group, is_video);
  plot.title = group_text(group) + (is_video ? ", video" : ", still");
  plot.description = "SSIMULACRA 2 against bytes a frame, " + plot.title + "; higher is better";
  plot.x_label = is_video ? "bytes a frame, first one included" : "bytes";
  plot.y_label = "SSIMULACRA 2, " + plot.title;
  for (const ExperimentArm& arm : experiment_arms()) {
    if (arm.is_video != is_video) continue;
    sim::PlotSeries series{arm.label, arm.style, {}};
    for (const ExperimentRow& row : curve_of(rows, group.scene, group.split, arm.key))
      if (row.scores[0].mean >= kLeastScore)
        series.points.push_back({static_cast<double>(row.bytes) / row.frames, row.scores[0].mean, ""});
    if (!series.points.empty()) plot.series.push_back(std::move(series));
  }
  return plot;
}

// What polygons save JPEG, percent, at the scores between the points of JPEG's curve.
std::vector<sim::PlotPoint> saving_curve(const ExperimentCurve& jpeg, const ExperimentCurve& ours, size_t kind) {
  std::vector<sim::PlotPoint> points;
  constexpr int kSteps = 6;
  for (size_t i = jpeg.size(); i-- > 1;)
    for (int step = 0; step < kSteps; ++step) {
      const double part = static_cast<double>(step) / kSteps;
      const double a = jpeg[i].scores[kind].mean, b = jpeg[i - 1].scores[kind].mean, score = a + part * (b - a);
      if (kind == 0 && score < kLeastScore) continue;
      const auto theirs = log_bytes_at(jpeg, kind, score), own = log_bytes_at(ours, kind, score);
      if (!theirs || !own) continue;
      const double ratio = 3.0 * jpeg[i].width * jpeg[i].height / std::exp(*theirs);
      if (points.empty() || ratio > points.back().x)
        points.push_back({ratio, 100 * (1 - std::exp(*own - *theirs)), ""});
    }
  return points;
}

sim::Plot paper_plot(std::span<const ExperimentRow> rows, const char* name, size_t kind) {
  constexpr const char* kStyles[] = {"polygon", "image", "hue3", "hue4", "hue5", "hue6", "hue2"};
  constexpr const char* kDashes[] = {"", " dashed", " dotted"};
  constexpr size_t kColors = std::size(kStyles);
  sim::Plot plot;
  plot.id = name;
  const std::string metric = kind == 0 ? "SSIMULACRA 2" : "PSNR";
  plot.title = "What polygons save JPEG at equal " + metric;
  plot.description = plot.title + ", percent of JPEG's bytes, against JPEG's compression ratio";
  plot.x_label = "compression ratio of JPEG (24 bits a pixel = 1)";
  plot.y_label = "% of JPEG's bytes saved at equal " + metric;
  plot.zero_line = true;
  plot.marks.push_back({25, "25:1"});
  for (const ExperimentGroup& group : groups_of(rows)) {
    auto points = saving_curve(curve_of(rows, group.scene, group.split, "jpeg"),
                               curve_of(rows, group.scene, group.split, "polygons-jpeg"), kind);
    const size_t n = plot.series.size();
    if (points.size() > 1)
      plot.series.push_back({group_text(group), std::string(kStyles[n % kColors]) + kDashes[n / kColors % 3] + " bare",
                             std::move(points)});
  }
  return plot;
}

}  // namespace

std::string rate_plot_name(const ExperimentGroup& group, bool is_video) {
  return slug(group.scene + '-' + group.split + (is_video ? "-video" : "-still"));
}

std::vector<std::pair<std::string, std::string>> experiment_plots(std::span<const ExperimentRow> rows) {
  std::vector<std::pair<std::string, std::string>> files;
  for (const ExperimentGroup& group : groups_of(rows))
    for (const bool is_video : {false, true}) {
      const sim::Plot plot = rate_plot(rows, group, is_video);
      if (!plot.series.empty()) files.emplace_back(plot.id, sim::plot_svg_file(plot));
    }
  for (const size_t kind : {size_t{0}, kPsnr}) {
    const char* name = kPaperPlots[kind == 0 ? 0 : 1];
    files.emplace_back(name, sim::plot_svg_file(paper_plot(rows, name, kind)));
  }
  return files;
}

}  // namespace pac::bench
