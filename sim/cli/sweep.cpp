// `pac sweep`: rate-distortion curves; a part of them; parts joined.
#include "sim/sweep.h"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <utility>

#include "sim/cli/command.h"
#include "sim/cli/report_files.h"
#include "sim/cli/scene_source.h"
#include "sim/cli/sweep_files.h"
#include "sim/loaded_scene.h"
#include "sim/report_markup.h"
#include "sim/split.h"

namespace pac::cli {
namespace {

struct Request {
  std::vector<std::string> operands;  // scenes, or folders
  std::string out, splits, codecs = "jpeg,mjpeg,mpeg1", shard_text;
  bool merge = false;
  sim::SweepPlan plan;
  sim::SweepShard shard;
};

constexpr const char* kPlanOptions[] = {"--splits", "--codecs", "--qualities", "--quantizers", "--frames", "--fps",
                                        "--width",  "--height", "--samples",   "--tables",     "--effort", "--shard"};

void declare(Options& options, Request& request) {
  using sim::TableFamily;
  sim::SweepPlan& plan = request.plan;
  options.positionals("SCENE...", request.operands,
                      "built-in scenes ('pac scenes'), OBJ or PLY files; --merge: folders");
  options.text("-o|--output", "DIR", request.out, "sweep.csv, gains.csv, times.csv, a .svg a plot, index.html", true);
  options.text("--splits", "LIST", request.splits,
               "texture, tessellation, shading, antialiasing, lighting, joined by commas (a+b: both at once); all: "
               "each that the scene can do (the scene's own)");
  options.text("--codecs", "LIST", request.codecs, "of jpeg (the first frame), mjpeg, mpeg1 (all three)");
  options.reals("--qualities", "LIST", plan.qualities, 0.01, 100, "of jpeg and mjpeg (5,10,20,35,55,75)");
  options.reals("--quantizers", "LIST", plan.quantizers, 1, 31, "quantizer_scales of mpeg1 (2,4,8,14,21,31)");
  options.integer("--frames", "N", plan.frames, 1, 100000, "of the camera path, for mjpeg and mpeg1 (24)");
  options.integer("--fps", "F", plan.frames_per_second, 1, 60, "frames a second (20)");
  options.integer("--width", "W", plan.width, 1, 32768, "pixels (the scene's own)");
  options.integer("--height", "H", plan.height, 1, 32768, "pixels (the scene's own)");
  options.choice<int>("--samples", plan.samples, {{"1", 1}, {"4", 4}, {"16", 16}, {"64", 64}},
                      "a pixel, of an antialiased side (16)");
  options.choice<TableFamily>("--tables", plan.tables,
                              {{"annex-k", TableFamily::annex_k}, {"adapted", TableFamily::adapted}},
                              "quantization tables of JPEG, both arms (annex-k)");
  options.choice<mpeg1::Effort>(
      "--effort", plan.effort,
      {{"fast", mpeg1::Effort::fast}, {"default", mpeg1::Effort::normal}, {"best", mpeg1::Effort::best}},
      "of MPEG-1, all arms (default)");
  options.text("--shard", "I/N", request.shard_text,
               "only every N-th job, from the I-th on (1..N): writes sweep-I-of-N.csv and times-I-of-N.csv");
  options.flag("--merge", request.merge, "joins the shards in the folders instead");
}

std::vector<std::string> words_of(const std::string& list) {
  std::vector<std::string> words;
  for (size_t begin = 0; begin <= list.size();) {
    const size_t end = std::min(list.find(',', begin), list.size());
    words.push_back(list.substr(begin, end - begin));
    begin = end + 1;
  }
  return words;
}

// Empty, or the problem.
std::string parse_codecs(const std::string& list, std::vector<sim::SweepCodec>& codecs) {
  const std::vector<std::string> names = {"jpeg", "mjpeg", "mpeg1"};
  for (const std::string& word : words_of(list)) {
    sim::SweepCodec codec{};
    if (!sim::parse_sweep_codec(word, codec)) {
      const std::string suggestion = nearest(word, names);
      return "--codecs: '" + word + "' is not one of jpeg, mjpeg, mpeg1" +
             (suggestion.empty() ? "" : "; did you mean '" + suggestion + "'?");
    }
    if (std::find(codecs.begin(), codecs.end(), codec) != codecs.end())
      return "--codecs: '" + word + "' is there twice";
    codecs.push_back(codec);
  }
  return "";
}

std::string parse_shard(const std::string& text, sim::SweepShard& shard) {
  constexpr uint64_t kMost = 1000000;
  const char* end = text.data() + text.size();
  const auto number = std::from_chars(text.data(), end, shard.number);
  if (number.ec == std::errc() && number.ptr != end && *number.ptr == '/') {
    const auto count = std::from_chars(number.ptr + 1, end, shard.count);
    if (count.ec == std::errc() && count.ptr == end && shard.number >= 1 && shard.number <= shard.count &&
        shard.count <= kMost)
      return "";
  }
  return "--shard: '" + text + "' is not I/N with 1 <= I <= N";
}

// The names of known parts, so that a slip of the keys is a usage error and not a split that no scene can do.
std::string check_split_names(const std::vector<std::string>& splits) {
  std::vector<std::string> names;
  for (const char* const* name = sim::split_names(); *name != nullptr; ++name) names.emplace_back(*name);
  for (const std::string& split : splits)
    for (size_t begin = 0; begin <= split.size();) {
      const size_t end = std::min(split.find('+', begin), split.size());
      const std::string part = split.substr(begin, end - begin);
      if (std::find(names.begin(), names.end(), part) == names.end()) {
        const std::string suggestion = nearest(part, names);
        return "--splits: unknown split '" + part + "'" +
               (suggestion.empty() ? "" : "; did you mean '" + suggestion + "'?");
      }
      begin = end + 1;
    }
  return "";
}

// The splits that the scene can do; a warning for each that it cannot, unless the request was for all.
std::vector<std::string> possible_splits(const SceneSource& source, std::vector<std::string> wanted, int samples,
                                         const Options& options) {
  const bool all = wanted.size() == 1 && wanted[0] == "all";
  if (wanted.empty()) wanted = {source.set.default_split};
  if (all) {
    wanted.clear();
    for (const char* const* name = sim::split_names(); *name != nullptr; ++name) wanted.emplace_back(*name);
  }
  std::vector<std::string> possible;
  for (std::string& name : wanted) {
    std::replace(name.begin(), name.end(), '+', ',');
    const auto split = sim::make_split(name, source.set, {samples});
    if (!split.ok()) {
      if (!all && !options.quiet) warn(source.name, split.failure().text);
    } else if (std::find(possible.begin(), possible.end(), split->name) == possible.end()) {
      possible.push_back(split->name);
    }
  }
  return possible;
}

// Fills the plan's scenes, which look into `sources`.
int load_scenes(Request& request, std::vector<SceneSource>& sources, const Options& options) {
  const std::vector<std::string> wanted =
      request.splits.empty() ? std::vector<std::string>{} : words_of(request.splits);
  const bool coarse = request.splits == "all" || request.splits.find("tessellation") != std::string::npos;
  sources.reserve(request.operands.size());  // the plan points into it
  for (const std::string& name : request.operands) {
    auto loaded = load_scene(name, options);
    if (!loaded) return kBadData;
    sources.push_back(std::move(*loaded));
    SceneSource& source = sources.back();
    if (coarse && source.builtin == nullptr) sim::add_coarse_model(source.set);
    sim::SweepScene scene;
    scene.name = name;
    scene.splits = possible_splits(source, wanted, request.plan.samples, options);
    if (scene.splits.empty()) return data_error(name, "this scene can do none of the splits");
    scene.set = &source.set;
    scene.path = [&source](int frame, float aspect) { return source.camera(frame, aspect); };
    request.plan.scenes.push_back(std::move(scene));
  }
  return kDone;
}

// ---- what is printed

void json_metrics(sim::JsonWriter& json, const char* name, const sim::MetricIntervals& gains) {
  json.begin_object(name);
  for (size_t kind = 0; kind < sim::kScoreCount; ++kind) {
    json.key(sim::kScores[kind].key);
    if (!gains[kind]) {
      json.null();
      continue;
    }
    json.begin_object();
    json.fixed_field("percent", gains[kind]->percent, 1);
    json.fixed_field("low_95", gains[kind]->low, 1);
    json.fixed_field("high_95", gains[kind]->high, 1);
    json.field("scenes", gains[kind]->n_scenes);
    json.end_object();
  }
  json.end_object();
}

int print_as_json(const sim::SweepTable& table, const sim::SweepGains& gains) {
  sim::JsonWriter json;
  json.begin_object();
  json.field("plan", table.plan);
  json.field("jobs", table.n_jobs);
  json.field("points", uint64_t{table.points.size()});
  json.begin_array("gains");
  for (const sim::SplitGain& gain : gains.splits) {
    json.begin_object();
    json.field("split", gain.split);
    json.field("codec", sim::sweep_codec_name(gain.comparison.codec));
    json.field("test", sim::sweep_arm_name(gain.comparison.test));
    json.field("reference", sim::sweep_arm_name(gain.comparison.reference));
    json_metrics(json, "mean", gain.mean);
    json_metrics(json, "worst_5_percent", gain.worst);
    json.field("scenes_better", gain.n_better);
    json.field("scenes_worse", gain.n_worse);
    json.field("scenes_metrics_disagree", gain.n_disagree);
    json.end_object();
  }
  json.end_array();
  json.end_object();
  return print_json(json);
}

std::string interval_text(const std::optional<sim::GainInterval>& gain) {
  if (!gain) return "-";
  char text[96];
  if (gain->n_scenes < 2)
    std::snprintf(text, sizeof text, "%+.1f", gain->percent);
  else
    std::snprintf(text, sizeof text, "%+.1f [%+.1f, %+.1f]", gain->percent, gain->low, gain->high);
  return text;
}

void print_text(const sim::SweepGains& gains) {
  std::printf("%% of bytes at equal score; [95 %% over the scenes]\n");
  for (const sim::SplitGain& gain : gains.splits) {
    std::printf("\n%s, %s: %s\n", gain.split.c_str(), sim::sweep_codec_name(gain.comparison.codec),
                sim::comparison_text(gain.comparison).c_str());
    for (size_t kind = 0; kind < sim::kScoreCount; ++kind)
      std::printf("  %-18s %-28s worst 5 %%: %s\n", sim::kScores[kind].label, interval_text(gain.mean[kind]).c_str(),
                  interval_text(gain.worst[kind]).c_str());
    std::printf("  at equal bytes: better in %d, worse in %d, metrics disagree in %d\n", gain.n_better, gain.n_worse,
                gain.n_disagree);
  }
}

int finish(const std::string& folder, const sim::SweepTable& table, const std::string& times, const Options& options) {
  const sim::SweepGains gains = sim::sweep_gains(table);
  if (const int code = write_output(folder + "/times.csv", times); code != kDone) return code;
  if (const int code = write_sweep(folder, table, gains); code != kDone) return code;
  if (options.json) return print_as_json(table, gains);
  print_text(gains);
  if (!options.quiet) std::printf("\nLook at %s/index.html\n", folder.c_str());
  return kDone;
}

int measure(Request& request, const Options& options) {
  std::vector<SceneSource> sources;
  if (const int code = load_scenes(request, sources, options); code != kDone) return code;
  if (const int code = make_folder(request.out); code != kDone) return code;
  sim::SweepOptions sweep;
  sweep.shard = request.shard;
  sweep.threads = options.threads;
  sweep.isa = options.isa;
  std::string scene = request.operands[0];
  Result<sim::SweepRun> run = [&] {
    Progress progress(options.quiet);
    sweep.progress = [&](size_t done, size_t total, const sim::SweepJob& next) {
      scene = request.plan.scenes[next.scene].name;
      progress.show(static_cast<double>(done) / static_cast<double>(total), scene.c_str());
    };
    return sim::run_sweep(request.plan, sweep);
  }();
  if (!run.ok()) return data_error(scene, run.failure());
  const std::string times = sim::sweep_times_csv(run->times);
  if (request.shard_text.empty()) return finish(request.out, run->table, times, options);

  const std::string table_file = request.out + "/" + sweep_file("sweep", request.shard);
  if (const int code = write_output(request.out + "/" + sweep_file("times", request.shard), times); code != kDone)
    return code;
  if (const int code = write_output(table_file, sim::sweep_csv(run->table)); code != kDone) return code;
  if (options.json) return print_as_json(run->table, {});
  if (!options.quiet)
    std::printf("%zu of %llu jobs in %s; join the shards with: pac sweep --merge DIR... -o DIR\n",
                run->table.points.size(), static_cast<unsigned long long>(run->table.n_jobs), table_file.c_str());
  return kDone;
}

int merge(const Request& request, const Options& options) {
  for (const char* name : kPlanOptions)
    if (options.given(name)) return options.usage_error(std::string("--merge measures nothing: leave out ") + name);
  const auto parts = read_sweeps(request.operands);
  if (!parts) return kBadData;
  if (const int code = make_folder(request.out); code != kDone) return code;
  return finish(request.out, parts->table, parts->times_csv, options);
}

}  // namespace

int run_sweep(Args args) {
  Options options("sweep", "rate-distortion curves over scenes, splits, codecs and rates",
                  "pac sweep cubes letter --width 96 --height 96 --samples 4 --frames 3 --qualities 10,40,80 "
                  "--quantizers 4,12,31 -o sweep");
  Request request;
  declare(options, request);
  if (const auto code = options.parse(args)) return *code;
  if (request.merge) return merge(request, options);
  if (const std::string problem = parse_codecs(request.codecs, request.plan.codecs); !problem.empty())
    return options.usage_error(problem);
  if (!request.splits.empty() && request.splits != "all")
    if (const std::string problem = check_split_names(words_of(request.splits)); !problem.empty())
      return options.usage_error(problem);
  if (!request.shard_text.empty())
    if (const std::string problem = parse_shard(request.shard_text, request.shard); !problem.empty())
      return options.usage_error(problem);
  for (size_t i = 0; i < request.operands.size(); ++i)
    for (size_t j = 0; j < i; ++j)
      if (request.operands[i] == request.operands[j])
        return options.usage_error("'" + request.operands[i] + "' is there twice");
  return measure(request, options);
}

}  // namespace pac::cli
