// The experiment: scenes, splits, every codec of ours and of others, at four rates each; a page with curves.
//   experiment [--quick] [--size N] [--frames N] [--shard I/N] [--scenes A,B] [--page] -o DIR
// Measures every curve that no DIR/rows*.csv has yet, a line a point as it goes: cut it short, start it again, or run
// N shards at once into one DIR. Then (with --page: only that) writes DIR.md and DIR/*.svg from all rows; what
// DIR/conclusions.md says goes to the top of the page. --size: of the longer side. --quick: three scenes, 192 pixels, 6
// frames, three rates.
#include <dirent.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "base/file_io.h"
#include "bench/peers/experiment_codecs.h"
#include "bench/peers/experiment_page.h"
#include "bench/peers/experiment_table.h"
#include "bench/peers/peer_codecs.h"
#include "bench/peers/scene_shots.h"

namespace {

using namespace pac;
using bench::ExperimentArm;
using bench::ExperimentRow;
using bench::need;

struct Request {
  bool quick = false, page_only = false;
  int size = 384, frames = 24;
  unsigned long shard = 1, shards = 1;
  std::string out, scenes;
  std::string options;  // what a reader must say to get the same
};

struct SceneAndSplit {
  std::string scene, split;
};

// NAME.obj: a model of debian_models.sh. `fence` in split shading is there to lose: L has one sample a pixel, and bars
// thinner than it.
std::vector<SceneAndSplit> plan(const Request& request) {
  std::vector<SceneAndSplit> all = {
      {"room", "texture"},      {"room", "lighting"},          {"room+moving", "texture"}, {"cubes", "texture"},
      {"cubes", "lighting"},    {"cubes+moving", "texture"},   {"cubes", "antialiasing"},  {"pin", "tessellation"},
      {"letter", "shading"},    {"letter-texture", "texture"}, {"spider.obj", "texture"},  {"duck.obj", "texture"},
      {"truck.obj", "texture"}, {"jeep.obj", "texture"},       {"fence", "texture"},       {"fence", "shading"},
  };
  if (request.quick) all = {{"cubes", "texture"}, {"room", "lighting"}, {"fence", "shading"}};
  if (request.scenes.empty()) return all;
  std::erase_if(all, [&](const SceneAndSplit& one) {
    return (',' + request.scenes + ',').find(',' + one.scene + ',') == std::string::npos;
  });
  return all;
}

// A moved object changes nothing in a still.
bool is_wanted(const SceneAndSplit& group, const ExperimentArm& arm) {
  return arm.is_video || group.scene.find('+') == std::string::npos;
}

// A folder of its own, gone with the object.
class DebianModels {
 public:
  DebianModels() {
    char folder[] = "/tmp/pac_models_XXXXXX";
    if (mkdtemp(folder) == nullptr) return;
    folder_ = folder;
    if (std::system(
            ("sh \"" + bench::peers_folder() + "/debian_models.sh\" " + folder_ + " >/dev/null 2>&1").c_str()) != 0)
      std::printf("Debian's models are not there (assimp-testmodels, assimp-utils, ffmpeg)\n");
  }
  ~DebianModels() {
    if (!folder_.empty() && std::system(("rm -r " + folder_).c_str()) != 0)
      std::fprintf(stderr, "%s: is left over\n", folder_.c_str());
  }
  DebianModels(const DebianModels&) = delete;
  DebianModels& operator=(const DebianModels&) = delete;

  std::string path_of(const std::string& scene) const {
    return scene.ends_with(".obj") ? folder_ + '/' + scene : scene;
  }
  bool has(const std::string& scene) const {
    return !scene.ends_with(".obj") || access(path_of(scene).c_str(), R_OK) == 0;
  }

 private:
  std::string folder_;
};

// ---- One curve

ExperimentRow row_of(const SceneAndSplit& group, const ExperimentArm& arm, double setting,
                     const bench::Sequence& sequence, const bench::PeerCode& coded) {
  ExperimentRow row;
  row.scene = group.scene;
  row.split = group.split;
  row.arm = arm.key;
  row.setting = setting;
  row.width = sequence.width;
  row.height = sequence.height;
  row.frames = static_cast<int>(coded.shown.size());
  row.bytes = coded.bytes;
  if (row.arm.starts_with("polygons")) {
    row.resident_model_bytes = sequence.resident_model_bytes;
    row.draw_low_ms = sequence.draw_low_ms;
  }
  row.encode_ms = coded.encode_ms;
  row.decode_ms = coded.decode_ms;
  std::vector<sim::ScoredPair> pairs;
  for (size_t i = 0; i < coded.shown.size(); ++i)
    pairs.push_back({sequence.shots[i].images.high.view(), coded.shown[i].view()});
  const auto scores = sim::score_frames(pairs, 1);
  for (size_t kind = 0; kind < sim::kScoreCount; ++kind) row.scores[kind] = sim::summarize(scores, kind);
  return row;
}

// ---- All of them

std::vector<ExperimentRow> rows_in(const std::string& folder) {
  std::vector<std::string> names;
  if (DIR* entries = opendir(folder.c_str())) {
    while (const dirent* entry = readdir(entries)) {
      const std::string name = entry->d_name;
      if (name.starts_with("rows") && name.ends_with(".csv")) names.push_back(name);
    }
    closedir(entries);
  }
  std::sort(names.begin(), names.end());
  std::vector<ExperimentRow> rows;
  for (const std::string& name : names) {
    const Bytes bytes = need(read_file(folder + "/" + name), name.c_str());
    for (ExperimentRow& row : bench::read_rows({reinterpret_cast<const char*>(bytes.data()), bytes.size()}))
      rows.push_back(std::move(row));
  }
  return rows;
}

bool has_row(const std::vector<ExperimentRow>& rows, const SceneAndSplit& group, const char* arm, double setting) {
  return std::any_of(rows.begin(), rows.end(), [&](const ExperimentRow& row) {
    return row.scene == group.scene && row.split == group.split && row.arm == arm && row.setting == setting;
  });
}

std::vector<double> wanted_settings(const ExperimentArm& arm, bool quick) {
  std::vector<double> settings(arm.settings.begin(), arm.settings.end());
  std::erase(settings, 0.0);
  if (quick) settings = {settings.front(), settings[settings.size() / 2], settings.back()};
  return settings;
}

// The curves of one scene and split that are this shard's and not there.
void measure(const Request& request, const DebianModels& models, const SceneAndSplit& group, size_t& curve,
             std::FILE* file, const std::vector<ExperimentRow>& rows) {
  std::optional<bench::Sequence> sequence;
  std::optional<bench::ExperimentCodecs> codecs;
  for (const ExperimentArm& arm : bench::experiment_arms()) {
    if (!is_wanted(group, arm) || curve++ % request.shards != request.shard - 1) continue;
    for (const double setting : wanted_settings(arm, request.quick)) {
      if (has_row(rows, group, arm.key, setting)) continue;
      if (!sequence) {
        bench::NamedScene scene = bench::load_scene(models.path_of(group.scene));
        sequence = bench::draw(scene, group.split, request.frames, request.size, request.quick ? 4 : 16);
        codecs.emplace(*sequence);
      }
      const auto coded = codecs->code(arm, setting);
      if (!coded) {
        std::printf("%s, %s: %s is not there\n", group.scene.c_str(), group.split.c_str(), arm.label);
        break;
      }
      const ExperimentRow row = row_of(group, arm, setting, *sequence, *coded);
      std::fputs(bench::row_line(row).c_str(), file);
      std::fflush(file);
      std::printf("%s, %s, %s, %g: %llu bytes, %.1f\n", group.scene.c_str(), group.split.c_str(), arm.label, setting,
                  static_cast<unsigned long long>(row.bytes), row.scores[0].mean);
      std::fflush(stdout);
    }
  }
}

void write(const std::string& path, const std::string& text) {
  const auto written = write_file(path, {reinterpret_cast<const uint8_t*>(text.data()), text.size()});
  if (written.ok()) return;
  std::fprintf(stderr, "%s: %s\n", path.c_str(), written.failure().text);
  std::exit(1);
}

void write_page(const Request& request) {
  const std::vector<ExperimentRow> rows = rows_in(request.out);
  bench::PageFrame frame;
  for (const SceneAndSplit& group : plan(request))
    for (const ExperimentArm& arm : bench::experiment_arms()) {
      if (!is_wanted(group, arm)) continue;
      const auto settings = wanted_settings(arm, request.quick);
      if (!std::ranges::all_of(settings, [&](double setting) { return has_row(rows, group, arm.key, setting); }))
        ++frame.n_missing;
    }
  for (const auto& [name, svg] : bench::experiment_plots(rows)) write(request.out + "/" + name + ".svg", svg);
  frame.folder = request.out.substr(request.out.rfind('/') + 1);
  frame.command = "build/release/bench/peers/experiment " + request.options + "-o " + request.out;
  if (const auto conclusions = read_file(request.out + "/conclusions.md"); conclusions.ok())
    frame.conclusions.assign(conclusions->begin(), conclusions->end());
  write(request.out + ".md", bench::experiment_page(rows, frame));
  std::printf("%zu rows, %zu curves missing: %s.md\n", rows.size(), frame.n_missing, request.out.c_str());
}

int positive(const char* text) {
  const int number = std::atoi(text);
  return number > 0 && number <= 4096 ? number : 0;
}

bool parse(int argc, char** argv, Request& request) {
  for (int i = 1; i < argc; ++i) {
    const bool has_value = i + 1 < argc;
    if (std::strcmp(argv[i], "--quick") == 0) {
      request.quick = true;
      request.size = 192;
      request.frames = 6;
      request.options += "--quick ";
    } else if (std::strcmp(argv[i], "--size") == 0 && has_value) {
      request.options += std::string("--size ") + argv[i + 1] + ' ';
      if ((request.size = positive(argv[++i])) == 0) return false;
    } else if (std::strcmp(argv[i], "--frames") == 0 && has_value) {
      request.options += std::string("--frames ") + argv[i + 1] + ' ';
      if ((request.frames = positive(argv[++i])) == 0) return false;
    } else if (std::strcmp(argv[i], "--page") == 0) {
      request.page_only = true;
    } else if (std::strcmp(argv[i], "--scenes") == 0 && has_value) {
      request.scenes = argv[++i];
    } else if (std::strcmp(argv[i], "-o") == 0 && has_value) {
      request.out = argv[++i];
    } else if (std::strcmp(argv[i], "--shard") == 0 && has_value) {
      if (std::sscanf(argv[++i], "%lu/%lu", &request.shard, &request.shards) != 2) return false;
    } else {
      return false;
    }
  }
  return !request.out.empty() && request.shard >= 1 && request.shard <= request.shards;
}

}  // namespace

int main(int argc, char** argv) {
  Request request;
  if (!parse(argc, argv, request)) {
    std::fprintf(stderr,
                 "usage: experiment [--quick] [--size N] [--frames N] [--shard I/N] [--scenes A,B] [--page] -o DIR\n");
    return 2;
  }
  mkdir(request.out.c_str(), 0777);
  if (!request.page_only) {
    const std::vector<ExperimentRow> rows = rows_in(request.out);
    const std::string name =
        request.out + "/rows-" + std::to_string(request.shard) + "-of-" + std::to_string(request.shards) + ".csv";
    std::FILE* file = std::fopen(name.c_str(), "a+b");
    if (file == nullptr) {
      std::fprintf(stderr, "%s: cannot be written\n", name.c_str());
      return 1;
    }
    // After a line that was cut short, too: it becomes a line that read_rows() leaves out.
    if (std::fseek(file, 0, SEEK_END) == 0)
      std::fputs(std::ftell(file) == 0 ? bench::row_header().c_str() : "\n", file);
    size_t curve = 0;
    const DebianModels models;
    for (const SceneAndSplit& group : plan(request))
      if (models.has(group.scene)) measure(request, models, group, curve, file, rows);
    std::fclose(file);
  }
  write_page(request);
  return 0;
}
