// One still through both arms: JPEG of the high-quality rendering against polygon-assisted JPEG.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/image.h"
#include "base/isa.h"
#include "base/result.h"
#include "raster/scene.h"
#include "sim/block_importance.h"
#include "sim/match.h"
#include "sim/scenes.h"
#include "sim/screen_model.h"
#include "sim/split.h"

namespace pac::sim {

// First-order entropies in bits a pixel (definitions in base/metrics.h). The paper does not say which one it means.
struct Entropies {
  double luma = 0;       // of Y, 8 bits
  double mean_rgb = 0;   // mean of the three channels'
  double joint_rgb = 0;  // of whole pixels
};

// Against H, over all images [Levoy95 s.3].
struct Scores {
  double rms = 0;      // root mean square over all samples of R, G, B, in code values
  double psnr_db = 0;  // from rms, peak 255; +infinity where the images are equal (JSON: null)
  double ssim = 0;     // of luma
};

Entropies measure_entropies(ConstRgbView image);
Scores measure_scores(ConstRgbView reference, ConstRgbView test);

// Milliseconds of wall clock; never part of a comparison of results.
struct Timings {
  double render_high = 0, render_low = 0;               // each alone
  double render_pair = 0;                               // H, L and D in one traversal; 0 where the split has two models
  double encode_image = 0, decode_image = 0;            // one JPEG encode and decode of H
  double encode_difference = 0, decode_difference = 0;  // of D
  double composite = 0;                                 // L + 2 (D - 127)
  double encode_model = 0, decode_model = 0;            // transmitted model only
};

struct RenderOptions {
  std::string split;          // as make_split; empty = the scene's own
  int width = 0, height = 0;  // 0 = the scene's own
  int samples = 16;
  bool transmit_model = false;   // L is drawn from the decoded screen-space model
  int position_bits = 16;        // of that model, 1..16
  bool time_renders = false;     // also render H and L alone, for Timings
  bool find_blocks = false;      // also tell what each 8x8 block shows, for Renderings::blocks
  ImportanceOptions importance;  // how much errors in them count, of both arms; heeded where tables are adapted
  int threads = 1;               // 0 = all
  Isa isa = best_isa();
};

// H, L and D of one camera: everything that does not depend on quality.
struct Renderings {
  Split split;
  RgbImage high, low, difference;
  BlockImportance blocks;  // of H; empty unless asked for or the options of importance are on
  Entropies high_entropy, low_entropy, difference_entropy;
  uint64_t high_polygons = 0, low_polygons = 0;  // faces of the models, as the paper counts
  uint64_t visible_low_polygons = 0;             // of the transmitted model, after clipping; 0 where resident
  uint64_t visible_low_vertices = 0;
  bool model_transmitted = false;
  uint64_t model_bytes = 0;            // a frame: 0 where resident
  int position_bits = 0;               // of that model; 0 where resident
  geomcodec::EncodedSize model_parts;  // of model_bytes
  double estimated_model_bytes = 0;    // the paper's estimate: 10/3 bytes a polygon of the low model
  uint64_t resident_model_bytes = 0;   // the session message's model, once
  Timings timings;                     // the render_* and *_model fields
};

// Fails as make_split, Renderer::create and Renderer::render.
Result<Renderings> render_split(const SceneSet& scene, const raster::Camera& camera, const RenderOptions& options);

// One arm of the comparison.
struct Arm {
  CodedImage coded;                    // of H, or of D
  RgbImage shown;                      // what the viewer sees: decoded H, or the composite
  RgbImage decoded;                    // decoded D; empty for the image-based arm
  Scores scores;                       // of `shown` against H
  uint64_t image_bytes = 0;            // the JPEG file
  uint64_t optimal_huffman_bytes = 0;  // with Huffman codes made for it; 0 but from run_still
  uint64_t model_bytes = 0;            // of this frame; 0 where resident, and for the image-based arm
  uint64_t total_bytes = 0;            // image + model
  double compression_ratio = 0;        // width * height * 3 / total_bytes
  double budget_share = 0;  // total_bytes / 12,500: a frame's share of 2 Mb/s at 20 frames a second [Table I]
};

constexpr double kBudgetBytesPerFrame = 2e6 / 20 / 8;

enum class ArmKind : uint8_t { image_based, polygon_assisted };

// Codes, decodes, adds, scores: at a coded quality, or at a size of the JPEG file (the model is on top of it).
// `timings` (may be null) gets the encode_*, decode_* and composite fields.
Result<Arm> code_arm_at_quality(const Renderings& renderings, ArmKind kind, double quality,
                                const CodingOptions& options, Timings* timings = nullptr);
Result<Arm> code_arm_at_size(const Renderings& renderings, ArmKind kind, uint64_t target_bytes,
                             const CodingOptions& options, Timings* timings = nullptr);

struct StillOptions {
  RenderOptions render;
  CodingOptions coding;
  double quality = 15;        // of the image-based arm; the polygon-assisted JPEG is matched to its size [s.4.1]
  uint64_t target_bytes = 0;  // > 0: both arms' JPEG files are matched to this size instead
  bool charge_model = false;  // the polygon-assisted arm's JPEG *and* transmitted model together match the size
};

struct Still {
  Renderings renderings;
  Arm image_based, polygon_assisted;
  Timings timings;  // all fields
};

// One way to divide a byte budget between the transmitted model's positions and the image.
struct Division {
  int position_bits = 0;
  uint64_t model_bytes = 0, image_bytes = 0;
  double image_quality = 0, rms = 0;  // of the difference's JPEG; of the composite against H
};
// Precisions that divide_budget() tries: below, vertices lie pixels apart; 16 is what the paper sends.
constexpr int kFewestPositionBits = 8, kMostPositionBits = 16;

// Fails with bad_argument for quality out of range, and as the functions above. With charge_model: limit_exceeded
// where the model alone is larger than the size.
Result<Still> run_still(const SceneSet& scene, const raster::Camera& camera, const StillOptions& options);

struct DividedStill {
  Still still;                      // at the best division: the least rms, of equals the coarser model
  std::vector<Division> divisions;  // all that fit the budget, by position bits
};

// A transmitted model and an image that take target_bytes together, divided so that the composite is nearest to H; the
// image-based arm gets the same bytes. transmit_model, charge_model and position_bits of `options` are taken as said.
// Fails as run_still; bad_argument without target_bytes, limit_exceeded where no division fits.
Result<DividedStill> divide_budget(const SceneSet& scene, const raster::Camera& camera, const StillOptions& options);

// Row F of Table I: the same still with the model transmitted. D is coded at `difference_quality` (row E's), and the
// image-based arm at the size of D and model together, so that the two can be compared ("even in this case", s.4.1).
Result<Still> run_transmitted(const SceneSet& scene, const raster::Camera& camera, const StillOptions& options,
                              double difference_quality);

}  // namespace pac::sim
