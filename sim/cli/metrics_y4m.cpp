// `pac metrics` for sequences: every frame, then the mean and the worst.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "base/metrics.h"
#include "base/y4m.h"
#include "sim/cli/metrics.h"

namespace pac::cli {
namespace {

struct FrameScores {
  double rms_luma = 0, psnr_luma_db = 0, ssim = 0;
};

FrameScores score(const Frame420& reference, const Frame420& test) {
  const double error = mean_squared_error(reference.y.view(), test.y.view());
  return {std::sqrt(error), psnr_from_mse(error), ssim(reference.y.view(), test.y.view())};
}

struct Summary {
  double mean = 0, worst = 0;  // worst: the value that 5 % of the frames reach or fall behind
};

// better_is_larger tells which end is the worst.
Summary summarize(const std::vector<FrameScores>& frames, double FrameScores::*member, bool better_is_larger) {
  std::vector<double> values;
  for (const FrameScores& frame : frames) values.push_back(frame.*member);
  Summary summary;
  for (const double value : values) summary.mean += value / static_cast<double>(values.size());
  std::sort(values.begin(), values.end());
  if (!better_is_larger) std::reverse(values.begin(), values.end());
  summary.worst = values[(values.size() - 1) / 20];
  return summary;
}

struct Row {
  const char* key;
  const char* label;
  Summary summary;
  int digits;
};

int print(const Options& options, const Y4mHeader& header, const std::vector<FrameScores>& frames) {
  const Row rows[] = {{"rms_luma", "rms, luma (levels)", summarize(frames, &FrameScores::rms_luma, false), 4},
                      {"psnr_luma_db", "PSNR, luma (dB)", summarize(frames, &FrameScores::psnr_luma_db, true), 3},
                      {"ssim", "SSIM, luma", summarize(frames, &FrameScores::ssim, true), 5}};
  if (!options.json) {
    std::printf("%zu frames%17s %10s\n", frames.size(), "mean", "worst 5 %");
    for (const Row& row : rows)
      std::printf("%-20s %*.*f %10.*f\n", row.label, 10, row.digits, row.summary.mean, row.digits, row.summary.worst);
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
    json.field("worst_5_percent", row.summary.worst);
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
  Frame420 a, b;
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
    frames.push_back(score(a, b));
    const double frame_bytes = 1.5 * a.width() * a.height() + 6;
    progress.show(static_cast<double>(frames.size()) * frame_bytes / static_cast<double>(reference.bytes.size()),
                  "frames");
  }
  if (frames.empty()) return data_error(reference.path, "holds no frame");
  return print(options, first->header(), frames);
}

}  // namespace pac::cli
