// The page of `pac demo`: the results of the paper's experiments as a document.
#pragma once

#include <string>
#include <vector>

#include "base/image.h"
#include "sim/paper_figures.h"
#include "sim/report.h"

namespace pac::sim {

// A picture that the page shows: to be written as PNG beside it.
struct ReportImage {
  std::string file;    // as ReportPicture::file
  ConstRgbView image;  // inside the results that the page was made from
};

struct IllustratedReport {
  Report report;
  std::vector<ReportImage> images;
};

// The whole page: Table I, figures 2 to 5 and the splits beyond them, plots, claims, methods. Keep `results` alive as
// long as the views are read.
IllustratedReport demo_report(const PaperResults& results);

// The page of one `pac compare`: H, L, D and the matched pair of `title`, with a wipe and enlargements.
IllustratedReport compare_report(const std::string& title, const Still& still, const std::string& command_line);

}  // namespace pac::sim
