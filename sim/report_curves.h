// Plots of a run of the paper's experiments.
#pragma once

#include <optional>
#include <vector>

#include "sim/paper_figures.h"
#include "sim/report_plot.h"

namespace pac::sim {

// SSIM and PSNR against bytes for each figure that has curves, then the gain of polygon assistance at equal bytes
// against the compression ratio, all figures together.
std::vector<Plot> demo_plots(const PaperResults& results);

// Mean SSIM gained by polygon assistance at the bytes of those points of the image-based curve whose compression ratio
// lies in [low, high); empty where there is none that both curves reach.
std::optional<double> mean_ssim_gain(const FigureSet& set, double low_ratio, double high_ratio);

}  // namespace pac::sim
