// The paper's claims in words, checked against the numbers of a run; and the numbers of the page's head.
#pragma once

#include <vector>

#include "sim/paper_figures.h"
#include "sim/report.h"

namespace pac::sim {

// Claim by claim, in the paper's order. A claim that this run contradicts is Verdict::against, and says so.
std::vector<ReportFinding> paper_claims(const PaperResults& results);

// One sentence a figure: which arm wins what at matched bytes.
ReportFinding figure_finding(const FigureSet& set);

std::vector<ReportHighlight> demo_highlights(const PaperResults& results);
std::vector<ReportHighlight> still_highlights(const Still& still);

}  // namespace pac::sim
