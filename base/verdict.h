// When one way of coding may be called better than another: only if SSIMULACRA2, FLIP and PSNR-HVS-M agree, at equal
// bytes, on the mean of the frames and on the worst of them. Each metric alone has been seen to err (SSIM hardly
// notices a lost shadow, FLIP forgives blur); whoever reports must print "metrics disagree" and show the pictures.
#pragma once

#include <cstdint>
#include <span>

namespace pac {

// Of one picture or frame.
struct QualityScores {
  double ssimulacra2 = 100;  // larger is better, at most 100
  double flip = 0;           // smaller is better, 0..1
  double psnr_hvs_m_db = 0;  // larger is better, +infinity where nothing is visible
};

// Mean, and the value that the worst 5 % of the frames reach or fall behind (the worst of 20 and fewer). Values above
// `cap` count as `cap`: a PSNR of +infinity must not make a mean infinite. No values: 0 and 0.
struct FrameSummary {
  double mean = 0, worst_5_percent = 0;

  bool operator==(const FrameSummary&) const = default;
};
enum class Better : uint8_t { larger, smaller };
FrameSummary summarize_frames(std::span<const double> values, Better better, double cap = 100);

// One of the two that are compared: the same pictures, coded in some way.
struct QualityArm {
  uint64_t size_bytes = 0;
  std::span<const QualityScores> frames;  // at least one
};

enum class Verdict : uint8_t {
  first_better,
  second_better,
  disagree,     // some metric, on the mean or on the worst 5 %, sees it otherwise, or SSIMULACRA2 sees too little
  bytes_differ  // the better one took over 1 % more bytes: no comparison
};
const char* verdict_text(Verdict verdict);  // "the first is better", ..., "metrics disagree", "bytes differ"

// A difference in SSIMULACRA2 of 2 points and less, on the mean or on the worst 5 %, is no difference.
constexpr double kVerdictSsimulacra2Points = 2;
Verdict compare_quality(const QualityArm& first, const QualityArm& second);

// The same from what the frames come to: where curves are interpolated there are no frames.
struct QualitySummary {
  uint64_t size_bytes = 0;
  FrameSummary ssimulacra2, flip, psnr_hvs_m_db;
};
Verdict compare_summaries(const QualitySummary& first, const QualitySummary& second);

}  // namespace pac
