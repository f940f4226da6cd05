// What the experiment measured: rows, one an arm and setting, in files that grow line by line, and what they say.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/verdict.h"
#include "sim/sweep_gain.h"
#include "sim/video_scores.h"

namespace pac::bench {

// Every way to code the pictures. The first of each kind are ours.
struct ExperimentArm {
  const char* key;    // of the tables
  const char* label;  // of the page
  bool is_video;
  const char* style;               // of sim/report_sweep.h's plot_svg_file
  std::array<double, 7> settings;  // quality, quantizer, crf or kb/s; 0: no more
};
std::span<const ExperimentArm> experiment_arms();
const ExperimentArm* find_arm(const std::string& key);

struct ExperimentRow {
  std::string scene, split, arm;
  double setting = 0;
  int width = 0, height = 0, frames = 0;
  uint64_t bytes = 0, resident_model_bytes = 0;
  double draw_low_ms = 0;               // CPU time a frame; 0 where the client draws nothing
  double encode_ms = 0, decode_ms = 0;  // CPU time, all frames; 0: not known
  std::array<FrameSummary, sim::kScoreCount> scores{};
};

std::string row_header();
std::string row_line(const ExperimentRow& row);  // with its end

// Lines that are no whole row (the last one of a run that was cut short) are left out.
std::vector<ExperimentRow> read_rows(std::string_view csv);

// One curve, by ascending bytes.
using ExperimentCurve = std::vector<ExperimentRow>;
ExperimentCurve curve_of(std::span<const ExperimentRow> rows, const std::string& scene, const std::string& split,
                         const std::string& arm);

// Bytes of `test` over bytes of `reference` at equal score, percent below or above 100; empty where the two curves
// share less than a fifth of the shorter one's scores.
struct ArmGain {
  std::string scene, split;
  sim::MetricGains mean, worst;
  Verdict verdict;  // at equal bytes, the test second; bytes_differ: no equal bytes, and the smaller one is not better
};

// Scenes of that split in which both have curves; `split` empty: of all.
std::vector<ArmGain> arm_gains(std::span<const ExperimentRow> rows, const std::string& split, const std::string& test,
                               const std::string& reference);

// Over scenes: sim/sweep_gain.h's geometric mean and bootstrap.
std::optional<sim::GainInterval> over_scenes(std::span<const ArmGain> gains, size_t kind, bool of_worst);

// ln(bytes) of the curve at a mean score, straight between its points; empty outside.
std::optional<double> log_bytes_at(const ExperimentCurve& curve, size_t kind, double score);

// A mean score at bytes, straight over their logarithm; empty outside.
std::optional<double> score_at(const ExperimentCurve& curve, size_t kind, double bytes);

}  // namespace pac::bench
