#include "bench/peers/experiment_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

#include "base/bd_rate.h"

namespace pac::bench {

namespace {

// Rates from coarse to fine, or the other way round: four, of JPEG's stills more, for the paper's curves. Colors say
// the codec; whole lines have polygons, dashed ones are codecs alone, dotted ones codecs at their best.
constexpr ExperimentArm kArms[] = {
    {"polygons-jpeg", "polygons + JPEG", false, "image", {3, 7, 15, 30, 50, 75, 92}},
    {"polygons-still", "polygons, predicted from L", false, "polygon wide", {26, 13, 7, 4}},
    {"polygons-avif", "polygons + AVIF", false, "hue4", {46, 36, 26, 16}},
    {"jpeg", "JPEG", false, "image dashed", {3, 7, 15, 30, 50, 75, 92}},
    {"mozjpeg", "mozjpeg", false, "hue6 dashed", {15, 35, 55, 80}},
    {"webp", "WebP", false, "hue3 dashed", {5, 30, 60, 85}},
    {"avif", "AVIF", false, "hue4 dashed", {52, 42, 32, 22}},
    {"jpeg-xl", "JPEG XL", false, "hue5 dashed", {10, 6, 3, 1.5}},
    {"polygons-model", "polygons + MPEG-1, model", true, "polygon wide", {26, 13, 7, 4}},
    {"polygons-block", "polygons + MPEG-1, blocks", true, "hue2", {26, 13, 7, 4}},
    {"polygons-none", "polygons, predicted from L", true, "hue5", {26, 13, 7, 4}},
    {"polygons-mjpeg", "polygons + motion JPEG", true, "image", {8, 20, 45, 75}},
    {"polygons-x264", "polygons + x264 low delay", true, "hue3", {38, 32, 26, 20}},
    {"mjpeg", "motion JPEG", true, "image dashed", {8, 20, 45, 75}},
    {"mpeg1", "MPEG-1", true, "hue2 dashed", {26, 13, 7, 4}},
    {"x264-low-delay", "x264 veryslow, zerolatency", true, "hue3 dashed", {40, 34, 28, 22}},
    {"x264-best", "x264 veryslow, two-pass, B", true, "hue3 dotted", {25, 75, 225, 675}},
    {"x265-low-delay", "x265 slower, zerolatency", true, "hue6 dashed", {40, 34, 28, 22}},
    {"svt-av1-low-delay", "SVT-AV1, low delay", true, "hue4 dashed", {60, 48, 36, 24}},
    {"svt-av1-best", "SVT-AV1 p4, random access", true, "hue4 dotted", {60, 48, 36, 24}},
};

std::string number_text(double number) {
  char buffer[40];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, number, std::chars_format::general, 6).ptr};
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

double score_of(const ExperimentRow& row, size_t kind, bool of_worst) {
  return of_worst ? row.scores[kind].worst_5_percent : row.scores[kind].mean;
}

// Of all scores that a curve reaches.
double score_span(std::span<const RatePoint> points) {
  const auto [low, high] = std::minmax_element(
      points.begin(), points.end(), [](const RatePoint& a, const RatePoint& b) { return a.quality < b.quality; });
  return high->quality - low->quality;
}

sim::MetricGains gains_of(const ExperimentCurve& reference, const ExperimentCurve& test, bool of_worst) {
  constexpr double kLeastShare = 0.2;
  sim::MetricGains gains;
  for (size_t kind = 0; kind < sim::kScoreCount; ++kind) {
    std::vector<RatePoint> points[2];
    for (int side = 0; side < 2; ++side)
      for (const ExperimentRow& row : side == 0 ? reference : test)
        points[side].push_back({static_cast<double>(row.bytes), score_of(row, kind, of_worst)});
    const auto rate = bd_rate(points[0], points[1]);
    if (!rate.ok()) continue;
    const double shared = rate->highest_quality - rate->lowest_quality;
    if (shared >= kLeastShare * std::min(score_span(points[0]), score_span(points[1]))) gains[kind] = rate->percent;
  }
  return gains;
}

// What is known of a curve at `bytes`: linear over their logarithm, clamped to its ends.
QualitySummary summary_at(const ExperimentCurve& curve, double bytes) {
  size_t i = 1;
  while (i + 1 < curve.size() && static_cast<double>(curve[i].bytes) < bytes) ++i;
  const double low = std::log(static_cast<double>(curve[i - 1].bytes));
  const double span = std::log(static_cast<double>(curve[i].bytes)) - low;
  const double part = span > 0 ? std::clamp((std::log(bytes) - low) / span, 0.0, 1.0) : 0.0;
  const auto mix = [&](size_t kind) -> FrameSummary {
    const FrameSummary &a = curve[i - 1].scores[kind], &b = curve[i].scores[kind];
    return {a.mean + part * (b.mean - a.mean), a.worst_5_percent + part * (b.worst_5_percent - a.worst_5_percent)};
  };
  return {static_cast<uint64_t>(std::exp(low + part * span)), mix(0), mix(1), mix(2)};
}

// At the middle, by logarithms, of the bytes that both reach; else the larger end of the smaller curve against the
// smaller end of the larger one.
Verdict verdict_of(const ExperimentCurve& reference, const ExperimentCurve& test) {
  const auto low = static_cast<double>(std::max(reference.front().bytes, test.front().bytes));
  const auto high = static_cast<double>(std::min(reference.back().bytes, test.back().bytes));
  const double middle = std::sqrt(low * high);
  QualitySummary first = summary_at(reference, middle), second = summary_at(test, middle);
  if (low <= high) first.size_bytes = second.size_bytes;
  return compare_summaries(first, second);
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
    gains.push_back(
        {row.scene, row.split, gains_of(theirs, ours, false), gains_of(theirs, ours, true), verdict_of(theirs, ours)});
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

std::optional<double> log_bytes_at(const ExperimentCurve& curve, size_t kind, double score) {
  for (size_t i = 1; i < curve.size(); ++i) {
    const double a = curve[i - 1].scores[kind].mean, b = curve[i].scores[kind].mean;
    if (a == b || (score - a) * (score - b) > 0) continue;
    const double low = std::log(static_cast<double>(curve[i - 1].bytes));
    return low + (std::log(static_cast<double>(curve[i].bytes)) - low) * (score - a) / (b - a);
  }
  return std::nullopt;
}

std::optional<double> score_at(const ExperimentCurve& curve, size_t kind, double bytes) {
  for (size_t i = 1; i < curve.size(); ++i) {
    const auto low = static_cast<double>(curve[i - 1].bytes), high = static_cast<double>(curve[i].bytes);
    if (bytes < low || bytes > high || low == high) continue;
    const double part = std::log(bytes / low) / std::log(high / low);
    const double a = curve[i - 1].scores[kind].mean;
    return a + part * (curve[i].scores[kind].mean - a);
  }
  return std::nullopt;
}

}  // namespace pac::bench
