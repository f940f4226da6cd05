// Rate-distortion sweeps: scenes x splits x codecs x arms x settings as a list of jobs that depends on nothing but the
// plan, so that any number of processes can share it; each job is one point of one curve.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "base/isa.h"
#include "base/result.h"
#include "mpeg1/mpeg1.h"
#include "sim/animation.h"
#include "sim/match.h"
#include "sim/scenes.h"
#include "sim/sweep_table.h"

namespace pac::sim {

struct SweepScene {
  std::string name;
  std::vector<std::string> splits;  // as Split::name; all of them possible in this scene
  const SceneSet* set = nullptr;    // must outlive the run; the list of jobs does not look at it
  CameraPath path;
};

// What is measured. Equal plans give equal tables, on every machine and number of threads.
struct SweepPlan {
  std::vector<SweepScene> scenes;
  std::vector<SweepCodec> codecs;
  std::vector<double> qualities = {5, 10, 20, 35, 55, 75};  // of jpeg and mjpeg, in H's domain, (0, 100]
  std::vector<double> quantizers = {2, 4, 8, 14, 21, 31};   // of mpeg1, 1..31
  int frames = 24;                                          // of the camera path, 1..100000; jpeg: the first only
  int frames_per_second = 20;                               // 1..60, for headers and axes
  int width = 0, height = 0;                                // 0 = the scene's own
  int samples = 16;                                         // a pixel, of an antialiased side: 1, 4, 16, 64
  TableFamily tables = TableFamily::annex_k;                // of JPEG, both arms; Huffman codes are optimal
  mpeg1::Effort effort = mpeg1::Effort::normal;             // of MPEG-1, all arms
};

// The operands and options of `pac sweep` that make this plan.
std::string plan_text(const SweepPlan& plan);

struct SweepJob {
  uint64_t number = 0;  // place in the list
  size_t scene = 0;     // into SweepPlan::scenes
  size_t split = 0;     // into its splits
  SweepCodec codec = SweepCodec::jpeg;
  SweepArm arm = SweepArm::image;
  double setting = 0;
};

// All jobs; those of one scene and split are neighbors.
std::vector<SweepJob> sweep_jobs(const SweepPlan& plan);

// The part of the list that one process does: jobs whose number leaves the remainder number - 1 when divided by count.
struct SweepShard {
  uint64_t number = 1, count = 1;  // 1 <= number <= count
};
std::vector<SweepJob> jobs_of_shard(const std::vector<SweepJob>& jobs, const SweepShard& shard);

// Wall clock, jobs side by side on all threads: to be looked at, never compared.
struct SweepTime {
  uint64_t job = 0;
  double render_ms = 0;  // H, L and D of all frames; shared by the jobs of one scene and split
  double code_ms = 0;    // encoding, and decoding to what the viewer sees
  double score_ms = 0;
};
std::string sweep_times_csv(const std::vector<SweepTime>& times);

struct SweepRun {
  SweepTable table;
  std::vector<SweepTime> times;  // in the order of the points
};

struct SweepOptions {
  SweepShard shard;
  int threads = 1;  // 0 = all
  Isa isa = best_isa();
  // Before each batch of jobs: how many are done, of how many, and the batch's first. May be empty.
  std::function<void(size_t done, size_t total, const SweepJob& next)> progress;
};

// Fails with bad_argument for a plan out of its ranges, and as make_split, Renderer::render and the codecs.
Result<SweepRun> run_sweep(const SweepPlan& plan, const SweepOptions& options = {});

}  // namespace pac::sim
