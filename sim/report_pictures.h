// The pictures of a figure: rows, the wipe, enlargements.
#pragma once

#include <string>

#include "sim/report.h"

namespace pac::sim {

// Rows of pictures with captions, the wipe after the first row, enlargements at the end.
std::string figure_pictures(const ReportFigure& figure);

// The figure's wipe without its controls; empty where it has none.
std::string head_wipe(const ReportFigure& figure);

}  // namespace pac::sim
