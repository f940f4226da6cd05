// The experiment's page in Markdown, and its plots.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bench/peers/experiment_table.h"

namespace pac::bench {

// Files by name, as `folder`/NAME.svg: one a scene, split and kind, SSIMULACRA 2 against bytes a frame.
std::vector<std::pair<std::string, std::string>> experiment_plots(std::span<const ExperimentRow> rows);

// A line a scene, arm, metric; then over the scenes.
std::string experiment_gains_csv(std::span<const ExperimentRow> rows);

// `command`: what made the rows. `missing`: curves that are not there yet. `folder`: where the plots are, as the page
// says it.
std::string experiment_page(std::span<const ExperimentRow> rows, const std::string& command, size_t missing,
                            const std::string& folder);

}  // namespace pac::bench
