// The paper's animations [Levoy95 s.3, last paragraph, and s.4.2]: motion JPEG and MPEG-1, image-based and
// polygon-assisted, each over several rates: the data of the demo's second page.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/file_io.h"
#include "base/image.h"
#include "base/result.h"
#include "sim/animation.h"
#include "sim/paper_figures.h"

namespace pac::sim {

enum class AnimationArm : uint8_t {
  mjpeg,           // every frame of H a JPEG file
  mjpeg_assisted,  // every frame's D a JPEG file, in the bytes of H's
  mpeg1,           // MPEG-1 of H
  mpeg1_assisted,  // MPEG-1 of D = 127 + (H - L)/2, in the bytes of H's; the paper's form
  mpeg1_predicted  // beyond the paper: H predicted from L and the warped difference of the frame before
};
constexpr size_t kAnimationArmCount = 5;

// An arm at one rate.
struct AnimationPoint {
  double setting = 0;  // IJG quality, or quantizer_scale, of the image-based arm whose bytes are matched
  VideoArm arm;
};

struct AnimationCurve {
  std::vector<AnimationPoint> points;  // from the finest to the coarsest
  RgbImage film;                       // what is shown at points[kShownRate]: the frames one below the other
};

// The streams of points[kShownRate] of both arms of a run.
struct AnimationStreams {
  AnimationArm assisted;  // the polygon-assisted arm
  VideoCodec codec;
  Bytes image, difference;  // JPEG files one after the other, or MPEG-1 at the run's own frame rate
  Bytes session;            // .pacs
};

struct AnimationSet {
  std::string key;    // "room", "cubes"
  std::string title;  // one line
  Split split;
  int width = 0, height = 0, frames = 0, frames_per_second = 0;
  RgbImage high_film;
  std::array<AnimationCurve, kAnimationArmCount> curves;  // by AnimationArm
  std::array<AnimationStreams, 3> streams;                // of the three polygon-assisted arms
};

constexpr size_t kShownRate = 2;

// Half a minute of work on two cores at full size. PaperOptions as for run_paper(). Fails as run_animation.
Result<std::vector<AnimationSet>> run_paper_animations(const PaperOptions& options);

// BD-rate of `test` against `reference` by metric `kind` of kScores (its mean over the frames), in percent of bytes;
// empty where the two share no range of quality.
std::optional<double> bytes_saved_percent(const AnimationCurve& reference, const AnimationCurve& test, size_t kind);

}  // namespace pac::sim
