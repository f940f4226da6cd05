#include "sim/video_scores.h"

#include "base/flip.h"
#include "base/metrics.h"
#include "base/parallel.h"
#include "base/psnr_hvs.h"
#include "base/ssimulacra2.h"

namespace pac::sim {

namespace {

double ssimulacra2_score(ConstRgbView reference, ConstRgbView test) {
  return ssimulacra2(reference, test);
}
double flip_score(ConstRgbView reference, ConstRgbView test) {
  return flip(reference, test);
}
double psnr_hvs_m(ConstRgbView reference, ConstRgbView test) {
  return psnr_hvs_luma(reference, test).psnr_hvs_m_db;
}

}  // namespace

const std::array<ScoreKind, kScoreCount> kScores = {{
    {"ssimulacra2", "SSIMULACRA 2", true, 2, ssimulacra2_score},
    {"flip", "FLIP", false, 4, flip_score},
    {"psnr_hvs_m_db", "PSNR-HVS-M (dB)", true, 2, psnr_hvs_m},
    {"psnr_rgb_db", "PSNR, RGB (dB)", true, 2, psnr_rgb},
    {"ssim", "SSIM, luma", true, 4, ssim_luma},
}};

QualityScores quality_scores(const FrameScores& scores) {
  return {scores[0], scores[1], scores[2]};
}

std::vector<FrameScores> score_frames(std::span<const ScoredPair> pairs, int threads) {
  std::vector<FrameScores> scores(pairs.size());
  parallel_for(threads, static_cast<int64_t>(pairs.size() * kScoreCount), [&](int64_t job) {
    const size_t pair = static_cast<size_t>(job) / kScoreCount, kind = static_cast<size_t>(job) % kScoreCount;
    scores[pair][kind] = kScores[kind].measure(pairs[pair].reference, pairs[pair].test);
  });
  return scores;
}

FrameSummary summarize(std::span<const FrameScores> frames, size_t kind) {
  PAC_ASSERT(kind < kScoreCount);
  std::vector<double> values;
  for (const FrameScores& frame : frames) values.push_back(frame[kind]);
  return summarize_frames(values, kScores[kind].larger_is_better ? Better::larger : Better::smaller);
}

}  // namespace pac::sim
