#include "sim/sweep_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>

namespace pac::sim {

namespace {

constexpr const char* kCodecNames[] = {"jpeg", "mjpeg", "mpeg1"};
constexpr const char* kArmNames[] = {"image", "polygons", "none", "block", "model"};
constexpr uint64_t kMostJobs = 10000000;
constexpr int kLongestSide = 65535, kMostFrames = 1000000, kMostFramesPerSecond = 60;

template <class T, size_t kCount>
bool parse_name(const char* const (&names)[kCount], std::string_view name, T& value) {
  for (size_t i = 0; i < kCount; ++i)
    if (name == names[i]) {
      value = static_cast<T>(i);
      return true;
    }
  return false;
}

// RFC 4180: in quotes where it must be.
std::string csv_text(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string quoted(1, '"');
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

std::string csv_number(double number) {
  char buffer[32];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, number).ptr};
}

std::string csv_header() {
  std::string header =
      "job,jobs,scene,split,codec,arm,setting,width,height,frames,frames_per_second,bytes,resident_model_bytes";
  for (const ScoreKind& kind : kScores) {
    header += std::string(",") + kind.key;
    header += std::string(",") + kind.key + "_worst_5_percent";
  }
  return header + ",plan\n";
}

// Fields of a CSV file one by one; sticky: after the first fault every read gives nothing.
class CsvReader {
 public:
  explicit CsvReader(std::string_view text) : text_(text) {}

  bool ok() const { return ok_; }
  bool at_end() const { return at_ >= text_.size(); }
  const Failure& failure() const { return failure_; }

  void expect(std::string_view wanted, const char* problem) {
    for (size_t i = 0; ok_ && i < wanted.size(); ++i) {
      if (at_end() || text_[at_] != wanted[i]) fail_here(problem);
      if (ok_) ++at_;
    }
  }

  std::string text() {
    std::string field;
    field_start_ = at_;
    if (ok_ && !at_end() && text_[at_] == '"') {
      read_quoted(field);
    } else {
      while (ok_ && !at_end() && text_[at_] != ',' && text_[at_] != '\n') field += text_[at_++];
    }
    if (ok_ && at_end()) fail_here("the file ends inside a line");
    if (ok_ && ++n_fields_ < kFields && text_[at_] != ',') fail_here("a line with too few fields");
    if (ok_ && n_fields_ == kFields && text_[at_] != '\n') fail_here("a line with too many fields");
    if (!ok_) return "";
    if (n_fields_ == kFields) n_fields_ = 0;
    ++at_;
    return field;
  }

  uint64_t whole(uint64_t least, uint64_t most) {
    const std::string field = text();
    uint64_t number = 0;
    const auto parsed = std::from_chars(field.data(), field.data() + field.size(), number);
    if (parsed.ec != std::errc() || parsed.ptr != field.data() + field.size() || number < least || number > most)
      fail_at(field_start_, "not a whole number, or out of range");
    return ok_ ? number : 0;
  }
  int small(int least, int most) {
    return static_cast<int>(whole(static_cast<uint64_t>(least), static_cast<uint64_t>(most)));
  }

  double real() {
    const std::string field = text();
    double number = 0;
    const auto parsed = std::from_chars(field.data(), field.data() + field.size(), number);
    if (parsed.ec != std::errc() || parsed.ptr != field.data() + field.size() || !std::isfinite(number))
      fail_at(field_start_, "not a number");
    return ok_ ? number : 0;
  }

  template <class T, size_t kCount>
  T name(const char* const (&names)[kCount], const char* problem) {
    T value{};
    if (!parse_name(names, text(), value)) fail_at(field_start_, problem);
    return value;
  }

  void fail_at(size_t place, const char* problem, Error error = Error::corrupt) {
    if (ok_) failure_ = {error, place, problem};
    ok_ = false;
  }

 private:
  static constexpr size_t kFields = 14 + 2 * kScoreCount;

  void fail_here(const char* problem) { fail_at(at_, problem, at_end() ? Error::truncated : Error::corrupt); }

  void read_quoted(std::string& field) {
    for (++at_; !at_end(); ++at_) {
      if (text_[at_] == '"') {
        ++at_;
        if (at_end() || text_[at_] != '"') return;
      }
      field += text_[at_];
    }
  }

  std::string_view text_;
  size_t at_ = 0, field_start_ = 0, n_fields_ = 0;
  bool ok_ = true;
  Failure failure_;
};

SweepPoint read_point(CsvReader& csv, uint64_t& n_jobs, std::string& plan) {
  SweepPoint point;
  point.job = csv.whole(0, kMostJobs - 1);
  n_jobs = csv.whole(point.job + 1, kMostJobs);
  point.scene = csv.text();
  point.split = csv.text();
  point.codec = csv.name<SweepCodec>(kCodecNames, "no codec of a sweep");
  point.arm = csv.name<SweepArm>(kArmNames, "no arm of a sweep");
  point.setting = csv.real();
  point.width = csv.small(1, kLongestSide);
  point.height = csv.small(1, kLongestSide);
  point.frames = csv.small(1, kMostFrames);
  point.frames_per_second = csv.small(1, kMostFramesPerSecond);
  point.bytes = csv.whole(1, UINT64_MAX);
  point.resident_model_bytes = csv.whole(0, UINT64_MAX);
  for (FrameSummary& score : point.scores) {
    score.mean = csv.real();
    score.worst_5_percent = csv.real();
  }
  plan = csv.text();
  return point;
}

}  // namespace

const char* sweep_codec_name(SweepCodec codec) {
  return kCodecNames[static_cast<size_t>(codec)];
}

const char* sweep_arm_name(SweepArm arm) {
  return kArmNames[static_cast<size_t>(arm)];
}

bool parse_sweep_codec(std::string_view name, SweepCodec& codec) {
  return parse_name(kCodecNames, name, codec);
}

std::string sweep_csv(const SweepTable& table) {
  std::string csv = csv_header();
  for (const SweepPoint& point : table.points) {
    for (const uint64_t number : {point.job, table.n_jobs}) csv += std::to_string(number) + ',';
    for (const std::string& text : {point.scene, point.split}) csv += csv_text(text) + ',';
    csv += std::string(sweep_codec_name(point.codec)) + ',' + sweep_arm_name(point.arm) + ',';
    csv += csv_number(point.setting);
    for (const int number : {point.width, point.height, point.frames, point.frames_per_second})
      csv += ',' + std::to_string(number);
    for (const uint64_t number : {point.bytes, point.resident_model_bytes}) csv += ',' + std::to_string(number);
    for (const FrameSummary& score : point.scores)
      csv += ',' + csv_number(score.mean) + ',' + csv_number(score.worst_5_percent);
    csv += ',' + csv_text(table.plan) + '\n';
  }
  return csv;
}

Result<SweepTable> read_sweep_csv(std::string_view text) {
  CsvReader csv(text);
  csv.expect(csv_header(), "this is no sweep's CSV file, or one of another version");
  SweepTable table;
  for (size_t line = 0; csv.ok() && !csv.at_end(); ++line) {
    uint64_t n_jobs = 0;
    std::string plan;
    SweepPoint point = read_point(csv, n_jobs, plan);
    if (!csv.ok()) break;
    if (line > 0 && (n_jobs != table.n_jobs || plan != table.plan))
      return Failure{Error::corrupt, 0, "the lines come from different sweeps"};
    if (line > 0 && point.job <= table.points.back().job)
      return Failure{Error::corrupt, 0, "the jobs are not in ascending order"};
    table.n_jobs = n_jobs;
    table.plan = std::move(plan);
    table.points.push_back(std::move(point));
  }
  if (!csv.ok()) return csv.failure();
  return table;
}

Result<void> join_sweep(SweepTable& table, const SweepTable& part) {
  if (part.points.empty()) return {};
  if (!table.points.empty() && (table.plan != part.plan || table.n_jobs != part.n_jobs))
    return Failure{Error::bad_argument, 0, "this is a part of another sweep: scenes or options differ"};
  const auto before = [](const SweepPoint& a, const SweepPoint& b) { return a.job < b.job; };
  std::vector<SweepPoint> joined;
  std::merge(table.points.begin(), table.points.end(), part.points.begin(), part.points.end(),
             std::back_inserter(joined), before);
  const auto same = [](const SweepPoint& a, const SweepPoint& b) { return a.job == b.job; };
  if (std::adjacent_find(joined.begin(), joined.end(), same) != joined.end())
    return Failure{Error::bad_argument, 0, "some of its jobs are in another part as well"};
  table = {part.plan, part.n_jobs, std::move(joined)};
  return {};
}

std::vector<uint64_t> missing_jobs(const SweepTable& table) {
  std::vector<uint64_t> missing;
  size_t next = 0;
  for (uint64_t job = 0; job < table.n_jobs; ++job) {
    if (next < table.points.size() && table.points[next].job == job)
      ++next;
    else
      missing.push_back(job);
  }
  return missing;
}

}  // namespace pac::sim
