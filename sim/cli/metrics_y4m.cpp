// `pac metrics` for sequences: every frame, then the mean and the worst.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>
#include <vector>

#include "base/cambi.h"
#include "base/flip.h"
#include "base/metrics.h"
#include "base/parallel.h"
#include "base/psnr_hvs.h"
#include "base/ssimulacra2.h"
#include "base/verdict.h"
#include "base/y4m.h"
#include "sim/cli/metrics.h"
#include "sim/frame420.h"

namespace pac::cli {
namespace {

struct FrameScores {
  double rms_luma = 0, psnr_luma_db = 0, psnr_hvs_db = 0, psnr_hvs_m_db = 0;
  double ssim = 0, ms_ssim = 0, ssimulacra2 = 0, flip = 0;
  double cambi = 0;    // of the test
  double flicker = 0;  // of the change from the frame before
};

RgbImage rgb_of(const Frame420& frame, Isa isa) {
  RgbImage picture(frame.width(), frame.height());
  sim::rgb_from_frame420(frame, picture.view(), isa);
  return picture;
}

// previous: the frames before, empty for the first.
FrameScores score(const Frame420& reference, const Frame420& test, const Frame420& previous_reference,
                  const Frame420& previous_test, Isa isa, ThreadPool& pool) {
  const double error = mean_squared_error(reference.y.view(), test.y.view());
  const RgbImage a = rgb_of(reference, isa), b = rgb_of(test, isa);
  FrameScores scores;
  scores.rms_luma = std::sqrt(error);
  scores.psnr_luma_db = psnr_from_mse(error);
  const PsnrHvs hvs = psnr_hvs(reference.y.view(), test.y.view());
  scores.psnr_hvs_db = hvs.psnr_hvs_db;
  scores.psnr_hvs_m_db = hvs.psnr_hvs_m_db;
  scores.ssim = ssim(reference.y.view(), test.y.view());
  scores.ms_ssim = ms_ssim(reference.y.view(), test.y.view());
  scores.ssimulacra2 = ssimulacra2(a.view(), b.view(), &pool);
  scores.flip = flip(a.view(), b.view(), &pool);
  scores.cambi = cambi(test.y.view());
  if (!previous_test.y.empty())
    scores.flicker =
        flicker_rms(previous_reference.y.view(), reference.y.view(), previous_test.y.view(), test.y.view());
  return scores;
}

// skip: frames at the start that have no value.
FrameSummary summarize(const std::vector<FrameScores>& frames, double FrameScores::*member, Better better,
                       size_t skip = 0) {
  std::vector<double> values;
  for (size_t i = skip; i < frames.size(); ++i) values.push_back(frames[i].*member);
  return summarize_frames(values, better, std::numeric_limits<double>::infinity());
}

struct Row {
  const char* key;
  const char* label;
  FrameSummary summary;
  int digits;
};

int print(const Options& options, const Y4mHeader& header, const std::vector<FrameScores>& frames) {
  const Row rows[] = {
      {"rms_luma", "rms, luma (levels)", summarize(frames, &FrameScores::rms_luma, Better::smaller), 4},
      {"psnr_luma_db", "PSNR, luma (dB)", summarize(frames, &FrameScores::psnr_luma_db, Better::larger), 3},
      {"psnr_hvs_db", "PSNR-HVS (dB)", summarize(frames, &FrameScores::psnr_hvs_db, Better::larger), 3},
      {"psnr_hvs_m_db", "PSNR-HVS-M (dB)", summarize(frames, &FrameScores::psnr_hvs_m_db, Better::larger), 3},
      {"ssim", "SSIM, luma", summarize(frames, &FrameScores::ssim, Better::larger), 5},
      {"ms_ssim", "MS-SSIM, luma", summarize(frames, &FrameScores::ms_ssim, Better::larger), 5},
      {"ssimulacra2", "SSIMULACRA 2.1", summarize(frames, &FrameScores::ssimulacra2, Better::larger), 3},
      {"flip", "FLIP, mean", summarize(frames, &FrameScores::flip, Better::smaller), 5},
      {"cambi", "banding (CAMBI)", summarize(frames, &FrameScores::cambi, Better::smaller), 3},
      {"flicker", "flicker, luma (rms)", summarize(frames, &FrameScores::flicker, Better::smaller, 1), 4}};
  if (!options.json) {
    std::printf("%zu frames%17s %10s\n", frames.size(), "mean", "worst 5 %");
    for (const Row& row : rows)
      std::printf("%-20s %*.*f %10.*f\n", row.label, 10, row.digits, row.summary.mean, row.digits,
                  row.summary.worst_5_percent);
    return kDone;
  }
  sim::JsonWriter json;
  json.begin_object();
  json.field("width", header.width);
  json.field("height", header.height);
  json.field("frames", uint64_t{frames.size()});
  for (const Row& row : rows) {
    json.begin_object(row.key);
    json.field("mean", row.summary.mean);
    json.field("worst_5_percent", row.summary.worst_5_percent);
    json.end_object();
  }
  json.end_object();
  return print_json(json);
}

}  // namespace

bool is_y4m(std::span<const uint8_t> bytes) {
  constexpr char kMagic[] = "YUV4MPEG2";
  return bytes.size() >= 9 && std::equal(kMagic, kMagic + 9, bytes.begin());
}

int compare_sequences(const Options& options, const NamedBytes& reference, const NamedBytes& test) {
  auto first = Y4mReader::open(reference.bytes);
  if (!first.ok()) return data_error(reference.path, first.failure());
  auto second = Y4mReader::open(test.bytes);
  if (!second.ok()) return data_error(test.path, second.failure());
  if (first->header().width != second->header().width || first->header().height != second->header().height)
    return data_error(test.path, "has frames of another size than " + reference.path);
  std::vector<FrameScores> frames;
  Frame420 a, b, previous_a, previous_b;
  ThreadPool pool(options.threads);
  Progress progress(options.quiet);
  while (true) {
    const auto more_a = first->next(a);
    if (!more_a.ok()) return data_error(reference.path, more_a.failure());
    const auto more_b = second->next(b);
    if (!more_b.ok()) return data_error(test.path, more_b.failure());
    if (*more_a != *more_b)
      return data_error(test.path,
                        std::string("has ") + (*more_b ? "more" : "fewer") + " frames than " + reference.path);
    if (!*more_a) break;
    frames.push_back(score(a, b, previous_a, previous_b, options.isa, pool));
    const double frame_bytes = 1.5 * a.width() * a.height() + 6;
    std::swap(a, previous_a);
    std::swap(b, previous_b);
    progress.show(static_cast<double>(frames.size()) * frame_bytes / static_cast<double>(reference.bytes.size()),
                  "frames");
  }
  if (frames.empty()) return data_error(reference.path, "holds no frame");
  return print(options, first->header(), frames);
}

}  // namespace pac::cli
