// What the curves of a sweep say: bytes at equal score, scene by scene and over the scenes with an interval, and who is
// better at equal bytes.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/verdict.h"
#include "sim/sweep_table.h"

namespace pac::sim {

// Two arms of one codec; the reference is the first of base/verdict.h's two.
struct SweepComparison {
  SweepCodec codec;
  SweepArm reference, test;
};
std::span<const SweepComparison> sweep_comparisons();
std::string comparison_text(const SweepComparison& comparison);  // "polygons, model, against MPEG-1 of H"

// By metric, in the order of kScores: percent of bytes that the test saves (below 0) or costs over the reference at
// equal score [Bjontegaard, base/bd_rate.h]; empty where the two curves share no range of scores.
using MetricGains = std::array<std::optional<double>, kScoreCount>;

struct SceneGain {
  std::string scene, split;
  SweepComparison comparison{};
  MetricGains mean, worst;  // of the frames' mean score, and of the score of the worst 5 %

  // At the middle (in logarithms) of the sizes that both curves reach; empty where there is none.
  std::optional<Verdict> verdict;
  double verdict_bytes = 0;
};

// Geometric mean over scenes. The interval is the bootstrap's [Efron 1979], percentile method: 2.5 and 97.5 % of the
// means of kResamples draws of as many scenes, with replacement; it is there from two scenes on, and says nothing about
// scenes of another kind than these.
struct GainInterval {
  int n_scenes = 0;
  double percent = 0, low = 0, high = 0;  // low = high = percent for one scene
};
constexpr int kResamples = 10000;
using MetricIntervals = std::array<std::optional<GainInterval>, kScoreCount>;

struct SplitGain {
  std::string split;
  SweepComparison comparison{};
  MetricIntervals mean, worst;
  int n_better = 0, n_worse = 0, n_disagree = 0;  // scenes, by verdict on the test
};

struct SweepGains {
  std::vector<SceneGain> scenes;  // scenes and splits as they come in the table, comparisons within
  std::vector<SplitGain> splits;
};

// Comparisons without points on either side are left out. The same bits on every machine.
SweepGains sweep_gains(const SweepTable& table);

// Both lists as CSV: a line a gain; percent with one digit after the point.
std::string sweep_gains_csv(const SweepGains& gains);

// The points of one curve, by ascending bytes.
std::vector<SweepPoint> curve_of(const SweepTable& table, const std::string& scene, const std::string& split,
                                 SweepCodec codec, SweepArm arm);

// Geometric mean and interval of percentages.
GainInterval bootstrap_interval(std::span<const double> percents);

}  // namespace pac::sim
