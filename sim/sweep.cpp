#include "sim/sweep.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <optional>
#include <utility>

#include "base/parallel.h"
#include "jpeg/jpeg.h"
#include "sim/difference.h"
#include "sim/frame_renderer.h"
#include "sim/packet.h"
#include "sim/video_sequence.h"

namespace pac::sim {

namespace {

class Stopwatch {
 public:
  double ms() const {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// ---- the plan

constexpr SweepArm kJpegArms[] = {SweepArm::image, SweepArm::polygons};
constexpr SweepArm kMpeg1Arms[] = {SweepArm::image, SweepArm::none, SweepArm::block, SweepArm::model};

std::span<const SweepArm> arms_of(SweepCodec codec) {
  if (codec == SweepCodec::mpeg1) return kMpeg1Arms;
  return kJpegArms;
}

int frames_of(const SweepPlan& plan, SweepCodec codec) {
  return codec == SweepCodec::jpeg ? 1 : plan.frames;
}

const char* problem_with(const SweepPlan& plan, const SweepShard& shard) {
  const auto outside = [](const std::vector<double>& settings, double least, double most) {
    return std::any_of(settings.begin(), settings.end(), [=](double x) { return !(x >= least && x <= most); });
  };
  if (outside(plan.qualities, 0.01, 100)) return "qualities must be in 0.01..100";
  if (outside(plan.quantizers, 1, 31)) return "quantizers must be in 1..31";
  if (plan.frames < 1 || plan.frames > 100000) return "frames must be 1..100000";
  if (plan.frames_per_second < 1 || plan.frames_per_second > 60) return "frames a second must be 1..60";
  if (plan.width < 0 || plan.width > 65535 || plan.height < 0 || plan.height > 65535)
    return "picture sides must be 1..65535";
  if (shard.count < 1 || shard.number < 1 || shard.number > shard.count) return "a shard I/N needs 1 <= I <= N";
  return nullptr;
}

std::string number_text(double number) {
  char buffer[32];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, number).ptr};
}

std::string numbers_text(const std::vector<double>& numbers) {
  std::string text;
  for (const double number : numbers) {
    if (!text.empty()) text += ',';
    text += number_text(number);
  }
  return text;
}

// As a shell takes it for one word.
std::string shell_word(const std::string& text) {
  const auto is_plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string_view("_-./+,=:").find(c) != std::string_view::npos;
  };
  if (!text.empty() && std::all_of(text.begin(), text.end(), is_plain)) return text;
  std::string quoted(1, '\'');
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + '\'';
}

// Every split of any scene once, a combined one as its option says it: parts joined by plus signs.
std::string splits_text(const SweepPlan& plan) {
  std::vector<std::string> names;
  for (const SweepScene& scene : plan.scenes)
    for (std::string name : scene.splits) {
      std::replace(name.begin(), name.end(), ',', '+');
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(std::move(name));
    }
  std::string text;
  for (const std::string& name : names) {
    if (!text.empty()) text += ',';
    text += name;
  }
  return text;
}

// ---- one scene under one split: drawn once, coded many times

struct CodedFrames {
  uint64_t bytes = 0;
  std::vector<RgbImage> shown;
};

class DrawnScene {
 public:
  static Result<DrawnScene> create(const SweepPlan& plan, size_t scene_number, size_t split_number, int frames,
                                   bool with_geometry, const SweepOptions& options) {
    const SweepScene& scene = plan.scenes[scene_number];
    const SceneSet& set = *scene.set;
    const int width = plan.width > 0 ? plan.width : set.width, height = plan.height > 0 ? plan.height : set.height;
    const Stopwatch watch;
    PAC_TRY(Split split, make_split(scene.splits[split_number], set, {plan.samples}));
    PAC_TRY(FrameRenderer renderer,
            FrameRenderer::create(set, split, false, width, height, options.threads, options.isa));
    DrawnScene drawn(plan, std::move(split), std::move(renderer), options.isa);
    const float aspect = static_cast<float>(width) / static_cast<float>(height);
    for (int number = 0; number < frames; ++number) {
      const raster::Camera camera = scene.path(number, aspect);
      PAC_TRY(FrameImages images, drawn.renderer_.render(set, camera, with_geometry));
      drawn.shots_.push_back({camera, std::move(images)});
    }
    drawn.model_bytes_ = serialize_model(drawn.renderer_.low_scene(), drawn.split_.low.texture).size();
    drawn.render_ms_ = watch.ms();
    return drawn;
  }

  // Any number of jobs at once.
  Result<SweepPoint> measure(const SweepJob& job, SweepTime& time) const {
    const Stopwatch watch;
    PAC_TRY(const CodedFrames coded, code(job));
    time = {job.number, render_ms_, watch.ms(), 0};
    const Stopwatch score_watch;
    SweepPoint point;
    point.job = job.number;
    point.scene = plan_->scenes[job.scene].name;
    point.split = plan_->scenes[job.scene].splits[job.split];
    point.codec = job.codec;
    point.arm = job.arm;
    point.setting = job.setting;
    point.width = shots_[0].images.high.width();
    point.height = shots_[0].images.high.height();
    point.frames = static_cast<int>(coded.shown.size());
    point.frames_per_second = plan_->frames_per_second;
    point.bytes = coded.bytes;
    point.resident_model_bytes = job.arm == SweepArm::image ? 0 : model_bytes_;
    std::vector<ScoredPair> pairs;
    for (size_t i = 0; i < coded.shown.size(); ++i)
      pairs.push_back({shots_[i].images.high.view(), coded.shown[i].view()});
    const std::vector<FrameScores> scores = score_frames(pairs, 1);
    for (size_t kind = 0; kind < kScoreCount; ++kind) point.scores[kind] = summarize(scores, kind);
    time.score_ms = score_watch.ms();
    return point;
  }

 private:
  DrawnScene(const SweepPlan& plan, Split split, FrameRenderer renderer, Isa isa)
      : plan_(&plan), split_(std::move(split)), renderer_(std::move(renderer)), isa_(isa) {}

  Result<CodedFrames> code(const SweepJob& job) const {
    if (job.codec == SweepCodec::mpeg1) return code_mpeg1(job);
    CodedFrames out;
    for (size_t i = 0; i < static_cast<size_t>(frames_of(*plan_, job.codec)); ++i)
      PAC_CHECK(code_jpeg(job, shots_[i].images, out));
    return out;
  }

  Result<void> code_jpeg(const SweepJob& job, const FrameImages& images, CodedFrames& out) const {
    CodingOptions coding;
    coding.tables = plan_->tables;
    coding.huffman = jpeg::Huffman::optimal;
    coding.isa = isa_;
    const bool is_image = job.arm == SweepArm::image;
    const Content content = is_image ? Content::image : Content::difference;
    PAC_TRY(const CodedImage coded, code_at_quality((is_image ? images.high : images.difference).view(), content,
                                                    coded_quality(job.setting, content), coding));
    PAC_TRY(RgbImage shown, jpeg::decode(coded.bytes, {}, isa_));
    if (!is_image) composite_image(images.low.view(), shown.view(), shown.view(), isa_);
    out.bytes += coded.bytes.size();
    out.shown.push_back(std::move(shown));
    return {};
  }

  Result<CodedFrames> code_mpeg1(const SweepJob& job) const {
    const int rate_code = mpeg1::picture_rate_code(1000 * plan_->frames_per_second);
    if (job.arm == SweepArm::image) {
      ImageVideoOptions video;
      video.quantizer_scale = job.setting;
      video.picture_rate_code = rate_code;
      video.effort = plan_->effort;
      video.isa = isa_;
      return frames_from(code_image_video(shots_, video, true));
    }
    AssistedVideoOptions video;
    video.prediction = job.arm == SweepArm::none    ? Prediction::none
                       : job.arm == SweepArm::block ? Prediction::block
                                                    : Prediction::model;
    video.difference = job.arm == SweepArm::block ? Difference::halved : Difference::full;
    video.quantizer_scale = job.setting;
    video.picture_rate_code = rate_code;
    video.effort = plan_->effort;
    const RgbImage& high = shots_[0].images.high;
    const AssistedScene scene = {high.width(), high.height(), &renderer_.low_scene(), split_.low.samples,
                                 split_.differs_in_light()};
    return frames_from(code_assisted_video(shots_, scene, video, isa_, true));
  }

  static Result<CodedFrames> frames_from(Result<std::vector<VideoFrame>> coded) {
    PAC_TRY(std::vector<VideoFrame> frames, std::move(coded));
    CodedFrames out;
    out.bytes = total_bytes(frames);
    for (VideoFrame& frame : frames) out.shown.push_back(std::move(frame.shown));
    return out;
  }

  const SweepPlan* plan_;
  Split split_;
  FrameRenderer renderer_;
  Isa isa_;
  std::vector<Shot> shots_;
  uint64_t model_bytes_ = 0;
  double render_ms_ = 0;
};

// A batch keeps all threads busy, one job each.
Result<void> run_batch(const DrawnScene& drawn, std::span<const SweepJob> jobs, int threads, SweepRun& run) {
  std::vector<std::optional<Result<SweepPoint>>> points(jobs.size());
  std::vector<SweepTime> times(jobs.size());
  parallel_for(threads, static_cast<int64_t>(jobs.size()), [&](int64_t i) {
    const auto index = static_cast<size_t>(i);
    points[index] = drawn.measure(jobs[index], times[index]);
  });
  for (size_t i = 0; i < jobs.size(); ++i) {
    PAC_TRY(SweepPoint point, std::move(*points[i]));
    run.table.points.push_back(std::move(point));
    run.times.push_back(times[i]);
  }
  return {};
}

}  // namespace

std::string plan_text(const SweepPlan& plan) {
  std::string text;
  for (const SweepScene& scene : plan.scenes) text += shell_word(scene.name) + ' ';
  text += "--splits " + splits_text(plan) + " --codecs ";
  bool is_first = true, has_jpeg = false, has_mpeg1 = false, has_video = false;
  for (const SweepCodec codec : plan.codecs) {
    if (!is_first) text += ',';
    text += sweep_codec_name(codec);
    is_first = false;
    has_jpeg = has_jpeg || codec != SweepCodec::mpeg1;
    has_mpeg1 = has_mpeg1 || codec == SweepCodec::mpeg1;
    has_video = has_video || codec != SweepCodec::jpeg;
  }
  if (has_jpeg) text += " --qualities " + numbers_text(plan.qualities);
  if (has_mpeg1) text += " --quantizers " + numbers_text(plan.quantizers);
  if (has_video)
    text += " --frames " + std::to_string(plan.frames) + " --fps " + std::to_string(plan.frames_per_second);
  if (plan.width > 0) text += " --width " + std::to_string(plan.width);
  if (plan.height > 0) text += " --height " + std::to_string(plan.height);
  text += " --samples " + std::to_string(plan.samples);
  if (has_jpeg) text += std::string(" --tables ") + (plan.tables == TableFamily::adapted ? "adapted" : "annex-k");
  constexpr const char* kEfforts[] = {"fast", "default", "best"};
  if (has_mpeg1) text += std::string(" --effort ") + kEfforts[static_cast<size_t>(plan.effort)];
  return text;
}

std::vector<SweepJob> sweep_jobs(const SweepPlan& plan) {
  std::vector<SweepJob> jobs;
  for (size_t scene = 0; scene < plan.scenes.size(); ++scene)
    for (size_t split = 0; split < plan.scenes[scene].splits.size(); ++split)
      for (const SweepCodec codec : plan.codecs)
        for (const SweepArm arm : arms_of(codec))
          for (const double setting : codec == SweepCodec::mpeg1 ? plan.quantizers : plan.qualities)
            jobs.push_back({jobs.size(), scene, split, codec, arm, setting});
  return jobs;
}

std::vector<SweepJob> jobs_of_shard(const std::vector<SweepJob>& jobs, const SweepShard& shard) {
  std::vector<SweepJob> mine;
  for (const SweepJob& job : jobs)
    if (job.number % shard.count == shard.number - 1) mine.push_back(job);
  return mine;
}

std::string sweep_times_csv(const std::vector<SweepTime>& times) {
  std::string csv = "job,render_ms,code_ms,score_ms\n";
  for (const SweepTime& time : times) {
    csv += std::to_string(time.job);
    for (const double ms : {time.render_ms, time.code_ms, time.score_ms}) {
      char buffer[64];
      const auto end = std::to_chars(buffer, buffer + sizeof buffer, ms, std::chars_format::fixed, 1).ptr;
      csv += ',';
      csv.append(buffer, end);
    }
    csv += '\n';
  }
  return csv;
}

Result<SweepRun> run_sweep(const SweepPlan& plan, const SweepOptions& options) {
  if (const char* problem = problem_with(plan, options.shard)) return Failure{Error::bad_argument, 0, problem};
  const std::vector<SweepJob> all = sweep_jobs(plan), jobs = jobs_of_shard(all, options.shard);
  SweepRun run;
  run.table.plan = plan_text(plan);
  run.table.n_jobs = all.size();
  const auto batch_size = static_cast<size_t>(options.threads > 0 ? options.threads : hardware_thread_count());
  for (size_t first = 0; first < jobs.size();) {
    size_t end = first;
    int frames = 1;
    bool with_geometry = false;
    for (; end < jobs.size() && jobs[end].scene == jobs[first].scene && jobs[end].split == jobs[first].split; ++end) {
      frames = std::max(frames, frames_of(plan, jobs[end].codec));
      with_geometry = with_geometry || jobs[end].codec == SweepCodec::mpeg1;
    }
    if (options.progress) options.progress(first, jobs.size(), jobs[first]);
    PAC_TRY(const DrawnScene drawn,
            DrawnScene::create(plan, jobs[first].scene, jobs[first].split, frames, with_geometry, options));
    while (first < end) {
      const std::span batch(jobs.data() + first, std::min(batch_size, end - first));
      if (options.progress) options.progress(first, jobs.size(), batch[0]);
      PAC_CHECK(run_batch(drawn, batch, options.threads, run));
      first += batch.size();
    }
  }
  return run;
}

}  // namespace pac::sim
