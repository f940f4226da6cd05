// What a sweep measured, as the rows of a CSV file: written, read again, joined from the parts that shards wrote.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "base/verdict.h"
#include "sim/video_scores.h"

namespace pac::sim {

enum class SweepCodec : uint8_t { jpeg, mjpeg, mpeg1 };

// Who codes what:
//   image     H itself, by the codec alone
//   polygons  the paper's D by JPEG
//   none, block, model  polygon-assisted MPEG-1 under that prediction (sim/assisted_video.h)
enum class SweepArm : uint8_t { image, polygons, none, block, model };

const char* sweep_codec_name(SweepCodec codec);  // "jpeg", "mjpeg", "mpeg1"
const char* sweep_arm_name(SweepArm arm);        // "image", "polygons", "none", "block", "model"
bool parse_sweep_codec(std::string_view name, SweepCodec& codec);

// One job done: one arm of one codec at one setting, over all frames.
struct SweepPoint {
  uint64_t job = 0;  // its number in the plan
  std::string scene, split;
  SweepCodec codec = SweepCodec::jpeg;
  SweepArm arm = SweepArm::image;
  double setting = 0;  // jpeg, mjpeg: quality in H's domain (sim/match.h: equivalent quality); mpeg1: quantizer_scale
  int width = 0, height = 0, frames = 0, frames_per_second = 0;
  uint64_t bytes = 0;                 // of the code of all frames
  uint64_t resident_model_bytes = 0;  // that the client must have before; not in `bytes`; 0 for image-based arms
  std::array<FrameSummary, kScoreCount> scores{};  // against H, in the order of kScores

  bool operator==(const SweepPoint&) const = default;
};

struct SweepTable {
  std::string plan;                // the command line's operands and options that say what is measured
  uint64_t n_jobs = 0;             // of the whole plan
  std::vector<SweepPoint> points;  // ascending jobs, each at most once
};

// A header and a line a point. Numbers are the shortest decimals that read back to the same bits: no rounding, the same
// text on every machine. No times: those differ from run to run.
std::string sweep_csv(const SweepTable& table);

// Reads what sweep_csv wrote. Fails with truncated or corrupt, at the byte.
Result<SweepTable> read_sweep_csv(std::string_view text);

// Adds the points of another part of the same sweep. Fails with bad_argument, leaving `table` as it was, where the
// parts come from different plans or have a job in common. A table without points, whatever its plan, takes the
// other's.
Result<void> join_sweep(SweepTable& table, const SweepTable& part);

// Jobs of the plan that are not in the table, ascending.
std::vector<uint64_t> missing_jobs(const SweepTable& table);

}  // namespace pac::sim
