// Every figure of [Levoy95] and the numbers its text draws from them, on the built-in scenes: the data of `pac demo`.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/result.h"
#include "sim/experiment.h"
#include "sim/rate_curve.h"
#include "sim/table1.h"

namespace pac::sim {

// One pair of pictures at matched bytes.
struct MatchedPair {
  std::string image_label, assisted_label;  // the paper's, "2d" and "2h"; empty where it has none
  Arm image_based, polygon_assisted;
};

// A scene under one split: its three pictures, one or more matched pairs, and what the curves say.
struct FigureSet {
  std::string key;    // "figure2", "figure3", "figure4", "figure5", "antialiasing", "lighting", "cubes"
  std::string title;  // one line
  std::string scene;
  std::string finding;  // one sentence, composed from the numbers: who wins what; says so where it is against the paper
  Renderings renderings;
  std::vector<MatchedPair> pairs;
  RateCurve image_curve, assisted_curve;                  // optimal Huffman codes on both arms; empty where not plotted
  Crossing rms_crossing, ssim_crossing;                   // of the curves
  std::optional<double> equal_rms_gain, equal_ssim_gain;  // at q15 of the image-based arm
  Timings timings;
};

struct PaperOptions {
  int threads = 0;  // 0 = all
  Isa isa = best_isa();
  uint32_t seed = 1;     // of the scenes
  int size_divisor = 1;  // pictures this many times smaller on each side: for tests
  // Called before each step with what it is, how many are done and how many there will be. May be empty.
  std::function<void(const char* step, int done, int total)> progress;
};

struct PaperResults {
  Table1 table1;
  Still room, pin;                          // the matched pairs of Table I, model resident (2l, 2m; 3d, 3e)
  Still room_transmitted, pin_transmitted;  // run_transmitted: row F
  std::vector<FigureSet> figures;
};

// About a minute of work at full size on two cores. Fails as run_still; bad_argument where a built-in scene is missing.
Result<PaperResults> run_paper(const PaperOptions& options);

}  // namespace pac::sim
