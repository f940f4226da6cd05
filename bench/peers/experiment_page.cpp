#include "bench/peers/experiment_page.h"

#include <algorithm>
#include <cstdio>

#include "sim/report_plot.h"
#include "sim/report_sweep.h"

namespace pac::bench {

namespace {

constexpr size_t kVoices = 3;  // metrics of the verdict
constexpr size_t kPsnr = 3;    // of kScores

struct Group {
  std::string scene, split;
};

// Scenes and splits as they come.
std::vector<Group> groups_of(std::span<const ExperimentRow> rows) {
  std::vector<Group> groups;
  for (const ExperimentRow& row : rows)
    if (std::none_of(groups.begin(), groups.end(),
                     [&](const Group& g) { return g.scene == row.scene && g.split == row.split; }))
      groups.push_back({row.scene, row.split});
  return groups;
}

std::vector<std::string> splits_of(std::span<const ExperimentRow> rows) {
  std::vector<std::string> splits;
  for (const ExperimentRow& row : rows)
    if (std::find(splits.begin(), splits.end(), row.split) == splits.end()) splits.push_back(row.split);
  return splits;
}

std::string short_name(const std::string& scene) {
  return scene.substr(scene.rfind('/') + 1);
}

std::string plot_name(const Group& group, bool is_video) {
  std::string name = short_name(group.scene) + '-' + group.split + (is_video ? "-video" : "-still");
  for (char& c : name)
    if ((c < 'a' || c > 'z') && (c < '0' || c > '9') && (c < 'A' || c > 'Z')) c = '-';
  return name;
}

template <class... Numbers>
std::string text(const char* pattern, Numbers... numbers) {
  char buffer[256];
  std::snprintf(buffer, sizeof buffer, pattern, numbers...);
  return buffer;
}

// "0.35 [0.28, 0.44]": bytes of the one over the other's.
std::string ratio_text(const std::optional<sim::GainInterval>& gain) {
  if (!gain) return "-";
  const auto ratio = [](double percent) { return 1 + percent / 100; };
  if (gain->n_scenes < 2) return text("%.2f", ratio(gain->percent));
  return text("%.2f [%.2f, %.2f]", ratio(gain->percent), ratio(gain->low), ratio(gain->high));
}

// What is compared: ours with every other of its kind, then each codec with polygons and without.
struct Pair {
  const char *test, *reference;
};
constexpr Pair kStillPairs[] = {
    {"polygons-still", "jpeg"}, {"polygons-still", "mozjpeg"},       {"polygons-still", "webp"},
    {"polygons-still", "avif"}, {"polygons-still", "jpeg-xl"},       {"polygons-jpeg", "jpeg"},
    {"polygons-avif", "avif"},  {"polygons-still", "polygons-avif"},
};
constexpr Pair kVideoPairs[] = {
    {"polygons-model", "mjpeg"},         {"polygons-model", "mpeg1"},          {"polygons-model", "x264-low-delay"},
    {"polygons-model", "x264-best"},     {"polygons-model", "x265-low-delay"}, {"polygons-model", "svt-av1-low-delay"},
    {"polygons-model", "svt-av1-best"},  {"polygons-model", "polygons-none"},  {"polygons-model", "polygons-block"},
    {"polygons-model", "polygons-x264"}, {"polygons-mjpeg", "mjpeg"},          {"polygons-block", "mpeg1"},
    {"polygons-x264", "x264-low-delay"},
};

std::string pair_label(const Pair& pair) {
  return std::string(find_arm(pair.test)->label) + " / " + find_arm(pair.reference)->label;
}

std::string gain_cells(std::span<const ArmGain> gains) {
  std::string line;
  for (size_t kind = 0; kind < kVoices; ++kind)
    line += " | " + ratio_text(over_scenes(gains, kind, false)) + "<br>" + ratio_text(over_scenes(gains, kind, true));
  return line;
}

std::string agreement_text(std::span<const ArmGain> gains) {
  int counts[3] = {};
  for (const ArmGain& gain : gains) ++counts[static_cast<size_t>(gain.agreement())];
  std::string line;
  constexpr const char* kNames[] = {"fewer", "more", "disagree"};
  for (size_t i = 0; i < 3; ++i)
    if (counts[i] > 0) line += (line.empty() ? "" : ", ") + std::string(kNames[i]) + text(" in %d", counts[i]);
  return line;
}

std::string table_start(const char* first, const char* last) {
  return std::string("| ") + first + " | SSIMULACRA 2 | FLIP | PSNR-HVS-M | " + last + " |\n" +
         "| --- | --- | --- | --- | --- |\n";
}

std::string summary(std::span<const ExperimentRow> rows, std::span<const Pair> pairs, const char* title) {
  std::string page;
  for (const std::string& split : splits_of(rows)) {
    std::string lines;
    for (const Pair& pair : pairs)
      if (const auto gains = arm_gains(rows, split, pair.test, pair.reference); !gains.empty())
        lines += "| " + pair_label(pair) + gain_cells(gains) + " | " + agreement_text(gains) + " |\n";
    if (!lines.empty())
      page += std::string("### ") + title + ", split " + split + "\n\n" +
              table_start("bytes of / bytes of", "all metrics agree: scenes") + lines + '\n';
  }
  return page;
}

// Scene by scene: where it wins and where it loses.
std::string by_scene(std::span<const ExperimentRow> rows, const Pair& pair) {
  std::string lines;
  for (const ArmGain& gain : arm_gains(rows, "", pair.test, pair.reference))
    lines += "| " + short_name(gain.scene) + ", " + gain.split + gain_cells({&gain, 1}) + " | " +
             (gain.agreement() == ArmGain::Agreement::better  ? "fewer"
              : gain.agreement() == ArmGain::Agreement::worse ? "more"
                                                              : "metrics disagree") +
             " |\n";
  if (lines.empty()) return "";
  return "### " + pair_label(pair) + "\n\n" + table_start("scene, split", "bytes") + lines + '\n';
}

double mean_of(const ExperimentCurve& curve, double ExperimentRow::*member) {
  double sum = 0;
  for (const ExperimentRow& row : curve) sum += row.*member / row.frames;
  return curve.empty() ? 0 : sum / static_cast<double>(curve.size());
}

std::string cost_table(std::span<const ExperimentRow> rows) {
  std::string page =
      "## What it costs\n\nCPU time of one core, mean over the rates. Resident bytes come before the first frame and "
      "are in no curve. A peer's times hold start and files of its program; \"-\": not measured apart.\n\n"
      "| scene, split | pixels, frames | resident bytes | client draws L, ms | our encoder, ms a frame | x264 "
      "zerolatency | SVT-AV1 low delay |\n| --- | --- | --- | --- | --- | --- | --- |\n";
  for (const Group& group : groups_of(rows)) {
    const ExperimentCurve ours = curve_of(rows, group.scene, group.split, "polygons-model");
    if (ours.empty()) continue;
    page += "| " + short_name(group.scene) + ", " + group.split +
            text(" | %d x %d, %d | %llu | %.1f | %.0f", ours[0].width, ours[0].height, ours[0].frames,
                 static_cast<unsigned long long>(ours[0].resident_model_bytes), ours[0].draw_low_ms,
                 mean_of(ours, &ExperimentRow::encode_ms));
    for (const char* peer : {"x264-low-delay", "svt-av1-low-delay"}) {
      const ExperimentCurve curve = curve_of(rows, group.scene, group.split, peer);
      page += curve.empty() ? " | -"
                            : text(" | %.0f, decoder %.0f", mean_of(curve, &ExperimentRow::encode_ms),
                                   mean_of(curve, &ExperimentRow::decode_ms));
    }
    page += " |\n";
  }
  return page + "\nThe client's stages one by one: `bench/peers/client_cost`.\n\n";
}

// The paper's own claims, by stills of JPEG.
std::string paper_claims(std::span<const ExperimentRow> rows) {
  std::string page =
      "## The paper's claims\n\nPolygons + JPEG against JPEG. Gain: JPEG's bytes over ours at equal score (the paper "
      "judges 3 by eye). Crossing: the compression ratio below which polygons cost bytes (the paper: 25:1); \"-\": "
      "the curves do not cross where both reach.\n\n"
      "| scene, split | gain, SSIMULACRA 2 | gain, PSNR | crossing, SSIMULACRA 2 | crossing, PSNR |\n"
      "| --- | --- | --- | --- | --- |\n";
  std::string paradox;
  for (const ArmGain& gain : arm_gains(rows, "", "polygons-jpeg", "jpeg")) {
    const ExperimentCurve jpeg = curve_of(rows, gain.scene, gain.split, "jpeg");
    const ExperimentCurve ours = curve_of(rows, gain.scene, gain.split, "polygons-jpeg");
    page += "| " + short_name(gain.scene) + ", " + gain.split;
    for (const size_t kind : {size_t{0}, kPsnr})
      page += gain.mean[kind] ? text(" | %.2f", 1 / (1 + *gain.mean[kind] / 100)) : " | -";
    for (const size_t kind : {size_t{0}, kPsnr}) {
      const auto ratio = crossing_ratio(jpeg, ours, kind);
      page += ratio ? text(" | %.0f:1", *ratio) : " | -";
    }
    page += " |\n";
    if (gain.mean[0] && gain.mean[kPsnr] && *gain.mean[0] < 0 && *gain.mean[kPsnr] > 0)
      paradox += (paradox.empty() ? "" : ", ") + short_name(gain.scene) + " (" + gain.split + ")";
  }
  return page + "\nPictures that look better at a larger rms error (SSIMULACRA 2 saves bytes, PSNR costs them): " +
         (paradox.empty() ? "none of these scenes" : paradox) + ".\n\n";
}

std::string plot_links(std::span<const ExperimentRow> rows, const std::string& folder) {
  std::string page = "## Curves\n\n";
  for (const Group& group : groups_of(rows))
    for (const bool is_video : {false, true})
      page += "![" + short_name(group.scene) + ", " + group.split + (is_video ? ", video" : ", still") + "](" + folder +
              '/' + plot_name(group, is_video) + ".svg)\n";
  return page;
}

sim::Plot plot_of(std::span<const ExperimentRow> rows, const Group& group, bool is_video) {
  sim::Plot plot;
  plot.id = plot_name(group, is_video);
  plot.title = short_name(group.scene) + ", " + group.split + (is_video ? ", video" : ", still");
  plot.description = "SSIMULACRA 2 against bytes a frame, " + plot.title + "; higher is better";
  plot.x_label = "bytes a frame";
  plot.y_label = sim::kScores[0].label;
  for (const ExperimentArm& arm : experiment_arms()) {
    if (arm.is_video != is_video) continue;
    sim::PlotSeries series{arm.label, arm.style, {}};
    for (const ExperimentRow& row : curve_of(rows, group.scene, group.split, arm.key)) {
      const double bytes = static_cast<double>(row.bytes) / row.frames;
      series.points.push_back(
          {bytes, row.scores[0].mean,
           std::string(arm.label) + text(", %g: %.0f bytes, %.1f", row.setting, bytes, row.scores[0].mean)});
    }
    if (!series.points.empty()) plot.series.push_back(std::move(series));
  }
  return plot;
}

}  // namespace

std::vector<std::pair<std::string, std::string>> experiment_plots(std::span<const ExperimentRow> rows) {
  std::vector<std::pair<std::string, std::string>> files;
  for (const Group& group : groups_of(rows))
    for (const bool is_video : {false, true})
      files.emplace_back(plot_name(group, is_video), sim::plot_svg_file(plot_of(rows, group, is_video)));
  return files;
}

std::string experiment_gains_csv(std::span<const ExperimentRow> rows) {
  std::string csv = "scene,split,test,reference,metric,of,scenes,percent,low_95,high_95\n";
  const auto add = [&](const std::string& scene, const std::string& split, const Pair& pair,
                       std::span<const ArmGain> gains) {
    for (size_t kind = 0; kind < sim::kScoreCount; ++kind)
      for (const bool of_worst : {false, true})
        if (const auto gain = over_scenes(gains, kind, of_worst))
          csv += scene + ',' + split + ',' + pair.test + ',' + pair.reference + ',' + sim::kScores[kind].key +
                 (of_worst ? ",worst_5_percent" : ",mean") +
                 text(",%d,%.1f,%.1f,%.1f\n", gain->n_scenes, gain->percent, gain->low, gain->high);
  };
  for (const std::span<const Pair> pairs : {std::span<const Pair>(kStillPairs), std::span<const Pair>(kVideoPairs)})
    for (const Pair& pair : pairs) {
      for (const ArmGain& gain : arm_gains(rows, "", pair.test, pair.reference))
        add(gain.scene, gain.split, pair, {&gain, 1});
      for (const std::string& split : splits_of(rows))
        add("(all)", split, pair, arm_gains(rows, split, pair.test, pair.reference));
    }
  return csv;
}

std::string experiment_page(std::span<const ExperimentRow> rows, const std::string& command, size_t missing,
                            const std::string& folder) {
  std::string page =
      "# The experiment\n\nEvery way to code the same pictures H, against H in RGB: " + std::to_string(rows.size()) +
      " measurements. Made by\n\n```\n" + command + "\n```\n\nwhich goes on where it was cut short";
  page += missing == 0 ? ".\n" : "; " + std::to_string(missing) + " curves are not measured here.\n";
  page +=
      "\nRatios: bytes at equal score, Bjontegaard over all scores that both curves reach, geometric mean over the "
      "scenes with its 95 % interval (bootstrap over scenes); below, of the worst 5 % of the frames. Fewer or more: "
      "SSIMULACRA 2, FLIP and PSNR-HVS-M agree on mean and worst frames; else the metrics disagree, or the curves "
      "share too few scores. Charged: whole files of stills, whole packets of ours, of video peers the code without "
      "container. The model is resident.\n\n";
  page += "## Bytes at equal score\n\n" + summary(rows, kVideoPairs, "Video") + summary(rows, kStillPairs, "Stills");
  page += "## Scene by scene\n\n";
  for (const Pair& pair : {Pair{"polygons-model", "x264-low-delay"}, Pair{"polygons-model", "svt-av1-low-delay"},
                           Pair{"polygons-still", "avif"}})
    page += by_scene(rows, pair);
  return page + cost_table(rows) + paper_claims(rows) + plot_links(rows, folder);
}

}  // namespace pac::bench
