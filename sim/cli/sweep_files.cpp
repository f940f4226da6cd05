#include "sim/cli/sweep_files.h"

#include <dirent.h>

#include <algorithm>
#include <charconv>
#include <string_view>
#include <utility>

#include "sim/cli/command.h"
#include "sim/report_sweep.h"

namespace pac::cli {
namespace {

// Files of the folder whose names are STEM-*.csv, sorted.
std::vector<std::string> parts_in(const std::string& folder, const std::string& stem) {
  std::vector<std::string> names;
  DIR* entries = opendir(folder.c_str());
  if (entries == nullptr) return names;
  while (const dirent* entry = readdir(entries)) {
    const std::string_view name(entry->d_name);
    if (name.starts_with(stem + "-") && name.ends_with(".csv")) names.emplace_back(name);
  }
  closedir(entries);
  std::sort(names.begin(), names.end());
  return names;
}

bool join_file(const std::string& path, sim::SweepTable& table) {
  const auto bytes = read_file(path);
  if (!bytes.ok()) {
    data_error(path, bytes.failure());
    return false;
  }
  const auto part = sim::read_sweep_csv({reinterpret_cast<const char*>(bytes->data()), bytes->size()});
  if (!part.ok()) {
    data_error(path, part.failure());
    return false;
  }
  if (const auto joined = sim::join_sweep(table, *part); !joined.ok()) {
    data_error(path, joined.failure());
    return false;
  }
  return true;
}

// "3, 7, 11 and 40 more".
std::string some_of(const std::vector<uint64_t>& jobs) {
  constexpr size_t kMost = 8;
  std::string text;
  for (size_t i = 0; i < jobs.size() && i < kMost; ++i) text += (i > 0 ? ", " : "") + std::to_string(jobs[i]);
  if (jobs.size() > kMost) text += " and " + std::to_string(jobs.size() - kMost) + " more";
  return text;
}

// Lines of times by job, without the header; other lines are left out.
void add_times(const std::string& path, std::vector<std::pair<uint64_t, std::string>>& lines) {
  const auto bytes = read_file(path);
  if (!bytes.ok()) return;
  const std::string text(bytes->begin(), bytes->end());
  for (size_t begin = 0; begin < text.size();) {
    const size_t end = std::min(text.find('\n', begin), text.size());
    uint64_t job = 0;
    const auto parsed = std::from_chars(text.data() + begin, text.data() + end, job);
    if (parsed.ec == std::errc() && *parsed.ptr == ',') lines.emplace_back(job, text.substr(begin, end - begin));
    begin = end + 1;
  }
}

}  // namespace

std::string sweep_file(const char* stem, const sim::SweepShard& shard) {
  if (shard.count == 1) return std::string(stem) + ".csv";
  return std::string(stem) + "-" + std::to_string(shard.number) + "-of-" + std::to_string(shard.count) + ".csv";
}

int write_sweep(const std::string& folder, const sim::SweepTable& table, const sim::SweepGains& gains) {
  const auto scenes = sim::sweep_plots(table);
  const std::string start = folder + "/";
  if (const int code = write_output(start + "sweep.csv", sim::sweep_csv(table)); code != kDone) return code;
  if (const int code = write_output(start + "gains.csv", sim::sweep_gains_csv(gains)); code != kDone) return code;
  for (const sim::SweepPlots& scene : scenes)
    for (const sim::Plot& plot : scene.plots)
      if (const int code = write_output(start + plot.id + ".svg", sim::plot_svg_file(plot)); code != kDone) return code;
  return write_output(start + "index.html", sim::sweep_html(table, gains, scenes));
}

std::optional<SweepParts> read_sweeps(const std::vector<std::string>& folders) {
  SweepParts parts;
  std::vector<std::pair<uint64_t, std::string>> times;
  for (const std::string& folder : folders) {
    std::vector<std::string> names = parts_in(folder, "sweep");
    std::vector<std::string> time_names = parts_in(folder, "times");
    if (names.empty()) {
      names = {"sweep.csv"};
      time_names = {"times.csv"};
    }
    for (const std::string& name : names)
      if (!join_file(folder + "/" + name, parts.table)) return std::nullopt;
    for (const std::string& name : time_names) add_times(folder + "/" + name, times);
  }
  const std::string all = folders.size() == 1 ? folders[0] : folders[0] + " ... " + folders.back();
  if (parts.table.points.empty()) {
    data_error(all, "there are no measurements");
    return std::nullopt;
  }
  if (const auto missing = sim::missing_jobs(parts.table); !missing.empty()) {
    data_error(all, "jobs are missing: " + some_of(missing) + " of " + std::to_string(parts.table.n_jobs) +
                        " (counted from 0; shard I of N does those with remainder I-1)");
    return std::nullopt;
  }
  std::stable_sort(times.begin(), times.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  parts.times_csv = sim::sweep_times_csv({});
  for (const auto& [job, line] : times) parts.times_csv += line + '\n';
  return parts;
}

}  // namespace pac::cli
