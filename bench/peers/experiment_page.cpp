#include "bench/peers/experiment_page.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace pac::bench {

namespace {

constexpr size_t kVoices = 3;  // metrics of the verdict

std::vector<std::string> splits_of(std::span<const ExperimentRow> rows) {
  std::vector<std::string> splits;
  for (const ExperimentRow& row : rows)
    if (std::find(splits.begin(), splits.end(), row.split) == splits.end()) splits.push_back(row.split);
  return splits;
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

const char* verdict_name(Verdict verdict) {
  switch (verdict) {
    case Verdict::second_better:
      return "better";
    case Verdict::first_better:
      return "worse";
    case Verdict::disagree:
      return "metrics disagree";
    default:
      return "no equal bytes";
  }
}

std::string verdicts_text(std::span<const ArmGain> gains) {
  std::string line;
  for (const Verdict verdict :
       {Verdict::second_better, Verdict::disagree, Verdict::first_better, Verdict::bytes_differ}) {
    const auto count =
        std::count_if(gains.begin(), gains.end(), [&](const ArmGain& g) { return g.verdict == verdict; });
    if (count > 0) line += (line.empty() ? "" : ", ") + text("%d ", static_cast<int>(count)) + verdict_name(verdict);
  }
  return line;
}

std::string table_start(const char* first) {
  return std::string("| ") + first +
         " | SSIMULACRA 2 | FLIP | PSNR-HVS-M | at equal bytes |\n| --- | --- | --- | --- | --- |\n";
}

std::string summary(std::span<const ExperimentRow> rows, std::span<const Pair> pairs, const char* title) {
  std::string page;
  for (const std::string& split : splits_of(rows)) {
    std::string lines;
    size_t n_scenes = 0;
    for (const Pair& pair : pairs)
      if (const auto gains = arm_gains(rows, split, pair.test, pair.reference); !gains.empty()) {
        lines += "| " + pair_label(pair) + gain_cells(gains) + " | " + verdicts_text(gains) + " |\n";
        n_scenes = std::max(n_scenes, gains.size());
      }
    if (!lines.empty())
      page += std::string("### ") + title + ", split " + split + text(": %zu scene", n_scenes) +
              (n_scenes > 1 ? "s" : "") + "\n\n" + table_start("bytes of / bytes of") + lines + '\n';
  }
  return page;
}

// Scene by scene: where it wins and where it loses.
std::string by_scene(std::span<const ExperimentRow> rows, const Pair& pair) {
  std::string lines;
  for (const ArmGain& gain : arm_gains(rows, "", pair.test, pair.reference))
    lines += "| " + group_text({gain.scene, gain.split}) + gain_cells({&gain, 1}) + " | " + verdict_name(gain.verdict) +
             " |\n";
  if (lines.empty()) return "";
  return "### " + pair_label(pair) + "\n\n" + table_start("scene, split") + lines + '\n';
}

// ---- What it costs

double mean_of(std::span<const ExperimentRow> rows, double ExperimentRow::*member) {
  double sum = 0;
  for (const ExperimentRow& row : rows) sum += row.*member / row.frames;
  return rows.empty() ? 0 : sum / static_cast<double>(rows.size());
}

std::string scene_costs(std::span<const ExperimentRow> rows) {
  std::string page =
      "| scene, split | pixels, frames | resident bytes | draw L, ms | our decoder, ms | our encoder, ms |\n"
      "| --- | --- | --- | --- | --- | --- |\n";
  for (const ExperimentGroup& group : groups_of(rows)) {
    const ExperimentCurve ours = curve_of(rows, group.scene, group.split, "polygons-model");
    if (ours.empty()) continue;
    page += "| " + group_text(group) +
            text(" | %d x %d, %d | %llu | %.1f | %.1f | %.0f |\n", ours[0].width, ours[0].height, ours[0].frames,
                 static_cast<unsigned long long>(ours[0].resident_model_bytes), ours[0].draw_low_ms,
                 mean_of(ours, &ExperimentRow::decode_ms), mean_of(ours, &ExperimentRow::encode_ms));
  }
  return page + '\n';
}

std::string arm_costs(std::span<const ExperimentRow> rows) {
  std::string page = "| codec | encoder, ms a frame | decoder, ms a frame |\n| --- | --- | --- |\n";
  for (const ExperimentArm& arm : experiment_arms()) {
    std::vector<ExperimentRow> own;
    std::copy_if(rows.begin(), rows.end(), std::back_inserter(own),
                 [&](const ExperimentRow& row) { return row.arm == arm.key; });
    if (own.empty()) continue;
    page +=
        std::string("| ") + arm.label + (arm.is_video ? "" : ", still") +
        text(" | %.1f | %.1f |\n", mean_of(own, &ExperimentRow::encode_ms), mean_of(own, &ExperimentRow::decode_ms));
  }
  return page + '\n';
}

std::string costs(std::span<const ExperimentRow> rows) {
  return "## What it costs\n\nCPU time of one core a frame, mean over the rates. Resident bytes come before the first "
         "frame and are in no curve. Our arms code effort `best`; \"decoder\" is all that comes after L: unpacking, "
         "prediction, MPEG-1, sum. Stage by stage at 1280 x 720: `build/release/bench/peers/client_cost`.\n\n" +
         scene_costs(rows) +
         "All codecs, mean over all scenes and rates. Other people's times hold the start of their programs and "
         "reading "
         "and writing files, some 50 to 100 ms a run.\n\n" +
         arm_costs(rows);
}

// ---- The paper's own claims

constexpr double kPaperQuality = 15;  // of its JPEG arm

double rms_of(double psnr_db) {
  return 255 * std::pow(10.0, -psnr_db / 20);
}

// From the small files on, the ratio at which saving turns into cost.
std::string crossing_text(const ExperimentCurve& jpeg, const ExperimentCurve& ours, size_t kind) {
  std::optional<double> last_gap;
  for (size_t i = 1; i < jpeg.size(); ++i)
    for (int step = 0; step <= 64; ++step) {
      const double a = jpeg[i - 1].scores[kind].mean, b = jpeg[i].scores[kind].mean, score = a + step / 64.0 * (b - a);
      const auto theirs = log_bytes_at(jpeg, kind, score), own = log_bytes_at(ours, kind, score);
      if (!theirs || !own) continue;
      const double gap = *own - *theirs;
      if (last_gap && *last_gap < 0 && gap >= 0)
        return text("%.0f:1", 3.0 * jpeg[0].width * jpeg[0].height / std::exp(*theirs));
      last_gap = gap;
    }
  return !last_gap ? "-" : *last_gap < 0 ? "saves everywhere" : "costs everywhere";
}

std::string paper_table(std::span<const ExperimentRow> rows) {
  std::string page =
      "| scene, split | JPEG's bytes over ours at equal SSIMULACRA 2, PSNR | crossing by SSIMULACRA 2, PSNR | at "
      "JPEG's "
      "bytes at quality 15: rms error, JPEG and ours | SSIMULACRA 2, JPEG and ours |\n| --- | --- | --- | --- | --- "
      "|\n";
  for (const ArmGain& gain : arm_gains(rows, "", "polygons-jpeg", "jpeg")) {
    const ExperimentCurve jpeg = curve_of(rows, gain.scene, gain.split, "jpeg");
    const ExperimentCurve ours = curve_of(rows, gain.scene, gain.split, "polygons-jpeg");
    page += "| " + group_text({gain.scene, gain.split}) + " | ";
    for (const size_t kind : {size_t{0}, kPsnr})
      page += (kind == 0 ? "" : ", ") + (gain.mean[kind] ? text("%.2f", 1 / (1 + *gain.mean[kind] / 100)) : "-");
    page += " | " + crossing_text(jpeg, ours, 0) + ", " + crossing_text(jpeg, ours, kPsnr) + " | ";
    const auto at =
        std::find_if(jpeg.begin(), jpeg.end(), [](const auto& row) { return row.setting == kPaperQuality; });
    const bool is_there = at != jpeg.end();
    const auto psnr = is_there ? score_at(ours, kPsnr, static_cast<double>(at->bytes)) : std::nullopt;
    const auto score = is_there ? score_at(ours, 0, static_cast<double>(at->bytes)) : std::nullopt;
    page += psnr && score ? text("%.1f, %.1f | %.1f, %.1f |\n", rms_of(at->scores[kPsnr].mean), rms_of(*psnr),
                                 at->scores[0].mean, *score)
                          : "- | - |\n";
  }
  return page;
}

std::string paper_claims(std::span<const ExperimentRow> rows, const std::string& folder) {
  std::string page =
      "## The paper's claims\n\nPolygons + JPEG against JPEG, both with optimal Huffman codes. The paper: three times "
      "fewer bytes, judged by eye; no gain below a compression ratio of 25:1; at quality 15 its room looks better "
      "though "
      "its rms error is larger (7.5 against 6.1). Where rms and SSIMULACRA 2 below point in opposite directions, the "
      "last "
      "is so here.\n\n" +
      paper_table(rows) + '\n';
  for (const char* name : kPaperPlots) page += std::string("![") + name + "](" + folder + '/' + name + ".svg)\n";
  return page + '\n';
}

std::string curves(std::span<const ExperimentRow> rows, const std::string& folder) {
  std::string page =
      "## Curves\n\nWhole lines: with polygons; dashed: codecs alone; dotted: at their best. Points below -20 are left "
      "out.\n\n";
  for (const ExperimentGroup& group : groups_of(rows))
    for (const bool is_video : {true, false}) {
      const bool is_there = std::any_of(rows.begin(), rows.end(), [&](const ExperimentRow& row) {
        return ExperimentGroup{row.scene, row.split} == group && find_arm(row.arm)->is_video == is_video;
      });
      if (is_there)
        page += "![" + group_text(group) + (is_video ? ", video" : ", still") + "](" + folder + '/' +
                rate_plot_name(group, is_video) + ".svg)\n";
    }
  return page;
}

std::string run_text(std::span<const ExperimentRow> rows, const PageFrame& frame) {
  std::string page = "## What was run\n\n```\n" + frame.command + "\n```\n\n" + std::to_string(rows.size()) +
                     " measurements of the same pictures H, against H in RGB";
  if (!rows.empty()) {
    const auto video = std::find_if(rows.begin(), rows.end(), [](const auto& row) { return row.frames > 1; });
    page += text("; %d pixels on the longer side, %d frames at 20 a second; stills: the first frame",
                 std::max(rows[0].width, rows[0].height), video != rows.end() ? video->frames : 1);
  }
  page += frame.n_missing == 0 ? ".\n" : ". " + std::to_string(frame.n_missing) + " curves are not measured here.\n";
  return page +
         "\nModels: a spider, a duck, a truck and a jeep of Debian's assimp-testmodels, as OBJ files. Peers: Debian "
         "12's "
         "ffmpeg 5.1 (libx264, libx265, SVT-AV1 1.4.1, which forces preset 8 on low delay), webp, libavif-bin, "
         "libjxl-tools, mozjpeg by node. `+moving`: parts of the scene are objects that move. `fence`: hundreds of "
         "bars "
         "thinner than a pixel.\n\nCharged: whole files of stills; of ours whole packets (camera, hash, checksum); of "
         "video peers, and of others' codecs on our differences, the code without containers or texts about the "
         "encoder. "
         "The model is resident.\n\nRatios: bytes at equal score, Bjontegaard over all scores that both curves reach, "
         "geometric mean over the scenes with its 95 % interval (bootstrap over scenes); the second line is the worst "
         "5 "
         "% of the frames. \"-\": less than a fifth of the scores is common. At equal bytes (in the middle of those "
         "that "
         "both reach): better or worse where SSIMULACRA 2 (by more than 2 points), FLIP and PSNR-HVS-M agree on mean "
         "and "
         "worst frames; else the metrics disagree.\n\n";
}

}  // namespace

std::vector<ExperimentGroup> groups_of(std::span<const ExperimentRow> rows) {
  std::vector<ExperimentGroup> groups;
  for (const ExperimentRow& row : rows) {
    ExperimentGroup group{row.scene, row.split};
    if (std::find(groups.begin(), groups.end(), group) == groups.end()) groups.push_back(std::move(group));
  }
  return groups;
}

std::string group_text(const ExperimentGroup& group) {
  return group.scene + ", " + group.split;
}

std::string experiment_page(std::span<const ExperimentRow> rows, const PageFrame& frame) {
  std::string page = "# Every codec, with polygons and without\n\n" + frame.conclusions;
  if (!frame.conclusions.empty()) page += '\n';
  page += run_text(rows, frame);
  page += "## Bytes at equal score\n\n" + summary(rows, kVideoPairs, "Video") + summary(rows, kStillPairs, "Stills");
  page += "## Scene by scene\n\n";
  for (const Pair& pair : {Pair{"polygons-model", "x264-low-delay"}, Pair{"polygons-model", "svt-av1-low-delay"},
                           Pair{"polygons-still", "avif"}})
    page += by_scene(rows, pair);
  return page + costs(rows) + paper_claims(rows, frame.folder) + curves(rows, frame.folder);
}

}  // namespace pac::bench
