// How far the shown frames of a sequence are from H: every metric by name, its mean and its worst 5 %.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "base/image.h"
#include "base/verdict.h"

namespace pac::sim {

struct ScoreKind {
  const char* key;    // of JSON and CSV
  const char* label;  // of tables and plots
  bool larger_is_better;
  int digits;  // worth printing
  double (*measure)(ConstRgbView reference, ConstRgbView test);
};

constexpr size_t kScoreCount = 5;
extern const std::array<ScoreKind, kScoreCount> kScores;

using FrameScores = std::array<double, kScoreCount>;  // in the order of kScores

struct ScoredPair {
  ConstRgbView reference, test;
};

// How the verdict of base/verdict.h sees them.
QualityScores quality_scores(const FrameScores& scores);

// All metrics of all pairs, on up to `threads` threads (0 = all); the result does not depend on it.
std::vector<FrameScores> score_frames(std::span<const ScoredPair> pairs, int threads);

// Of metric number `kind` (base/verdict.h). Infinite values (PSNR of equal pictures) count as 100.
FrameSummary summarize(std::span<const FrameScores> frames, size_t kind);

}  // namespace pac::sim
