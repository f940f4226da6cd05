// The page of `pac sweep`: bytes at equal score over the scenes, then every scene's curves.
#pragma once

#include <string>
#include <vector>

#include "sim/report_plot.h"
#include "sim/sweep_gain.h"
#include "sim/sweep_table.h"

namespace pac::sim {

// One plot a scene, split, codec and metric of the verdict, in the order of the table. Plot::id is unique and made of
// [a-z0-9-]: also the name of its file.
struct SweepPlots {
  std::string scene, split;
  std::vector<Plot> plots;
};
std::vector<SweepPlots> sweep_plots(const SweepTable& table);

// A plot as a file of its own: colors inside. Its styles may also say "wide", "dashed", "dotted" and "bare" (no
// points).
std::string plot_svg_file(const Plot& plot);

// index.html, whole: styles, script and plots are inside.
std::string sweep_html(const SweepTable& table, const SweepGains& gains, const std::vector<SweepPlots>& plots);

}  // namespace pac::sim
