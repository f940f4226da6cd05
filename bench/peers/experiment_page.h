// The experiment's page in Markdown, and its plots.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bench/peers/experiment_table.h"

namespace pac::bench {

constexpr size_t kPsnr = 3;  // of kScores

struct ExperimentGroup {
  std::string scene, split;

  bool operator==(const ExperimentGroup&) const = default;
};
std::vector<ExperimentGroup> groups_of(std::span<const ExperimentRow> rows);  // as they come
std::string group_text(const ExperimentGroup& group);                         // "room, texture"

// Files by name, as FOLDER/NAME.svg: SSIMULACRA 2 against bytes a frame, one a scene, split and kind; then what
// polygons save JPEG against its compression ratio, as the paper says it.
std::vector<std::pair<std::string, std::string>> experiment_plots(std::span<const ExperimentRow> rows);
std::string rate_plot_name(const ExperimentGroup& group, bool is_video);
constexpr const char* kPaperPlots[] = {"paper-ssimulacra2", "paper-psnr"};

struct PageFrame {
  std::string command;      // what made the rows
  std::string conclusions;  // written by hand, in Markdown
  std::string folder;       // of the plots, as the page says it
  size_t n_missing = 0;     // curves that are not there yet
};
std::string experiment_page(std::span<const ExperimentRow> rows, const PageFrame& frame);

}  // namespace pac::bench
