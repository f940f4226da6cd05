#include "sim/sweep_gain.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include "base/bd_rate.h"
#include "base/exact_math.h"

namespace pac::sim {

namespace {

constexpr SweepComparison kComparisons[] = {
    {SweepCodec::jpeg, SweepArm::image, SweepArm::polygons}, {SweepCodec::mjpeg, SweepArm::image, SweepArm::polygons},
    {SweepCodec::mpeg1, SweepArm::image, SweepArm::none},    {SweepCodec::mpeg1, SweepArm::image, SweepArm::block},
    {SweepCodec::mpeg1, SweepArm::image, SweepArm::model},   {SweepCodec::mpeg1, SweepArm::block, SweepArm::model}};

const char* arm_text(SweepArm arm) {
  constexpr const char* kTexts[] = {"H itself", "polygons", "polygons, predicted from L", "polygons, by moved blocks",
                                    "polygons, by the model"};
  return kTexts[static_cast<size_t>(arm)];
}

using Curve = std::vector<SweepPoint>;

double score_of(const SweepPoint& point, size_t kind, bool worst) {
  const FrameSummary& score = point.scores[kind];
  return worst ? score.worst_5_percent : score.mean;
}

std::vector<pac::RatePoint> rate_points(const Curve& curve, size_t kind, bool worst) {
  std::vector<pac::RatePoint> points;
  for (const SweepPoint& point : curve)
    points.push_back({static_cast<double>(point.bytes), score_of(point, kind, worst)});
  return points;
}

MetricGains metric_gains(const Curve& reference, const Curve& test, bool worst) {
  MetricGains gains;
  for (size_t kind = 0; kind < kScoreCount; ++kind) {
    const auto rate = bd_rate(rate_points(reference, kind, worst), rate_points(test, kind, worst));
    if (rate.ok()) gains[kind] = rate->percent;
  }
  return gains;
}

// ---- at equal bytes

double log_bytes(const SweepPoint& point) {
  return exact_log(static_cast<double>(point.bytes));
}

// The curve's scores at exp(x) bytes, linear in x between its points; x within their range.
QualitySummary summary_at(const Curve& curve, double x) {
  size_t i = 1;
  while (i + 1 < curve.size() && log_bytes(curve[i]) < x) ++i;
  const SweepPoint &a = curve[i - 1], &b = curve[i];
  const double span = log_bytes(b) - log_bytes(a), part = span > 0 ? (x - log_bytes(a)) / span : 0;
  const auto mix = [&](size_t kind) -> FrameSummary {
    return {a.scores[kind].mean + part * (b.scores[kind].mean - a.scores[kind].mean),
            a.scores[kind].worst_5_percent + part * (b.scores[kind].worst_5_percent - a.scores[kind].worst_5_percent)};
  };
  return {1, mix(0), mix(1), mix(2)};  // of one size, whichever it is
}

void judge(const Curve& reference, const Curve& test, SceneGain& gain) {
  if (reference.size() < 2 || test.size() < 2) return;
  const double low = std::max(log_bytes(reference.front()), log_bytes(test.front()));
  const double high = std::min(log_bytes(reference.back()), log_bytes(test.back()));
  if (low > high) return;
  const double middle = 0.5 * (low + high);
  gain.verdict = compare_summaries(summary_at(reference, middle), summary_at(test, middle));
  gain.verdict_bytes = exact_exp(middle);
}

// ---- over scenes

// SplitMix64 [Steele, Lea, Flood 2014].
uint64_t next_random(uint64_t& state) {
  state += 0x9e3779b97f4a7c15u;
  uint64_t z = state;
  z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
  z = (z ^ z >> 27) * 0x94d049bb133111ebu;
  return z ^ z >> 31;
}

double percent_of(double log_ratio) {
  return 100 * (exact_exp(log_ratio) - 1);
}

MetricIntervals intervals(std::span<const SceneGain* const> scenes, MetricGains SceneGain::*member) {
  MetricIntervals out;
  for (size_t kind = 0; kind < kScoreCount; ++kind) {
    std::vector<double> percents;
    for (const SceneGain* scene : scenes)
      if (const auto& percent = (scene->*member)[kind]) percents.push_back(*percent);
    if (!percents.empty()) out[kind] = bootstrap_interval(percents);
  }
  return out;
}

SplitGain summarize_split(std::string split, const SweepComparison& comparison,
                          std::span<const SceneGain* const> scenes) {
  SplitGain gain;
  gain.split = std::move(split);
  gain.comparison = comparison;
  gain.mean = intervals(scenes, &SceneGain::mean);
  gain.worst = intervals(scenes, &SceneGain::worst);
  for (const SceneGain* scene : scenes) {
    gain.n_better += scene->verdict == Verdict::second_better ? 1 : 0;
    gain.n_worse += scene->verdict == Verdict::first_better ? 1 : 0;
    gain.n_disagree += scene->verdict == Verdict::disagree ? 1 : 0;
  }
  return gain;
}

bool same(const SweepComparison& a, const SweepComparison& b) {
  return a.codec == b.codec && a.reference == b.reference && a.test == b.test;
}

void summarize_splits(SweepGains& gains) {
  std::vector<std::string> splits;
  for (const SceneGain& scene : gains.scenes)
    if (std::find(splits.begin(), splits.end(), scene.split) == splits.end()) splits.push_back(scene.split);
  for (const std::string& split : splits)
    for (const SweepComparison& comparison : kComparisons) {
      std::vector<const SceneGain*> scenes;
      for (const SceneGain& scene : gains.scenes)
        if (scene.split == split && same(scene.comparison, comparison)) scenes.push_back(&scene);
      if (!scenes.empty()) gains.splits.push_back(summarize_split(split, comparison, scenes));
    }
}

// ---- as text

std::string fixed(double number) {
  char buffer[352];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, number, std::chars_format::fixed, 1).ptr};
}

// As in sim/sweep_table.cpp: names are paths and may hold anything.
std::string quoted(const std::string& text) {
  std::string out(1, '"');
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + '"';
}

std::string line_start(const std::string& scene, const std::string& split, const SweepComparison& comparison) {
  return quoted(scene) + ',' + quoted(split) + ',' + sweep_codec_name(comparison.codec) + ',' +
         sweep_arm_name(comparison.test) + ',' + sweep_arm_name(comparison.reference) + ',';
}

}  // namespace

std::span<const SweepComparison> sweep_comparisons() {
  return kComparisons;
}

std::string comparison_text(const SweepComparison& comparison) {
  return std::string(arm_text(comparison.test)) + ", against " + arm_text(comparison.reference);
}

std::vector<SweepPoint> curve_of(const SweepTable& table, const std::string& scene, const std::string& split,
                                 SweepCodec codec, SweepArm arm) {
  Curve curve;
  for (const SweepPoint& point : table.points)
    if (point.codec == codec && point.arm == arm && point.scene == scene && point.split == split)
      curve.push_back(point);
  std::stable_sort(curve.begin(), curve.end(),
                   [](const SweepPoint& a, const SweepPoint& b) { return a.bytes < b.bytes; });
  return curve;
}

GainInterval bootstrap_interval(std::span<const double> percents) {
  GainInterval interval;
  interval.n_scenes = static_cast<int>(percents.size());
  if (percents.empty()) return interval;
  const auto n = static_cast<double>(percents.size());
  std::vector<double> logs;
  double sum = 0;
  for (const double percent : percents) {
    logs.push_back(exact_log(1 + percent / 100));
    sum += logs.back();
  }
  interval.percent = interval.low = interval.high = percent_of(sum / n);
  if (percents.size() < 2) return interval;
  std::vector<double> means(kResamples);
  uint64_t state = 1995;
  for (double& mean : means) {
    double total = 0;
    for (size_t i = 0; i < logs.size(); ++i) total += logs[next_random(state) % logs.size()];
    mean = total / n;
  }
  std::sort(means.begin(), means.end());
  interval.low = percent_of(means[kResamples / 40]);
  interval.high = percent_of(means[kResamples - 1 - kResamples / 40]);
  return interval;
}

SweepGains sweep_gains(const SweepTable& table) {
  SweepGains gains;
  std::vector<std::pair<std::string, std::string>> done;
  for (const SweepPoint& first : table.points) {
    std::pair key(first.scene, first.split);
    if (std::find(done.begin(), done.end(), key) != done.end()) continue;
    done.push_back(std::move(key));
    for (const SweepComparison& comparison : kComparisons) {
      const Curve reference = curve_of(table, first.scene, first.split, comparison.codec, comparison.reference);
      const Curve test = curve_of(table, first.scene, first.split, comparison.codec, comparison.test);
      if (reference.empty() || test.empty()) continue;
      SceneGain gain;
      gain.scene = first.scene;
      gain.split = first.split;
      gain.comparison = comparison;
      gain.mean = metric_gains(reference, test, false);
      gain.worst = metric_gains(reference, test, true);
      judge(reference, test, gain);
      gains.scenes.push_back(std::move(gain));
    }
  }
  summarize_splits(gains);
  return gains;
}

std::string sweep_gains_csv(const SweepGains& gains) {
  std::string csv = "scene,split,codec,test,reference,metric,of,scenes,percent,low_95,high_95\n";
  const auto add = [&](const std::string& start, size_t kind, const char* of, const GainInterval& gain) {
    csv += start + kScores[kind].key + ',' + of + ',' + std::to_string(gain.n_scenes) + ',' + fixed(gain.percent) + ',';
    if (gain.n_scenes > 1) csv += fixed(gain.low);
    csv += ',';
    if (gain.n_scenes > 1) csv += fixed(gain.high);
    csv += '\n';
  };
  for (const SceneGain& scene : gains.scenes)
    for (size_t kind = 0; kind < kScoreCount; ++kind) {
      const std::string start = line_start(scene.scene, scene.split, scene.comparison);
      if (scene.mean[kind]) add(start, kind, "mean", {1, *scene.mean[kind], 0, 0});
      if (scene.worst[kind]) add(start, kind, "worst_5_percent", {1, *scene.worst[kind], 0, 0});
    }
  for (const SplitGain& split : gains.splits)
    for (size_t kind = 0; kind < kScoreCount; ++kind) {
      const std::string start = line_start("(all)", split.split, split.comparison);
      if (split.mean[kind]) add(start, kind, "mean", *split.mean[kind]);
      if (split.worst[kind]) add(start, kind, "worst_5_percent", *split.worst[kind]);
    }
  return csv;
}

}  // namespace pac::sim
