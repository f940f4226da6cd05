#include "base/verdict.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "base/result.h"

namespace pac {
namespace {

FrameSummary summarize(std::span<const QualityScores> frames, double QualityScores::*member, Better better) {
  std::vector<double> values;
  for (const QualityScores& frame : frames) values.push_back(frame.*member);
  return summarize_frames(values, better);
}

QualitySummary summary_of(const QualityArm& arm) {
  return {arm.size_bytes, summarize(arm.frames, &QualityScores::ssimulacra2, Better::larger),
          summarize(arm.frames, &QualityScores::flip, Better::smaller),
          summarize(arm.frames, &QualityScores::psnr_hvs_m_db, Better::larger)};
}

// +1: the first is better, both on the mean and on the worst; -1: the second; 0: neither. `least` is what counts.
int vote(const FrameSummary& a, const FrameSummary& b, Better better, double least) {
  const double sign = better == Better::larger ? 1 : -1;
  const double mean = sign * (a.mean - b.mean), worst = sign * (a.worst_5_percent - b.worst_5_percent);
  if (mean > least && worst > least) return 1;
  if (mean < -least && worst < -least) return -1;
  return 0;
}

}  // namespace

FrameSummary summarize_frames(std::span<const double> values, Better better, double cap) {
  if (values.empty()) return {};
  std::vector<double> sorted;
  for (const double value : values) sorted.push_back(std::min(value, cap));
  FrameSummary summary;
  for (const double value : sorted) summary.mean += value / static_cast<double>(sorted.size());
  std::sort(sorted.begin(), sorted.end());
  if (better == Better::smaller) std::reverse(sorted.begin(), sorted.end());
  summary.worst_5_percent = sorted[(sorted.size() - 1) / 20];
  return summary;
}

const char* verdict_text(Verdict verdict) {
  constexpr const char* kTexts[] = {"the first is better", "the second is better", "metrics disagree", "bytes differ"};
  return kTexts[static_cast<size_t>(verdict)];
}

Verdict compare_quality(const QualityArm& first, const QualityArm& second) {
  PAC_ASSERT(!first.frames.empty() && !second.frames.empty());
  return compare_summaries(summary_of(first), summary_of(second));
}

Verdict compare_summaries(const QualitySummary& first, const QualitySummary& second) {
  const int ssimulacra2 = vote(first.ssimulacra2, second.ssimulacra2, Better::larger, kVerdictSsimulacra2Points);
  const int flip = vote(first.flip, second.flip, Better::smaller, 0);
  const int psnr_hvs_m = vote(first.psnr_hvs_m_db, second.psnr_hvs_m_db, Better::larger, 0);
  if (ssimulacra2 == 0 || flip != ssimulacra2 || psnr_hvs_m != ssimulacra2) return Verdict::disagree;
  const QualitySummary& winner = ssimulacra2 > 0 ? first : second;
  const QualitySummary& loser = ssimulacra2 > 0 ? second : first;
  if (static_cast<double>(winner.size_bytes) > 1.01 * static_cast<double>(loser.size_bytes))
    return Verdict::bytes_differ;
  return ssimulacra2 > 0 ? Verdict::first_better : Verdict::second_better;
}

}  // namespace pac
