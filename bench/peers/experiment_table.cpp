#include "bench/peers/experiment_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

#include "base/bd_rate.h"

namespace pac::bench {

namespace {

constexpr size_t kVoices = 3;  // metrics of the verdict, the first of kScores

constexpr ExperimentArm kArms[] = {
    {"polygons-jpeg", "polygons + JPEG", false, "polygon"},
    {"polygons-still", "polygons, predicted from L", false, "hue2"},
    {"polygons-avif", "polygons + AVIF", false, "hue5"},
    {"jpeg", "JPEG", false, "image"},
    {"mozjpeg", "mozjpeg", false, "hue1"},
    {"webp", "WebP", false, "hue3"},
    {"avif", "AVIF", false, "hue4"},
    {"jpeg-xl", "JPEG XL", false, "hue6"},
    {"polygons-model", "polygons + MPEG-1, model", true, "polygon"},
    {"polygons-block", "polygons + MPEG-1, blocks", true, "hue0"},
    {"polygons-none", "polygons, predicted from L", true, "hue2"},
    {"polygons-mjpeg", "polygons + motion JPEG", true, "hue2"},
    {"polygons-x264", "polygons + x264 low delay", true, "hue5"},
    {"mjpeg", "motion JPEG", true, "hue1"},
    {"mpeg1", "MPEG-1", true, "image"},
    {"x264-low-delay", "x264 veryslow, zerolatency", true, "hue3"},
    {"svt-av1-low-delay", "SVT-AV1 p4, low delay", true, "hue4"},
    {"x264-best", "x264 veryslow, two-pass, B", true, "hue3"},
    {"x265-low-delay", "x265 slower, zerolatency", true, "hue6"},
    {"svt-av1-best", "SVT-AV1 p4, random access", true, "hue4"},
};

std::string number_text(double number) {
  char buffer[40];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, number, std::chars_format::general, 8).ptr};
}

std::vector<std::string_view> split_at(std::string_view text, char mark) {
  std::vector<std::string_view> parts;
  for (size_t begin = 0; begin <= text.size();) {
    const size_t end = std::min(text.find(mark, begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

bool parse_row(std::string_view line, ExperimentRow& row) {
  const auto fields = split_at(line, ',');
  constexpr size_t kNames = 3, kNumbers = 9;
  if (fields.size() != kNames + kNumbers + 2 * sim::kScoreCount) return false;
  double numbers[kNumbers + 2 * sim::kScoreCount];
  for (size_t i = 0; i + kNames < fields.size(); ++i) {
    const std::string_view field = fields[i + kNames];
    const auto parsed = std::from_chars(field.data(), field.data() + field.size(), numbers[i]);
    if (parsed.ec != std::errc() || parsed.ptr != field.data() + field.size() || !std::isfinite(numbers[i]))
      return false;
  }
  row.scene = fields[0];
  row.split = fields[1];
  row.arm = fields[2];
  row.setting = numbers[0];
  row.width = static_cast<int>(numbers[1]);
  row.height = static_cast<int>(numbers[2]);
  row.frames = static_cast<int>(numbers[3]);
  row.bytes = static_cast<uint64_t>(numbers[4]);
  row.resident_model_bytes = static_cast<uint64_t>(numbers[5]);
  row.draw_low_ms = numbers[6];
  row.encode_ms = numbers[7];
  row.decode_ms = numbers[8];
  for (size_t kind = 0; kind < sim::kScoreCount; ++kind)
    row.scores[kind] = {numbers[kNumbers + 2 * kind], numbers[kNumbers + 2 * kind + 1]};
  return find_arm(row.arm) != nullptr && row.bytes > 0;
}

sim::MetricGains gains_of(const ExperimentCurve& reference, const ExperimentCurve& test, bool of_worst) {
  sim::MetricGains gains;
  for (size_t kind = 0; kind < sim::kScoreCount; ++kind) {
    std::vector<RatePoint> points[2];
    for (int side = 0; side < 2; ++side)
      for (const ExperimentRow& row : side == 0 ? reference : test)
        points[side].push_back(
            {static_cast<double>(row.bytes), of_worst ? row.scores[kind].worst_5_percent : row.scores[kind].mean});
    const auto rate = bd_rate(points[0], points[1]);
    if (rate.ok()) gains[kind] = rate->percent;
  }
  return gains;
}

// ln(bytes) of the curve at a score, between its points; empty outside.
std::optional<double> log_bytes_at(const ExperimentCurve& curve, size_t kind, double score) {
  for (size_t i = 1; i < curve.size(); ++i) {
    const double a = curve[i - 1].scores[kind].mean, b = curve[i].scores[kind].mean;
    if (a == b || (score - a) * (score - b) > 0) continue;
    const double low = std::log(static_cast<double>(curve[i - 1].bytes));
    return low + (std::log(static_cast<double>(curve[i].bytes)) - low) * (score - a) / (b - a);
  }
  return std::nullopt;
}

}  // namespace

std::span<const ExperimentArm> experiment_arms() {
  return kArms;
}

const ExperimentArm* find_arm(const std::string& key) {
  for (const ExperimentArm& arm : kArms)
    if (key == arm.key) return &arm;
  return nullptr;
}

std::string row_header() {
  std::string text =
      "scene,split,arm,setting,width,height,frames,bytes,resident_model_bytes,draw_low_ms,encode_ms,decode_ms";
  for (const sim::ScoreKind& kind : sim::kScores)
    text += std::string(",") + kind.key + ',' + kind.key + "_worst_5_percent";
  return text + '\n';
}

std::string row_line(const ExperimentRow& row) {
  std::string text = row.scene + ',' + row.split + ',' + row.arm + ',' + number_text(row.setting);
  for (const int number : {row.width, row.height, row.frames}) text += ',' + std::to_string(number);
  for (const uint64_t number : {row.bytes, row.resident_model_bytes}) text += ',' + std::to_string(number);
  for (const double ms : {row.draw_low_ms, row.encode_ms, row.decode_ms}) text += ',' + number_text(ms);
  for (const FrameSummary& score : row.scores)
    text += ',' + number_text(score.mean) + ',' + number_text(score.worst_5_percent);
  return text + '\n';
}

std::vector<ExperimentRow> read_rows(std::string_view csv) {
  std::vector<ExperimentRow> rows;
  for (size_t begin = 0; begin < csv.size();) {
    const size_t end = csv.find('\n', begin);
    if (end == std::string_view::npos) break;  // cut short
    ExperimentRow row;
    if (parse_row(csv.substr(begin, end - begin), row)) rows.push_back(std::move(row));
    begin = end + 1;
  }
  return rows;
}

ExperimentCurve curve_of(std::span<const ExperimentRow> rows, const std::string& scene, const std::string& split,
                         const std::string& arm) {
  ExperimentCurve curve;
  for (const ExperimentRow& row : rows)
    if (row.scene == scene && row.split == split && row.arm == arm) curve.push_back(row);
  std::stable_sort(curve.begin(), curve.end(), [](const auto& a, const auto& b) { return a.bytes < b.bytes; });
  return curve;
}

ArmGain::Agreement ArmGain::agreement() const {
  int n_better = 0, n_worse = 0;
  for (const sim::MetricGains* gains : {&mean, &worst})
    for (size_t kind = 0; kind < kVoices; ++kind) {
      n_better += (*gains)[kind] && *(*gains)[kind] < 0 ? 1 : 0;
      n_worse += (*gains)[kind] && *(*gains)[kind] > 0 ? 1 : 0;
    }
  constexpr int kAll = 2 * static_cast<int>(kVoices);
  return n_better == kAll ? Agreement::better : n_worse == kAll ? Agreement::worse : Agreement::disagree;
}

std::vector<ArmGain> arm_gains(std::span<const ExperimentRow> rows, const std::string& split, const std::string& test,
                               const std::string& reference) {
  std::vector<ArmGain> gains;
  for (const ExperimentRow& row : rows) {
    if (row.arm != test || (!split.empty() && row.split != split)) continue;
    const bool is_known = std::any_of(gains.begin(), gains.end(), [&](const ArmGain& gain) {
      return gain.scene == row.scene && gain.split == row.split;
    });
    if (is_known) continue;
    const ExperimentCurve ours = curve_of(rows, row.scene, row.split, test);
    const ExperimentCurve theirs = curve_of(rows, row.scene, row.split, reference);
    if (ours.size() < 2 || theirs.size() < 2) continue;
    gains.push_back({row.scene, row.split, gains_of(theirs, ours, false), gains_of(theirs, ours, true)});
  }
  return gains;
}

std::optional<sim::GainInterval> over_scenes(std::span<const ArmGain> gains, size_t kind, bool of_worst) {
  std::vector<double> percents;
  for (const ArmGain& gain : gains)
    if (const auto& percent = (of_worst ? gain.worst : gain.mean)[kind]) percents.push_back(*percent);
  if (percents.empty()) return std::nullopt;
  return sim::bootstrap_interval(percents);
}

std::optional<double> crossing_ratio(const ExperimentCurve& reference, const ExperimentCurve& test, size_t kind) {
  if (reference.empty()) return std::nullopt;
  const double bits = 24.0 * reference[0].width * reference[0].height;
  std::optional<double> before_bytes, before_gap;
  for (size_t i = 1; i < reference.size(); ++i) {
    constexpr int kSteps = 64;
    for (int step = 0; step <= kSteps; ++step) {
      const double part = static_cast<double>(step) / kSteps;
      const double a = reference[i - 1].scores[kind].mean, b = reference[i].scores[kind].mean;
      const auto theirs = log_bytes_at(reference, kind, a + part * (b - a));
      const auto ours = log_bytes_at(test, kind, a + part * (b - a));
      if (!theirs || !ours) continue;
      const double gap = *ours - *theirs;
      if (before_gap && *before_gap < 0 && gap >= 0) return bits / (8 * std::exp(*before_bytes)) * reference[0].frames;
      before_gap = gap;
      before_bytes = *theirs;
    }
  }
  return std::nullopt;
}

}  // namespace pac::bench
