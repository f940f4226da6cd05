// The demo's second page: the paper's animations as films, curves and files to play.
#pragma once

#include <string>
#include <vector>

#include "sim/paper_animations.h"
#include "sim/report_demo.h"

namespace pac::sim {

// The folder beside the page where the streams of one polygon-assisted arm and its image-based partner lie:
// "animations/room-mpeg1".
std::string streams_folder(const AnimationSet& set, const AnimationStreams& streams);

// animations.html. Keep `sets` alive as long as the views are read.
IllustratedReport animations_report(const std::vector<AnimationSet>& sets);

}  // namespace pac::sim
