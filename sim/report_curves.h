// Plots of a run of the paper's experiments.
#pragma once

#include <vector>

#include "sim/paper_figures.h"
#include "sim/report_plot.h"

namespace pac::sim {

// SSIM and PSNR against bytes for each figure that has curves, then the gain of polygon assistance at equal bytes
// against the compression ratio, all figures together.
std::vector<Plot> demo_plots(const PaperResults& results);

}  // namespace pac::sim
