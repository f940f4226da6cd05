#include "sim/video_scores.h"

#include <algorithm>
#include <cmath>

#include "base/metrics.h"
#include "base/parallel.h"

namespace pac::sim {

const std::array<ScoreKind, kScoreCount> kScores = {{
    {"psnr_rgb_db", "PSNR, RGB (dB)", true, 2, psnr_rgb},
    {"psnr_luma_db", "PSNR, luma (dB)", true, 2, psnr_luma},
    {"ssim", "SSIM, luma", true, 4, ssim_luma},
    {"ms_ssim", "MS-SSIM, luma", true, 4, ms_ssim_luma},
}};

std::vector<FrameScores> score_frames(std::span<const ScoredPair> pairs, int threads) {
  std::vector<FrameScores> scores(pairs.size());
  parallel_for(threads, static_cast<int64_t>(pairs.size() * kScoreCount), [&](int64_t job) {
    const size_t pair = static_cast<size_t>(job) / kScoreCount, kind = static_cast<size_t>(job) % kScoreCount;
    scores[pair][kind] = kScores[kind].measure(pairs[pair].reference, pairs[pair].test);
  });
  return scores;
}

ScoreSummary summarize(std::span<const FrameScores> frames, size_t kind) {
  PAC_ASSERT(!frames.empty() && kind < kScoreCount);
  constexpr double kEqual = 100;
  std::vector<double> values;
  for (const FrameScores& frame : frames) values.push_back(std::isfinite(frame[kind]) ? frame[kind] : kEqual);
  std::sort(values.begin(), values.end());
  if (!kScores[kind].larger_is_better) std::reverse(values.begin(), values.end());
  ScoreSummary summary;
  for (const double value : values) summary.mean += value;
  summary.mean /= static_cast<double>(values.size());
  const size_t n_worst = std::max<size_t>(1, values.size() / 20);
  for (size_t i = 0; i < n_worst; ++i) summary.worst += values[i];
  summary.worst /= static_cast<double>(n_worst);
  return summary;
}

}  // namespace pac::sim
